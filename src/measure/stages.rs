//! Where the time of a frame goes, stage by stage.
//!
//! In tiled execution, stages run one after the other and each records its own time; the frame with the median time is shown. In the classic way rasterizing, depth and
//! shading are interleaved sample by sample, and a clock in that loop would cost more than what it measures. There they are
//! told apart by drawing the frame several times, each time one stage further, and taking differences. So they are estimates:
//! a difference within the noise of its two runs comes out as zero, which means "too short to tell". The compiler may also
//! move work from one stage into the next where only the next one reads the result.

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::chain::{Frame, FrameTimes, KeepDepth, Recipe, Renderer, redraw};
use crate::pipeline::Until;
use crate::pipeline::settings::{DepthTest, Execution};
use crate::pipeline::tiled::TiledTimes;
use crate::scene::{Camera, Scene};

/// Time of each stage of a frame; `None` for a stage that did not run, or whose time is that of another one.
#[derive(Clone, Copy, Debug, Default)]
pub struct StageTimes {
    /// Plan and vertices. Tile by tile with projection.
    pub transform: Duration,
    /// Clipping.
    pub clip: Option<Duration>,
    /// Division and snapping.
    pub project: Option<Duration>,
    /// Facing and edge setup. Tile by tile with clipping and sorting into tiles.
    pub cull: Duration,
    /// Clearing the framebuffer and finding covered samples. Tile by tile with the depth test.
    pub rasterize: Duration,
    /// Depth test and store.
    pub depth: Option<Duration>,
    /// Interpolating attributes.
    pub interpolate: Option<Duration>,
    /// Shading and writing. Tile by tile with interpolation.
    pub shade: Duration,
    /// Averaging the samples of each pixel. Classic execution: with the passes after the first.
    pub resolve: Option<Duration>,
    /// Finding the surface that each pixel shows, for upscalers that read it.
    pub surfaces: Option<Duration>,
    /// Filling in pixels that were not drawn, and keeping the frame as history.
    pub upscale: Duration,
    /// Post filter and wireframe.
    pub post: Option<Duration>,
    /// Work between the stages: buffers, thread pool, copies.
    pub other: Duration,
    /// The whole frame: the sum of all stages. Tiled execution: the median of warm frames.
    pub frame: Duration,
}

impl StageTimes {
    /// Returns the stages that have a time of their own, with their names, in their order; they add up to the frame.
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
            ("post filter", self.post),
            ("other", Some(self.other)),
        ];
        stages.into_iter().filter_map(|(name, time)| Some((name, time?))).collect()
    }

    /// Takes over the stages that no redraw measures, and adds up the frame.
    fn with_rest_of(self, recipe: &Recipe, times: &FrameTimes) -> Self {
        let mut all = Self {
            resolve: (!recipe.antialias.is_off()).then_some(times.resolve),
            surfaces: recipe.upscaler.upscaler().reads().surfaces.then_some(times.surfaces),
            upscale: times.upscale,
            post: (!recipe.post.is_off() || recipe.wireframe).then_some(times.post),
            other: times.other(),
            ..self
        };
        all.frame = all.named().iter().map(|(_, time)| *time).sum();
        all
    }
}

/// Frames up to this long are drawn several times per level.
const SHORT_FRAME: Duration = Duration::from_millis(250);

/// Rounds for short frames.
const ROUNDS: usize = 3;

/// How far each level draws.
const LEVELS: [Until; 4] = [Until::Coverage, Until::Depth, Until::Interpolate, Until::Shade];

/// Times the stages of one frame piece by piece, so that whoever waits for something else never waits long.
///
/// Rounds run all levels in turn, so that a disturbance hits one run and not one level; the least time of each level is the
/// one that was disturbed least.
#[derive(Debug)]
pub struct StageTimer {
    least: [Duration; LEVELS.len()],
    runs: usize,
    wanted_runs: usize,
    /// Draws frames once more tile by tile.
    renderer: Renderer,
    tiled: Vec<(FrameTimes, TiledTimes)>,
}

impl StageTimer {
    /// For a frame, which tells how many rounds are worth while.
    pub fn new(frame: &Frame) -> Self {
        let rounds = if frame.times.total < SHORT_FRAME { ROUNDS } else { 1 };
        Self {
            least: [Duration::MAX; LEVELS.len()],
            runs: 0,
            wanted_runs: rounds * LEVELS.len(),
            renderer: Renderer::default(),
            tiled: Vec::new(),
        }
    }

    /// Whether a piece was timed already.
    pub fn has_begun(&self) -> bool {
        self.runs > 0
    }

    /// Times the next piece, at most one frame, of the frame that was drawn of `scene` by `recipe`. The times are there when
    /// all pieces are.
    pub fn step(&mut self, scene: &Arc<Scene>, camera: &Camera, recipe: &Recipe, frame: &Frame) -> Option<StageTimes> {
        if frame.execution == Execution::Tiled {
            return self.step_tiled(scene, camera, recipe, frame);
        }
        let level = self.runs % LEVELS.len();
        let start = Instant::now();
        black_box(redraw(scene, recipe, frame, LEVELS[level], &mut ()));
        self.least[level] = self.least[level].min(start.elapsed());
        self.runs += 1;
        (self.runs >= self.wanted_runs).then(|| self.differences(recipe, frame))
    }

    fn step_tiled(
        &mut self,
        scene: &Arc<Scene>,
        camera: &Camera,
        recipe: &Recipe,
        frame: &Frame,
    ) -> Option<StageTimes> {
        let again = self.renderer.render(scene, camera, recipe, frame.viewport, KeepDepth::Yes);
        let times = again.tiled.as_ref().map(|report| report.times)?;
        self.tiled.push((again.times, times));
        self.renderer.recycle(again);
        self.runs += 1;
        (self.runs >= self.wanted_runs).then(|| self.median_frame(recipe))
    }

    /// Returns the stages of the frame whose time is the median: stages of one frame add up, medians of each do not.
    fn median_frame(&mut self, recipe: &Recipe) -> StageTimes {
        self.tiled.sort_by_key(|(frame, _)| frame.total);
        let (frame, tiled) = self.tiled[self.tiled.len() / 2];
        let stages = StageTimes {
            transform: tiled.transform,
            cull: tiled.cull,
            rasterize: tiled.rasterize,
            shade: tiled.shade,
            ..StageTimes::default()
        };
        stages.with_rest_of(recipe, &frame)
    }

    fn differences(&self, recipe: &Recipe, frame: &Frame) -> StageTimes {
        let [coverage, depth, interpolate, shade] = self.least;
        let geometry = frame.geometry.times;
        let tests_depth = recipe.pipeline.depth_test != DepthTest::Off;
        // Without a test both levels do the same, and the better time stands for both.
        let (coverage, depth) =
            if tests_depth { (coverage, depth) } else { (coverage.min(depth), coverage.min(depth)) };
        StageTimes {
            transform: geometry.transform,
            clip: Some(geometry.clip),
            project: Some(geometry.project),
            cull: geometry.cull,
            rasterize: coverage,
            depth: tests_depth.then(|| depth.saturating_sub(coverage)),
            interpolate: Some(interpolate.saturating_sub(depth)),
            shade: shade.saturating_sub(interpolate),
            ..StageTimes::default()
        }
        .with_rest_of(recipe, &frame.times)
    }
}

/// Times every stage of a frame that was drawn of `scene` by `recipe`; costs some ten more frames if it is a short one, else
/// about three.
pub fn stage_times(scene: &Arc<Scene>, camera: &Camera, recipe: &Recipe, frame: &Frame) -> StageTimes {
    let mut timer = StageTimer::new(frame);
    loop {
        if let Some(times) = timer.step(scene, camera, recipe, frame) {
            return times;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::run;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    fn times(depth_test: DepthTest) -> StageTimes {
        let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
        let mut recipe = Recipe { execution: Execution::Classic, ..Recipe::default() };
        recipe.pipeline.depth_test = depth_test;
        let frame = run(&scene, &scene.home, &recipe, Viewport { width: 160, height: 120 }, &mut ());
        stage_times(&scene, &scene.home, &recipe, &frame)
    }

    #[test]
    fn every_stage_takes_time_of_its_own() {
        // A single difference may drown in noise; twenty do not, unless the compiler left the stage out.
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
            &["antialias.method=multisample", "antialias.samples=4"],
            &["upscaler.method=checkerboard-surfaces", "post.filter=fxaa", "wireframe=true"],
            &["upscaler.method=accumulation", "upscaler.scale=2"],
            &["execution=classic", "antialias.method=regular", "antialias.samples=4", "post.filter=blur"],
        ] {
            let mut recipe = Recipe::default();
            recipe.set_all(settings).unwrap();
            let frame = Renderer::default().render(&scene, &scene.home, &recipe, size, KeepDepth::Yes);
            let times = stage_times(&scene, &scene.home, &recipe, &frame);
            let sum: Duration = times.named().iter().map(|(_, time)| *time).sum();
            assert_eq!(sum, times.frame, "{settings:?}");
            let parts = frame.times;
            let known = parts.geometry + parts.pixels + parts.resolve + parts.surfaces + parts.upscale + parts.post;
            assert!(known <= parts.total, "{settings:?}: no part is counted twice: {parts:?}");
            let names: Vec<_> = times.named().into_iter().map(|(name, _)| name).collect();
            assert_eq!(names.contains(&"resolve"), !recipe.antialias.is_off(), "{settings:?}");
            assert_eq!(names.contains(&"post filter"), !recipe.post.is_off() || recipe.wireframe, "{settings:?}");
        }
    }

    #[test]
    fn without_a_depth_test_there_is_no_time_of_one() {
        let times = times(DepthTest::Off);
        assert_eq!(times.depth, None);
        assert!(times.named().iter().all(|(name, _)| *name != "depth"));
        assert!(times.rasterize > Duration::ZERO);
    }
}
