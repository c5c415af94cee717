//! Tests of the tab “Fates”: bins, objects and members, and their selection in the picture.

use eframe::egui::Key;
use rasterscope::inspect::fates::{Bin, TriangleFate};
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::fates::FatesChange;
use rasterscope::ui::session::workspace::Panel;

use super::bench::Bench;

#[test]
fn a_bin_selects_its_members_until_it_is_dropped() {
    let mut bench = Bench::small("near-plane");
    assert!(bench.session().features.fates.fates.is_none(), "fates are counted only while the tab is open");
    bench.show_panel(Panel::TriangleFates);
    let fates = bench.session().features.fates.fates.clone().expect("the tab is open");
    assert!(bench.says("all sums match"));
    let count = fates.triangle_counts().of(TriangleFate::LostDepth);
    bench.click(&format!("Depth failed: {count}"));
    let selection = bench.session().selection.clone();
    assert_eq!((selection.len() as u64, selection.label()), (count, "depth failed"));
    assert_eq!(bench.session().features.fates.members.len() as u64, count);
    assert!(bench.mentions(&format!("Clear the selection: {count} triangles: depth failed")));
    bench.press(Key::Escape);
    assert!(bench.session().selection.is_empty() && !bench.session().features.fates.is_filtering());
}

#[test]
fn clicking_a_member_picks_one_of_its_pixels() {
    let mut bench = Bench::small("interpenetrating");
    bench.show_panel(Panel::TriangleFates);
    bench.session_mut().apply(Command::Fates(FatesChange::Bin(Bin::Triangles(TriangleFate::Visible))));
    bench.rest();
    let fates = bench.session().features.fates.fates.clone().expect("the tab is open");
    let first = bench.session().features.fates.members[0];
    let name = &fates.objects[fates.object_of(first)].name;
    bench.click(&format!("Triangle {} of {name}: visible", first.0));
    assert_eq!(bench.session().pick, fates.representative_pixel(first));
    assert_eq!(bench.view().report.as_ref().expect("picked").visible().map(|f| f.triangle), Some(first));
}

#[test]
fn the_selection_follows_the_camera() {
    let mut bench = Bench::small("near-plane");
    bench.show_panel(Panel::TriangleFates);
    bench.session_mut().apply(Command::Fates(FatesChange::Bin(Bin::Triangles(TriangleFate::Outside))));
    bench.rest();
    let before = bench.session().selection.clone();
    bench.session_mut().state.camera.orbit(0.6, 0.1);
    bench.rest();
    let fates = bench.session().features.fates.fates.clone().expect("still open");
    let now = &bench.session().selection;
    assert_ne!(*now, before);
    assert_eq!(now.len() as u64, fates.triangle_counts().of(TriangleFate::Outside));
}
