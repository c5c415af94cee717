//! Tests of case files on the canvas, of saved cases, and of the stability report, which opens cases.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use eframe::egui::{Key, Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use rasterscope::case::Case;
use rasterscope::pipeline::settings::{Arithmetic, Rasterizer};
use rasterscope::report::stability::catalogue;
use rasterscope::report::stability::sweep::{self, StabilityPlan, StabilityReport};
use rasterscope::ui::session::workspace::Panel;
use rasterscope::ui::worker::Worker;
use tempfile::TempDir;

use super::bench::Bench;

/// Triangle that is half of a square of 8 × 8 pixels. It covers 1 + 2 + … + 7 centres; the 8 on the long edge belong to
/// [`OTHER_HALF`].
const HALF_SQUARE: &str = "[[1, 1], [9, 1], [1, 9]]";

/// Triangle that is the other half of the square and owns the centres on the long edge.
const OTHER_HALF: &str = "[[9, 9], [1, 9], [9, 1]]";

fn case_file(folder: &TempDir, name: &str, id: &str, triangles: &[&str]) -> PathBuf {
    let path = folder.path().join(name);
    let json = format!(
        r#"{{"id": "{id}", "kind": "tri_coverage", "width": 12, "height": 12, "rule": "top_left", "triangles": [{}]}}"#,
        triangles.join(", ")
    );
    std::fs::write(&path, json).unwrap();
    path
}

/// Writes a short case whose answer takes minutes, because every pixel is so close to the line that floats cannot
/// decide.
fn slow_case_file(folder: &TempDir) -> PathBuf {
    let path = folder.path().join("slow.json");
    let json = r#"{"id": "slow", "kind": "distance_line", "width": 16384, "height": 2048,
        "p0": [-3e38, -1.3e38], "p1": [3e38, 1.3e38]}"#;
    std::fs::write(&path, json).unwrap();
    path
}

/// Runs frames until `done` returns `true`. Panics after 60 s.
fn wait(bench: &mut Bench, what: &str, done: impl Fn(&Bench) -> bool) {
    let begun = Instant::now();
    while !done(bench) {
        assert!(begun.elapsed() < Duration::from_secs(300), "waited for {what}");
        std::thread::sleep(Duration::from_millis(10));
        bench.window.step();
    }
}

/// Returns whether a button with this name exists.
fn offers(bench: &Bench, button: &str) -> bool {
    bench.window.query_by_role_and_label(Role::Button, button).is_some()
}

#[test]
fn a_slow_case_is_opened_in_the_background_and_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::with_worker("triangle", Worker::spawn(|| ()));
    wait(&mut bench, "the first frame", |bench| bench.session().view.is_some());
    bench.window.input_mut().dropped_files.push(super::bench::dropped(&slow_case_file(&folder)));
    wait(&mut bench, "the progress", |bench| bench.mentions("Loading") && offers(bench, "Cancel"));
    assert!(bench.session().features.case.is_none() && shows_the_scene(&bench), "the scene stays meanwhile");
    bench.window.get_by_role_and_label(Role::Button, "Cancel").click();
    wait(&mut bench, "its end", |bench| !offers(bench, "Cancel"));
    for _ in 0..20 {
        std::thread::sleep(Duration::from_millis(10));
        bench.window.step();
    }
    assert!(
        bench.session().features.case.is_none()
            && bench.session().features.messages.error.is_none()
            && shows_the_scene(&bench)
    );
}

#[test]
fn an_open_case_is_answered_in_the_background_and_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::with_worker("triangle", Worker::spawn(|| ()));
    wait(&mut bench, "the first frame", |bench| bench.session().view.is_some());
    let slow = Case::read(&slow_case_file(&folder)).unwrap();
    bench.session_mut().show_case(slow);
    wait(&mut bench, "the progress", |bench| offers(bench, "Cancel"));
    assert!(bench.session().features.case.is_some());
    bench.window.get_by_role_and_label(Role::Button, "Cancel").click();
    wait(&mut bench, "its end", |bench| bench.session().features.case.is_none());

    // The previous answer stays until the answer by another method is ready.
    bench
        .session_mut()
        .show_case(Case::read(&case_file(&folder, "both.json", "both", &[HALF_SQUARE, OTHER_HALF])).unwrap());
    wait(&mut bench, "an answer", |bench| bench.says("0 of 28 pixels differ"));
    bench.window.get_by_role_and_label(Role::Button, "Next triangle").click();
    wait(&mut bench, "the other triangle", |bench| bench.says("0 of 36 pixels differ"));
}

#[test]
fn a_case_of_many_triangles_and_pixels_opens_at_its_first_triangle() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.json");
    let triangles = vec!["[[0, 0], [16384, 3], [5, 2048]]"; 20_000].join(", ");
    let json = format!(
        r#"{{"id": "large", "kind": "tri_coverage", "width": 16384, "height": 2048, "rule": "top_left", "triangles": [{triangles}]}}"#
    );
    std::fs::write(&path, json).unwrap();
    let mut bench = Bench::with_worker("triangle", Worker::spawn(|| ()));
    wait(&mut bench, "the first frame", |bench| bench.session().view.is_some());
    bench.window.input_mut().dropped_files.push(super::bench::dropped(&path));
    wait(&mut bench, "the case", |bench| bench.says("triangle 1 of 20000") && bench.mentions("0 of "));
    let next = |bench: &mut Bench| bench.window.get_by_role_and_label(Role::Button, "Next triangle").click();
    next(&mut bench);
    // All triangles are equal, so only their number distinguishes them.
    wait(&mut bench, "the next triangle", |bench| bench.says("triangle 2 of 20000"));
}

/// Returns whether the canvas shows the scene rather than a case.
fn shows_the_scene(bench: &Bench) -> bool {
    bench.window.query_by_role_and_label(Role::Image, "Rendered picture").is_some()
}

/// Returns the number of differing pixels and the number of compared pixels, as displayed.
fn differing(bench: &Bench) -> (u32, u32) {
    let reported = bench.window.get_by_label_contains(" pixels differ").accesskit_node();
    let text = reported.label().or_else(|| reported.value()).unwrap();
    let numbers: Vec<u32> = text.split(' ').filter_map(|word| word.parse().ok()).collect();
    (numbers[0], numbers[1])
}

#[test]
fn a_dropped_case_is_shown_beside_its_exact_answer_until_it_is_closed() {
    let folder = tempfile::tempdir().unwrap();
    let path = case_file(&folder, "half.json", "half a square", &[HALF_SQUARE]);
    for close in [Key::Escape, Key::X] {
        let mut bench = Bench::small("triangle");
        bench.drop_file(&path);
        assert_eq!(bench.session().features.messages.error, None);
        assert!(bench.says("half a square") && bench.says("0 of 28 pixels differ") && !shows_the_scene(&bench));
        if close == Key::Escape {
            bench.press(close);
        } else {
            bench.click("Close the case  (Esc)");
        }
        assert!(bench.session().features.case.is_none() && shows_the_scene(&bench));
        assert_eq!(&bench.image(), bench.expected().image());
    }
}

#[test]
fn a_faulty_rasterizer_chosen_above_the_case_makes_pixels_differ_and_they_can_be_visited() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::small("triangle");
    bench.drop_file(&case_file(&folder, "half.json", "half", &[HALF_SQUARE]));
    assert!(bench.window.query_by_label("Next differing pixel").is_none(), "there is none");
    bench.choose("Rasterizer of the case", "Scanline (as published)");
    assert_eq!(bench.session().state.recipe.pipeline.rasterizer, Rasterizer::ScanlinePublished);
    assert!(differing(&bench).0 > 0, "it draws both ends of its rows");
    bench.click("Next differing pixel");
    bench.click("Previous differing pixel");
    bench.choose("Rasterizer of the case", "Edge walk");
    bench.choose("Arithmetic of the case", "Exact");
    assert_eq!(bench.session().state.recipe.pipeline.arithmetic, Arithmetic::Exact);
    assert!(bench.says("0 of 28 pixels differ"));
}

#[test]
fn triangles_of_a_case_are_shown_one_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::small("triangle");
    bench.drop_file(&case_file(&folder, "both.json", "both", &[HALF_SQUARE, OTHER_HALF]));
    assert!(bench.says("triangle 1 of 2") && bench.says("0 of 28 pixels differ"));
    for _ in 0..2 {
        bench.click("Next triangle");
        assert!(bench.says("triangle 2 of 2") && bench.says("0 of 36 pixels differ"), "the last one stays");
    }
    bench.click("Previous triangle");
    assert!(bench.says("triangle 1 of 2") && bench.says("0 of 28 pixels differ"));
}

#[test]
fn another_case_of_the_same_name_is_another_case() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::small("triangle");
    bench.drop_file(&case_file(&folder, "a.json", "same", &[HALF_SQUARE]));
    assert!(bench.says("0 of 28 pixels differ"));
    bench.drop_file(&case_file(&folder, "b.json", "same", &[OTHER_HALF]));
    assert!(bench.says("0 of 36 pixels differ"));
}

#[test]
fn a_bad_case_is_named_and_the_scene_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.json");
    std::fs::write(&path, r#"{"id": "bad", "kind": "tri_coverage"}"#).unwrap();
    let mut bench = Bench::small("triangle");
    bench.drop_file(&path);
    assert!(bench.session().features.messages.error.as_ref().is_some_and(|error| error.contains("bad.json")));
    assert!(bench.session().features.case.is_none() && shows_the_scene(&bench));
}

#[test]
fn a_case_whose_answer_is_numbers_shows_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("depth.json");
    let json =
        r#"{"id": "d", "kind": "depth", "mapping": "standard", "format": "f32", "near": 1, "far": 2, "z": [1.5]}"#;
    std::fs::write(&path, json).unwrap();
    let mut bench = Bench::small("triangle");
    bench.drop_file(&path);
    assert!(bench.mentions("The answer consists of numbers") && bench.mentions("0.66666"));
}

#[test]
fn the_triangle_of_the_picked_pixel_is_saved_as_a_case_that_opens_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::small("triangle");
    bench.session_mut().features.files.folder = folder.path().to_owned();
    bench.session_mut().pick = Some((80, 50));
    bench.rest();
    for number in 1..=2 {
        bench.click("Save triangle as case file");
        assert_eq!(bench.session().features.messages.error, None);
        assert_eq!(files(folder.path()).len(), number, "no file is overwritten");
    }
    for path in files(folder.path()) {
        Case::read(&path).unwrap();
        bench.drop_file(&path);
        let (wrong, covered) = differing(&bench);
        assert!(wrong == 0 && covered > 0, "{wrong} of {covered}");
    }
}

#[test]
fn without_a_triangle_there_is_no_case_to_save() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::small("triangle");
    bench.session_mut().features.files.folder = folder.path().to_owned();
    bench.session_mut().pick = Some((0, 0));
    bench.rest();
    assert!(bench.window.query_by_label("Save triangle as case file").is_none(), "nothing covers the corner");
    assert!(files(folder.path()).is_empty());
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().path()).collect()
}

/// Returns a stability report of two rasterizers on two classes; the published rasterizer has errors.
pub(super) fn small_report() -> StabilityReport {
    let plan = StabilityPlan {
        classes: vec![catalogue::by_id("needles").unwrap(), catalogue::by_id("not-finite").unwrap()],
        rasterizers: vec![Rasterizer::Scanline, Rasterizer::ScanlinePublished],
        timed: false,
        ..StabilityPlan::default()
    };
    sweep::run(&plan, &|_| {}, &AtomicBool::new(false)).unwrap()
}

#[test]
fn a_cell_of_the_report_opens_the_worst_case_of_its_column() {
    let report = Arc::new(small_report());
    let class = &report.classes[0];
    let cell = class.cells.iter().find(|cell| cell.column.method() == "scanline-published").unwrap();
    let worst = cell.worst.as_ref().expect("it goes wrong");
    let mut bench = Bench::small("triangle");
    let before = bench.session().state.recipe;
    bench.show_panel(Panel::Stability);
    assert!(bench.says("No stability report yet"));
    bench.session_mut().features.tasks.stability.report = Some(report.clone());
    bench.rest();
    let name = format!("{}, {}: ", class.class.name, cell.column.label());
    bench.window.get_by_label_contains(&name).click();
    bench.rest();
    assert_eq!(bench.session().features.case.as_ref().map(|open| open.case.id.clone()), Some(worst.case.id.clone()));
    let options = bench.session().features.case.as_ref().and_then(|open| open.own_options);
    assert_eq!(options.map(|options| options.rasterizer), Some(Rasterizer::ScanlinePublished));
    assert_eq!(bench.session().state.recipe, before, "the case has its own settings");
    let (differ, of) = differing(&bench);
    assert!(differ > 0 && differ <= of, "{differ} of {of}");
    bench.press(Key::Escape);
    assert!(bench.session().features.case.is_none());
    assert_eq!(bench.session().state.recipe, before, "the settings stay");

    bench.click("Error against time");
    bench.click("Heat map");
}

#[test]
fn a_report_is_started_and_cancelled() {
    /// Time limit for cancelling the report, sufficient for slow machines.
    const PATIENCE: Duration = Duration::from_secs(120);
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::Stability);
    bench.window.get_by_role_and_label(Role::Button, "Run the stability report").click();
    bench.window.step();
    assert!(bench.session().features.tasks.stability.progress.is_some());
    // Commands of one frame take visible effect in the next.
    bench.window.step();
    bench.window.get_by_role_and_label(Role::Button, "Cancel").click();
    let begun = Instant::now();
    while bench.session().features.tasks.stability.progress.is_some() {
        assert!(begun.elapsed() < PATIENCE, "it does not end");
        std::thread::sleep(Duration::from_millis(20));
        bench.window.step();
    }
    assert!(
        bench.session().features.tasks.stability.report.is_none() && bench.session().features.messages.error.is_none()
    );
    assert!(bench.says("No stability report yet"));
}
