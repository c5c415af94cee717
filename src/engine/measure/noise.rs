//! Noise floor of a timing run: the difference between two measurements of the same recipe.
//!
//! A run draws some recipes twice per round (A/A), interleaved with all others. The rounds are split into blocks of
//! consecutive rounds. For each recipe drawn twice, each block yields one pair: the median of the recipe's first times
//! in the block, and the median of its second times. The pairs therefore sample the whole run. The noise floor is the
//! 90th percentile of the relative differences of all pairs.
//!
//! A median over the whole run uses more frames than a median over a block, so the floor is an upper estimate.

use serde::{Deserialize, Serialize};

use super::timing::summarize;

/// Label for a difference that is not larger than the noise floor.
pub const WITHIN: &str = "within noise";

/// Label of a difference that is larger than the noise floor.
pub(crate) const ABOVE: &str = "larger than the noise";

/// Minimum number of rounds per block. With fewer, a single outlier would distort the median.
const ROUNDS_PER_BLOCK: usize = 3;

/// Maximum number of blocks of a run; longer runs have longer blocks and therefore a lower floor.
const MAX_BLOCKS: usize = 10;

/// Noise floor of a timing run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Noise {
    /// Number of A/A pairs, at least 1.
    pub pairs: usize,
    /// 90th percentile of the relative differences of the pairs: 0.02 means 2 % of the shorter time.
    pub p90: f64,
}

impl Noise {
    /// Converts the noise floor to milliseconds, for a frame time of `ms` milliseconds.
    pub fn ms(&self, ms: f64) -> f64 {
        self.p90 * ms
    }

    /// Whether the difference of two times is within the noise floor.
    pub fn covers(&self, a_ms: f64, b_ms: f64) -> bool {
        relative_difference(a_ms, b_ms) <= self.p90
    }

    /// Whether a change by `change_ms` milliseconds is within the noise floor of a frame time of `of_ms` milliseconds.
    pub(crate) fn covers_change(&self, change_ms: f64, of_ms: f64) -> bool {
        change_ms.abs() <= self.ms(of_ms)
    }

    /// Returns the noise floor and the number of pairs as text, for example “±1.8 % (90th percentile of 25 A/A pairs)”.
    pub fn words(&self) -> String {
        let pairs = if self.pairs == 1 { "1 A/A pair".to_owned() } else { format!("{} A/A pairs", self.pairs) };
        format!("±{:.1} % (90th percentile of {pairs})", self.p90 * 100.0)
    }
}

/// Returns the label of a difference: [`WITHIN`] or [`ABOVE`].
pub fn label(within_noise: bool) -> &'static str {
    if within_noise { WITHIN } else { ABOVE }
}

/// A/A pairs of a timing run.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Pairs {
    /// Relative difference of each pair.
    differences: Vec<f64>,
}

impl Pairs {
    /// Adds the pairs of a recipe that was timed twice per round. Both series hold one time per round, in order; rounds
    /// missing from either series are ignored.
    pub(crate) fn add(&mut self, first: &[f64], again: &[f64]) {
        let rounds = first.len().min(again.len());
        let blocks = (rounds / ROUNDS_PER_BLOCK).clamp(1, MAX_BLOCKS);
        for block in 0..blocks {
            let range = block * rounds / blocks..(block + 1) * rounds / blocks;
            let medians = [first, again].map(|times| summarize(&times[range.clone()]).map(|summary| summary.median));
            if let [Some(a), Some(b)] = medians {
                self.differences.push(relative_difference(a, b));
            }
        }
    }

    /// Adds the pairs of a recipe whose frames were timed one after another. Times at even indices form the first
    /// series, times at odd indices the second.
    pub(crate) fn add_alternating(&mut self, times: &[f64]) {
        let series = [0, 1].map(|first| times.iter().skip(first).step_by(2).copied().collect::<Vec<_>>());
        self.add(&series[0], &series[1]);
    }

    /// Adds the pairs of another run.
    pub(crate) fn append(&mut self, other: Self) {
        self.differences.extend(other.differences);
    }

    /// Returns the noise floor, or `None` if there are no pairs.
    pub(crate) fn noise(&self) -> Option<Noise> {
        let summary = summarize(&self.differences)?;
        Some(Noise { pairs: summary.n, p90: summary.p90 })
    }
}

/// Returns the difference of two times relative to the shorter one, so the order of the times does not matter; 0 for
/// equal times.
fn relative_difference(a: f64, b: f64) -> f64 {
    if a == b { 0.0 } else { (a - b).abs() / a.min(b).max(f64::MIN_POSITIVE) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns reproducible times around `ms` that vary by up to `share` in either direction.
    fn times(ms: f64, share: f64, count: usize, seed: u64) -> Vec<f64> {
        let mut random = fastrand::Rng::with_seed(seed);
        (0..count).map(|_| ms * (1.0 + share * (2.0 * random.f64() - 1.0))).collect()
    }

    /// Computes the median by sorting, independently of the code under test.
    fn middle(values: &[f64]) -> f64 {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2]) / 2.0
    }

    #[test]
    fn the_floor_is_the_90th_percentile_of_the_medians_of_blocks() {
        let (first, again) = (times(5.0, 0.04, 33, 1), times(5.0, 0.04, 33, 2));
        let mut pairs = Pairs::default();
        pairs.add(&first, &again);
        // 33 rounds make ten blocks of three or four rounds: block k begins at round ⌊3.3 k⌋.
        let ends = [0, 3, 6, 9, 13, 16, 19, 23, 26, 29, 33];
        let mut differences: Vec<f64> = ends
            .windows(2)
            .map(|ends| {
                let [a, b] = [&first, &again].map(|times| middle(&times[ends[0]..ends[1]]));
                (a - b).abs() / a.min(b)
            })
            .collect();
        differences.sort_by(f64::total_cmp);
        // The 90th percentile of ten sorted values lies a tenth of the way from the ninth to the tenth.
        let expected = differences[8] + 0.1 * (differences[9] - differences[8]);
        let noise = pairs.noise().unwrap();
        assert_eq!(noise.pairs, 10);
        assert!((noise.p90 - expected).abs() < 1e-15 && expected > 0.0, "{noise:?}, not {expected}");
    }

    #[test]
    fn a_large_difference_stays_and_a_small_one_is_within_noise() {
        let mut pairs = Pairs::default();
        for seed in 0..5 {
            pairs.add(&times(4.0, 0.03, 15, 2 * seed), &times(4.0, 0.03, 15, 2 * seed + 1));
        }
        let noise = pairs.noise().unwrap();
        assert_eq!(noise.pairs, 25);
        assert!((0.01..0.06).contains(&noise.p90), "{noise:?}");
        let median = |ms, seed| summarize(&times(ms, 0.03, 15, seed)).unwrap().median;
        let (base, larger, same) = (median(4.0, 100), median(4.0 * 1.2, 101), median(4.0 * 1.005, 102));
        assert!(!noise.covers(base, larger) && !noise.covers(larger, base));
        assert!(noise.covers(base, same) && noise.covers(same, base));
        assert!(noise.covers_change(-0.005 * 4.0, 4.0) && !noise.covers_change(-0.2 * 4.0, 4.0));
    }

    #[test]
    fn a_quiet_machine_has_no_noise_and_an_outlier_does_not_make_any() {
        let mut hitch = vec![2.0; 30];
        hitch[7] = 50.0;
        let mut pairs = Pairs::default();
        pairs.add(&hitch, &[2.0; 30]);
        let noise = pairs.noise().unwrap();
        assert_eq!(noise, Noise { pairs: 10, p90: 0.0 });
        assert!(noise.covers(2.0, 2.0) && !noise.covers(2.0, 2.001));
    }

    #[test]
    fn every_other_frame_of_one_series_is_the_second_series() {
        let (mut alternating, mut apart) = (Pairs::default(), Pairs::default());
        alternating.add_alternating(&[1.0, 10.0, 2.0, 20.0, 3.0, 30.0, 4.0]);
        apart.add(&[1.0, 2.0, 3.0], &[10.0, 20.0, 30.0]);
        assert_eq!(alternating.noise(), apart.noise());
        assert_eq!(apart.noise(), Some(Noise { pairs: 1, p90: 9.0 }));
        assert_eq!(apart.noise().unwrap().words(), "±900.0 % (90th percentile of 1 A/A pair)");
    }

    #[test]
    fn without_a_pair_there_is_no_noise() {
        let mut pairs = Pairs::default();
        assert_eq!(pairs.noise(), None);
        pairs.add_alternating(&[1.0]);
        assert_eq!(pairs.noise(), None);
    }
}
