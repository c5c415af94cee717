//! Conversion from binary floating point to exact numbers.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One as _, Pow as _, Signed as _, ToPrimitive as _, Zero as _};

/// Number of bits in the fraction field of an f32.
const FRACTION_BITS: u32 = 23;

/// Exponent of the smallest positive f32, 2⁻¹⁴⁹.
const MIN_EXPONENT: i32 = -149;

/// Returns the exact value of a finite f32; `None` for NaN and infinities.
pub(crate) fn exact(value: f32) -> Option<BigRational> {
    BigRational::from_float(value)
}

/// Returns the exact value of a finite f64; `None` for NaN and infinities.
pub(super) fn exact_f64(value: f64) -> Option<BigRational> {
    BigRational::from_float(value)
}

/// Converts a fraction to an approximate f64, for display and for comparing errors.
pub(crate) fn approximate(value: &BigRational) -> f64 {
    value.to_f64().unwrap_or(f64::NAN)
}

/// Returns the absolute error of a computed value; infinite if the value is not finite.
pub(crate) fn error(answer: f64, right: &BigRational) -> f64 {
    exact_f64(answer).map_or(f64::INFINITY, |answer| approximate(&(answer - right).abs()))
}

/// Returns the error of a computed value in ulps: units in the last place of an f32 as large as the exact value. A
/// correctly rounded value has an error of at most 0.5. The error is infinite if the computed value is not finite.
pub(crate) fn ulps(answer: f64, right: &BigRational) -> f64 {
    exact_f64(answer).map_or(f64::INFINITY, |answer| approximate(&((answer - right).abs() / last_place(right))))
}

/// Returns the unit in the last place of an f32 as large as `value`, but at least the smallest positive f32. The unit
/// is 2^(e − 23) where 2^e ≤ |value| < 2^(e + 1).
fn last_place(value: &BigRational) -> BigRational {
    let bits = |n: &BigInt| n.magnitude().bits() as i32;
    if value.is_zero() {
        return power_of_two(MIN_EXPONENT);
    }
    // The quotient of an n-bit and a d-bit number lies between 2^(n − d − 1) and 2^(n − d + 1).
    let guess = bits(value.numer()) - bits(value.denom());
    let exponent = if value.abs() < power_of_two(guess) { guess - 1 } else { guess };
    power_of_two((exponent - FRACTION_BITS as i32).max(MIN_EXPONENT))
}

/// Returns 2^`exponent`.
fn power_of_two(exponent: i32) -> BigRational {
    BigRational::from_integer(BigInt::from(2)).pow(exponent)
}

/// Decomposes a finite f32 into mantissa and exponent: value = mantissa · 2^exponent, with an odd or zero mantissa.
fn parts(value: f32) -> (i64, i32) {
    let bits = value.to_bits();
    let (field, fraction) = (bits >> FRACTION_BITS & 0xff, i64::from(bits & ((1 << FRACTION_BITS) - 1)));
    let (magnitude, exponent) = match field {
        0 => (fraction, MIN_EXPONENT),
        _ => (fraction | 1 << FRACTION_BITS, field as i32 - 1 + MIN_EXPONENT),
    };
    if magnitude == 0 {
        return (0, 0);
    }
    let zeros = magnitude.trailing_zeros();
    let mantissa = magnitude >> zeros;
    (if value.is_sign_negative() { -mantissa } else { mantissa }, exponent + zeros as i32)
}

/// Returns the number of fractional bits needed to represent a finite f32 exactly.
pub(super) fn places(value: f32) -> u32 {
    parts(value).1.min(0).unsigned_abs()
}

/// Returns `value` · 2^`scale` as an integer. `value` must be finite and need at most `scale` fractional bits (see
/// [`places`]).
pub(super) fn scaled(value: f32, scale: u32) -> BigInt {
    let (mantissa, exponent) = parts(value);
    BigInt::from(mantissa) << (exponent + scale as i32)
}

/// Rounds a finite f32 to the nearest multiple of 2^−`target_places`, ties to even, and returns the result as
/// an integer in that unit.
pub(super) fn rounded(value: f32, target_places: u32) -> BigInt {
    let surplus = places(value).saturating_sub(target_places);
    let precise = scaled(value, target_places + surplus);
    if surplus == 0 {
        return precise;
    }
    // The right shift rounds down, for negative numbers as well.
    let below = &precise >> surplus;
    let twice_rest = (precise - (&below << surplus)) * 2;
    let whole = BigInt::one() << surplus;
    if twice_rest > whole || (twice_rest == whole && below.bit(0)) { below + 1 } else { below }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rational(numerator: i64, denominator: i64) -> BigRational {
        BigRational::new(numerator.into(), denominator.into())
    }

    #[test]
    fn every_finite_float_is_taken_apart_and_put_together_again() {
        let mut random = fastrand::Rng::with_seed(3);
        let special = [0.0, -0.0, 1.0, -0.1, f32::MAX, f32::MIN_POSITIVE, 1e-45, -3e-45, 16_777_217.0];
        let bits = std::iter::repeat_with(|| f32::from_bits(random.u32(..)));
        for value in special.into_iter().chain(bits.filter(|v| v.is_finite()).take(2000)) {
            let scale = places(value);
            let back = BigRational::new(scaled(value, scale), BigInt::one() << scale);
            assert_eq!(Some(back), exact(value), "{value:e}");
        }
    }

    #[test]
    fn nan_and_infinity_have_no_exact_value() {
        assert_eq!(exact(f32::NAN), None);
        assert_eq!(exact(f32::NEG_INFINITY), None);
        assert_eq!(error(f64::NAN, &rational(1, 2)), f64::INFINITY);
    }

    #[test]
    fn rounding_goes_to_the_nearest_and_ties_to_even() {
        for (quarter_steps, expected) in
            [(0, 0), (1, 0), (2, 0), (3, 1), (5, 1), (6, 2), (7, 2), (-2, 0), (-3, -1), (-6, -2)]
        {
            let value = quarter_steps as f32 / 1024.0;
            assert_eq!(rounded(value, 8), BigInt::from(expected), "{quarter_steps}/4 of a step");
        }
        assert_eq!(rounded(1e-45, 8), BigInt::zero());
        assert_eq!(rounded(f32::MAX, 8), scaled(f32::MAX, 8));
    }

    #[test]
    fn an_ulp_is_the_distance_of_neighbouring_floats() {
        for value in [1.0_f32, 1.5, 0.1, 3e38, 1e-40, 1e-45] {
            let next = f64::from(f32::from_bits(value.to_bits() + 1));
            assert_eq!(ulps(next, &exact(value).unwrap()), 1.0, "{value:e}");
        }
        assert_eq!(last_place(&rational(1, 3)), power_of_two(-2 - 23));
        assert_eq!(ulps(1e-45_f32.into(), &BigRational::zero()), 1.0);
    }
}
