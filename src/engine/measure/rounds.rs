//! Frame times of several recipes, measured in rounds.
//!
//! A round draws one frame of a sequence with every recipe, in a newly shuffled order, so that changes in machine speed
//! affect all recipes alike. Some recipes are drawn twice per round, which yields the noise floor. The frames are those
//! of [`super::motion::ErrorMeasurement`], with the same history. Frames that only build up history are drawn before
//! the round and are not timed.

use crate::chain::{FrameTimes, Recipe, Renderer};

use super::motion::{FrameSequence, Playback};
use super::noise::{Noise, Pairs};

/// Number of warm-up rounds before the measured ones. During warm-up, caches and clock frequencies settle.
pub(crate) const WARM_UP_ROUNDS: usize = 2;

/// Maximum number of recipes drawn twice per round. They are spread evenly over all recipes, because cheap and
/// expensive recipes differ in noise.
const MAX_TWINS: usize = 5;

/// Seed of the shuffled order within rounds.
const SEED: u64 = 7;

/// Recipe to time, or its repetition for the noise floor.
#[derive(Debug)]
struct RoundEntry {
    recipe: usize,
    playback: Playback,
    times: Vec<FrameTimes>,
}

/// Times of one measured frame.
#[derive(Clone, Copy, Debug)]
pub struct Timed {
    /// Index of the timed recipe in the list of recipes.
    pub recipe: usize,
    /// Times of the frame and its stages.
    pub times: FrameTimes,
}

/// Timer for several recipes, drawn in interleaved rounds. Each step draws at most one frame.
#[derive(Debug)]
pub struct RoundTimer {
    /// All recipes in the given order, followed by the repetitions.
    entries: Vec<RoundEntry>,
    recipes: usize,
    renderer: Renderer,
    random: fastrand::Rng,
    order: Vec<usize>,
    /// Number of entries already drawn in the current round.
    place: usize,
    /// Number of the current round, warm-up included.
    round: usize,
    rounds: usize,
}

impl RoundTimer {
    /// Prepares to time recipes over `rounds` measured rounds, at least one.
    pub fn new(recipes: &[Recipe], rounds: usize) -> Self {
        let twins = twins(recipes.len());
        let entry = |recipe: usize| RoundEntry { recipe, playback: Playback::new(recipes[recipe]), times: Vec::new() };
        let entries: Vec<_> = (0..recipes.len()).chain(twins).map(entry).collect();
        Self {
            order: (0..entries.len()).collect(),
            entries,
            recipes: recipes.len(),
            renderer: Renderer::default(),
            random: fastrand::Rng::with_seed(SEED),
            place: 0,
            round: 0,
            rounds: rounds.max(1),
        }
    }

    /// Draws at most one frame. Returns its times if the frame is measured and is not a repetition.
    pub fn step(&mut self, shot: &FrameSequence<'_>) -> Option<Timed> {
        if self.is_complete() {
            return None;
        }
        let round = self.round as i64 - WARM_UP_ROUNDS as i64;
        let number = shot.turn.frame_of_round(round);
        if self.place == 0 {
            if self.entries.iter_mut().any(|entry| entry.playback.warm_up(shot, number)) {
                return None;
            }
            self.random.shuffle(&mut self.order);
        }
        let entry = &mut self.entries[self.order[self.place]];
        let times = entry.playback.draw(shot, number, &mut self.renderer, |frame| frame.times);
        let is_twin = self.order[self.place] >= self.recipes;
        let recipe = entry.recipe;
        if round >= 0 {
            entry.times.push(times);
        }
        self.place += 1;
        if self.place == self.order.len() {
            (self.place, self.round) = (0, self.round + 1);
        }
        (round >= 0 && !is_twin).then_some(Timed { recipe, times })
    }

    /// Whether all measured rounds are complete.
    pub(crate) fn is_complete(&self) -> bool {
        self.round >= WARM_UP_ROUNDS + self.rounds || self.entries.is_empty()
    }

    /// Returns the number of complete measured rounds.
    pub fn rounds(&self) -> usize {
        self.round.saturating_sub(WARM_UP_ROUNDS)
    }

    /// Returns the number of frames drawn so far and the total number. Both include warm-up rounds, but not frames that
    /// only build up history.
    pub fn progress(&self) -> (usize, usize) {
        let count = self.entries.len();
        (self.round * count + self.place, (WARM_UP_ROUNDS + self.rounds) * count)
    }

    /// Returns the times of a recipe, one entry per measured round.
    pub(crate) fn times(&self, recipe: usize) -> &[FrameTimes] {
        &self.entries[recipe].times
    }

    /// Returns the frame times of a recipe in milliseconds, one entry per measured round.
    pub(crate) fn ms(&self, recipe: usize) -> Vec<f64> {
        ms(self.times(recipe))
    }

    /// Returns the noise floor of the rounds so far, or `None` before the first measured round.
    pub fn noise(&self) -> Option<Noise> {
        self.pairs().noise()
    }

    /// Returns the A/A pairs of the rounds so far.
    pub(crate) fn pairs(&self) -> Pairs {
        let mut pairs = Pairs::default();
        for twin in &self.entries[self.recipes..] {
            pairs.add(&self.ms(twin.recipe), &ms(&twin.times));
        }
        pairs
    }
}

fn ms(times: &[FrameTimes]) -> Vec<f64> {
    times.iter().map(|times| times.total.as_secs_f64() * 1e3).collect()
}

/// Returns the indices of the recipes that are drawn twice, out of `count` recipes.
fn twins(count: usize) -> Vec<usize> {
    let chosen = count.min(MAX_TWINS);
    (0..chosen).map(|twin| twin * count.saturating_sub(1) / (chosen - 1).max(1)).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::measure::motion::Turn;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;
    use crate::upscale::Upscaling;

    #[test]
    fn every_recipe_is_timed_once_per_round_and_twins_are_not_reported() {
        let scene = Arc::new(builtin::by_id("triangle").unwrap().build());
        let turn = Turn { degrees: 0.5, frames: 2, ..Turn::STILL };
        let shot =
            FrameSequence { scene: &scene, camera: &scene.home, viewport: Viewport { width: 24, height: 16 }, turn };
        let recipes: Vec<_> =
            Upscaling::every().map(|upscaler| Recipe { upscaler, ..Recipe::default() }).take(7).collect();
        let mut timer = RoundTimer::new(&recipes, 3);
        assert_eq!(timer.noise(), None);
        let mut timed = Vec::new();
        while !timer.is_complete() {
            timed.extend(timer.step(&shot));
        }
        assert_eq!((timer.rounds(), timed.len()), (3, 3 * 7));
        for round in timed.chunks(7) {
            let mut of: Vec<_> = round.iter().map(|timed| timed.recipe).collect();
            of.sort_unstable();
            assert!(of.into_iter().eq(0..7));
        }
        for recipe in 0..7 {
            let reported = timed.iter().filter(|timed| timed.recipe == recipe);
            assert!(ms(timer.times(recipe)).into_iter().eq(reported.map(|t| t.times.total.as_secs_f64() * 1e3)));
        }
        let noise = timer.noise().unwrap();
        assert_eq!(noise.pairs, 5, "one block of three rounds for each of five twins");
        let (done, of) = timer.progress();
        assert_eq!((done, of), (5 * 12, 5 * 12));
    }

    #[test]
    fn twins_are_spread_over_all_recipes() {
        assert_eq!(twins(37), [0, 9, 18, 27, 36]);
        assert_eq!(twins(2), [0, 1]);
        assert_eq!(twins(1), [0]);
        assert!(twins(0).is_empty());
    }
}
