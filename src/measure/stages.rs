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
const SHORT_FRAME: Duration = Duration::from_millis(30);

/// Rounds for short frames.
const ROUNDS: usize = 3;

/// How far each level draws.
const LEVELS: [Until; 4] = [Until::Coverage, Until::Depth, Until::Interpolate, Until::Shade];

/// Times every stage of a frame that was drawn of `scene` by `recipe`; costs up to about nine more frames if it is a short
/// one, else about three.
pub fn stage_times(scene: &Scene, recipe: &Recipe, frame: &Frame) -> StageTimes {
    let rounds = if frame.times.total < SHORT_FRAME { ROUNDS } else { 1 };
    let [coverage, depth, interpolate, shade] = least_times(scene, recipe, frame, rounds);
    let geometry = frame.geometry.times;
    let tests_depth = recipe.pipeline.depth_test != DepthTest::Off;
    // Without a test both levels do the same, and the better time stands for both.
    let (coverage, depth) = if tests_depth { (coverage, depth) } else { (coverage.min(depth), coverage.min(depth)) };
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

/// The least time of each level over rounds that run all levels in turn, so that a disturbance hits one run and not one
/// level. The least is the one that was disturbed least.
fn least_times(scene: &Scene, recipe: &Recipe, frame: &Frame, rounds: usize) -> [Duration; LEVELS.len()] {
    let time = |until| {
        let start = Instant::now();
        black_box(redraw(scene, recipe, frame, until, &mut ()));
        start.elapsed()
    };
    let mut least = [Duration::MAX; LEVELS.len()];
    for _ in 0..rounds {
        for (least, until) in least.iter_mut().zip(LEVELS) {
            *least = time(until).min(*least);
        }
    }
    least
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
