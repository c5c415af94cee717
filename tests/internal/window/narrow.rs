//! Tests that narrow windows keep all controls: what does not fit is in a menu at the end of its bar.

use eframe::egui::{Key, Vec2};
use egui_kittest::kittest::Queryable as _;
use rasterscope::pipeline::settings::Choice as _;
use rasterscope::ui::session::workspace::Workspace;

use super::bench::Bench;

/// Controls of the bar above the canvas.
const TOOLS: [&str; 13] = [
    "Show the previous stage",
    "Show the next stage",
    "160 × 90",
    "Overlays",
    "Orbit mode",
    "Pan mode",
    "Camera mode",
    "Fit the picture into the canvas  (F)",
    "Show one picture pixel per screen pixel  (0)",
    "Compare pictures side by side  (T)",
    "Show the mesh view: the scene from a second camera  (M)",
    "Show the effect of the last change of a setting  (X)",
    "Show the range controls and the histogram over the picture",
];

fn is_shown(bench: &Bench, name: &str) -> bool {
    let window = bench.window.ctx.content_rect();
    bench.window.query_all_by_label(name).any(|node| window.contains_rect(node.rect()))
}

/// Asserts that a control is in its bar or in the menu `more`. Returns whether it is in the menu.
fn is_in_menu(bench: &mut Bench, name: &str, more: &str) -> bool {
    if is_shown(bench, name) {
        return false;
    }
    bench.click(more);
    assert!(is_shown(bench, name), "“{name}” is neither in the bar nor in the menu");
    bench.press(Key::Escape);
    true
}

#[test]
fn every_control_is_reachable_in_a_narrow_window() {
    for (width, height) in [(900.0, 560.0), (1024.0, 640.0), (1280.0, 800.0)] {
        let mut bench = Bench::small("triangle");
        bench.window.set_size(Vec2::new(width, height));
        bench.rest();
        let hidden = TOOLS.into_iter().filter(|name| is_in_menu(&mut bench, name, "More tools of the picture")).count();
        assert!(hidden > 0 || width > 900.0, "the smallest window has no room for all tools");
        assert!(is_shown(&bench, "160 × 90"), "the picture size is the last one to move");
        for name in ["File", "Edit", "Scene", "View", "Go", "Help", "Switch between dark and light theme"] {
            assert!(is_shown(&bench, name), "{name} at {width}");
        }
        for workspace in Workspace::ALL {
            is_in_menu(&mut bench, workspace.name(), "More of the menu bar");
        }
    }
}

#[test]
fn a_tool_in_the_menu_works_as_in_the_bar() {
    let mut bench = Bench::small("triangle");
    bench.window.set_size(Vec2::new(900.0, 560.0));
    bench.rest();
    bench.click("More tools of the picture");
    bench.click("Show the range controls and the histogram over the picture");
    assert!(bench.session().features.range.open);
}

#[test]
fn workspaces_that_do_not_fit_are_in_the_menu() {
    let mut bench = Bench::small("triangle");
    bench.window.set_size(Vec2::new(620.0, 560.0));
    bench.rest();
    assert!(!is_shown(&bench, Workspace::Robustness.name()));
    bench.click("More of the menu bar");
    bench.click(Workspace::Robustness.name());
    assert_eq!(bench.session().workspace(), Workspace::Robustness);
}
