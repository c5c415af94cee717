//! Measures every recipe on every scene: first its errors at rest and in motion, then its time in interleaved rounds.
//!
//! The rounds time the same frames whose error in motion is measured; see [`crate::measure::rounds`]. File access and
//! error metrics are not timed.

use std::sync::Arc;
use std::time::Duration;

use serde::Serialize;

use super::skipping::{self, PixelShareTimes};
use super::tradeoff::{Standing, standings};
use crate::chain::{Frame, FrameTimes, Recipe};
use crate::image::{Image, Rgba8};
use crate::measure::against::ErrorMetrics;
use crate::measure::machine::Machine;
use crate::measure::motion::{ErrorMeasurement, FrameSequence, MotionError, Turn};
use crate::measure::noise::Noise;
use crate::measure::reference::Reference;
use crate::measure::region::PixelRegion;
use crate::measure::rounds::RoundTimer;
use crate::measure::timing::{Summary, summarize};
use crate::pipeline::settings::Choice as _;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};
use crate::upscale::Upscaling;

/// Scene to measure, with its name and camera.
#[derive(Clone, Debug)]
pub struct NamedView {
    /// Display name of the scene.
    pub name: String,
    /// Scene to draw.
    pub scene: Arc<Scene>,
    /// Camera of the view.
    pub camera: Camera,
}

/// Scenes, recipes, image size and measurement parameters of a report.
#[derive(Clone, Debug)]
pub struct UpscalingPlan {
    /// Scenes to measure, each from one view.
    pub subjects: Vec<NamedView>,
    /// Recipes to measure on every scene.
    pub recipes: Vec<Recipe>,
    /// Size of the full image, in pixels.
    pub viewport: Viewport,
    /// Number of measured rounds, at least 1.
    pub rounds: usize,
    /// Reference that errors are computed against.
    pub reference: Reference,
    /// Camera motion over the frames that are measured for error and time.
    pub turn: Turn,
}

/// Returns one copy of the recipe for each upscaler at each of its scales.
pub fn every_upscaler(recipe: Recipe) -> Vec<Recipe> {
    Upscaling::every().map(|upscaler| Recipe { upscaler, ..recipe }).collect()
}

/// Progress of an upscaling report.
#[derive(Clone, Debug, PartialEq)]
pub struct UpscalingProgress {
    /// Name of the scene that is being measured.
    pub scene: String,
    /// Name of the current stage, such as "errors at rest".
    pub stage: &'static str,
    /// Number of completed steps in this stage.
    pub done: usize,
    /// Total number of steps in this stage.
    pub of: usize,
}

/// Complete upscaling report.
#[derive(Clone, Debug, Serialize)]
pub struct UpscalingReport {
    /// Machine and build, with the load at the start and at the end.
    pub(crate) machine: Machine,
    /// Number of threads that draw.
    pub(crate) threads: usize,
    /// Width and height of the full image, in pixels.
    pub(crate) size: [u32; 2],
    /// Number of timed rounds.
    pub(crate) rounds: usize,
    /// Name of the reference that errors are relative to.
    pub(crate) reference: &'static str,
    /// Camera motion over the frames that are measured for error and time.
    pub(crate) turn: Turn,
    /// Results of each scene.
    pub scenes: Vec<SceneReport>,
    /// Whether the sweep was cancelled before all scenes and rounds were complete.
    pub partial: bool,
}

/// Results of one scene.
#[derive(Clone, Debug, Serialize)]
pub struct SceneReport {
    /// Display name of the scene.
    pub(crate) scene: String,
    /// Number of triangles in the scene.
    pub(crate) triangles: usize,
    /// Noise floor of the times measured on this scene.
    pub(crate) noise: Noise,
    /// Results of each recipe.
    pub rows: Vec<UpscalingRow>,
    /// Comparison of two ways to draw fewer pixels; `None` if the scene has transparency.
    pub(crate) shares: Option<Vec<PixelShareTimes>>,
    /// Part of the image where the methods' errors are largest.
    pub(crate) crop: PixelRegion,
}

/// Results of one recipe on one scene.
#[derive(Clone, Debug, Serialize)]
pub struct UpscalingRow {
    /// Name of the upscaler with its options.
    pub label: String,
    /// Recipe that drew the frames.
    pub recipe: Recipe,
    /// Fraction of the pixels that were drawn, in (0, 1].
    pub(crate) drawn: f64,
    /// Frame time, in milliseconds.
    pub(crate) frame_ms: Summary,
    /// Median time spent in each part of a frame, in milliseconds.
    pub(crate) parts_ms: Parts,
    /// Error of the image in the still view.
    pub(crate) error: ErrorMetrics,
    /// Error over the frames of the moving view, used to rank the methods. Without motion, it equals the error in the
    /// still view.
    pub(crate) motion: MotionError,
    /// Label of a recipe that dominates this one in frame time and in the FLIP error of the moving view; `None` if
    /// there is no such recipe. A shorter time counts as better only if the difference exceeds the noise.
    pub(crate) dominated_by: Option<String>,
    /// Label of a recipe that is better than this one, although the two times differ by no more than the noise: its
    /// error is smaller, or the errors are equal and its time is shorter. `None` if there is no such recipe, or if some
    /// recipe dominates this one.
    pub(crate) within_noise_of: Option<String>,
    /// Whether the frame time is within noise of the native frame time; `false` for native rendering itself.
    pub(crate) native_within_noise: bool,
    /// Failure of the upscaler because of which other pictures than its own were measured; `None` without a failure.
    pub(crate) failure: Option<String>,
    /// Image of the recipe, cropped to the region of the largest errors.
    #[serde(skip)]
    pub crop: Image<Rgba8>,
}

impl UpscalingRow {
    /// Whether the row is on the Pareto front of frame time and FLIP error in the moving view.
    pub(crate) fn is_on_front(&self) -> bool {
        self.dominated_by.is_none() && self.within_noise_of.is_none()
    }
}

/// Time spent in each part of a frame, in milliseconds.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Parts {
    /// Median geometry time, from planning to culling, in milliseconds.
    pub(crate) geometry: f64,
    /// Median pixel time, from rasterization to shading, in milliseconds.
    pub(crate) pixels: f64,
    /// Median upscaling time without transfers, in milliseconds.
    pub(crate) upscale: f64,
    /// Median time of transfers to and from the process of the upscaler, in milliseconds; 0 within this process.
    pub(crate) transfer: f64,
}

/// Maximum width and height of a crop, in pixels.
const CROP: (u32, u32) = (160, 110);

/// Runs all measurements. If cancelled, returns the scenes measured so far, or `None` if there are none. The last scene
/// may have fewer rounds.
pub fn run(
    plan: &UpscalingPlan,
    report_progress: &dyn Fn(UpscalingProgress),
    cancelled: &dyn Fn() -> bool,
) -> Option<UpscalingReport> {
    let machine = Machine::at_start();
    let mut scenes = Vec::with_capacity(plan.subjects.len());
    for subject in &plan.subjects {
        match of_scene(plan, subject, report_progress, cancelled) {
            Some(scene) => scenes.push(scene),
            None if cancelled() && !scenes.is_empty() => break,
            None => return None,
        }
        if cancelled() {
            break;
        }
    }
    let Viewport { width, height } = plan.viewport;
    Some(UpscalingReport {
        machine: machine.at_end(),
        threads: rayon::current_num_threads(),
        size: [width, height],
        rounds: plan.rounds,
        reference: plan.reference.name(),
        turn: plan.turn,
        scenes,
        partial: cancelled(),
    })
}

/// Image of one recipe at rest, with its FLIP error.
struct MeasuredImage {
    picture: Image<Rgba8>,
    flip: Image<f32>,
    drawn: f64,
}

fn of_scene(
    plan: &UpscalingPlan,
    subject: &NamedView,
    report_progress: &dyn Fn(UpscalingProgress),
    cancelled: &dyn Fn() -> bool,
) -> Option<SceneReport> {
    let say = |stage, done, of| report_progress(UpscalingProgress { scene: subject.name.clone(), stage, done, of });
    let NamedView { scene, camera, .. } = subject;
    let shot = FrameSequence { scene, camera, viewport: plan.viewport, turn: plan.turn };
    let still = FrameSequence { turn: Turn::STILL, ..shot };
    let mut judged = Vec::with_capacity(plan.recipes.len());
    let at_rest = measure_errors(
        plan,
        &still,
        cancelled,
        &mut |done, judge| {
            say("errors at rest", done, judge.total(still.turn));
        },
        |frame, flip| {
            judged.push(MeasuredImage { picture: frame.image().clone(), drawn: frame.drawn_share(), flip });
        },
    )?;
    let in_motion = if plan.turn.is_still() {
        None
    } else {
        let say = &mut |done, judge: &ErrorMeasurement| say("errors in motion", done, judge.total(plan.turn));
        Some(measure_errors(plan, &shot, cancelled, say, |_, _| ())?)
    };
    let timer = time(plan, &shot, &|done, of| say("times", done, of), cancelled)?;
    say("shares", 0, 1);
    let first = plan.recipes.first()?;
    let applies = skipping::applies(scene, first, camera, plan.viewport);
    let rounds = plan.rounds.min(SHARE_ROUNDS);
    let shares = applies.then(|| skipping::measure(scene, camera, first, plan.viewport, rounds, cancelled));
    let shares = shares.map_or(Some(None), |shares| shares.map(Some).or(cancelled().then_some(None)))?;
    let crop = crop_of(&judged);
    let mut rows = Vec::with_capacity(judged.len());
    for (number, (recipe, judged)) in plan.recipes.iter().zip(&judged).enumerate() {
        let still = at_rest.error(number)?;
        let motion = in_motion.as_ref().map_or(Some(still), |judge| judge.error(number))?;
        rows.push(row(*recipe, judged, (still.mean, motion), timer.times(number), crop)?);
    }
    let noise = timer.noise()?;
    rank(&mut rows, &noise);
    Some(SceneReport {
        scene: subject.name.clone(),
        triangles: subject.scene.triangle_count(),
        noise,
        rows,
        shares,
        crop,
    })
}

/// Maximum number of rounds for the comparison of two ways to draw fewer pixels. Each round draws 20 images on one
/// thread.
const SHARE_ROUNDS: usize = 9;

/// Measures the errors of all recipes over a frame sequence. `look` receives each frame and the FLIP error of each of
/// its pixels. Returns `None` if cancelled.
fn measure_errors(
    plan: &UpscalingPlan,
    shot: &FrameSequence<'_>,
    cancelled: &dyn Fn() -> bool,
    say: &mut dyn FnMut(usize, &ErrorMeasurement),
    mut look: impl FnMut(&Frame, Image<f32>),
) -> Option<ErrorMeasurement> {
    let mut judge = ErrorMeasurement::new(plan.reference, plan.recipes.iter().copied());
    say(0, &judge);
    while !judge.is_complete(shot.turn) {
        if cancelled() {
            return None;
        }
        if judge.step(shot, |_, frame, flip| look(frame, flip)).is_some() {
            say(judge.measured_frames(), &judge);
        }
    }
    Some(judge)
}

/// Times all recipes. If cancelled, returns the rounds completed so far, or `None` if there are none.
fn time(
    plan: &UpscalingPlan,
    shot: &FrameSequence<'_>,
    say: &dyn Fn(usize, usize),
    cancelled: &dyn Fn() -> bool,
) -> Option<RoundTimer> {
    let mut timer = RoundTimer::new(&plan.recipes, plan.rounds);
    let mut reported_rounds = None;
    while !timer.is_complete() {
        if reported_rounds != Some(timer.rounds()) {
            reported_rounds = Some(timer.rounds());
            say(timer.rounds(), plan.rounds);
        }
        if cancelled() {
            return (timer.rounds() > 0).then_some(timer);
        }
        timer.step(shot);
    }
    Some(timer)
}

fn row(
    recipe: Recipe,
    judged: &MeasuredImage,
    (error, motion): (ErrorMetrics, MotionError),
    times: &[FrameTimes],
    crop: PixelRegion,
) -> Option<UpscalingRow> {
    let summary = |part: fn(&FrameTimes) -> Duration| {
        summarize(&times.iter().map(|times| part(times).as_secs_f64() * 1e3).collect::<Vec<_>>())
    };
    let parts_ms = Parts {
        geometry: summary(|times| times.geometry)?.median,
        pixels: summary(|times| times.pixels)?.median,
        upscale: summary(|times| times.upscale.saturating_sub(times.transfer))?.median,
        transfer: summary(|times| times.transfer)?.median,
    };
    Some(UpscalingRow {
        label: recipe.upscaler.label(),
        recipe,
        drawn: judged.drawn,
        frame_ms: summary(|times| times.total)?,
        parts_ms,
        error,
        motion,
        dominated_by: None,
        within_noise_of: None,
        native_within_noise: false,
        failure: recipe.upscaler.upscaler().failure(),
        crop: crop.of(&judged.picture)?,
    })
}

/// Determines which rows are dominated, and which time differences are within noise.
fn rank(rows: &mut [UpscalingRow], noise: &Noise) {
    let points: Vec<_> = rows.iter().map(|row| (row.frame_ms.median, row.motion.mean.flip)).collect();
    let labels: Vec<_> = rows.iter().map(|row| row.label.clone()).collect();
    let native = rows.iter().find(|row| row.recipe.upscaler.is_native()).map(|row| row.frame_ms.median);
    for (row, standing) in rows.iter_mut().zip(standings(&points, noise)) {
        match standing {
            Standing::Front => {}
            Standing::WithinNoise(of) => row.within_noise_of = Some(labels[of].clone()),
            Standing::Beaten(by) => row.dominated_by = Some(labels[by].clone()),
        }
        row.native_within_noise =
            !row.recipe.upscaler.is_native() && native.is_some_and(|native| noise.covers(native, row.frame_ms.median));
    }
}

/// Returns the crop rectangle with the largest total error over all recipes. Candidate positions are half a rectangle
/// apart.
fn crop_of(judged: &[MeasuredImage]) -> PixelRegion {
    let (width, height) = judged.first().map_or((1, 1), |judged| judged.picture.size());
    let (across, down) = (CROP.0.min(width), CROP.1.min(height));
    let steps = |length: u32, part: u32| (0..=length - part).step_by((part as usize / 2).max(1));
    let regions = steps(height, down).flat_map(|top| steps(width, across).map(move |left| (left, top)));
    let region = |(left, top)| PixelRegion { left, top, right: left + across, bottom: top + down };
    let error = |region: &PixelRegion| judged.iter().filter_map(|judged| region.mean(&judged.flip)).sum::<f64>();
    let regions = regions.map(region).map(|region| (region, error(&region)));
    let worst = regions.max_by(|(_, a), (_, b)| a.total_cmp(b));
    worst.map_or(PixelRegion { left: 0, top: 0, right: across, bottom: down }, |(region, _)| region)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneSource;

    fn plan(viewport: Viewport, rounds: usize) -> UpscalingPlan {
        let scene = SceneSource::named("triangle".into()).load().unwrap().scene;
        let subject = NamedView { name: scene.name.clone(), camera: scene.home, scene: Arc::new(scene) };
        UpscalingPlan {
            subjects: vec![subject],
            recipes: every_upscaler(Recipe::default()),
            viewport,
            rounds,
            reference: Reference::Native,
            turn: Turn { degrees: 0.5, frames: 2 },
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
        assert!(
            temporal.error.codes.mse == 0.0 && temporal.motion.mean.codes.mse > 0.0,
            "exact at rest, not in motion"
        );
        for row in &scene.rows {
            assert_eq!((row.frame_ms.n, row.crop.size()), (2, (40, 24)), "{}", row.label);
            assert!(row.parts_ms.pixels <= row.frame_ms.max && row.error.flip >= 0.0, "{}", row.label);
        }
        let nearest = scene.rows.iter().find(|row| row.label == "Nearest ×4").unwrap();
        assert!(nearest.error.flip > 0.0 && (nearest.drawn - 1.0 / 16.0).abs() < 1e-9);
        assert!(scene.rows.iter().any(|row| row.dominated_by.is_none()), "somebody is best");
        // Two rounds form one block for each of five twins.
        assert_eq!(scene.noise.pairs, 5);
        assert_eq!(report.machine.load_at_start.is_some(), report.machine.load_at_end.is_some());
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
        rank(&mut rows, &Noise { pairs: 5, p90: 0.02 });
        let native = Some(rows[0].label.clone());
        assert_eq!(rows.iter().map(|row| row.dominated_by.clone()).collect::<Vec<_>>(), [None, native.clone(), None]);
        assert_eq!(rows.iter().map(|row| row.within_noise_of.clone()).collect::<Vec<_>>(), [None, None, native]);
        assert_eq!(rows.iter().map(|row| row.native_within_noise).collect::<Vec<_>>(), [false, true, true]);
        rank(&mut rows, &Noise { pairs: 5, p90: 0.001 });
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
}
