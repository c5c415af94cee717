//! Upscaling factor: a fraction with a small denominator, so that sample positions repeat periodically.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Upscaling factor per axis: a multiple of 1/10 from 1 to 4.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(from = "f64", into = "f64")]
pub struct Scale {
    tenths: u32,
}

impl Scale {
    /// Factor 1: no upscaling.
    pub const ONE: Self = Self { tenths: 10 };

    /// Factor 1.3: thirteen output pixels per ten samples along each axis. FSR 1 calls it “Ultra Quality”.
    pub(crate) const ONE_AND_THREE_TENTHS: Self = Self { tenths: 13 };

    /// Factor 1.5: three output pixels per two samples along each axis.
    pub(crate) const ONE_AND_A_HALF: Self = Self { tenths: 15 };

    /// Factor 1.7: seventeen output pixels per ten samples along each axis. FSR 1 calls it “Balanced”.
    pub(crate) const ONE_AND_SEVEN_TENTHS: Self = Self { tenths: 17 };

    /// Factor 2: two output pixels per sample along each axis.
    pub const TWO: Self = Self { tenths: 20 };

    /// Factor 3: three output pixels per sample along each axis.
    pub(crate) const THREE: Self = Self { tenths: 30 };

    /// Factor 4: four output pixels per sample along each axis.
    pub const FOUR: Self = Self { tenths: 40 };

    /// Returns the factor as a fraction in lowest terms: `(pixels, samples)` means that `pixels` output pixels span
    /// `samples` samples along each axis.
    pub(crate) fn ratio(self) -> (u32, u32) {
        let common = [10, 5, 2].into_iter().find(|divisor| self.tenths.is_multiple_of(*divisor)).unwrap_or(1);
        (self.tenths / common, 10 / common)
    }

    /// Returns the factor if it is an integer.
    pub(crate) fn whole(self) -> Option<u32> {
        self.tenths.is_multiple_of(10).then_some(self.tenths / 10)
    }

    /// Returns the factor as a floating-point number.
    pub fn value(self) -> f64 {
        f64::from(self.tenths) / 10.0
    }

    /// Returns the absolute difference of two factors, in tenths.
    pub(crate) fn distance(self, other: Self) -> u32 {
        self.tenths.abs_diff(other.tenths)
    }
}

impl From<u32> for Scale {
    /// Converts an integer factor, clamped to 1 to 4.
    fn from(whole: u32) -> Self {
        Self { tenths: whole.saturating_mul(10).clamp(Self::ONE.tenths, Self::FOUR.tenths) }
    }
}

impl From<f64> for Scale {
    /// Converts to the nearest multiple of 1/10, clamped to 1 to 4; NaN becomes 1.
    fn from(value: f64) -> Self {
        Self { tenths: ((value * 10.0).round() as u32).clamp(Self::ONE.tenths, Self::FOUR.tenths) }
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
        for tenths in 10..=40 {
            let scale = Scale { tenths };
            let (pixels, samples) = scale.ratio();
            assert_eq!(pixels * 10, tenths * samples, "{scale}");
            assert!((2..=10).all(|d| !pixels.is_multiple_of(d) || !samples.is_multiple_of(d)), "{scale}: lowest terms");
            assert_eq!(scale.whole(), (samples == 1).then_some(pixels), "{scale}");
            assert_eq!(Scale::from(scale.value()), scale);
            assert_eq!(scale.to_string().parse::<f64>().map(Scale::from), Ok(scale));
        }
        let between = [Scale::ONE_AND_THREE_TENTHS, Scale::ONE_AND_A_HALF, Scale::ONE_AND_SEVEN_TENTHS, Scale::TWO];
        assert_eq!(between.map(Scale::ratio), [(13, 10), (3, 2), (17, 10), (2, 1)]);
        assert_eq!(between.map(|scale| scale.to_string()), ["1.3", "1.5", "1.7", "2"]);
        assert_eq!([Scale::from(0), Scale::from(3), Scale::from(u32::MAX)], [Scale::ONE, Scale::THREE, Scale::FOUR]);
        assert_eq!([f64::NAN, -1.0, 1e300].map(Scale::from), [Scale::ONE, Scale::ONE, Scale::FOUR]);
    }
}
