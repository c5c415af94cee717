//! Logarithmic time axis between powers of two.

/// Smallest and largest power of two of an axis, in milliseconds: about 1 µs and 17 min.
const POWERS: (i32, i32) = (-10, 20);

/// Logarithmic time axis. Both ends are powers of two of a millisecond.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TimeAxis {
    low_power: i32,
    high_power: i32,
}

impl TimeAxis {
    /// Returns the smallest axis, of at least a factor of four, that contains all `times_ms`. Ignores times that are not
    /// positive and finite. The axis is unchanged as long as no time crosses a power of two.
    pub(super) fn covering(times_ms: impl Iterator<Item = f64>) -> Self {
        let powers = times_ms.filter(|ms| *ms > 0.0 && ms.is_finite()).map(f64::log2);
        let (low, high) = powers.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), power| {
            (low.min(power.floor()), high.max(power.ceil()))
        });
        if low > high {
            return Self { low_power: 0, high_power: 2 };
        }
        let low_power = (low as i32).clamp(POWERS.0, POWERS.1);
        Self { low_power, high_power: (high as i32).clamp(low_power + 2, POWERS.1 + 2) }
    }

    /// Returns the position of a time on the axis, from 0 at its start to 1 at its end; outside this range for times
    /// beyond the ends.
    pub(super) fn share(self, ms: f64) -> f32 {
        ((ms.max(f64::MIN_POSITIVE).log2() - f64::from(self.low_power)) / self.octaves()) as f32
    }

    /// Returns the time in milliseconds at a position on the axis, from 0 at its start to 1 at its end.
    pub(super) fn ms(self, share: f32) -> f64 {
        (f64::from(self.low_power) + f64::from(share) * self.octaves()).exp2()
    }

    /// Returns at most `count` ticks in milliseconds, at least two: all powers of two in range, or every second, third
    /// and so on.
    pub(super) fn ticks(self, count: usize) -> impl Iterator<Item = f64> {
        let octaves = (self.high_power - self.low_power) as usize;
        let step = octaves.div_ceil(count.max(2) - 1).max(1);
        (self.low_power..=self.high_power).step_by(step).map(|power| f64::from(power).exp2())
    }

    fn octaves(self) -> f64 {
        f64::from(self.high_power - self.low_power)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ticks(axis: TimeAxis, count: usize) -> Vec<f64> {
        axis.ticks(count).collect()
    }

    #[test]
    fn an_axis_ends_at_the_powers_of_two_around_all_times() {
        let axis = TimeAxis::covering([0.6, 5.1, 1.6].into_iter());
        assert_eq!(ticks(axis, 9), [0.5, 1.0, 2.0, 4.0, 8.0]);
        assert_eq!([axis.share(0.5), axis.share(2.0), axis.share(8.0)], [0.0, 0.5, 1.0]);
        assert!(axis.share(16.0) > 1.0 && axis.share(0.0) < 0.0);
    }

    #[test]
    fn positions_and_times_are_inverse() {
        let axis = TimeAxis::covering([0.03, 70.0].into_iter());
        for ms in [0.04, 1.0, 2.7, 65.0] {
            assert!((axis.ms(axis.share(ms)) / ms - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn an_axis_spans_at_least_a_factor_of_four() {
        assert_eq!(ticks(TimeAxis::covering([1.0].into_iter()), 9), [1.0, 2.0, 4.0]);
        let none = [f64::NAN, 0.0, -1.0, f64::INFINITY];
        assert_eq!(ticks(TimeAxis::covering(none.into_iter()), 9), [1.0, 2.0, 4.0]);
        let extreme = TimeAxis::covering([1e300].into_iter());
        assert!(extreme.ms(0.0).is_finite() && extreme.ms(1.0).is_finite());
    }

    #[test]
    fn ticks_are_thinned_evenly() {
        let axis = TimeAxis::covering([0.5, 30.0].into_iter());
        assert_eq!(ticks(axis, 7), [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0]);
        assert_eq!(ticks(axis, 6), [0.5, 2.0, 8.0, 32.0]);
        assert_eq!(ticks(axis, 3), [0.5, 4.0, 32.0]);
        assert_eq!(ticks(axis, 0), [0.5, 32.0]);
    }
}
