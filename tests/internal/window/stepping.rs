//! Tests of stepping through the frame by stage, by buffer and by triangle.

use eframe::egui::{self, Key, Modifiers, Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glam::Vec3;
use rasterscope::inspect::overlays::Overlay;
use rasterscope::inspect::{Buffer, Stage, stages};
use rasterscope::pipeline::settings::{Choice as _, DepthTest, FillRule};
use rasterscope::scene::Camera;
use rasterscope::ui::engine::Shown;
use rasterscope::ui::format;
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::overlays::OverlayChange;

use super::bench::Bench;

/// Checks that the canvas shows the picture after `stage`.
fn assert_shows(bench: &Bench, stage: Stage) {
    let view = bench.view();
    let request = bench.session().request();
    assert_eq!(request.shown, Shown::Stage(stage));
    let expected = stages::picture(&request.scene, &request.camera, &request.recipe, &bench.expected(), stage);
    assert_eq!(*view.picture, expected, "{}", stage.name());
}

#[test]
fn brackets_step_through_all_stages_and_stop_at_the_ends() {
    let mut bench = Bench::small("interpenetrating");
    bench.click_eye(Stage::Upscale);
    for stage in Stage::ALL.iter().rev().skip(1) {
        bench.press(Key::OpenBracket);
        assert_shows(&bench, *stage);
    }
    bench.press(Key::OpenBracket);
    assert_shows(&bench, Stage::ALL[0]);
    for stage in &Stage::ALL[1..] {
        bench.press(Key::CloseBracket);
        assert_shows(&bench, *stage);
    }
    bench.press(Key::CloseBracket);
    assert_shows(&bench, Stage::Upscale);
}

#[test]
fn every_stage_s_eye_shows_its_picture_and_hides_it_again() {
    let mut bench = Bench::small("interpenetrating");
    for stage in Stage::ALL {
        bench.click_eye(*stage);
        assert_shows(&bench, *stage);
        assert_eq!(bench.session().features.stages.selected, *stage);
        bench.click_eye(*stage);
        assert_eq!(bench.session().shown, Shown::Buffer(Buffer::Color));
    }
}

#[test]
fn brackets_move_the_selection_and_leave_a_shown_buffer() {
    let mut bench = Bench::small("triangle");
    assert_eq!(bench.session().features.stages.selected, Stage::Rasterize);
    assert!(bench.says("Fill rule") && !bench.says("Colour space"));
    for (key, stage) in [(Key::OpenBracket, Stage::Cull), (Key::CloseBracket, Stage::Rasterize)] {
        bench.press(key);
        assert_eq!(bench.session().features.stages.selected, stage);
        assert_eq!(bench.session().shown, Shown::Buffer(Buffer::Color));
    }
}

#[test]
fn a_selected_row_shows_its_picture_if_a_stage_is_shown() {
    let mut bench = Bench::small("interpenetrating");
    bench.click_eye(Stage::Cull);
    bench.select(Stage::Depth);
    assert_shows(&bench, Stage::Depth);
    bench.click("Show the previous stage");
    assert_eq!(bench.session().features.stages.selected, Stage::Rasterize);
    assert_shows(&bench, Stage::Rasterize);
}

#[test]
fn rows_are_focused_and_selected_by_keys() {
    let mut bench = Bench::small("triangle");
    bench.window.get_by_role_and_label(Role::Button, "Clip stage").focus();
    bench.rest();
    bench.press(Key::Enter);
    assert_eq!(bench.session().features.stages.selected, Stage::Clip);
    bench.press(Key::CloseBracket);
    assert_eq!(bench.session().features.stages.selected, Stage::Project);
    for (name, is_selected) in [("Clip stage", false), ("Project stage", true)] {
        let row = bench.window.get_by_role_and_label(Role::Button, name).accesskit_node();
        assert_eq!(row.toggled() == Some(egui::accesskit::Toggled::True), is_selected, "{name}");
        assert_eq!(row.is_focused(), is_selected, "the focus moves along: {name}");
    }
}

#[test]
fn rows_have_counts_with_units_or_the_reason_for_skipping() {
    let mut bench = Bench::small("interpenetrating");
    let triangles = format!("{} tris", bench.session().scene.triangle_count());
    assert!(bench.says(&triangles), "{triangles}");
    let shaded = bench.session().features.stages.figures.expect("stages were timed").counters.shaded;
    assert!(bench.says(&format!("{} frags", format::short_count(shaded))));
    assert!(bench.says("every pixel is drawn") && !bench.says("the depth test is off"));
    bench.select(Stage::Depth);
    bench.choose("Test", DepthTest::Off.name());
    assert!(bench.says("the depth test is off"));
}

#[test]
fn faults_are_counted_stepped_through_and_explained() {
    let mut bench = Bench::small("shared-edges");
    bench.press(Key::J);
    assert_eq!(bench.session().shown, Shown::Buffer(Buffer::Hits));
    assert!(bench.says("0 cracks · 0 double hits"));
    let pick = bench.session().pick;
    bench.press(Key::J);
    assert_eq!(bench.session().pick, pick, "there is no fault to go to");

    bench.session_mut().state.recipe.pipeline.fill_rule = FillRule::Exclusive;
    bench.rest();
    let hits = bench.view().buffers.as_ref().and_then(|buffers| buffers.hits.clone()).expect("hits are counted");
    let places: Vec<_> = hits.faults.iter().map(|fault| (fault.x, fault.y)).collect();
    assert!(places.len() > 10 && bench.says(&format!("{} cracks", places.len())) && bench.says("0 double hits"));
    bench.session_mut().pick = None;
    bench.rest();
    bench.click("Next fault  (J)");
    assert_eq!(bench.session().pick, Some(places[0]));
    bench.press(Key::J);
    assert_eq!(bench.session().pick, Some(places[1]));
    bench.click("Previous fault  (Shift+J)");
    bench.press_with(Modifiers::SHIFT, Key::J);
    assert_eq!(bench.session().pick, places.last().copied(), "it wraps around");
    assert!(bench.mentions("A crack: no triangle covers this pixel, though triangle "));
    // The pixel is in the middle of the canvas: a click there picks the same pixel.
    let middle = bench.canvas().center();
    bench.session_mut().pick = None;
    bench.click_at(middle);
    assert_eq!(bench.session().pick, places.last().copied());
}

#[test]
fn j_goes_to_the_pixels_that_t_junctions_open_and_explains_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.obj");
    // A triangle above an edge, and below it two triangles that share a vertex slightly off that edge.
    let model = "v -1 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0.1 -0.0002 0\nf 1 2 3\nf 5 1 4\nf 2 5 4\n";
    std::fs::write(&path, model).unwrap();
    let mut bench = Bench::small("shared-edges");
    bench.drop_file(&path);
    // Tilted, because a gap between two rows of pixel centres would be invisible.
    let camera = Camera::look_at(Vec3::new(0.1, 0.02, 0.2), Vec3::new(0.1, 0.0, 0.0));
    bench.session_mut().state.camera = Camera { up: Vec3::new(0.2, 1.0, 0.0), ..camera };
    bench.rest();
    bench.press(Key::J);
    let hits = bench.view().buffers.as_ref().and_then(|buffers| buffers.hits.clone()).expect("hits are counted");
    assert!(hits.faults.len() > 3 && bench.says("Mesh: 1 T-junction · 0 unwelded vertices"));
    for fault in &hits.faults[..2] {
        bench.press(Key::J);
        assert_eq!(bench.session().pick, Some((fault.x, fault.y)));
        assert!(bench.mentions("A crack: no triangle covers the gap between triangles 0 and "));
        assert!(bench.mentions("T-junction: v"));
    }
    // With the overlay, the key goes to the vertex itself.
    bench.session_mut().apply(Command::Overlays(OverlayChange::Toggle(Overlay::Junctions)));
    bench.rest();
    bench.press(Key::J);
    let sheet = bench.view().look_result.sheets[0].clone();
    assert_eq!(bench.session().pick, sheet.next_pixel(None, true));
    assert_eq!(sheet.next_pixel(None, true), sheet.next_pixel(None, false), "there is only one");
}

#[test]
fn stages_differ_from_one_another() {
    let mut bench = Bench::small("cubes");
    let mut pictures = Vec::new();
    for stage in Stage::ALL {
        bench.click_eye(*stage);
        pictures.push(bench.view().picture.clone());
    }
    pictures.dedup();
    assert!(pictures.len() >= 7, "only {} different pictures", pictures.len());
}

#[test]
fn the_view_menu_shows_every_buffer() {
    let mut bench = Bench::small("interpenetrating");
    for buffer in Buffer::ALL {
        bench.click("View");
        bench.click("Buffer");
        bench.click(buffer.name());
        assert_eq!(bench.session().shown, Shown::Buffer(*buffer));
        assert_eq!(bench.view().request.shown, Shown::Buffer(*buffer));
    }
}

#[test]
fn keys_draw_the_frame_triangle_by_triangle() {
    let mut bench = Bench::small("shared-edges");
    let all = bench.view().rasterized;
    assert_eq!(all, 8);
    let drawn = |bench: &Bench| bench.view().frame.geometry().triangles.len();
    let complete = bench.image();

    bench.press(Key::Home);
    assert_eq!(drawn(&bench), 0);
    let empty = bench.image();
    assert!(empty.pixels().iter().all(|pixel| *pixel == empty.at(0, 0)), "only the background is left");
    for count in 1..=all {
        bench.press(Key::Period);
        assert_eq!(drawn(&bench), count);
    }
    assert_eq!(bench.session().features.scrub.triangle_limit, None, "all triangles are no limit");
    assert_eq!(bench.image(), complete);
    bench.press(Key::Period);
    assert_eq!(drawn(&bench), all);
    bench.press(Key::Comma);
    assert_eq!(drawn(&bench), all - 1);
    assert_ne!(bench.image(), complete);
    bench.press(Key::End);
    assert_eq!(bench.image(), complete);
}

#[test]
fn the_slider_and_its_buttons_limit_the_triangles() {
    let mut bench = Bench::small("shared-edges");
    bench.window.get_by_role_and_label(Role::Slider, "Triangles drawn").set_value_accesskit(3.0);
    bench.rest();
    assert_eq!(bench.session().features.scrub.triangle_limit, Some(3));
    assert_eq!(bench.view().frame.geometry().triangles.len(), 3);
    assert!(bench.says("3 / 8"));
    let buttons = [
        ("Draw one more triangle  (.)", Some(4)),
        ("Draw one fewer triangle  (,)", Some(3)),
        ("Go to the start, before the first triangle  (Home)", Some(0)),
        ("Draw one fewer triangle  (,)", Some(0)),
        ("Go to the end, after the last triangle  (End)", None),
    ];
    for (name, limit) in buttons {
        bench.click(name);
        assert_eq!(bench.session().features.scrub.triangle_limit, limit, "{name}");
    }
}

#[test]
fn the_inspector_explains_only_the_triangles_that_are_drawn() {
    let mut bench = Bench::small("shared-edges");
    let place = bench.place_of((80, 45));
    bench.click_at(place);
    assert!(!bench.view().report.as_ref().expect("picked").fragments.is_empty());
    bench.press(Key::Home);
    assert!(bench.view().report.as_ref().expect("picked").fragments.is_empty());
    assert!(bench.mentions("Passed 0"));
}
