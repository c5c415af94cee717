//! Effect of a recipe change on frame time. Frames of both recipes are timed in alternation; each recipe is drawn twice
//! per round, which also yields the noise floor.

use serde::Serialize;

use super::motion::FrameSequence;
use super::noise::Noise;
use super::rounds::RoundTimer;
use super::timing::{Summary, summarize};
use crate::chain::Recipe;

/// Frame times of two recipes, in milliseconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PairTimes {
    /// Frame times of recipe A.
    pub a_ms: Summary,
    /// Frame times of recipe B.
    pub b_ms: Summary,
    /// Frame time of B minus that of A in the same round.
    pub change_ms: Summary,
    /// Noise floor, from timing each recipe twice per round.
    pub noise: Noise,
    /// Whether the median change is within the noise floor.
    pub within_noise: bool,
}

impl PairTimes {
    /// Summarises the times of two recipes, one per round. Returns `None` without a round.
    pub(crate) fn of(a_ms: &[f64], b_ms: &[f64], noise: Noise) -> Option<Self> {
        let changes: Vec<_> = a_ms.iter().zip(b_ms).map(|(a, b)| b - a).collect();
        let (a_ms, b_ms, change_ms) = (summarize(a_ms)?, summarize(b_ms)?, summarize(&changes)?);
        let within_noise = noise.covers_change(change_ms.median, a_ms.median.min(b_ms.median));
        Some(Self { a_ms, b_ms, change_ms, noise, within_noise })
    }

    /// Returns the noise floor in milliseconds, for a frame time equal to the smaller of the two recipes' medians.
    pub fn noise_ms(&self) -> f64 {
        self.noise.ms(self.a_ms.median.min(self.b_ms.median))
    }
}

/// Incremental timer that draws two recipes in alternation.
#[derive(Debug)]
pub struct PairTimer {
    timer: RoundTimer,
}

impl PairTimer {
    /// Prepares to time `a` and `b` over `rounds` measured rounds, at least one.
    pub fn new(a: Recipe, b: Recipe, rounds: usize) -> Self {
        Self { timer: RoundTimer::new(&[a, b], rounds) }
    }

    /// Returns the completed fraction of the frames to draw, in [0, 1].
    pub fn progress(&self) -> f32 {
        let (done, of) = self.timer.progress();
        done as f32 / of.max(1) as f32
    }

    /// Draws at most one frame; returns the times once all rounds are complete.
    pub fn step(&mut self, shot: &FrameSequence<'_>) -> Option<PairTimes> {
        self.timer.step(shot);
        if !self.timer.is_complete() {
            return None;
        }
        PairTimes::of(&self.timer.ms(0), &self.timer.ms(1), self.timer.noise()?)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::measure::motion::Turn;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    #[test]
    fn times_are_available_after_the_last_round_without_warm_up() {
        let scene = Arc::new(builtin::by_id("triangle").unwrap().build());
        let mut timer = PairTimer::new(Recipe::default(), Recipe { wireframe: true, ..Recipe::default() }, 3);
        let viewport = Viewport { width: 32, height: 24 };
        let shot = FrameSequence { scene: &scene, camera: &scene.home, viewport, turn: Turn::STILL };
        // Four frames in each of five rounds; the first two rounds are warm-up.
        for _ in 0..4 * 5 - 1 {
            assert_eq!(timer.step(&shot), None);
        }
        let times = timer.step(&shot).unwrap();
        assert_eq!([times.a_ms, times.b_ms, times.change_ms].map(|summary| summary.n), [3; 3]);
        assert_eq!(times.noise.pairs, 2);
        assert!(times.a_ms.median > 0.0 && times.noise_ms() >= 0.0);
    }

    #[test]
    fn a_small_change_is_within_noise_and_a_large_one_is_not() {
        let noise = Noise { pairs: 10, p90: 0.02 };
        let of = |b: f64| PairTimes::of(&[4.0; 5], &[b; 5], noise).unwrap();
        assert!(of(4.02).within_noise && of(3.98).within_noise);
        assert!(!of(4.8).within_noise && !of(3.2).within_noise);
        assert_eq!(of(4.8).noise_ms(), 0.08);
    }
}
