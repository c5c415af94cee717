//! Tests of stepping and playing through the drawing of a frame by keys and sliders.

use eframe::egui::{Key, Modifiers, Role};
use egui_kittest::kittest::Queryable as _;
use rasterscope::inspect::scrub::{Moment, Unit};
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::scrub::ScrubChange;

use super::bench::Bench;

#[test]
fn keys_step_by_fragment_triangle_and_object() {
    let mut bench = Bench::small("cubes");
    let all = bench.session().triangle_count();
    bench.press_with(Modifiers::COMMAND, Key::Comma);
    let object = bench.session().moment();
    assert!(object.triangles < all - 1 && object.fragments.is_none());
    bench.press(Key::Comma);
    assert_eq!(bench.session().moment(), Moment::after(object.triangles - 1));
    bench.press_with(Modifiers::SHIFT, Key::Period);
    let first = bench.session().moment();
    assert_eq!(first.triangles, object.triangles);
    bench.press_with(Modifiers::SHIFT, Key::Comma);
    bench.press_with(Modifiers::COMMAND, Key::Period);
    assert_eq!(bench.session().moment(), object);
    bench.press_with(Modifiers::COMMAND, Key::Period);
    assert_eq!(bench.session().moment(), Moment::after(all));
}

#[test]
fn the_slider_of_fragments_draws_the_last_triangle_in_part() {
    let mut bench = Bench::small("shared-edges");
    bench.press(Key::Home);
    bench.press(Key::Period);
    let whole = bench.image();
    bench.window.get_by_role_and_label(Role::Slider, "Fragments drawn").set_value_accesskit(2.0);
    bench.rest();
    assert_eq!(bench.session().moment(), Moment { triangles: 1, fragments: Some(2) });
    let partial = bench.image();
    let drawn = partial.pixels().iter().filter(|pixel| **pixel != whole.at(0, 0)).count();
    assert_eq!(drawn, 2);
    assert_ne!(partial, whole);
    bench.press(Key::End);
    assert_eq!(bench.session().features.scrub.triangle_limit, None);
}

#[test]
fn the_bar_names_the_last_triangle_and_its_fragments() {
    let mut bench = Bench::small("cubes");
    bench.press(Key::Home);
    assert!(!bench.mentions(" fragments"));
    for _ in 0..3 {
        bench.press(Key::Period);
    }
    let session = bench.session();
    let view = bench.view();
    let last = view.timeline.as_ref().unwrap().last.clone().unwrap();
    let drawn = view.frame.geometry().triangles.last().unwrap().id;
    assert_eq!(last.id, drawn);
    let object = &session.scene.instances[last.instance as usize].name;
    let fragments = view.timeline.as_ref().unwrap().fragments[0];
    let name = format!("{object}, triangle {}, {fragments} fragments", last.id.0);
    assert!(bench.says(&name), "{name}");
    bench.press_with(Modifiers::SHIFT, Key::Comma);
    assert!(bench.mentions(&format!(", {} of {fragments} fragments", fragments - 1)));
    bench.press(Key::End);
    assert!(!bench.mentions(&format!(" of {fragments} fragments")));
}

#[test]
fn space_plays_and_stops() {
    let mut bench = Bench::small("shared-edges");
    bench.session_mut().apply(Command::Scrub(ScrubChange::Speed(4.0)));
    bench.window.key_press_modifiers(Modifiers::NONE, Key::Space);
    for _ in 0..6 {
        bench.window.step();
    }
    let on_the_way = bench.session().moment().triangles;
    assert!(bench.session().features.scrub.playing == 1 && (1..8).contains(&on_the_way), "{on_the_way}");
    bench.window.key_press_modifiers(Modifiers::NONE, Key::Space);
    bench.window.step();
    bench.rest();
    assert_eq!(bench.session().features.scrub.playing, 0);
}

#[test]
fn steps_that_do_not_touch_the_picked_pixel_are_skipped() {
    let mut bench = Bench::small("interpenetrating");
    let place = bench.place_of((80, 45));
    bench.click_at(place);
    let all = bench.view().report.as_ref().expect("picked").fragments.len();
    assert!(all > 0);
    bench.press(Key::Home);
    bench.click("Step only at the picked pixel");
    assert!(bench.session().features.scrub.only_touches);
    for fragments in 1..=all {
        bench.click("Draw one more triangle  (.)");
        assert_eq!(bench.view().report.as_ref().expect("picked").fragments.len(), fragments);
    }
    bench.press(Key::Y);
    assert!(!bench.session().features.scrub.only_touches);
    assert_eq!(bench.session().features.scrub.unit, Unit::Triangle);
}
