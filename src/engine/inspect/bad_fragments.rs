//! An observer that counts pipeline events, and fragments whose depth or weights are NaN or infinite.

use crate::chain::{Frame, Recipe, prepare_again, redraw};
use crate::pipeline::LastStage;
use crate::pipeline::interpolate::attribute_weights;
use crate::pipeline::observe::{Counters, DepthOutcome, Fate, Observer};
use crate::pipeline::raster::RasterSample;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::{DepthTest, Settings};
use crate::scene::{Scene, TriangleId};

/// Pipeline counters, and the number of fragments that passed the depth test with a NaN or infinite depth or weight.
#[derive(Clone, Copy, Debug)]
pub struct BadFragments {
    /// Counters of all pipeline events.
    pub counters: Counters,
    /// Number of fragments that passed the depth test with a NaN or infinite depth or weight.
    pub bad: u64,
    settings: Settings,
}

impl BadFragments {
    /// Creates zeroed counters for a frame drawn with `settings`.
    pub(crate) fn new(settings: Settings) -> Self {
        Self { counters: Counters::default(), bad: 0, settings }
    }

    /// Counts the triangles and fragments of a frame without shading them. Every fragment that passes the depth test
    /// counts as shaded; without a depth buffer, every covered sample does.
    pub fn of(scene: &Scene, recipe: &Recipe, frame: &Frame) -> Self {
        let mut counting = Self::new(recipe.pipeline);
        prepare_again(scene, recipe, frame, &mut counting);
        let again = redraw(scene, recipe, frame, LastStage::Depth, &mut counting);
        let counters = &mut counting.counters;
        counters.shaded = if again.depth.is_some() { counters.passed } else { counters.covered };
        counting
    }

    fn check(&mut self, triangle: &ScreenTriangle, sample: &RasterSample, depth: f32) {
        let weights = attribute_weights(triangle, sample, self.settings.interpolation);
        self.bad += u64::from(!depth.is_finite() || weights.iter().any(|weight| !weight.is_finite()));
    }
}

impl Observer for BadFragments {
    fn rejected(&mut self, id: TriangleId, fate: Fate) {
        self.counters.rejected(id, fate);
    }

    fn clipped(&mut self, id: TriangleId, pieces: usize) {
        self.counters.clipped(id, pieces);
    }

    fn visited(&mut self, samples: u64) {
        self.counters.visited(samples);
    }

    fn covered(&mut self, triangle: &ScreenTriangle, sample: &RasterSample) {
        self.counters.covered(triangle, sample);
        if self.settings.depth_test == DepthTest::Off {
            self.check(triangle, sample, 0.0);
        }
    }

    fn depth_tested(&mut self, triangle: &ScreenTriangle, sample: &RasterSample, outcome: DepthOutcome) {
        self.counters.depth_tested(triangle, sample, outcome);
        if outcome.passed {
            self.check(triangle, sample, outcome.new);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::{Recipe, redraw, run};
    use crate::inspect::capture;
    use crate::pipeline::LastStage;
    use crate::pipeline::settings::Interpolation;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    #[test]
    fn bad_weights_are_counted_only_for_interpolations_that_produce_them() {
        let scene = builtin::by_id("shared-edges").unwrap().build();
        for (interpolation, depth_test) in [
            (Interpolation::Perspective, DepthTest::Less),
            (Interpolation::Published, DepthTest::Less),
            (Interpolation::Published, DepthTest::Off),
        ] {
            let mut recipe = Recipe::default();
            (recipe.pipeline.interpolation, recipe.pipeline.depth_test) = (interpolation, depth_test);
            let frame = run(&scene, &scene.home, &recipe, Viewport { width: 32, height: 24 }, &mut ());
            let mut counting = BadFragments::new(recipe.pipeline);
            redraw(&scene, &recipe, &frame, LastStage::Depth, &mut counting);
            // The triangles do not overlap, so every fragment corresponds to one pixel of the buffer.
            let weights = capture(&scene, &recipe, &frame).perspective_lambda;
            let bad =
                weights.pixels().iter().filter(|weights| weights.iter().any(|weight| !weight.is_finite())).count();
            assert_eq!(counting.bad, bad as u64, "{interpolation:?} {depth_test:?}");
            assert_eq!(bad > 0, interpolation == Interpolation::Published, "{bad}");
            assert!(counting.counters.covered > 100);
        }
    }
}
