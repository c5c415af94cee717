//! Tests of watched pixels: adding, following from frame to frame, picking and removing them.

use eframe::egui::Key;
use rasterscope::inspect::Stage;
use rasterscope::pipeline::settings::{Choice as _, Shading};
use rasterscope::ui::session::workspace::Panel;

use super::bench::Bench;

#[test]
fn a_watched_pixel_is_followed_and_changes_are_marked() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::Watch);
    assert!(bench.says("No watched pixels"));
    let there = bench.place_of((80, 45));
    bench.click_at(there);
    bench.press(Key::Enter);
    let [r, g, b, _] = bench.image().at(80, 45);
    assert_eq!(bench.session().features.watch.pixels, [(80, 45)]);
    assert!(bench.mentions(&format!("{r} {g} {b}")));
    bench.select(Stage::Shade);
    bench.choose("Shading", Shading::Normals.name());
    let [r, g, b, _] = bench.image().at(80, 45);
    assert!(bench.says(&format!("• {r} {g} {b}")), "the colour changed");
    assert!(bench.says("1"), "and the overdraw did not");
}

#[test]
fn a_watched_pixel_is_picked_by_a_click_and_removed() {
    let mut bench = Bench::small("triangle");
    for pixel in [(80, 45), (3, 4)] {
        let there = bench.place_of(pixel);
        bench.click_at(there);
        bench.click("Watch this pixel  (Enter)");
    }
    assert_eq!(bench.session().features.watch.pixels, [(80, 45), (3, 4)]);
    bench.show_panel(Panel::Watch);
    bench.click("80, 45");
    assert_eq!(bench.session().pick, Some((80, 45)));
    bench.click("Stop watching 80, 45");
    assert_eq!(bench.session().features.watch.pixels, [(3, 4)]);
    bench.click("Clear");
    assert!(bench.says("No watched pixels"));
}
