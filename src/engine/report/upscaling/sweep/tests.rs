use std::sync::Arc;

use super::*;
use crate::measure::reference::Reference;
use crate::pipeline::viewport::Viewport;
use crate::scene::SceneSource;

fn plan(viewport: Viewport, rounds: usize) -> UpscalingPlan {
    let scene = SceneSource::named("triangle".into()).load().unwrap().scene;
    let subject =
        NamedView { name: scene.name.clone(), camera: scene.home, recipe: Recipe::default(), scene: Arc::new(scene) };
    UpscalingPlan {
        subjects: vec![subject],
        upscalers: Upscaling::every().collect(),
        viewport,
        rounds,
        reference: Reference::Native,
        metric: Metric::Flip,
        turn: Turn { degrees: 0.5, frames: 2, ..Turn::STILL },
    }
}

#[test]
fn every_upscaler_has_a_row_and_native_has_no_error() {
    let plan = plan(Viewport { width: 40, height: 24 }, 2);
    let report = run(&plan, &|_| {}, &|| false).unwrap();
    let [scene] = &report.scenes[..] else { panic!("one scene") };
    assert_eq!(scene.rows.len(), Upscaling::every().count());
    let native = &scene.rows[0];
    assert!(native.recipe.upscaler.is_native() && native.error.codes.mse == 0.0 && native.drawn == 1.0);
    assert_eq!(native.motion.worst.codes.mse, 0.0);
    let temporal = scene.rows.iter().find(|row| row.recipe.upscaler.method() == "checkerboard-temporal").unwrap();
    assert!(temporal.error.codes.mse == 0.0 && temporal.motion.mean.codes.mse > 0.0, "exact at rest, not in motion");
    for row in &scene.rows {
        assert_eq!((row.frame_ms.n, row.crop.size()), (2, (40, 24)), "{}", row.label);
        assert!(row.parts_ms.pixels <= row.frame_ms.max && row.error.flip >= 0.0, "{}", row.label);
    }
    let nearest = scene.rows.iter().find(|row| row.label == "Nearest ×4").unwrap();
    assert!(nearest.error.flip > 0.0 && (nearest.drawn - 1.0 / 16.0).abs() < 1e-9);
    assert!(scene.rows.iter().any(|row| row.dominated_by.is_none()), "somebody is best");
    // Two rounds form one block for each of five twins.
    assert_eq!(scene.noise.pairs, 5);
}

#[test]
fn small_differences_of_time_do_not_rank_rows() {
    let plan = plan(Viewport { width: 16, height: 16 }, 1);
    let mut rows = run(&plan, &|_| {}, &|| false).unwrap().scenes.remove(0).rows;
    rows.truncate(3);
    assert!(rows[0].recipe.upscaler.is_native());
    for (row, (ms, flip)) in rows.iter_mut().zip([(4.0, 0.0), (4.02, 0.1), (3.98, 0.2)]) {
        row.frame_ms.median = ms;
        row.motion.mean.flip = flip;
        (row.dominated_by, row.within_noise_of) = (None, None);
    }
    rank(&mut rows, Metric::Flip, &Noise { pairs: 5, p90: 0.02 });
    let native = Some(rows[0].label.clone());
    assert_eq!(rows.iter().map(|row| row.dominated_by.clone()).collect::<Vec<_>>(), [None, native.clone(), None]);
    assert_eq!(rows.iter().map(|row| row.within_noise_of.clone()).collect::<Vec<_>>(), [None, None, native]);
    assert_eq!(rows.iter().map(|row| row.native_within_noise).collect::<Vec<_>>(), [false, true, true]);
    rank(&mut rows, Metric::Flip, &Noise { pairs: 5, p90: 0.001 });
    assert!(rows.iter().all(|row| !row.native_within_noise));
}

#[test]
fn a_cancelled_sweep_has_no_report() {
    assert!(run(&plan(Viewport { width: 16, height: 16 }, 1), &|_| {}, &|| true).is_none());
}

#[test]
fn a_sweep_cancelled_later_has_the_rounds_that_were_complete() {
    let rounds = std::cell::Cell::new(0);
    let note = |progress: UpscalingProgress| {
        if progress.stage == "times" {
            rounds.set(progress.done);
        }
    };
    let report = run(&plan(Viewport { width: 16, height: 16 }, 9), &note, &|| rounds.get() == 2).unwrap();
    assert!(report.partial && report.scenes[0].shares.is_none());
    assert!(report.scenes[0].rows.iter().all(|row| row.frame_ms.n == 2), "two complete rounds");
}

#[test]
fn rows_are_ranked_by_the_metric_of_the_error_axis() {
    let select = |metric| UpscalingPlan { metric, ..plan(Viewport { width: 24, height: 16 }, 1) };
    let report = run(&select(Metric::MsSsim), &|_| {}, &|| false).unwrap();
    let rows = &report.scenes[0].rows;
    assert_eq!((rows[0].error.selected, rows[0].error_in_motion(Metric::MsSsim)), (Some(1.0), 0.0));
    let nearest = rows.iter().find(|row| row.label == "Nearest ×4").unwrap();
    assert_eq!(nearest.error_in_motion(Metric::MsSsim), 1.0 - nearest.motion.mean.selected.unwrap());
    assert!(nearest.error_in_motion(Metric::MsSsim) > 0.0);
    // The faster of two rows is dominated by none; the ranking by PSNR prefers the larger value.
    let mut two: Vec<_> = rows.iter().take(2).cloned().collect();
    for (row, (ms, psnr)) in two.iter_mut().zip([(4.0, 30.0), (8.0, 20.0)]) {
        row.frame_ms.median = ms;
        row.motion.mean.codes.psnr_db = psnr;
        (row.dominated_by, row.within_noise_of) = (None, None);
    }
    rank(&mut two, Metric::Psnr, &Noise { pairs: 5, p90: 0.02 });
    assert_eq!(two[1].dominated_by.as_ref(), Some(&two[0].label));
    for text in [crate::report::upscaling::page::page(&report).unwrap(), crate::report::upscaling::csv::csv(&report)] {
        assert!(text.contains("MS-SSIM") || text.contains("ms-ssim"));
    }
}
