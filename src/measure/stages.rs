//! Where the time of a frame goes, stage by stage.
//!
//! Rasterizing, depth and shading are interleaved sample by sample, and a clock in that loop would cost more than what it
//! measures. They are told apart by drawing the frame several times, each time one stage further, and taking differences.
//! So they are estimates: a difference within the noise of its two runs comes out as zero, which means "too short to
//! tell". The compiler may also move work from one stage into the next where only the next one reads the result.

use std::hint::black_box;
use std::time::{Duration, Instant};

use crate::chain::{Frame, Recipe, redraw};
use crate::pipeline::Until;
use crate::pipeline::settings::DepthTest;
use crate::scene::Scene;

/// Time of each stage of a frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct StageTimes {
    /// Plan and vertices.
    pub transform: Duration,
    /// Clipping.
    pub clip: Duration,
    /// Division and snapping.
    pub project: Duration,
    /// Facing and edge setup.
    pub cull: Duration,
    /// Clearing the framebuffer and finding covered samples.
    pub rasterize: Duration,
    /// Depth test and store; `None` without a depth test.
    pub depth: Option<Duration>,
    /// Interpolating attributes.
    pub interpolate: Duration,
    /// Shading and writing.
    pub shade: Duration,
    /// Filling in.
    pub upscale: Duration,
}

impl StageTimes {
    /// The stages that ran, with their names, in their order.
    pub fn named(&self) -> Vec<(&'static str, Duration)> {
        let stages = [
            ("transform", Some(self.transform)),
            ("clip", Some(self.clip)),
            ("project", Some(self.project)),
            ("cull", Some(self.cull)),
            ("rasterize", Some(self.rasterize)),
            ("depth", self.depth),
            ("interpolate", Some(self.interpolate)),
            ("shade", Some(self.shade)),
            ("upscale", Some(self.upscale)),
        ];
        stages.into_iter().filter_map(|(name, time)| Some((name, time?))).collect()
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
#[derive(Clone, Copy, Debug)]
pub struct StageTimer {
    least: [Duration; LEVELS.len()],
    runs: usize,
    wanted_runs: usize,
}

impl StageTimer {
    /// For a frame, which tells how many rounds are worth while.
    pub fn new(frame: &Frame) -> Self {
        let rounds = if frame.times.total < SHORT_FRAME { ROUNDS } else { 1 };
        Self { least: [Duration::MAX; LEVELS.len()], runs: 0, wanted_runs: rounds * LEVELS.len() }
    }

    /// Whether a piece was timed already.
    pub fn has_begun(&self) -> bool {
        self.runs > 0
    }

    /// Times the next piece, at most one frame, of the frame that was drawn of `scene` by `recipe`. The times are there when
    /// all pieces are.
    pub fn step(&mut self, scene: &Scene, recipe: &Recipe, frame: &Frame) -> Option<StageTimes> {
        let level = self.runs % LEVELS.len();
        let start = Instant::now();
        black_box(redraw(scene, recipe, frame, LEVELS[level], &mut ()));
        self.least[level] = self.least[level].min(start.elapsed());
        self.runs += 1;
        (self.runs >= self.wanted_runs).then(|| self.differences(recipe, frame))
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
            clip: geometry.clip,
            project: geometry.project,
            cull: geometry.cull,
            rasterize: coverage,
            depth: tests_depth.then(|| depth.saturating_sub(coverage)),
            interpolate: interpolate.saturating_sub(depth),
            shade: shade.saturating_sub(interpolate),
            upscale: frame.times.upscale,
        }
    }
}

/// Times every stage of a frame that was drawn of `scene` by `recipe`; costs some ten more frames if it is a short one, else
/// about three.
pub fn stage_times(scene: &Scene, recipe: &Recipe, frame: &Frame) -> StageTimes {
    let mut timer = StageTimer::new(frame);
    loop {
        if let Some(times) = timer.step(scene, recipe, frame) {
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
        let scene = builtin::by_id("cubes").unwrap().build();
        let mut recipe = Recipe::default();
        recipe.pipeline.depth_test = depth_test;
        let frame = run(&scene, &scene.home, &recipe, Viewport { width: 160, height: 120 }, &mut ());
        stage_times(&scene, &recipe, &frame)
    }

    #[test]
    fn every_stage_takes_time_of_its_own() {
        // A single difference may drown in noise; twenty do not, unless the compiler left the stage out.
        let runs: Vec<_> = (0..20).map(|_| times(DepthTest::Less).named()).collect();
        let names: Vec<_> = runs[0].iter().map(|(name, _)| *name).collect();
        assert_eq!(names.len(), 9);
        for (place, name) in names.into_iter().enumerate().filter(|(_, name)| *name != "upscale") {
            assert!(runs.iter().any(|run| run[place].1 > Duration::ZERO), "{name} took none");
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
