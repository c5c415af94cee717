//! Measurements of one shard of an upscaling report: the errors of its recipes on every scene, then their times in
//! interleaved rounds, together with native rendering.
//!
//! The rounds time the same frames whose error in motion is measured; see [`crate::measure::rounds`]. File access and
//! error metrics are not timed.

use std::collections::BTreeMap;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::plan::{NamedView, PlanRecord, UpscalingPlan, UpscalingProgress, with};
use super::skipping::{self, PixelShareTimes};
use crate::chain::{Frame, FrameTimes, Recipe};
use crate::image::{Image, Rgba8, png_text};
use crate::measure::against::ErrorMetrics;
use crate::measure::machine::Machine;
use crate::measure::motion::{ErrorMeasurement, FrameSequence, MotionError, Turn};
use crate::measure::noise::Pairs;
use crate::measure::region::PixelRegion;
use crate::measure::rounds::RoundTimer;
use crate::measure::shard::{Shard, ShardRun};
use crate::measure::timing::{Summary, summarize};
use crate::pipeline::DrawnView;

/// Maximum width and height of a crop, in pixels.
const CROP: (u32, u32) = (160, 110);

/// Maximum number of rounds for the comparison of two ways to draw fewer pixels. Each round draws 20 images on one
/// thread.
const SHARE_ROUNDS: usize = 9;

/// Median times of native rendering, in milliseconds.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct NativeTimes {
    /// Time of a frame.
    pub(crate) frame: f64,
    /// Time from rasterization to shading.
    pub(crate) pixels: f64,
}

/// Time spent in each part of a frame, in milliseconds.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
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

/// Measurements of one shard.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Measurements {
    /// Number of threads that drew.
    pub(super) threads: usize,
    /// Measurements of each scene of the plan; `None` if no recipe on it belongs to the shard, or if it was cancelled.
    pub(super) scenes: Vec<Option<SceneMeasurements>>,
}

/// Measurements of one scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct SceneMeasurements {
    /// Measurements of the shard's recipes, by their index in the plan.
    pub(super) rows: BTreeMap<usize, RowMeasurements>,
    /// A/A pairs of the frame times.
    pub(super) pairs: Pairs,
    /// Comparison of two ways to draw fewer pixels, measured by the shard of the first recipe; `None` if the scene has
    /// transparency.
    pub(super) shares: Option<Vec<PixelShareTimes>>,
}

/// Measurements of one recipe on one scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct RowMeasurements {
    /// Fraction of the pixels that were drawn, in (0, 1].
    pub(super) drawn: f64,
    pub(super) frame_ms: Summary,
    /// Times of native rendering in the same rounds; `None` without a native recipe.
    pub(super) native_ms: Option<NativeTimes>,
    pub(super) parts_ms: Parts,
    /// Error in the still view.
    pub(super) error: ErrorMetrics,
    pub(super) motion: MotionError,
    /// Failure of the upscaler.
    pub(super) failure: Option<String>,
    /// Mean FLIP error in the still view in each of the [`candidates`].
    pub(super) region_errors: Vec<f64>,
    /// Image of the still view.
    #[serde(with = "png_text")]
    pub(super) picture: Image<Rgba8>,
}

impl Measurements {
    /// Returns the measurements of scene `number` of the plan, if there are any.
    pub(super) fn scene(&self, number: usize) -> Option<&SceneMeasurements> {
        self.scenes[number].as_ref()
    }

    /// Returns the first contradiction between the measurements of a shard and the plan, in words.
    ///
    /// # Errors
    /// Returns an error if a row is missing although the run was complete, or has the wrong size.
    pub fn check(plan: &PlanRecord, run: &ShardRun<Self>) -> Result<(), String> {
        if run.results.scenes.len() != plan.scenes.len() {
            return Err(format!("results of {} scenes instead of {}", run.results.scenes.len(), plan.scenes.len()));
        }
        let regions = candidates(plan.size).len();
        for (number, (scene, found)) in plan.scenes.iter().zip(&run.results.scenes).enumerate() {
            let row = |recipe: &usize| found.as_ref().and_then(|found| found.rows.get(recipe));
            let owned = owned(plan.upscalers.len(), number, run.shard);
            if let Some(recipe) = owned.iter().find(|recipe| row(recipe).is_none()).filter(|_| !run.partial) {
                return Err(format!("no results of {} on {}", plan.upscalers[*recipe].label(), scene.name));
            }
            let is_sound = |row: &RowMeasurements| {
                row.region_errors.len() == regions && <[u32; 2]>::from(row.picture.size()) == plan.size
            };
            if !owned.iter().filter_map(row).all(is_sound) {
                return Err(format!("a picture of {} has another size than the plan", scene.name));
            }
        }
        Ok(())
    }
}

/// Returns the indices of the recipes that a shard measures on scene `number`.
fn owned(recipes: usize, number: usize, shard: Shard) -> Vec<usize> {
    (0..recipes).filter(|recipe| shard.owns(number * recipes + recipe)).collect()
}

/// Measures the rows of a shard. If cancelled, returns the scenes measured so far, or `None` if there are none. The last
/// scene may have fewer rounds.
pub fn measure(
    plan: &UpscalingPlan,
    shard: Shard,
    report_progress: &dyn Fn(UpscalingProgress),
    cancelled: &dyn Fn() -> bool,
) -> Option<ShardRun<Measurements>> {
    let machine = Machine::at_start().with_host();
    let mut scenes = vec![None; plan.subjects.len()];
    for (number, subject) in plan.subjects.iter().enumerate() {
        let work = SceneWork { plan, subject, owned: owned(plan.upscalers.len(), number, shard) };
        if work.owned.is_empty() {
            continue;
        }
        match work.measure(report_progress, cancelled) {
            None if cancelled() && scenes.iter().any(Option::is_some) => break,
            None => return None,
            measured => scenes[number] = measured,
        }
        if cancelled() {
            break;
        }
    }
    let results = Measurements { threads: rayon::current_num_threads(), scenes };
    Some(ShardRun { shard, machine: machine.at_end(), partial: cancelled(), results })
}

/// Image of one recipe at rest, with its FLIP error in each of the [`candidates`].
struct MeasuredImage {
    picture: Image<Rgba8>,
    region_errors: Vec<f64>,
    drawn: f64,
}

/// One scene with the recipes to measure on it.
struct SceneWork<'a> {
    plan: &'a UpscalingPlan,
    subject: &'a NamedView,
    /// Indices of the recipes to measure, at least one.
    owned: Vec<usize>,
}

impl SceneWork<'_> {
    /// Returns the recipe of the scene with an upscaler of the plan.
    fn recipe(&self, index: usize) -> Recipe {
        with(&self.subject.recipe, self.plan.upscalers[index])
    }

    fn measure(
        &self,
        report_progress: &dyn Fn(UpscalingProgress),
        cancelled: &dyn Fn() -> bool,
    ) -> Option<SceneMeasurements> {
        let Self { plan, subject, owned } = self;
        let say = |stage, done, of| report_progress(UpscalingProgress { scene: subject.name.clone(), stage, done, of });
        let NamedView { scene, camera, .. } = subject;
        let shot = FrameSequence { scene, camera, viewport: plan.viewport, turn: plan.turn };
        let still = FrameSequence { turn: Turn::STILL, ..shot };
        let mut judged = Vec::with_capacity(owned.len());
        let regions = candidates([plan.viewport.width, plan.viewport.height]);
        let at_rest = self.errors(
            &still,
            cancelled,
            &mut |done, judge| {
                say("errors at rest", done, judge.total(still.turn));
            },
            |frame, flip| {
                let region_errors = regions.iter().map(|region| region.mean(&flip).unwrap_or(0.0)).collect();
                judged.push(MeasuredImage {
                    picture: frame.image().clone(),
                    drawn: frame.drawn_share(),
                    region_errors,
                });
            },
        )?;
        let in_motion = if plan.turn.is_still() {
            None
        } else {
            let say = &mut |done, judge: &ErrorMeasurement| say("errors in motion", done, judge.total(plan.turn));
            Some(self.errors(&shot, cancelled, say, |_, _| ())?)
        };
        // The native recipe is timed in every shard, as the baseline of the others.
        let native = plan.upscalers.iter().position(|upscaler| upscaler.is_native());
        let baseline = native.filter(|native| !owned.contains(native));
        let timed: Vec<usize> = baseline.into_iter().chain(owned.iter().copied()).collect();
        let timer = self.times(&timed, &shot, &|done, of| say("times", done, of), cancelled)?;
        let times = |recipe: usize| timed.iter().position(|timed| *timed == recipe).map(|place| timer.times(place));
        let shares = if owned[0] == 0 {
            say("shares", 0, 1);
            self.shares(cancelled)?
        } else {
            None
        };
        let native_ms = native.and_then(times).and_then(|times| {
            let frame = summary(times, |times| times.total)?.median;
            Some(NativeTimes { frame, pixels: summary(times, |times| times.pixels)?.median })
        });
        let mut rows = BTreeMap::new();
        for (place, (index, judged)) in owned.iter().zip(judged).enumerate() {
            let still = at_rest.error(place)?;
            let motion = in_motion.as_ref().map_or(Some(still), |judge| judge.error(place))?;
            let times = times(*index)?;
            let row = RowMeasurements {
                drawn: judged.drawn,
                frame_ms: summary(times, |times| times.total)?,
                native_ms,
                parts_ms: parts(times)?,
                error: still.mean,
                motion,
                failure: plan.upscalers[*index].upscaler().failure(),
                region_errors: judged.region_errors,
                picture: judged.picture,
            };
            rows.insert(*index, row);
        }
        Some(SceneMeasurements { rows, pairs: timer.pairs(), shares })
    }

    /// Compares two ways to draw fewer pixels, unless the scene has transparency. Returns `None` if the scene is
    /// incomplete because of a cancellation.
    fn shares(&self, cancelled: &dyn Fn() -> bool) -> Option<Option<Vec<PixelShareTimes>>> {
        let Self { plan, subject: NamedView { scene, camera, .. }, .. } = self;
        let view = DrawnView { scene, camera, settings: &self.recipe(0).pipeline, viewport: plan.viewport };
        if !skipping::applies(&view) {
            return Some(None);
        }
        let shares = skipping::measure(&view, plan.rounds.min(SHARE_ROUNDS), cancelled);
        shares.map(Some).or(cancelled().then_some(None))
    }

    /// Measures the errors of the recipes over a frame sequence. `look` receives each frame and the FLIP error of each
    /// of its pixels. Returns `None` if cancelled.
    fn errors(
        &self,
        shot: &FrameSequence<'_>,
        cancelled: &dyn Fn() -> bool,
        say: &mut dyn FnMut(usize, &ErrorMeasurement),
        mut look: impl FnMut(&Frame, Image<f32>),
    ) -> Option<ErrorMeasurement> {
        let recipes = self.owned.iter().map(|index| self.recipe(*index));
        let mut judge = ErrorMeasurement::new(self.plan.reference, recipes).selecting(self.plan.metric);
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

    /// Times recipes. If cancelled, returns the rounds completed so far, or `None` if there are none.
    fn times(
        &self,
        timed: &[usize],
        shot: &FrameSequence<'_>,
        say: &dyn Fn(usize, usize),
        cancelled: &dyn Fn() -> bool,
    ) -> Option<RoundTimer> {
        let recipes: Vec<Recipe> = timed.iter().map(|index| self.recipe(*index)).collect();
        let mut timer = RoundTimer::new(&recipes, self.plan.rounds);
        let mut reported_rounds = None;
        while !timer.is_complete() {
            if reported_rounds != Some(timer.rounds()) {
                reported_rounds = Some(timer.rounds());
                say(timer.rounds(), self.plan.rounds);
            }
            if cancelled() {
                return (timer.rounds() > 0).then_some(timer);
            }
            timer.step(shot);
        }
        Some(timer)
    }
}

/// Summarises the times of one part of the frames, in milliseconds.
fn summary(times: &[FrameTimes], part: fn(&FrameTimes) -> Duration) -> Option<Summary> {
    summarize(&times.iter().map(|times| part(times).as_secs_f64() * 1e3).collect::<Vec<_>>())
}

fn parts(times: &[FrameTimes]) -> Option<Parts> {
    Some(Parts {
        geometry: summary(times, |times| times.geometry)?.median,
        pixels: summary(times, |times| times.pixels)?.median,
        upscale: summary(times, |times| times.upscale.saturating_sub(times.transfer))?.median,
        transfer: summary(times, |times| times.transfer)?.median,
    })
}

/// Returns the rectangles of which the one with the largest error is shown, for an image of this width and height. They
/// are half a rectangle apart.
pub(super) fn candidates([width, height]: [u32; 2]) -> Vec<PixelRegion> {
    let (across, down) = (CROP.0.min(width), CROP.1.min(height));
    let steps = |length: u32, part: u32| (0..=length - part).step_by((part as usize / 2).max(1));
    let corners = steps(height, down).flat_map(|top| steps(width, across).map(move |left| (left, top)));
    corners.map(|(left, top)| PixelRegion { left, top, right: left + across, bottom: top + down }).collect()
}
