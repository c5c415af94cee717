//! Tests of the 2D lab, driven by its switch, keys, buttons and the pointer on its grid.

use eframe::egui::{Key, PointerButton, Pos2, Rect, Role, Vec2};
use egui_kittest::kittest::Queryable as _;
use glam::DVec2;
use rasterscope::lab::seed_fills::Paint;
use rasterscope::lab::{Lesson, Page};
use rasterscope::pipeline::settings::Choice as _;

use super::bench::Bench;

fn opened(page: &str) -> Bench {
    let mut bench = Bench::small("triangle");
    bench.click("2D lab");
    bench.click(page);
    bench
}

fn grid(bench: &Bench) -> Rect {
    bench.window.get_by_role_and_label(Role::Image, "Grid of the lab").rect()
}

/// Returns the screen position of a point of the fitted grid, in points. `place` is in cells.
fn at(bench: &Bench, place: DVec2) -> Pos2 {
    let area = grid(bench);
    let (width, height) = bench.session().features.lab.recording.size;
    let size = Vec2::new(width as f32, height as f32);
    let scale = ((area.size() - Vec2::splat(32.0)) / size).min_elem();
    area.center() + (Vec2::new(place.x as f32, place.y as f32) - size / 2.0) * scale
}

#[test]
fn the_switch_and_the_key_lead_to_the_lab_and_back() {
    let mut bench = Bench::small("triangle");
    let shows = |bench: &Bench| bench.window.query_by_role_and_label(Role::Image, "Grid of the lab").is_some();
    assert!(!shows(&bench));
    bench.click("2D lab");
    assert!(shows(&bench) && bench.session().features.lab.open);
    bench.press(Key::L);
    assert!(!shows(&bench));
    bench.press(Key::L);
    bench.click("Inspect");
    assert!(!shows(&bench));
    assert_eq!(&bench.image(), bench.expected().image(), "the pipeline is as it was");
}

#[test]
fn every_page_explains_itself_and_can_be_stepped() {
    for page in Page::ALL {
        let mut bench = opened(page.name());
        assert_eq!(bench.session().features.lab.page, *page);
        assert!(bench.says(bench.session().features.lab.lesson().explanation()));
        let all = bench.session().features.lab.recording.steps.len();
        bench.press(Key::Home);
        assert!(bench.says("No step yet: step forward or play."));
        bench.click("Step forward  (.)");
        assert!(bench.says(&bench.session().features.lab.recording.steps[0].description.clone()), "{page:?}");
        bench.press(Key::End);
        bench.press(Key::Comma);
        assert_eq!(bench.session().features.lab.step, all - 1);
    }
}

#[test]
fn playing_ends_at_the_last_step() {
    let mut bench = opened("Circles");
    bench.window.key_press(Key::K);
    bench.window.run_steps(3);
    let step = bench.session().features.lab.step;
    assert!(step > 0 && step < bench.session().features.lab.recording.steps.len(), "{step}");
    bench.window.run_steps(300);
    assert_eq!(bench.session().features.lab.step, bench.session().features.lab.recording.steps.len());
    assert_eq!(bench.window.run(), 1, "nothing requests another pass");
}

#[test]
fn a_handle_is_dragged_and_the_run_follows() {
    let mut bench = opened("Lines");
    let handle = bench.session().features.lab.lesson().handles()[1];
    let target = handle + DVec2::new(-6.0, -4.0);
    let (from, to) = (at(&bench, handle), at(&bench, target));
    bench.drag(PointerButton::Primary, from, to - from);
    let moved = bench.session().features.lab.lesson().handles()[1];
    assert!((moved - target).length() < 0.8, "{moved}, not {target}");
    let last = bench.session().features.lab.recording.steps.last().unwrap().cells[0];
    assert_eq!(DVec2::new(last.x as f64 + 0.5, last.y as f64 + 0.5), moved);
}

#[test]
fn walls_are_painted_and_wiped_with_the_mouse() {
    let mut bench = opened("Seed fill");
    bench.click("Empty");
    let paint = |bench: &Bench, x, y| match bench.session().features.lab.lesson() {
        Lesson::SeedFill(lesson) => lesson.grid.at(x, y),
        other => panic!("{other:?}"),
    };
    let place = at(&bench, DVec2::new(3.5, 4.5));
    bench.drag(PointerButton::Primary, place, Vec2::new(1.0, 1.0));
    assert_eq!(paint(&bench, 3, 4), Paint::Wall);
    bench.drag(PointerButton::Secondary, place, Vec2::new(1.0, 1.0));
    assert_eq!(paint(&bench, 3, 4), Paint::Paper);
}

#[test]
fn all_methods_are_compared_with_their_error_and_time() {
    let mut bench = opened("Lines");
    bench.click("Compare all methods");
    let comparison = bench.session().features.lab.comparison.clone().unwrap();
    assert!(bench.mentions(&comparison.task));
    for rival in &comparison.methods {
        assert!(bench.mentions(rival.name), "{}", rival.name);
    }
    bench.click("Close the comparison");
    assert!(bench.session().features.lab.comparison.is_none());
}

#[test]
fn the_drawing_is_saved_in_the_chosen_format() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = opened("Polygons");
    bench.session_mut().features.files.folder = folder.path().to_owned();
    bench.click("Save drawing");
    bench.click("SVG: vector drawing, sharp at any size");
    let text = std::fs::read_to_string(folder.path().join("polygons.svg")).unwrap();
    assert!(text.starts_with("<svg") && text.contains("<polygon"));
    assert_eq!(bench.session().features.messages.error, None);
}
