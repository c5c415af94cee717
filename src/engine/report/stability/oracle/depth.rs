//! Exact depths, and their rounding to the storage format of a depth buffer.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One as _, Zero as _};
use serde::{Deserialize, Serialize};

use super::number::{approximate, exact, exact_f64, ulps};

/// Mapping from a view-space distance to a depth in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum DepthMapping {
    /// 0 at the near plane, 1 at the far plane, hyperbolic.
    Standard,
    /// 1 at the near plane, 0 at the far plane, hyperbolic.
    Reversed,
    /// 1 − near / distance: 0 at the near plane, 1 at infinity.
    StandardInf,
    /// near / distance: 1 at the near plane, 0 at infinity.
    ReversedInf,
    /// 0 at the near plane, 1 at the far plane, linear in the distance.
    Linear,
    /// 1 at the near plane, 0 at the far plane, linear in the distance.
    ReversedLinear,
}

impl DepthMapping {
    /// Returns whether smaller distances map to larger depths.
    pub(crate) fn is_reversed(self) -> bool {
        matches!(self, Self::Reversed | Self::ReversedInf | Self::ReversedLinear)
    }

    /// Returns whether the mapping has a far plane.
    pub(crate) fn has_far_plane(self) -> bool {
        !matches!(self, Self::StandardInf | Self::ReversedInf)
    }
}

/// Storage format of a depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum DepthStorage {
    /// Depth as a 32-bit float.
    F32,
    /// Depth as a 24-bit unsigned normalised integer: a multiple of 1/(2²⁴ − 1).
    Unorm24,
    /// Depth as a 16-bit unsigned normalised integer: a multiple of 1/(2¹⁶ − 1).
    Unorm16,
}

impl DepthStorage {
    /// Returns the largest integer code of the format; `None` for floats.
    fn largest_code(self) -> Option<u32> {
        match self {
            Self::F32 => None,
            Self::Unorm24 => Some((1 << 24) - 1),
            Self::Unorm16 => Some((1 << 16) - 1),
        }
    }

    /// Returns the error of a stored depth in units in the last place of the format; infinite if the depth is not
    /// finite.
    pub(crate) fn error(self, stored: f64, right: &BigRational) -> f64 {
        let Some(largest) = self.largest_code() else { return ulps(stored, right) };
        let to_codes = |value: BigRational| value * BigInt::from(largest);
        let difference = exact_f64(stored).map(|stored| approximate(&to_codes(stored - right)).abs());
        difference.unwrap_or(f64::INFINITY)
    }
}

/// Returns the exact depth of a point at `distance`, or `None` if the distance is zero or a number is not finite.
/// Mappings without a far plane ignore `far`; the others need one that differs from the near plane.
pub(crate) fn exact_depth(mapping: DepthMapping, near: f32, far: Option<f32>, distance: f32) -> Option<BigRational> {
    let (near, z) = (exact(near)?, exact(distance)?);
    if z.is_zero() {
        return None;
    }
    let room = || Some(exact(far?)? - &near).filter(|room| !room.is_zero());
    Some(match mapping {
        DepthMapping::StandardInf => (&z - near) / z,
        DepthMapping::ReversedInf => near / z,
        DepthMapping::Linear => (&z - &near) / room()?,
        DepthMapping::ReversedLinear => (exact(far?)? - &z) / room()?,
        DepthMapping::Standard => exact(far?)? * (&z - &near) / (&z * room()?),
        DepthMapping::Reversed => &near * (exact(far?)? - &z) / (&z * room()?),
    })
}

/// Rounds an exact depth once to its storage format: to an integer code or to a float. Larger depths never give smaller
/// results. If two distances give the same result, the format cannot distinguish them, however precisely the depth is
/// computed.
pub(crate) fn ideal_code(storage: DepthStorage, value: &BigRational) -> BigRational {
    match storage.largest_code() {
        Some(largest) => {
            let half = BigRational::new(BigInt::one(), 2.into());
            (value * BigInt::from(largest) + half).floor()
        }
        None => nearest_f32(value),
    }
}

/// Returns the float nearest to a number in [0, 1], ties to even.
fn nearest_f32(value: &BigRational) -> BigRational {
    // Rounding twice, to f64 and then to f32, may be off by one step, so the neighbouring floats are compared as well.
    let guess = (approximate(value) as f32).to_bits();
    let candidates = [guess.saturating_sub(1), guess, guess + 1];
    let distance =
        |bits: u32| exact(f32::from_bits(bits)).map(|float| if &float > value { float - value } else { value - float });
    let nearest = candidates.into_iter().min_by_key(|bits| (distance(*bits), bits & 1));
    nearest.and_then(|bits| exact(f32::from_bits(bits))).unwrap_or_else(BigRational::zero)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rational(numerator: i64, denominator: i64) -> BigRational {
        BigRational::new(numerator.into(), denominator.into())
    }

    #[test]
    fn the_planes_are_where_the_mappings_say() {
        use DepthMapping::{Linear, Reversed, ReversedInf, ReversedLinear, Standard, StandardInf};
        let at = |mapping, distance| exact_depth(mapping, 0.5, Some(8.0), distance).unwrap();
        for (mapping, near, far, middle) in [
            (Standard, 0, 1, rational(14, 15)),
            (Reversed, 1, 0, rational(1, 15)),
            (Linear, 0, 1, rational(7, 15)),
            (ReversedLinear, 1, 0, rational(8, 15)),
        ] {
            assert_eq!(at(mapping, 0.5), rational(near, 1));
            assert_eq!(at(mapping, 8.0), rational(far, 1));
            assert_eq!(at(mapping, 4.0), middle, "{mapping:?}");
        }
        assert_eq!(exact_depth(ReversedInf, 0.5, None, 4.0), Some(rational(1, 8)));
        assert_eq!(exact_depth(StandardInf, 0.5, None, 4.0), Some(rational(7, 8)));
        assert_eq!(exact_depth(Standard, 0.5, None, 4.0), None);
        assert_eq!(exact_depth(Standard, 0.5, Some(0.5), 4.0), None);
    }

    #[test]
    fn codes_are_the_nearest_ones() {
        assert_eq!(ideal_code(DepthStorage::Unorm16, &rational(1, 2)), rational(32_768, 1), "32767.5 goes up");
        assert_eq!(ideal_code(DepthStorage::Unorm24, &rational(1, 3)), rational(5_592_405, 1));
        let mut random = fastrand::Rng::with_seed(5);
        for _ in 0..2000 {
            let value = random.f64() * 10.0_f64.powi(-random.i32(0..45));
            let expected = exact(value as f32).unwrap();
            assert_eq!(ideal_code(DepthStorage::F32, &exact_f64(value).unwrap()), expected, "{value:e}");
        }
    }

    #[test]
    fn errors_are_in_units_of_the_last_place_of_what_is_stored() {
        let right = rational(100, 65_535);
        let stored = 100.25 / 65_535.0;
        assert!((DepthStorage::Unorm16.error(stored, &right) - 0.25).abs() < 1e-9);
        assert!((DepthStorage::F32.error(0.5 + f64::from(f32::EPSILON), &rational(1, 2)) - 2.0).abs() < 1e-12);
        assert_eq!(DepthStorage::Unorm24.error(f64::NAN, &right), f64::INFINITY);
    }
}
