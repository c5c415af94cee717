//! Tests of the neighbourhood of the picked pixel in the inspector.

use eframe::egui::{Role, vec2};
use egui_kittest::kittest::Queryable as _;

use super::bench::Bench;

#[test]
fn a_click_on_a_neighbour_picks_it() {
    let mut bench = Bench::small("triangle");
    bench.session_mut().pick = Some((80, 45));
    bench.rest();
    let around = bench.window.get_by_role_and_label(Role::Image, "Neighbourhood of the picked pixel").rect();
    // A pixel is 8 points wide in this picture.
    bench.click_at(around.center() + vec2(16.0, -24.0));
    assert_eq!(bench.session().pick, Some((82, 42)));
    assert_eq!(bench.view().report.as_ref().map(|report| (report.x, report.y)), Some((82, 42)));
}
