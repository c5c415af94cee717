//! Upscaling factor: a fraction with a small denominator, so that sample positions repeat periodically.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Upscaling factor per axis: a multiple of ½ from 1 to 4.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(from = "f64", into = "f64")]
pub struct Scale {
    halves: u32,
}

impl Scale {
    /// Factor 1: no upscaling.
    pub const ONE: Self = Self { halves: 2 };

    /// Factor 1.5: three output pixels per two samples along each axis.
    pub(crate) const ONE_AND_A_HALF: Self = Self { halves: 3 };

    /// Factor 2: two output pixels per sample along each axis.
    pub const TWO: Self = Self { halves: 4 };

    /// Factor 3: three output pixels per sample along each axis.
    pub(crate) const THREE: Self = Self { halves: 6 };

    /// Factor 4: four output pixels per sample along each axis.
    pub const FOUR: Self = Self { halves: 8 };

    /// Returns the factor as a fraction in lowest terms: `(pixels, samples)` means that `pixels` output pixels span
    /// `samples` samples along each axis.
    pub(crate) fn ratio(self) -> (u32, u32) {
        if self.halves.is_multiple_of(2) { (self.halves / 2, 1) } else { (self.halves, 2) }
    }

    /// Returns the factor if it is an integer.
    pub(crate) fn whole(self) -> Option<u32> {
        self.halves.is_multiple_of(2).then_some(self.halves / 2)
    }

    /// Returns the factor as a floating-point number.
    pub fn value(self) -> f64 {
        f64::from(self.halves) / 2.0
    }

    /// Returns the absolute difference of two factors, in halves.
    pub(crate) fn distance(self, other: Self) -> u32 {
        self.halves.abs_diff(other.halves)
    }
}

impl From<u32> for Scale {
    /// Converts an integer factor, clamped to 1 to 4.
    fn from(whole: u32) -> Self {
        Self { halves: whole.saturating_mul(2).clamp(Self::ONE.halves, Self::FOUR.halves) }
    }
}

impl From<f64> for Scale {
    /// Converts to the nearest multiple of ½, clamped to 1 to 4; NaN becomes 1.
    fn from(value: f64) -> Self {
        Self { halves: ((value * 2.0).round() as u32).clamp(Self::ONE.halves, Self::FOUR.halves) }
    }
}

impl From<Scale> for f64 {
    fn from(scale: Scale) -> Self {
        scale.value()
    }
}

impl fmt::Display for Scale {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.value().fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_fractions_numbers_and_words() {
        let all = [Scale::ONE, Scale::ONE_AND_A_HALF, Scale::TWO, Scale::THREE, Scale::FOUR];
        assert_eq!(all.map(Scale::ratio), [(1, 1), (3, 2), (2, 1), (3, 1), (4, 1)]);
        assert_eq!(all.map(|scale| scale.to_string()), ["1", "1.5", "2", "3", "4"]);
        assert_eq!(all.map(|scale| Scale::from(scale.value())), all);
        assert_eq!([Scale::from(0), Scale::from(3), Scale::from(u32::MAX)], [Scale::ONE, Scale::THREE, Scale::FOUR]);
        assert_eq!([f64::NAN, -1.0, 1e300].map(Scale::from), [Scale::ONE, Scale::ONE, Scale::FOUR]);
    }
}
