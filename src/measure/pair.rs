//! What a change of the recipe does to the time of a frame: frames of both, in turn, and what the clock itself does.
//!
//! Every round draws the first recipe once and the second twice, forwards and then backwards, so that drift of the
//! machine's speed hits all alike. What two frames of the same recipe differ by is the noise that the change has to beat.

use std::sync::Arc;

use serde::Serialize;

use super::timing::{Summary, summarize};
use crate::chain::{KeepDepth, Recipe, Renderer};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};

/// Rounds that do not count: caches and clocks settle, and methods that read the past get one.
const WARM_UP_ROUNDS: usize = 2;

/// Times of two recipes, milliseconds per frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PairTimes {
    /// Of the first recipe.
    pub a_ms: Summary,
    /// Of the second.
    pub b_ms: Summary,
    /// The second less the first, of the same round.
    pub change_ms: Summary,
    /// The second again less the second, of the same round: what no change at all comes to.
    pub noise_ms: Summary,
}

impl PairTimes {
    /// Whether the change is larger than what about eight in ten rounds without any change came to.
    pub fn is_clear(&self) -> bool {
        self.change_ms.median.abs() > self.noise()
    }

    /// The larger of |p10| and |p90| of the rounds without a change, ms: about eight in ten of them lie within.
    pub fn noise(&self) -> f64 {
        self.noise_ms.p10.abs().max(self.noise_ms.p90.abs())
    }
}

/// Times two recipes round by round.
#[derive(Debug)]
pub struct PairTimer {
    recipes: [Recipe; 3],
    renderers: [Renderer; 3],
    ms: [Vec<f64>; 3],
    round: usize,
    rounds: usize,
}

impl PairTimer {
    /// Will time `a` and `b` in so many rounds that count, at least one.
    pub fn new(a: Recipe, b: Recipe, rounds: usize) -> Self {
        let (renderers, ms) = (Default::default(), Default::default());
        Self { recipes: [a, b, b], renderers, ms, round: 0, rounds: rounds.max(1) }
    }

    /// Draws one round. The times are there with the last one, and again with each that follows.
    pub fn step(&mut self, scene: &Arc<Scene>, camera: &Camera, viewport: Viewport) -> Option<PairTimes> {
        let mut order = [0, 1, 2];
        if !self.round.is_multiple_of(2) {
            order.reverse();
        }
        for entry in order {
            let renderer = &mut self.renderers[entry];
            let frame = renderer.render(scene, camera, &self.recipes[entry], viewport, KeepDepth::No);
            if self.round >= WARM_UP_ROUNDS {
                self.ms[entry].push(frame.times.total.as_secs_f64() * 1e3);
            }
            renderer.recycle(frame);
        }
        self.round += 1;
        if self.round < WARM_UP_ROUNDS + self.rounds { None } else { self.times() }
    }

    fn times(&self) -> Option<PairTimes> {
        let [a, b, again] = &self.ms;
        let less = |some: &[f64], others: &[f64]| {
            summarize(&some.iter().zip(others).map(|(one, other)| one - other).collect::<Vec<_>>())
        };
        Some(PairTimes { a_ms: summarize(a)?, b_ms: summarize(b)?, change_ms: less(b, a)?, noise_ms: less(again, b)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    #[test]
    fn times_are_there_after_the_last_round_and_are_of_all_that_count() {
        let scene = Arc::new(builtin::by_id("triangle").unwrap().build());
        let mut timer = PairTimer::new(Recipe::default(), Recipe { wireframe: true, ..Recipe::default() }, 3);
        let size = Viewport { width: 32, height: 24 };
        for _ in 0..4 {
            assert_eq!(timer.step(&scene, &scene.home, size), None);
        }
        let times = timer.step(&scene, &scene.home, size).unwrap();
        assert_eq!([times.a_ms, times.b_ms, times.change_ms, times.noise_ms].map(|summary| summary.n), [3; 4]);
        assert!(times.a_ms.median > 0.0 && times.noise() >= 0.0);
    }
}
