//! Tests of overlays on the canvas: list, stack, values under the pointer, steps from fault to fault, and totals as a
//! file.

use eframe::egui::{Key, Modifiers, Role, Vec2};
use egui_kittest::kittest::Queryable as _;
use rasterscope::inspect::Buffer;
use rasterscope::inspect::overlays::{Overlay, compose};
use rasterscope::inspect::view::Value;
use rasterscope::pipeline::settings::FillRule;
use rasterscope::ui::engine::Shown;
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::overlays::OverlayChange;

use super::bench::Bench;

fn lay(bench: &mut Bench, overlay: Overlay) {
    bench.session_mut().apply(Command::Overlays(OverlayChange::Toggle(overlay)));
    bench.rest();
}

#[test]
fn the_list_switches_overlays_on_and_off() {
    let mut bench = Bench::small("interpenetrating");
    let image = bench.image();
    bench.press(Key::O);
    bench.window.get_by_role_and_label(Role::CheckBox, "Facing").click();
    bench.rest();
    assert_eq!(bench.session().features.overlays.layers.len(), 1);
    assert!(bench.says("Overlays (1)") || bench.mentions("Overlays (1)"));
    let view = bench.view();
    assert_ne!(*view.picture, image);
    assert_eq!(
        *view.picture,
        compose(&image, [(&*view.look_result.sheets[0], bench.session().features.overlays.layers[0].opacity)])
    );
    assert_eq!(bench.image(), image, "the frame itself stays");
    bench.window.get_by_role_and_label(Role::CheckBox, "Facing").click();
    bench.rest();
    assert_eq!(*bench.view().picture, image);
    bench.press(Key::O);
    assert!(!bench.session().features.overlays.open);
}

#[test]
fn the_inspector_shows_the_value_under_the_pointer() {
    let mut bench = Bench::small("triangle");
    lay(&mut bench, Overlay::Rasterized);
    let middle = bench.place_of((84, 44));
    bench.window.hover_at(middle);
    bench.rest();
    assert!(bench.says("1 fragment"));
    let corner = bench.place_of((1, 1));
    bench.window.hover_at(corner + Vec2::splat(0.5));
    bench.rest();
    assert!(!bench.says("1 fragment"));
}

#[test]
fn j_goes_from_one_fault_of_an_overlay_to_the_next() {
    let mut bench = Bench::small("shared-edges");
    bench.session_mut().state.recipe.pipeline.fill_rule = FillRule::Exclusive;
    lay(&mut bench, Overlay::ExactOwner);
    bench.session_mut().pick = None;
    bench.rest();
    let sheet = bench.view().look_result.sheets[0].clone();
    let first = sheet.next_pixel(None, true).expect("the rule leaves pixels out");
    bench.press(Key::J);
    assert_eq!(bench.session().pick, Some(first));
    bench.press(Key::J);
    assert_eq!(bench.session().pick, sheet.next_pixel(Some(first), true));
}

#[test]
fn lines_are_drawn_into_small_pixels_and_over_large_ones() {
    let mut bench = Bench::new("triangle");
    let image = bench.image();
    lay(&mut bench, Overlay::Wireframe);
    assert_ne!(*bench.view().picture, image);
    let middle = bench.canvas().center();
    bench.wheel(middle, 800.0, Modifiers::NONE);
    assert!(bench.session().features.overlays.vectors);
    assert_eq!(*bench.view().picture, image, "lines are drawn over the picture, not into it");
    assert!(!bench.view().look_result.sheets[0].lines.is_empty());
}

#[test]
fn another_buffer_changes_only_the_sheets_that_read_it() {
    let mut bench = Bench::small("triangle");
    lay(&mut bench, Overlay::Rasterized);
    lay(&mut bench, Overlay::Clipped);
    let sheets = bench.view().look_result.sheets.clone();
    bench.press(Key::N);
    let again = bench.view().look_result.sheets.clone();
    assert!(std::sync::Arc::ptr_eq(&sheets[0], &again[0]));
    assert!(!std::sync::Arc::ptr_eq(&sheets[1], &again[1]));
}

#[test]
fn totals_and_exact_values_are_written_into_the_folder() {
    let mut bench = Bench::small("triangle");
    let folder = tempfile::tempdir().unwrap();
    bench.session_mut().features.files.folder = folder.path().to_owned();
    lay(&mut bench, Overlay::Rasterized);
    bench.press(Key::O);
    bench.click("Save all totals as CSV in the current folder");
    let table = std::fs::read_to_string(folder.path().join("overlays.csv")).unwrap();
    assert!(table.starts_with("overlay,total,value,unit\nrasterized,in all,"));
    bench.session_mut().apply(Command::Show(Shown::Buffer(Buffer::Depth)));
    bench.rest();
    bench.press_with(Modifiers::COMMAND | Modifiers::ALT, Key::S);
    let bytes = std::fs::read(folder.path().join("depth.pfm")).unwrap();
    let header = b"Pf\n160 90\n-1.0\n";
    assert_eq!(bytes.len(), header.len() + 4 * 160 * 90);
    let Value::Number(depth) = bench.view().value(84, 44) else { panic!("the triangle is there") };
    let at = header.len() + 4 * ((89 - 44) * 160 + 84);
    assert_eq!(bytes[at..at + 4], depth.to_le_bytes());
}

#[test]
fn the_list_changes_the_length_of_normals() {
    let mut bench = Bench::small("triangle");
    lay(&mut bench, Overlay::FaceNormals);
    let sheet = |bench: &Bench| bench.view().look_result.sheets[0].clone();
    let length = |bench: &Bench| {
        let [[ax, ay], [bx, by]] = sheet(bench).lines[0];
        (bx - ax).hypot(by - ay)
    };
    let (first, before) = (length(&bench), sheet(&bench));
    assert_eq!(before.lines.len(), 1);
    bench.press(Key::O);
    bench.window.get_by_role_and_label(Role::Slider, "Length of “Face normals”").set_value_accesskit(0.12);
    bench.rest();
    assert!(length(&bench) > 3.0 * first, "{} and {first}", length(&bench));
    // Switching the overlay off and on restores the default length.
    lay(&mut bench, Overlay::FaceNormals);
    lay(&mut bench, Overlay::FaceNormals);
    assert_eq!(length(&bench), first);
}
