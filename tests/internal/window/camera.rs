//! Tests of panning and zooming the picture on the canvas, and of moving the camera in the scene.

use eframe::egui::{Key, Modifiers, PointerButton, Vec2};
use rasterscope::ui::session::PointerMode;

use super::bench::Bench;

#[test]
fn the_wheel_enlarges_and_keeps_the_pixel_under_the_pointer() {
    let mut bench = Bench::small("triangle");
    let place = bench.place_of((37, 21));
    let width_before = bench.canvas().width();
    for points in [120.0, 300.0, -200.0, 90.0] {
        bench.wheel(place, points, Modifiers::NONE);
        bench.click_at(place);
        assert_eq!(bench.session().pick, Some((37, 21)), "after {points}");
    }
    // After zooming in, the neighbour is farther away than before.
    let before = Bench::small("triangle");
    let pitch = before.place_of((38, 21)).x - before.place_of((37, 21)).x;
    bench.click_at(place + Vec2::new(pitch, 0.0));
    assert_eq!(bench.session().pick, Some((37, 21)));
    assert_eq!(bench.canvas().width(), width_before);
    assert!(!bench.mentions("fit"));
    bench.press(Key::F);
    bench.click_at(place + Vec2::new(pitch, 0.0));
    assert_eq!(bench.session().pick, Some((38, 21)), "fitted again");
}

#[test]
fn one_to_one_puts_each_pixel_on_one_point() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::Num0);
    let center = bench.canvas().center();
    bench.click_at(center);
    let (x, y) = bench.session().pick.unwrap();
    bench.click_at(center + Vec2::new(7.0, -5.0));
    assert_eq!(bench.session().pick, Some((x + 7, y - 5)));
    assert!(bench.mentions("100 %"));
}

#[test]
fn dragging_pans_the_picture_in_pan_mode_and_with_the_middle_button() {
    for (key, button) in [(Some(Key::P), PointerButton::Primary), (None, PointerButton::Middle)] {
        let mut bench = Bench::small("triangle");
        let camera = bench.session().state.camera;
        key.into_iter().for_each(|key| bench.press(key));
        let place = bench.place_of((50, 50));
        bench.drag(button, place, Vec2::new(40.0, -30.0));
        bench.click_at(place + Vec2::new(40.0, -30.0));
        assert_eq!(bench.session().pick, Some((50, 50)), "{button:?}");
        assert_eq!(bench.session().state.camera, camera);
    }
}

#[test]
fn a_click_picks_and_does_not_orbit() {
    let mut bench = Bench::small("triangle");
    let camera = bench.session().state.camera;
    let place = bench.place_of((70, 40));
    // Pressing and releasing slightly apart is a click.
    bench.drag(PointerButton::Primary, place, Vec2::new(1.0, 1.0));
    assert_eq!((bench.session().pick, bench.session().state.camera), (Some((70, 40)), camera));
}

#[test]
fn a_rectangle_is_drawn_after_its_key() {
    let mut bench = Bench::small("triangle");
    let camera = bench.session().state.camera;
    bench.press_with(Modifiers::SHIFT, Key::R);
    let (from, to) = (bench.place_of((20, 10)), bench.place_of((60, 40)));
    bench.drag(PointerButton::Primary, from, to - from);
    let region = bench.session().features.range.region.expect("a rectangle is selected");
    assert_eq!((region.left, region.top, region.right, region.bottom), (20, 10, 61, 41));
    assert_eq!(bench.session().state.camera, camera);
}

#[test]
fn dragging_orbits_and_h_returns_to_the_home_view() {
    let mut bench = Bench::small("cubes");
    let (home, picture) = (bench.session().state.camera, bench.image());
    assert_eq!(bench.session().features.canvas.pointer_mode, PointerMode::Orbit);
    let from = bench.canvas().center();
    bench.drag(PointerButton::Primary, from, Vec2::new(60.0, 20.0));
    let turned = bench.session().state.camera;
    assert_ne!(turned, home);
    let (before, after) = ((home.eye - home.target).length(), (turned.eye - turned.target).length());
    assert!((before - after).abs() < 1e-3 * before, "orbiting keeps the distance: {before} and {after}");
    assert_ne!(bench.image(), picture);
    assert_eq!(bench.image(), *bench.expected().image());
    bench.press(Key::H);
    assert_eq!(bench.session().state.camera, home);
    assert_eq!(bench.image(), picture);
}

#[test]
fn a_whole_drag_of_the_camera_is_one_step_of_undo() {
    let mut bench = Bench::small("triangle");
    let home = bench.session().state.camera;
    let from = bench.canvas().center();
    bench.drag(PointerButton::Primary, from, Vec2::new(-50.0, 10.0));
    assert_ne!(bench.session().state.camera, home);
    bench.press_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(bench.session().state.camera, home);
    assert!(!bench.session().can_undo());
}

#[test]
fn the_wheel_dollies_in_camera_mode_and_with_ctrl() {
    let mut bench = Bench::small("triangle");
    let from = bench.canvas().center();
    let distance = |bench: &Bench| (bench.session().state.camera.eye - bench.session().state.camera.target).length();
    let start = distance(&bench);
    bench.wheel(from, 60.0, Modifiers::COMMAND);
    let nearer = distance(&bench);
    assert!(nearer < start, "{nearer} < {start}");
    bench.press(Key::C);
    bench.wheel(from, -60.0, Modifiers::NONE);
    assert!(distance(&bench) > nearer);
}

#[test]
fn buttons_and_keys_select_the_pointer_mode() {
    let mut bench = Bench::small("triangle");
    for (button, key, mode) in [("Camera mode", Key::C, PointerMode::Camera), ("Pan mode", Key::P, PointerMode::Pan)] {
        bench.click(button);
        assert_eq!(bench.session().features.canvas.pointer_mode, mode);
        bench.click("Orbit mode");
        assert_eq!(bench.session().features.canvas.pointer_mode, PointerMode::Orbit);
        bench.press(key);
        assert_eq!(bench.session().features.canvas.pointer_mode, mode);
        bench.press(key);
        assert_eq!(bench.session().features.canvas.pointer_mode, PointerMode::Orbit);
    }
}
