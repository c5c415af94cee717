//! A histogram with bins of equal width over a range.

use super::view::Range;

/// Histogram with bins of equal width over a range, plus the numbers of values outside the range.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Range that the bins divide evenly; both ends are included.
    pub range: Range,
    /// Number of values in each bin, from the low end.
    pub bins: Vec<u64>,
    /// Number of values below the range.
    pub(crate) below: u64,
    /// Number of values above the range.
    pub(crate) above: u64,
}

impl Histogram {
    /// Creates a histogram of the finite `values`, with `bins` bins of equal width, or one bin if `bins` is 0. If the
    /// range has no width, the values within it are counted in the first bin.
    pub(crate) fn of(values: impl IntoIterator<Item = f32>, range: Range, bins: usize) -> Self {
        let mut histogram = Self { range, bins: vec![0; bins.max(1)], below: 0, above: 0 };
        for value in values {
            histogram.add(value);
        }
        histogram
    }

    /// Counts one more value; ignores NaN and infinities.
    pub(crate) fn add(&mut self, value: f32) {
        if !value.is_finite() {
            return;
        }
        if value < self.range.low {
            self.below += 1;
        } else if value > self.range.high {
            self.above += 1;
        } else {
            let bin = self.bin_of(value);
            self.bins[bin] += 1;
        }
    }

    /// Returns the index of the bin that contains `value`, which must lie within the range.
    pub(crate) fn bin_of(&self, value: f32) -> usize {
        // In double precision the width cannot overflow.
        let (low, high) = (f64::from(self.range.low), f64::from(self.range.high));
        let width = high - low;
        let share = if width > 0.0 { (f64::from(value) - low) / width } else { 0.0 };
        ((share * self.bins.len() as f64) as usize).min(self.bins.len() - 1)
    }

    /// Returns the lower and upper bound of the values in a bin.
    pub fn span_of(&self, bin: usize) -> (f64, f64) {
        let (low, high) = (f64::from(self.range.low), f64::from(self.range.high));
        let at = |bin: usize| low + (high - low) * bin as f64 / self.bins.len() as f64;
        (at(bin), at(bin + 1))
    }

    /// Returns the count of the fullest bin.
    pub fn max_count(&self) -> u64 {
        self.bins.iter().copied().max().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_finite_number_is_counted_once_in_the_bin_that_contains_it() {
        let values: Vec<f32> = (0..500_u32).map(|i| (i * 331 % 503) as f32 / 100.0 - 1.0).collect();
        let range = Range { low: -0.5, high: 3.0 };
        let histogram = Histogram::of(values.iter().copied().chain([f32::NAN, f32::INFINITY]), range, 13);
        let count = |inside: &dyn Fn(f64) -> bool| values.iter().filter(|v| inside(f64::from(**v))).count() as u64;
        for (bin, number) in histogram.bins.iter().enumerate() {
            let (from, to) = histogram.span_of(bin);
            let last = bin == 12;
            assert_eq!(*number, count(&|v| v >= from && (v < to || last && v <= to)), "{bin}");
        }
        assert_eq!(histogram.below, count(&|v| v < -0.5));
        assert_eq!(histogram.above, count(&|v| v > 3.0));
        assert_eq!(histogram.bins.iter().sum::<u64>() + histogram.below + histogram.above, 500);
    }

    #[test]
    fn both_ends_belong_to_the_range_however_narrow_or_wide() {
        let flat = Histogram::of([2.0, 2.0], Range { low: 2.0, high: 2.0 }, 8);
        assert_eq!((flat.bins[0], flat.below, flat.above), (2, 0, 0));
        let wide = Histogram::of([f32::MIN, 0.0, f32::MAX], Range { low: f32::MIN, high: f32::MAX }, 4);
        assert_eq!(wide.bins, [1, 0, 1, 1]);
        assert_eq!(wide.max_count(), 1);
    }
}
