//! Upscaling report: every recipe on every scene, with its errors at rest and in motion, and its time.
//!
//! [`measure`] measures the rows of one shard, and [`combine`] ranks those of all shards. The shards of one report may run
//! on different machines; their times are then compared by their ratio to the time of native rendering, which every shard
//! measures in the same rounds.

use serde::Serialize;

use super::measurements::{Measurements, NativeTimes, Parts, RowMeasurements, candidates, measure};
use super::plan::with;
pub use super::plan::{NamedView, PlanRecord, UpscalingPlan, UpscalingProgress};
use super::skipping::PixelShareTimes;
use super::tradeoff::{Standing, standings};
use crate::chain::Recipe;
use crate::image::{Image, Rgba8};
use crate::measure::against::ErrorMetrics;
use crate::measure::machine::Machines;
use crate::measure::metric::Metric;
use crate::measure::motion::{MotionError, Turn};
use crate::measure::noise::{Noise, Pairs};
use crate::measure::region::PixelRegion;
use crate::measure::shard::{Shard, ShardRun};
use crate::measure::timing::Summary;
use crate::pipeline::settings::Choice as _;
use crate::upscale::Upscaling;

/// Complete upscaling report.
#[derive(Clone, Debug, Serialize)]
pub struct UpscalingReport {
    /// Machines and build, with the load at the start and at the end.
    #[serde(flatten)]
    pub(crate) machines: Machines,
    /// Largest number of threads that drew.
    pub(crate) threads: usize,
    /// Width and height of the full image, in pixels.
    pub(crate) size: [u32; 2],
    /// Number of timed rounds.
    pub(crate) rounds: usize,
    /// Name of the reference that errors are relative to.
    pub(crate) reference: &'static str,
    /// Metric on the error axis, by which the methods are ranked.
    pub(crate) metric: Metric,
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
    /// Machine that measured `shares`; `None` if the same one measured everything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) shares_machine: Option<String>,
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
    /// Machine that measured the times; `None` if the same one measured all rows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) machine: Option<String>,
    /// Number of threads that drew.
    pub(crate) threads: usize,
    /// Frame time, in milliseconds.
    pub(crate) frame_ms: Summary,
    /// Times of native rendering in the same rounds; `None` without a native recipe.
    pub(crate) native_ms: Option<NativeTimes>,
    /// Factor that makes times comparable with those of the native row, whose shard may have run elsewhere: the ratio of
    /// the native frame times. 1 without shards.
    #[serde(skip)]
    pub(crate) scale: f64,
    /// Median time spent in each part of a frame, in milliseconds.
    pub(crate) parts_ms: Parts,
    /// Error of the image in the still view.
    pub(crate) error: ErrorMetrics,
    /// Error over the frames of the moving view, used to rank the methods. Without motion, it equals the error in the
    /// still view.
    pub(crate) motion: MotionError,
    /// Label of a recipe that dominates this one in frame time and in the error of the moving view; `None` if there is
    /// no such recipe. A shorter time counts as better only if the difference exceeds the noise.
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
    /// Returns the median frame time, in milliseconds, in comparison with the native row.
    pub(crate) fn comparable_ms(&self) -> f64 {
        self.frame_ms.median * self.scale
    }

    /// Returns the error of the moving view by a metric: 0 for identical pictures.
    pub(crate) fn error_in_motion(&self, metric: Metric) -> f64 {
        metric.error(self.motion.mean.value(metric))
    }

    /// Whether the row is on the Pareto front of frame time and error in the moving view.
    pub(crate) fn is_on_front(&self) -> bool {
        self.dominated_by.is_none() && self.within_noise_of.is_none()
    }
}

/// Runs all measurements. If cancelled, returns the scenes measured so far, or `None` if there are none. The last scene
/// may have fewer rounds.
pub fn run(
    plan: &UpscalingPlan,
    report_progress: &dyn Fn(UpscalingProgress),
    cancelled: &dyn Fn() -> bool,
) -> Option<UpscalingReport> {
    combine(&plan.record(), &[measure(plan, Shard::WHOLE, report_progress, cancelled)?])
}

/// Combines the measurements of all shards of a plan. Returns `None` if there are none because shards were cancelled.
pub fn combine(plan: &PlanRecord, shards: &[ShardRun<Measurements>]) -> Option<UpscalingReport> {
    let machines = Machines::of(shards.iter().map(|shard| &shard.machine))?;
    let numbers = 0..plan.scenes.len();
    let scenes: Vec<_> = numbers.filter_map(|number| scene_report(plan, number, &machines, shards)).collect();
    let partial = shards.iter().any(|shard| shard.partial);
    if partial && scenes.is_empty() {
        return None;
    }
    Some(UpscalingReport {
        machines,
        threads: shards.iter().map(|shard| shard.results.threads).max()?,
        size: plan.size,
        rounds: plan.rounds,
        reference: plan.reference.name(),
        metric: plan.metric,
        turn: plan.turn,
        scenes,
        partial,
    })
}

/// Measurements of a row, with their recipe and the shard that they come from.
#[derive(Clone, Copy)]
struct MeasuredRow<'a> {
    recipe: Recipe,
    shard: &'a ShardRun<Measurements>,
    row: &'a RowMeasurements,
}

/// Combines the measurements of one scene; `None` if there are none.
fn scene_report(
    plan: &PlanRecord,
    number: usize,
    machines: &Machines,
    shards: &[ShardRun<Measurements>],
) -> Option<SceneReport> {
    let mut pairs = Pairs::default();
    shards.iter().filter_map(|shard| shard.results.scene(number)).for_each(|scene| pairs.append(scene.pairs.clone()));
    let measured = |(index, upscaler): (usize, &Upscaling)| {
        let recipe = with(&plan.scenes[number].recipe, *upscaler);
        let find = |shard| Some(MeasuredRow { recipe, shard, row: shard.results.scene(number)?.rows.get(&index)? });
        shards.iter().find_map(find)
    };
    // In the order of the upscalers, so that sums over them do not depend on the shards.
    let measured: Vec<MeasuredRow<'_>> = plan.upscalers.iter().enumerate().filter_map(measured).collect();
    let region_errors: Vec<&[f64]> = measured.iter().map(|measured| &measured.row.region_errors[..]).collect();
    let crop = crop_of(plan.size, &region_errors);
    let native = measured.iter().find(|row| row.recipe.upscaler.is_native()).or(measured.first());
    let native = native.and_then(|native| native.row.native_ms);
    let row = |measured: &MeasuredRow<'_>| row(measured, machines, native, crop);
    let mut rows = measured.iter().map(row).collect::<Option<Vec<_>>>()?;
    let noise = pairs.noise()?;
    rank(&mut rows, plan.metric, &noise);
    let shares = shards.iter().find_map(|shard| Some((shard, shard.results.scene(number)?.shares.as_ref()?)));
    Some(SceneReport {
        scene: plan.scenes[number].name.clone(),
        triangles: plan.scenes[number].triangles,
        noise,
        rows,
        shares: shares.map(|(_, shares)| shares.clone()),
        shares_machine: shares.and_then(|(shard, _)| machines.label(&shard.machine)),
        crop,
    })
}

/// Returns a row that is not ranked yet. `native` holds the times of native rendering with which times are compared.
fn row(
    MeasuredRow { recipe, shard, row }: &MeasuredRow<'_>,
    machines: &Machines,
    native: Option<NativeTimes>,
    crop: PixelRegion,
) -> Option<UpscalingRow> {
    let scale = |all: NativeTimes, own: NativeTimes| all.frame / own.frame.max(f64::MIN_POSITIVE);
    Some(UpscalingRow {
        label: recipe.upscaler.label(),
        recipe: *recipe,
        drawn: row.drawn,
        machine: machines.label(&shard.machine),
        threads: shard.results.threads,
        frame_ms: row.frame_ms,
        native_ms: row.native_ms,
        scale: native.zip(row.native_ms).map_or(1.0, |(all, own)| scale(all, own)),
        parts_ms: row.parts_ms,
        error: row.error,
        motion: row.motion,
        dominated_by: None,
        within_noise_of: None,
        native_within_noise: false,
        failure: row.failure.clone(),
        crop: crop.of(&row.picture)?,
    })
}

/// Determines which rows are dominated by a metric, and which time differences are within noise.
fn rank(rows: &mut [UpscalingRow], metric: Metric, noise: &Noise) {
    let points: Vec<_> = rows.iter().map(|row| (row.comparable_ms(), row.error_in_motion(metric))).collect();
    let labels: Vec<_> = rows.iter().map(|row| row.label.clone()).collect();
    let native = rows.iter().find(|row| row.recipe.upscaler.is_native()).map(UpscalingRow::comparable_ms);
    for (row, standing) in rows.iter_mut().zip(standings(&points, noise)) {
        match standing {
            Standing::Front => {}
            Standing::WithinNoise(of) => row.within_noise_of = Some(labels[of].clone()),
            Standing::Beaten(by) => row.dominated_by = Some(labels[by].clone()),
        }
        row.native_within_noise =
            !row.recipe.upscaler.is_native() && native.is_some_and(|native| noise.covers(native, row.comparable_ms()));
    }
}

/// Returns the crop rectangle with the largest total error over all rows. `errors` holds the errors of each row in all
/// [`candidates`].
fn crop_of(size: [u32; 2], errors: &[&[f64]]) -> PixelRegion {
    let total = |candidate: usize| errors.iter().map(|row| row[candidate]).sum::<f64>();
    let regions = candidates(size).into_iter().enumerate().map(|(number, region)| (region, total(number)));
    let worst = regions.max_by(|(_, a), (_, b)| a.total_cmp(b));
    worst.map_or(PixelRegion { left: 0, top: 0, right: size[0], bottom: size[1] }, |(region, _)| region)
}

#[cfg(test)]
mod tests;
