//! Statistics of a set of numbers: counts by kind, minimum, maximum, mean and standard deviation.

use serde::Serialize;

/// Statistics of the numbers [added](Statistics::add) so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Statistics {
    /// Number of finite values; all other statistics include only these.
    pub finite: u64,
    /// Number of NaN values.
    pub nan: u64,
    /// Number of infinite values, of either sign.
    pub infinite: u64,
    /// Minimum of the finite values; 0 if there are none.
    pub min: f32,
    /// Maximum of the finite values; 0 if there are none.
    pub max: f32,
    /// Mean of the finite values; 0 if there are none.
    pub mean: f64,
    /// Sum of the squared differences of the finite values from their mean.
    squares: f64,
}

impl Statistics {
    /// Returns the statistics of all `values`.
    #[cfg(test)]
    pub(crate) fn of(values: impl IntoIterator<Item = f32>) -> Self {
        let mut statistics = Self::default();
        values.into_iter().for_each(|value| statistics.add(value));
        statistics
    }

    /// Adds one value. Mean and deviation are updated without cancellation (Welford, "Note on a Method for Calculating
    /// Corrected Sums of Squares and Products", 1962).
    pub fn add(&mut self, value: f32) {
        if value.is_nan() {
            self.nan += 1;
            return;
        }
        if value.is_infinite() {
            self.infinite += 1;
            return;
        }
        (self.min, self.max) =
            if self.finite == 0 { (value, value) } else { (self.min.min(value), self.max.max(value)) };
        self.finite += 1;
        let value = f64::from(value);
        let from_mean = value - self.mean;
        self.mean += from_mean / self.finite as f64;
        self.squares += from_mean * (value - self.mean);
    }

    /// Returns the population standard deviation σ of the finite values; 0 if there are none.
    pub fn deviation(&self) -> f64 {
        if self.finite == 0 { 0.0 } else { (self.squares / self.finite as f64).sqrt() }
    }

    /// Returns the number of all values, finite or not.
    #[cfg(test)]
    pub(crate) fn count(&self) -> u64 {
        self.finite + self.nan + self.infinite
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_match_a_two_pass_computation() {
        // The values are far from zero, where a plain sum of squares would suffer from cancellation.
        let values: Vec<f32> = (0..1000_u32).map(|i| 50_000.0 + (i * 7919 % 1009) as f32 / 64.0).collect();
        let statistics = Statistics::of(values.iter().copied());
        let mean = values.iter().map(|v| f64::from(*v)).sum::<f64>() / 1000.0;
        let variance = values.iter().map(|v| (f64::from(*v) - mean).powi(2)).sum::<f64>() / 1000.0;
        assert!((statistics.mean - mean).abs() < 1e-9 * mean);
        assert!((statistics.deviation() - variance.sqrt()).abs() < 1e-9 * variance.sqrt());
        assert_eq!(statistics.min, values.iter().copied().fold(f32::INFINITY, f32::min));
        assert_eq!(statistics.max, values.iter().copied().fold(f32::NEG_INFINITY, f32::max));
    }

    #[test]
    fn non_finite_values_are_counted_and_do_not_affect_the_rest() {
        let statistics = Statistics::of([f32::NAN, -2.0, f32::INFINITY, f32::NEG_INFINITY, 4.0]);
        assert_eq!((statistics.finite, statistics.nan, statistics.infinite), (2, 1, 2));
        assert_eq!((statistics.min, statistics.max, statistics.mean), (-2.0, 4.0, 1.0));
        assert_eq!((statistics.deviation(), statistics.count()), (3.0, 5));
        assert_eq!(Statistics::of([f32::NAN]).deviation(), 0.0);
    }
}
