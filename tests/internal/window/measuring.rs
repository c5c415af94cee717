//! Tests of timing the upscalers from the window.

use std::time::{Duration, Instant};

use rasterscope::inspect::Stage;
use rasterscope::ui::worker::{MEASURE_ROUNDS, Worker};
use rasterscope::upscale::Upscaling;

use super::bench::Bench;

#[test]
fn every_upscaler_gets_a_row_with_all_its_frames() {
    let mut bench = Bench::small("triangle");
    bench.click("Measure all upscalers");
    assert_eq!(bench.session().measuring, None, "the measurement is complete");
    let series = bench.session().timings.series();
    assert_eq!(series.len(), Upscaling::every().count());
    for upscaling in Upscaling::every() {
        let (_, times) = series.iter().find(|(u, _)| *u == upscaling).expect("every method was timed");
        assert_eq!(times.len(), MEASURE_ROUNDS);
        assert!(times.iter().all(|t| *t > 0.0 && t.is_finite()));
        assert!(bench.mentions(&upscaling.label()), "{}", upscaling.label());
    }
    assert!(bench.mentions("Measured · One triangle · 160 × 90 px · noise floor ±"));
    bench.select(Stage::Cull);
    bench.choose("Culling", "None");
    assert!(bench.mentions("Measured with a different scene, view, size or setting"));
    bench.click("Clear");
    assert!(!bench.session().timings.has_measurement());
}

#[test]
fn a_row_of_the_table_draws_with_its_upscaler() {
    let mut bench = Bench::small("triangle");
    bench.click("Measure all upscalers");
    let other = Upscaling::every().nth(1).expect("there are several");
    bench.click(&other.label());
    assert_eq!(bench.session().state.recipe.upscaler, other);
}

#[test]
fn a_cancelled_measurement_keeps_its_samples() {
    let mut bench = Bench::with_worker("chess", Worker::spawn(|| ()));
    wait(&mut bench, "the first frame", |bench| bench.session().view.is_some());
    bench.click("Measure all upscalers");
    wait(&mut bench, "a sample", |bench| bench.session().timings.has_measurement());
    bench.click("Cancel");
    assert_eq!(bench.session().measuring, None);
    assert!(bench.mentions("Measure all upscalers"), "it can be started again");
    // One frame may have been in progress.
    std::thread::sleep(Duration::from_millis(500));
    bench.rest();
    let samples = |bench: &Bench| bench.session().timings.series().iter().map(|(_, t)| t.len()).sum::<usize>();
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
    let folder = tempfile::tempdir().unwrap();
    bench.session_mut().folder = folder.path().to_owned();
    bench.click("Pause recording frame times");
    let before = bench.session().timings.series();
    bench.session_mut().state.camera.orbit(0.2, 0.0);
    bench.rest();
    assert_eq!(bench.session().timings.series(), before);
    bench.click("Resume recording frame times");
    bench.session_mut().state.camera.orbit(0.2, 0.0);
    bench.rest();
    let lines = |bench: &Bench| bench.session().timings.series().iter().map(|(_, t)| t.len()).sum::<usize>();
    assert!(lines(&bench) > before.iter().map(|(_, times)| times.len()).sum());
    bench.click("Distribution");
    bench.click("Save all frame times as CSV");
    let written = std::fs::read_to_string(folder.path().join("frame-times.csv")).unwrap();
    assert_eq!(written.lines().count(), lines(&bench) + 1);
}
