//! From binary floating point to exact numbers.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One as _, Pow as _, Signed as _, ToPrimitive as _, Zero as _};

/// Bits of the fraction field of an f32.
const FRACTION_BITS: u32 = 23;

/// Exponent of the last place of the smallest f32, 2⁻¹⁴⁹.
const LEAST_EXPONENT: i32 = -149;

/// The value of a finite f32; `None` for NaN and the infinities.
pub fn exact(value: f32) -> Option<BigRational> {
    BigRational::from_float(value)
}

/// The value of a finite f64; `None` for NaN and the infinities.
pub(super) fn exact_f64(value: f64) -> Option<BigRational> {
    BigRational::from_float(value)
}

/// A number near a fraction, for people and for comparisons between errors.
pub fn approximate(value: &BigRational) -> f64 {
    value.to_f64().unwrap_or(f64::NAN)
}

/// How far an answer is from the exact one; infinite if it is no number.
pub fn error(answer: f64, right: &BigRational) -> f64 {
    exact_f64(answer).map_or(f64::INFINITY, |answer| approximate(&(answer - right).abs()))
}

/// How far an answer is from the exact one, in units of the last place of an f32 of that magnitude; infinite if it is no
/// number. 0.5 at most means correctly rounded.
pub fn ulps(answer: f64, right: &BigRational) -> f64 {
    exact_f64(answer).map_or(f64::INFINITY, |answer| approximate(&((answer - right).abs() / last_place(right))))
}

/// The last place of an f32 of the magnitude of `value`: 2^(e − 23) where 2^e ≤ |value| < 2^(e + 1), but never less than
/// the smallest f32.
fn last_place(value: &BigRational) -> BigRational {
    let bits = |n: &BigInt| n.magnitude().bits() as i32;
    if value.is_zero() {
        return power_of_two(LEAST_EXPONENT);
    }
    // The quotient of a number of n bits and one of d bits lies between 2^(n − d − 1) and 2^(n − d + 1).
    let guess = bits(value.numer()) - bits(value.denom());
    let exponent = if value.abs() < power_of_two(guess) { guess - 1 } else { guess };
    power_of_two((exponent - FRACTION_BITS as i32).max(LEAST_EXPONENT))
}

/// 2^`exponent`.
fn power_of_two(exponent: i32) -> BigRational {
    BigRational::from_integer(BigInt::from(2)).pow(exponent)
}

/// Mantissa and exponent of a finite f32: value = mantissa · 2^exponent, the mantissa odd or zero.
fn parts(value: f32) -> (i64, i32) {
    let bits = value.to_bits();
    let (field, fraction) = (bits >> FRACTION_BITS & 0xff, i64::from(bits & ((1 << FRACTION_BITS) - 1)));
    let (magnitude, exponent) = match field {
        0 => (fraction, LEAST_EXPONENT),
        _ => (fraction | 1 << FRACTION_BITS, field as i32 - 1 + LEAST_EXPONENT),
    };
    if magnitude == 0 {
        return (0, 0);
    }
    let zeros = magnitude.trailing_zeros();
    let mantissa = magnitude >> zeros;
    (if value.is_sign_negative() { -mantissa } else { mantissa }, exponent + zeros as i32)
}

/// How many binary places a finite f32 needs behind the point.
pub(super) fn places(value: f32) -> u32 {
    parts(value).1.min(0).unsigned_abs()
}

/// `value` · 2^`scale` of a finite f32, an integer if `scale` is at least its [`places`].
pub(super) fn scaled(value: f32, scale: u32) -> BigInt {
    let (mantissa, exponent) = parts(value);
    BigInt::from(mantissa) << (exponent + scale as i32)
}

/// A finite f32 rounded to the nearest multiple of 2^−`places`, ties to even, in units of that.
pub(super) fn rounded(value: f32, target_places: u32) -> BigInt {
    let surplus = places(value).saturating_sub(target_places);
    let precise = scaled(value, target_places + surplus);
    if surplus == 0 {
        return precise;
    }
    // Shifting right rounds down, also for negative numbers.
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
    fn nothing_that_is_no_number_has_a_value() {
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
