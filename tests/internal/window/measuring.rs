//! Tests of timing the upscalers from the window.

use std::time::{Duration, Instant};

use eframe::egui::{Key, Modifiers, PointerButton, Pos2, Rect, Role, Vec2};
use egui_kittest::kittest::Queryable as _;
use rasterscope::inspect::Stage;
use rasterscope::measure::timing::summarize;
use rasterscope::ui::format;
use rasterscope::ui::session::PictureSize;
use rasterscope::ui::session::compare::Mode;
use rasterscope::ui::session::timings::RowOrder;
use rasterscope::ui::session::workspace::Panel;
use rasterscope::ui::worker::{MEASURE_ROUNDS, Worker};
use rasterscope::upscale::Upscaling;

use super::bench::Bench;

#[test]
fn every_upscaler_gets_a_row_with_all_its_frames() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::FrameTime);
    bench.click("Measure all upscalers");
    assert_eq!(bench.session().features.tasks.measuring, None, "the measurement is complete");
    let series = bench.session().features.timings.series();
    assert_eq!(series.len(), Upscaling::every().count());
    for upscaling in Upscaling::every() {
        let (_, times) = series.iter().find(|(u, _)| *u == upscaling).expect("every method was timed");
        assert_eq!(times.len(), MEASURE_ROUNDS);
        assert!(times.iter().all(|t| *t > 0.0 && t.is_finite()));
        assert!(row_rect(&bench, upscaling).is_some(), "{}", upscaling.label());
    }
    assert!(bench.mentions("Measured · One triangle · 160 × 90 px · noise floor ±"));
    bench.show_panel(Panel::Stages);
    bench.select(Stage::Cull);
    bench.choose("Culling", "None");
    bench.show_panel(Panel::FrameTime);
    assert!(bench.mentions("Measured with a different scene, view, size or setting"));
    bench.click("Clear");
    assert!(!bench.session().features.timings.has_measurement());
}

/// Opens a window with a measurement of all upscalers on a picture of a few pixels.
fn measured() -> Bench {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::FrameTime);
    bench.session_mut().state.size = PictureSize::Fixed(48, 27);
    bench.session_mut().settle_silently();
    bench.rest();
    bench.click("Measure all upscalers");
    bench
}

/// Returns the accessible name of the row of an upscaler.
fn row_name(bench: &Bench, upscaling: Upscaling) -> String {
    let series = bench.session().features.timings.series();
    let (_, times) = series.iter().find(|(of, _)| *of == upscaling).expect("it was timed");
    let median = summarize(times).expect("there are times").median;
    format!("{}: {}", upscaling.label(), format::ms(median))
}

/// Returns the rectangle of the row of an upscaler; `None` if the filter hides the row.
fn row_rect(bench: &Bench, upscaling: Upscaling) -> Option<Rect> {
    let name = row_name(bench, upscaling);
    bench.window.query_by_role_and_label(Role::Button, &name).map(|row| row.rect())
}

fn upscaling(method: &str, scale: u32) -> Upscaling {
    Upscaling::new(method, scale).expect("there is one")
}

#[test]
fn a_row_draws_with_its_upscaler_and_with_shift_compares() {
    let mut bench = measured();
    let [first, second] = [upscaling("lanczos2", 2), upscaling("nearest", 4)];
    let name = row_name(&bench, first);
    bench.click(&name);
    assert_eq!(bench.session().state.recipe.upscaler, first);
    let name = row_name(&bench, second);
    bench.window.get_by_role_and_label(Role::Button, &name).scroll_to_me();
    bench.rest();
    let place = row_rect(&bench, second).expect("it is shown").center();
    bench.click_at_with(Modifiers::SHIFT, place);
    assert_eq!(bench.session().features.comparison.mode, Mode::Wipe);
    let tiles = &bench.session().features.comparison.compared.as_ref().expect("two are compared").tiles;
    assert_eq!([tiles[0].recipe.upscaler, tiles[1].recipe.upscaler], [first, second]);
}

#[test]
fn a_row_is_chosen_by_keyboard() {
    let mut bench = measured();
    let wanted = upscaling("bilinear", 3);
    let name = row_name(&bench, wanted);
    bench.window.get_by_role_and_label(Role::Button, &name).focus();
    bench.rest();
    bench.press(Key::Space);
    assert_eq!(bench.session().state.recipe.upscaler, wanted);
}

#[test]
fn rows_are_sorted_and_filtered_by_scale() {
    let mut bench = measured();
    let [coarse, fine] = [upscaling("nearest", 4), upscaling("nearest", 2)];
    bench.click("Sort by method");
    assert_eq!(bench.session().features.timings.list.order, RowOrder::Method);
    let tops = |bench: &Bench| {
        let rows = Upscaling::every().map(|upscaling| row_rect(bench, upscaling).expect("it is shown").top());
        rows.collect::<Vec<_>>()
    };
    assert!(tops(&bench).is_sorted(), "the order of the menus");
    bench.click("Sort by error");
    assert!(row_rect(&bench, fine).unwrap().top() < row_rect(&bench, coarse).unwrap().top());
    bench.click("Show scale ×4");
    assert_eq!(row_rect(&bench, coarse), None);
    assert!(row_rect(&bench, fine).is_some() && row_rect(&bench, Upscaling::NATIVE).is_some());
    bench.click("Show scale ×4");
    assert!(row_rect(&bench, coarse).is_some());
}

#[test]
fn frames_of_the_current_of_checked_and_of_hovered_rows_are_plotted() {
    let mut bench = measured();
    let [checked, hovered] = [upscaling("nearest", 2), upscaling("nearest", 4)];
    let plots = |bench: &Bench, upscaling: Upscaling| bench.says(&upscaling.label());
    assert!(plots(&bench, Upscaling::NATIVE) && !plots(&bench, checked));
    let name = format!("Plot the frames of {}", checked.label());
    bench.window.get_by_role_and_label(Role::CheckBox, &name).scroll_to_me();
    bench.rest();
    bench.window.get_by_role_and_label(Role::CheckBox, &name).click();
    bench.rest();
    bench.window.hover_at(Pos2::new(1.0, 1.0));
    bench.rest();
    assert!(plots(&bench, checked) && !plots(&bench, Upscaling::NATIVE));
    let name = row_name(&bench, hovered);
    bench.window.get_by_role_and_label(Role::Button, &name).scroll_to_me();
    bench.rest();
    bench.window.hover_at(row_rect(&bench, hovered).expect("it is shown").center());
    bench.rest();
    assert_eq!(bench.session().features.timings.list.hovered(), Some(hovered));
    assert!(plots(&bench, checked) && plots(&bench, hovered));
    bench.click("Distribution");
    assert_eq!(bench.session().features.timings.list.hovered(), None);
    assert!(plots(&bench, checked) && !plots(&bench, hovered));
}

#[test]
fn the_budget_line_names_the_best_method_within_it() {
    let mut bench = measured();
    let line = |bench: &Bench| bench.window.get_by_role_and_label(Role::Splitter, "Time budget").rect();
    assert!(bench.mentions("lowest FLIP within") || bench.mentions("No method within"));
    let mut drag = |points: f32| {
        let from = line(&bench).center();
        bench.drag(PointerButton::Primary, from, Vec2::new(points, 0.0));
        (bench.session().features.timings.budget_ms(), bench.mentions("No method within"))
    };
    // The first budget is half of the measured native time, which may lie anywhere on the axis.
    let (slowest, is_too_small) = drag(2000.0);
    assert!(!is_too_small, "the axis ends after the slowest method");
    let (fastest, is_too_small) = drag(-2000.0);
    assert!(is_too_small, "the axis begins before the fastest method");
    assert!(fastest < slowest);
    assert_eq!(drag(2000.0), (slowest, false));
    assert!(bench.mentions(": lowest FLIP within"));
    bench.show_panel(Panel::ErrorTime);
    assert!(bench.mentions(": lowest FLIP within"), "both tabs have the same budget");
}

#[test]
fn without_a_measurement_only_recent_methods_have_rows() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::FrameTime);
    assert!(row_rect(&bench, Upscaling::NATIVE).is_some());
    assert!(bench.mentions("errors not measured"));
    assert!(bench.window.query_by_role_and_label(Role::Button, "Show scale ×2").is_none());
}

#[test]
fn a_cancelled_measurement_keeps_its_samples() {
    let mut bench = Bench::with_worker("chess", Worker::spawn(|| ()));
    bench.session_mut().features.timings.automatic = false;
    bench.session_mut().state.size = PictureSize::Fixed(96, 54);
    bench.session_mut().settle_silently();
    bench.show_panel(Panel::FrameTime);
    wait(&mut bench, "the first frame", |bench| bench.session().view.is_some());
    bench.click("Measure all upscalers");
    wait(&mut bench, "a sample", |bench| bench.session().features.timings.has_measurement());
    bench.click("Cancel");
    assert_eq!(bench.session().features.tasks.measuring, None);
    assert!(bench.mentions("Measure all upscalers"), "it can be started again");
    // One frame may have been in progress.
    std::thread::sleep(Duration::from_millis(500));
    bench.rest();
    let samples = |bench: &Bench| bench.session().features.timings.series().iter().map(|(_, t)| t.len()).sum::<usize>();
    let kept = samples(&bench);
    assert!(kept > 0 && kept < MEASURE_ROUNDS * Upscaling::every().count());
    std::thread::sleep(Duration::from_millis(500));
    bench.rest();
    assert_eq!(samples(&bench), kept);
}

fn wait(bench: &mut Bench, what: &str, done: impl Fn(&Bench) -> bool) {
    let start = Instant::now();
    while !done(bench) {
        assert!(start.elapsed() < Duration::from_secs(300), "waited for {what}");
        std::thread::sleep(Duration::from_millis(10));
        bench.window.run_steps(1);
    }
}

#[test]
fn frame_times_are_paused_and_saved() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::FrameTime);
    let folder = tempfile::tempdir().unwrap();
    bench.session_mut().features.files.folder = folder.path().to_owned();
    bench.click("Pause recording frame times");
    let before = bench.session().features.timings.series();
    bench.session_mut().state.camera.orbit(0.2, 0.0);
    bench.rest();
    assert_eq!(bench.session().features.timings.series(), before);
    bench.click("Resume recording frame times");
    bench.session_mut().state.camera.orbit(0.2, 0.0);
    bench.rest();
    let lines = |bench: &Bench| bench.session().features.timings.series().iter().map(|(_, t)| t.len()).sum::<usize>();
    assert!(lines(&bench) > before.iter().map(|(_, times)| times.len()).sum());
    bench.click("Distribution");
    bench.click("Save all frame times as CSV");
    let written = std::fs::read_to_string(folder.path().join("frame-times.csv")).unwrap();
    assert_eq!(written.lines().count(), lines(&bench) + 1);
}

#[test]
fn the_history_names_every_change_of_settings() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::FrameTime);
    bench.click("History");
    bench.session_mut().state.recipe.set("wireframe=true").unwrap();
    bench.rest();
    bench.session_mut().state.recipe.set("culling=none").unwrap();
    bench.rest();
    let history = &bench.session().features.timings.history;
    let named: Vec<_> = history.markers().map(|marker| &*marker.words).collect();
    assert!(named.ends_with(&["wireframe: false → true", "culling: back → none"]), "{named:?}");
    assert!(history.runs().len() > named.len(), "frames before the first change are kept");
}

#[test]
fn a_warning_names_the_load_of_other_programs() {
    let mut bench = measured();
    assert!(!bench.mentions("Other programs use"));
    bench.session_mut().features.timings.record_others(0.05);
    bench.rest();
    assert!(!bench.mentions("Other programs use"));
    bench.session_mut().features.timings.record_others(0.43);
    bench.session_mut().features.timings.record_others(0.2);
    bench.rest();
    assert!(bench.mentions("Other programs use up to 43"));
}
