//! Summary statistics of frame times.
//!
//! The median is the typical cost of a frame; p10 and p90 show its spread; the maximum is the hitch that a user
//! notices. Comparisons do not use the mean, because a single hitch shifts it.

use serde::{Deserialize, Serialize};

/// Order statistics of a series of times, all in milliseconds.
///
/// A percentile is interpolated linearly between the two nearest samples. Among n sorted samples, it lies at index p ·
/// (n − 1), counted from 0 (definition 7 of Hyndman and Fan 1996, the default in spreadsheets and NumPy).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Number of times in the series, at least 1.
    pub n: usize,
    /// Shortest time of the series.
    pub(crate) min: f64,
    /// 10th percentile of the times.
    pub p10: f64,
    /// 50th percentile of the times.
    pub median: f64,
    /// 90th percentile of the times.
    pub p90: f64,
    /// 99th percentile of the times.
    pub p99: f64,
    /// Longest time of the series.
    pub max: f64,
    /// Arithmetic mean of the series.
    pub(crate) mean: f64,
}

/// Summarises times in milliseconds, in any order. Returns `None` if there are none or if one of them is not finite.
pub fn summarize(samples_ms: &[f64]) -> Option<Summary> {
    if samples_ms.is_empty() || !samples_ms.iter().all(|sample| sample.is_finite()) {
        return None;
    }
    let mut sorted = samples_ms.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    Some(Summary {
        n: sorted.len(),
        min: sorted[0],
        p10: percentile(&sorted, 10),
        median: percentile(&sorted, 50),
        p90: percentile(&sorted, 90),
        p99: percentile(&sorted, 99),
        max: sorted[sorted.len() - 1],
        mean: sorted.iter().sum::<f64>() / sorted.len() as f64,
    })
}

/// Returns a percentile of samples. `sorted` must be ascending and not empty; `percent` lies in [0, 100].
fn percentile(sorted: &[f64], percent: usize) -> f64 {
    // Position in hundredths of a sample, so that the arithmetic on indices is exact.
    let place = percent * (sorted.len() - 1);
    let (below, share) = (place / 100, (place % 100) as f64 / 100.0);
    let above = sorted.len().min(below + 2) - 1;
    sorted[below] + (sorted[above] - sorted[below]) * share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_lie_between_samples() {
        let summary = summarize(&[5.0, 1.0, 3.0, 2.0]).unwrap();
        assert_eq!((summary.n, summary.min, summary.median, summary.max), (4, 1.0, 2.5, 5.0));
        assert!((summary.p10 - 1.3).abs() < 1e-12, "sample number 0.3: {}", summary.p10);
        assert!((summary.p90 - 4.4).abs() < 1e-12, "sample number 2.7: {}", summary.p90);
        assert!((summary.p99 - 4.94).abs() < 1e-12, "sample number 2.97: {}", summary.p99);
        assert_eq!(summary.mean, 2.75);
    }

    #[test]
    fn percentiles_fall_on_samples_where_there_is_one() {
        let samples: Vec<f64> = (0..=100).rev().map(f64::from).collect();
        let summary = summarize(&samples).unwrap();
        assert_eq!((summary.p10, summary.median, summary.p90, summary.p99), (10.0, 50.0, 90.0, 99.0));
    }

    #[test]
    fn one_sample_is_all_of_its_percentiles() {
        let summary = summarize(&[4.5]).unwrap();
        let all = [summary.min, summary.p10, summary.median, summary.p90, summary.p99, summary.max, summary.mean];
        assert_eq!(all, [4.5; 7]);
    }

    #[test]
    fn a_single_hitch_moves_the_mean_and_the_maximum_but_not_the_median() {
        let mut samples = vec![2.0; 100];
        samples.push(1002.0);
        let summary = summarize(&samples).unwrap();
        assert_eq!((summary.median, summary.p90, summary.p99), (2.0, 2.0, 2.0));
        assert_eq!(summary.max, 1002.0);
        assert!(summary.mean > 11.0);
    }

    #[test]
    fn empty_and_non_finite_series_have_no_summary() {
        assert_eq!(summarize(&[]), None);
        assert_eq!(summarize(&[1.0, f64::NAN]), None);
        assert_eq!(summarize(&[1.0, f64::INFINITY]), None);
    }
}
