//! Frame time by pipeline stage.
//!
//! In tiled execution, stages run one after the other and each records its own time. In classic execution,
//! rasterization, depth test and shading are interleaved per sample, and a clock in that loop would cost more than the
//! work it times. Therefore, partial frames are drawn, each up to one stage further than the previous one. The total
//! time of the interleaved stages is split in proportion to the differences between the times of successive partial
//! frames. The results are estimates. Noise can make a difference negative; it then counts as zero, which means "too
//! short to measure". The compiler may also move work from one stage into the next if only the next one reads the
//! result.
//!
//! The medians of the stages do not add up to the median of the frame. Therefore [`StageTimes`] belong to one frame,
//! and [`summarize_stages`] scales the stages to the median frame time.

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use serde::Serialize;

use super::timing::summarize;
use crate::antialias::settings::AntialiasMethod;
use crate::chain::{Frame, FrameTimes, KeepDepth, Recipe, RenderInputs, Renderer, ViewChange, redraw};
use crate::pipeline::LastStage;
use crate::pipeline::settings::{DepthTest, Execution};
use crate::scene::{Camera, Scene};

/// Time spent in each stage of a frame; `None` for a stage that did not run or is timed as part of another stage.
#[derive(Clone, Copy, Debug, Default)]
pub struct StageTimes {
    /// Time spent planning draws and transforming vertices; includes projection in tiled execution.
    pub transform: Duration,
    /// Time spent on homogeneous clipping.
    pub clip: Option<Duration>,
    /// Time spent on perspective division, viewport transform and snapping.
    pub project: Option<Duration>,
    /// Time spent on the facing test and edge setup; includes clipping and binning in tiled execution.
    pub cull: Duration,
    /// Time spent clearing the framebuffer and finding covered samples; includes the depth test in tiled execution.
    pub rasterize: Duration,
    /// Time spent on depth test and depth write.
    pub depth: Option<Duration>,
    /// Time spent on attribute interpolation.
    pub interpolate: Option<Duration>,
    /// Time spent on shading and colour writes; includes interpolation in tiled execution.
    pub shade: Duration,
    /// Time spent averaging the supersampling passes.
    pub resolve: Option<Duration>,
    /// Time spent finding the visible surface of each pixel, for upscalers that read it.
    pub surfaces: Option<Duration>,
    /// Time spent on upscaling: filling in pixels that were not drawn, and storing the frame as history.
    pub upscale: Duration,
    /// Time spent on transfers to and from the process of the upscaler.
    pub transfer: Option<Duration>,
    /// Time spent on post filter and wireframe.
    pub post: Option<Duration>,
    /// Time spent between the stages, on buffers, thread pool and copies.
    pub other: Duration,
    /// Frame time: the sum of all stages.
    pub frame: Duration,
}

impl StageTimes {
    /// Returns the names and times of the separately timed stages, in pipeline order; they add up to the frame.
    pub fn named(&self) -> Vec<(&'static str, Duration)> {
        let stages = [
            ("transform", Some(self.transform)),
            ("clip", self.clip),
            ("project", self.project),
            ("cull", Some(self.cull)),
            ("rasterize", Some(self.rasterize)),
            ("depth", self.depth),
            ("interpolate", self.interpolate),
            ("shade", Some(self.shade)),
            ("resolve", self.resolve),
            ("surfaces", self.surfaces),
            ("upscale", Some(self.upscale)),
            ("transfer", self.transfer),
            ("post filter", self.post),
            ("other", Some(self.other)),
        ];
        stages.into_iter().filter_map(|(name, time)| Some((name, time?))).collect()
    }

    /// Returns the times that a frame recorded while it was drawn. In classic execution, `rasterize` holds the time of
    /// all per-pixel stages.
    pub fn recorded(recipe: &Recipe, frame: &Frame) -> Self {
        let stages = match &frame.tiled {
            Some(report) => {
                let times = report.times;
                Self {
                    transform: times.transform,
                    cull: times.cull,
                    rasterize: times.rasterize,
                    shade: times.shade,
                    ..Self::default()
                }
            }
            None => {
                // Geometry times of the first pass; the other passes are similar.
                let times = frame.geometry().times;
                let ends = running_sum([times.transform, times.clip, times.project, times.cull]);
                let [transform, clip, project, cull] = split(frame.times.geometry, ends, [1; 4]);
                let (clip, project, rasterize) = (Some(clip), Some(project), frame.times.pixels);
                Self { transform, clip, project, cull, rasterize, ..Self::default() }
            }
        };
        stages.with_rest_of(recipe, &frame.times)
    }

    /// Adds the times of the stages after shading, and computes the frame time as the sum of all stages.
    fn with_rest_of(self, recipe: &Recipe, times: &FrameTimes) -> Self {
        let mut all = Self {
            resolve: recipe.antialias.has_passes().then_some(times.resolve),
            surfaces: recipe.upscaler.upscaler().reads().gbuffer.then_some(times.surfaces),
            upscale: times.upscale.saturating_sub(times.transfer),
            transfer: recipe.upscaler.upscaler().process().map(|_| times.transfer),
            post: (!recipe.post.is_off() || recipe.wireframe).then_some(times.post),
            other: Duration::ZERO,
            ..self
        };
        let named: Duration = all.named().iter().map(|(_, time)| *time).sum();
        all.other = times.total.saturating_sub(named);
        all.frame = named + all.other;
        all
    }
}

/// Splits `total` into four parts, in proportion to the weighted differences between successive times in `ends`. A time
/// below its predecessor counts as equal to it; if all differences are zero, the first part gets everything.
fn split(total: Duration, ends: [Duration; 4], weights: [u32; 4]) -> [Duration; 4] {
    let mut before = Duration::ZERO;
    let parts = [0, 1, 2, 3].map(|part| {
        let step = ends[part].saturating_sub(before);
        before = before.max(ends[part]);
        step * weights[part]
    });
    let sum: Duration = parts.iter().sum();
    if sum.is_zero() {
        return [total, Duration::ZERO, Duration::ZERO, Duration::ZERO];
    }
    let share = total.as_secs_f64() / sum.as_secs_f64();
    parts.map(|part| part.mul_f64(share))
}

/// Returns the running sums of the times.
fn running_sum(times: [Duration; 4]) -> [Duration; 4] {
    let mut sum = Duration::ZERO;
    times.map(|time| {
        sum += time;
        sum
    })
}

/// Longest frame time for which several rounds are drawn.
const SHORT_FRAME: Duration = Duration::from_millis(250);

/// Number of rounds that are drawn for short frames.
const ROUNDS: usize = 3;

/// Last stage of each partial frame in classic execution.
const LEVELS: [LastStage; 4] = [LastStage::Coverage, LastStage::Depth, LastStage::Interpolate, LastStage::Shade];

/// Incremental timer for the stages of one frame. Each step is short, so that a new request never waits long.
///
/// In classic execution, each round draws a whole frame and one partial frame per entry of `LEVELS`. The time of a
/// partial frame is its minimum over the rounds, because disturbances can only add time. In tiled execution, every step
/// draws a whole frame. The result describes the whole frame with the median time. A frame in motion is not drawn again: its
/// stages have the times that it recorded.
#[derive(Debug)]
pub struct StageTimer {
    least: [Duration; LEVELS.len()],
    runs: usize,
    wanted_runs: usize,
    /// Renderer of the whole frames, with its own buffers and history.
    renderer: Renderer,
    frames: Vec<StageTimes>,
}

/// Number of steps per round: one for the whole frame, and one for each partial frame.
const PIECES: usize = LEVELS.len() + 1;

impl StageTimer {
    /// Creates a timer for a frame; its recorded time determines the number of rounds.
    pub fn new(frame: &Frame) -> Self {
        let rounds = if frame.times.total < SHORT_FRAME { ROUNDS } else { 1 };
        Self {
            least: [Duration::MAX; LEVELS.len()],
            runs: 0,
            wanted_runs: rounds * PIECES,
            renderer: Renderer::default(),
            frames: Vec::new(),
        }
    }

    /// Whether at least one step was timed.
    pub fn has_begun(&self) -> bool {
        self.runs > 0
    }

    /// Runs the next step, which draws at most one frame. `frame` must have been drawn from `scene` with `recipe`.
    /// Returns the stage times after the last step.
    pub fn step(&mut self, scene: &Arc<Scene>, camera: &Camera, recipe: &Recipe, frame: &Frame) -> Option<StageTimes> {
        let level = (self.runs % PIECES).checked_sub(1).filter(|_| frame.execution == Execution::Classic);
        if let Some(level) = level {
            let start = Instant::now();
            black_box(redraw(scene, recipe, frame, LEVELS[level], &mut ()));
            self.least[level] = self.least[level].min(start.elapsed());
        } else if self.reads_recorded(frame) {
            self.frames.push(StageTimes::recorded(recipe, frame));
        } else {
            let again =
                self.renderer.render(RenderInputs { scene, camera, recipe, viewport: frame.viewport }, KeepDepth::Yes);
            self.frames.push(StageTimes::recorded(recipe, &again));
            self.renderer.recycle(again);
        }
        self.runs += 1;
        (self.runs >= self.wanted_runs).then(|| {
            self.frames.sort_by_key(|times| times.frame);
            let median = self.frames[self.frames.len() / 2];
            if frame.execution == Execution::Classic { self.split_pixels(median, recipe) } else { median }
        })
    }

    /// Whether the times of whole frames are those that `frame` recorded. Drawn again, a frame in motion would be still, and
    /// would find no surfaces and no motion. With a single round, a new renderer would draw its only frame with cold buffers.
    fn reads_recorded(&self, frame: &Frame) -> bool {
        let is_moving = frame.view_change() == ViewChange::Changed;
        is_moving || (self.wanted_runs == PIECES && frame.execution == Execution::Classic)
    }

    /// Splits the total time of a classic frame's per-pixel stages, in proportion to the differences between the
    /// partial frames' times.
    fn split_pixels(&self, times: StageTimes, recipe: &Recipe) -> StageTimes {
        let [coverage, depth, ..] = self.least;
        let tests_depth = recipe.pipeline.depth_test != DepthTest::Off;
        let mut ends = self.least;
        if !tests_depth {
            // Without a depth test, the levels `Coverage` and `Depth` do the same work, so both get the minimum.
            ends[..2].fill(coverage.min(depth));
        }
        // Multisampling first draws a pass over the pixel centres. It then finds coverage and depth for every sample,
        // but interpolates and shades once per pixel.
        let samples = recipe.antialias.count();
        let multisampled = recipe.antialias.method == AntialiasMethod::Multisample;
        let weights = if multisampled { [1 + samples, 1 + samples, 2, 2] } else { [1; 4] };
        let [rasterize, depth, interpolate, shade] = split(times.rasterize, ends, weights);
        let depth = tests_depth.then_some(depth);
        StageTimes { rasterize, depth, interpolate: Some(interpolate), shade, ..times }
    }
}

/// Times every stage of `frame`, which must have been drawn from `scene` with `recipe`. Draws up to 15 additional
/// frames for a short frame, otherwise up to 5.
pub fn stage_times(scene: &Arc<Scene>, camera: &Camera, recipe: &Recipe, frame: &Frame) -> StageTimes {
    let mut timer = StageTimer::new(frame);
    loop {
        if let Some(times) = timer.step(scene, camera, recipe, frame) {
            return times;
        }
    }
}

/// Time spent in one stage over a series of frames, in milliseconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StageMs {
    /// Share of the stage in the frame time, multiplied by the median frame time. The values of all stages therefore
    /// add up to the median frame time. The share is measured over all frames except the fastest and the slowest
    /// quarter.
    pub median: f64,
    /// 10th percentile of the stage's time over all frames.
    pub p10: f64,
    /// 90th percentile of the stage's time over all frames.
    pub p90: f64,
}

/// Name of a stage, and the time spent in it over a series of frames.
#[derive(Clone, Debug, Serialize)]
pub struct StageSummary {
    /// Name of the stage, as in [`StageTimes::named`].
    pub stage: &'static str,
    /// Time spent in the stage, in milliseconds.
    pub ms: StageMs,
}

/// Summarises the stages of a series of frames; each frame lists all stages in the same order. Returns `None` without
/// frames.
pub fn summarize_stages(frames: &[Vec<(&'static str, Duration)>]) -> Option<Vec<StageSummary>> {
    let ms = |time: &Duration| time.as_secs_f64() * 1e3;
    let total = |frame: &&Vec<(&str, Duration)>| frame.iter().map(|(_, time)| ms(time)).sum::<f64>();
    let mut sorted: Vec<_> = frames.iter().collect();
    sorted.sort_by(|a, b| total(a).total_cmp(&total(b)));
    let median = summarize(&sorted.iter().map(total).collect::<Vec<_>>())?.median;
    let middle = &sorted[sorted.len() / 4..sorted.len() - sorted.len() / 4];
    let all: f64 = middle.iter().map(total).sum();
    let summary = |place: usize| {
        let time = |frame: &&Vec<(&str, Duration)>| ms(&frame[place].1);
        let share = middle.iter().map(time).sum::<f64>() / all.max(f64::MIN_POSITIVE);
        let over_all = summarize(&sorted.iter().map(time).collect::<Vec<_>>())?;
        let ms = StageMs { median: share * median, p10: over_all.p10, p90: over_all.p90 };
        Some(StageSummary { stage: frames[0][place].0, ms })
    };
    (0..frames[0].len()).map(summary).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::run;
    use crate::pipeline::settings::{Choice as _, DisabledOptimisation};
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    fn times(depth_test: DepthTest) -> StageTimes {
        let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
        let mut recipe = Recipe { execution: Execution::Classic, ..Recipe::default() };
        recipe.pipeline.depth_test = depth_test;
        // Otherwise clipping would be skipped, because all objects lie inside the view.
        recipe.pipeline.force = DisabledOptimisation::Clipping;
        let frame = run(&scene, &scene.home, &recipe, Viewport { width: 160, height: 120 }, &mut ());
        stage_times(&scene, &scene.home, &recipe, &frame)
    }

    #[test]
    fn every_stage_takes_time_of_its_own() {
        // A single difference may be lost in noise. Over twenty runs, a stage has a positive time at least once, unless
        // the compiler removed its work.
        let runs: Vec<_> = (0..20).map(|_| times(DepthTest::Less).named()).collect();
        let names: Vec<_> = runs[0].iter().map(|(name, _)| *name).collect();
        assert_eq!(names.len(), 10);
        for (place, name) in names.into_iter().enumerate().filter(|(_, name)| !["upscale", "other"].contains(name)) {
            assert!(runs.iter().any(|run| run[place].1 > Duration::ZERO), "{name} took none");
        }
    }

    #[test]
    fn stages_add_up_to_the_frame_in_every_recipe() {
        let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
        let size = Viewport { width: 160, height: 120 };
        for settings in [
            &[][..],
            &["antialias.method=regular", "antialias.samples=4"],
            &["antialias.method=jittered", "antialias.samples=4"],
            &["antialias.method=multisample", "antialias.samples=4"],
            &["upscaler.method=checkerboard-surfaces", "post.filter=fxaa", "wireframe=true"],
            &["upscaler.method=accumulation", "upscaler.scale=2"],
            &["upscaler.method=fsr1", "antialias.method=rotated-grid", "post.filter=blur"],
            &["depth_test=off"],
        ] {
            for execution in Execution::ALL {
                let mut recipe = Recipe { execution: *execution, ..Recipe::default() };
                recipe.set_all(settings).unwrap();
                let frame = Renderer::default().render(
                    RenderInputs { scene: &scene, camera: &scene.home, recipe: &recipe, viewport: size },
                    KeepDepth::Yes,
                );
                let recorded = StageTimes::recorded(&recipe, &frame).frame;
                // Stage shares are rounded to nanoseconds.
                assert!(recorded.abs_diff(frame.times.total) < Duration::from_nanos(10), "{execution:?} {settings:?}");
                let times = stage_times(&scene, &scene.home, &recipe, &frame);
                let sum: Duration = times.named().iter().map(|(_, time)| *time).sum();
                assert!(sum.abs_diff(times.frame) < Duration::from_nanos(10), "{execution:?} {settings:?}");
                let parts = frame.times;
                let known = parts.geometry + parts.pixels + parts.resolve + parts.surfaces + parts.upscale + parts.post;
                assert!(known <= parts.total, "{execution:?} {settings:?}: no part is counted twice: {parts:?}");
                let names: Vec<_> = times.named().into_iter().map(|(name, _)| name).collect();
                assert_eq!(names.contains(&"resolve"), recipe.antialias.has_passes(), "{settings:?}");
                assert_eq!(names.contains(&"post filter"), !recipe.post.is_off() || recipe.wireframe, "{settings:?}");
            }
        }
    }

    #[test]
    fn a_frame_in_motion_keeps_the_times_of_its_surfaces() {
        let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
        let size = Viewport { width: 160, height: 120 };
        let mut moved = scene.home;
        moved.orbit(0.1, 0.0);
        for execution in Execution::ALL {
            let mut recipe = Recipe { execution: *execution, ..Recipe::default() };
            recipe.set("upscaler.method=taa").unwrap();
            let mut renderer = Renderer::default();
            let _ = renderer.render(
                RenderInputs { scene: &scene, camera: &scene.home, recipe: &recipe, viewport: size },
                KeepDepth::Yes,
            );
            let frame = renderer.render(
                RenderInputs { scene: &scene, camera: &moved, recipe: &recipe, viewport: size },
                KeepDepth::Yes,
            );
            let times = stage_times(&scene, &moved, &recipe, &frame);
            assert_eq!(times.surfaces, Some(frame.times.surfaces), "{execution:?}");
        }
    }

    #[test]
    fn pixels_are_split_by_the_differences_of_the_levels() {
        let ms = |times: [u64; 4]| times.map(Duration::from_millis);
        let of_100 = |ends, weights| split(Duration::from_millis(100), ms(ends), weights);
        assert_eq!(of_100([10, 20, 20, 50], [1; 4]), ms([20, 20, 0, 60]));
        assert_eq!(of_100([10, 8, 20, 50], [1; 4]), ms([20, 0, 20, 60]), "a level within noise takes nothing");
        assert_eq!(of_100([10, 20, 30, 40], [3, 3, 2, 2]), ms([30, 30, 20, 20]));
        assert_eq!(of_100([0; 4], [1; 4]), ms([100, 0, 0, 0]));
        assert_eq!(running_sum(ms([1, 2, 3, 4])), ms([1, 3, 6, 10]));
    }

    #[test]
    fn stages_of_a_series_add_up_to_its_median() {
        let frame = |a, b| vec![("a", Duration::from_millis(a)), ("b", Duration::from_millis(b))];
        // The median of each stage is 10, but the median frame takes 30.
        let frames = [frame(10, 10), frame(10, 20), frame(20, 10), frame(10, 90), frame(2, 8)];
        let stages = summarize_stages(&frames).unwrap();
        assert_eq!(stages.iter().map(|stage| stage.stage).collect::<Vec<_>>(), ["a", "b"]);
        let sum: f64 = stages.iter().map(|stage| stage.ms.median).sum();
        assert!((sum - 30.0).abs() < 1e-9, "{sum}");
        // The middle half of the frames takes 20, 30 and 30; each stage has 40 of these 80.
        assert!((stages[0].ms.median - 15.0).abs() < 1e-9, "{stages:?}");
        assert!(summarize_stages(&[]).is_none());
    }

    #[test]
    fn without_a_depth_test_no_time_is_attributed_to_it() {
        let times = times(DepthTest::Off);
        assert_eq!(times.depth, None);
        assert!(times.named().iter().all(|(name, _)| *name != "depth"));
        assert!(times.rasterize > Duration::ZERO);
    }
}
