//! Tests of the key sheet, the theme and the tabs, and that an idle window draws nothing.

use eframe::egui::{Key, Modifiers, Role};
use egui_kittest::kittest::Queryable as _;
use rasterscope::ui::key_map::{BINDINGS, MOUSE};
use rasterscope::ui::session::WindowState;
use rasterscope::ui::session::appearance::AppearanceChange;
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::workspace::Panel;

use super::bench::Bench;

#[test]
fn the_key_sheet_lists_all_keys_and_gestures() {
    for (modifiers, key) in [(Modifiers::SHIFT, Key::Slash), (Modifiers::NONE, Key::Questionmark)] {
        let mut bench = Bench::small("triangle");
        bench.press_with(modifiers, key);
        assert!(bench.says("Keys and mouse"), "{key:?}");
        for what in BINDINGS.iter().map(|binding| binding.description).chain(MOUSE.iter().map(|(_, what)| *what)) {
            assert!(bench.says(what), "{what}");
        }
        bench.click("Close");
        assert!(!bench.says("Keys and mouse"));
    }
}

#[test]
fn keys_do_nothing_under_a_dialog() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::Questionmark);
    let pick = bench.session().pick;
    bench.press(Key::ArrowLeft);
    bench.press(Key::Home);
    assert_eq!(bench.session().pick, pick);
    assert_eq!(bench.session().features.scrub.triangle_limit, None);
    bench.press(Key::Escape);
    assert!(!bench.says("Keys and mouse"), "Escape closes the sheet");
    assert_eq!(bench.session().pick, pick, "and nothing else");
}

#[test]
fn one_button_switches_between_dark_and_light() {
    let mut bench = Bench::small("triangle");
    let dark = |bench: &Bench| bench.window.ctx.global_style().visuals.dark_mode;
    let before = dark(&bench);
    bench.click("Switch between dark and light theme");
    assert_ne!(dark(&bench), before);
    bench.click("Switch between dark and light theme");
    assert_eq!(dark(&bench), before);
}

#[test]
fn the_plan_lists_skipped_parts_with_reasons() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::SkippedWork);
    assert!(bench.mentions("1 × the mesh has no texture coordinates"));
    bench.show_panel(Panel::Log);
    assert!(bench.says("No messages"));
}

#[test]
fn an_idle_window_draws_nothing() {
    let mut bench = Bench::small("triangle");
    let view = bench.view().frame.clone();
    bench.window.run_steps(20);
    assert!(std::sync::Arc::ptr_eq(&view, &bench.view().frame));
    assert_eq!(bench.window.run(), 1, "nothing requests another pass");
}

#[test]
fn reduced_motion_stops_animations_and_is_stored() {
    let mut bench = Bench::small("triangle");
    let animates = |bench: &Bench| bench.window.ctx.global_style().animation_time > 0.0;
    assert!(animates(&bench));
    bench.click("View");
    bench.window.get_by_role_and_label(Role::CheckBox, "Reduce motion").click();
    bench.rest();
    assert!(!animates(&bench));
    let stored = bench.session().preferences(&WindowState::default()).window;
    assert_eq!(stored.reduce_motion, Some(true));
    bench.window.state_mut().queue(vec![Command::Appearance(AppearanceChange::ToggleMotion)]);
    bench.rest();
    assert!(animates(&bench));
}
