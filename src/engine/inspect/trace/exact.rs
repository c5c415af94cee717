//! Exact numbers: fractions of integers times a power of two. Fractions are never reduced, so sums and products of
//! floats are cheap. Exact numbers verify the pipeline's arithmetic and do not depend on it.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use num_bigint::BigInt;
use num_traits::{One as _, Signed as _, ToPrimitive as _, Zero as _};

/// Precision of computed roots in bits, far more than that of an f64. Roots are the only inexact results.
const ROOT_BITS: i64 = 160;

/// A number without rounding error: numerator / denominator · 2^exponent.
#[derive(Clone, Debug)]
pub(crate) struct ExactNumber {
    numerator: BigInt,
    /// Positive denominator.
    denominator: BigInt,
    exponent: i64,
}

impl ExactNumber {
    /// Converts an f64 exactly; `None` for NaN and the infinities.
    pub(crate) fn from_f64(value: f64) -> Option<Self> {
        /// Width of the fraction field of an f64, in bits.
        const FRACTION_BITS: u32 = 52;
        /// Binary exponent of the least significant bit of subnormal f64 numbers.
        const MIN_EXPONENT: i64 = -1074;
        if !value.is_finite() {
            return None;
        }
        let bits = value.to_bits();
        let field = (bits >> FRACTION_BITS & 0x7ff) as i64;
        let fraction = bits & ((1 << FRACTION_BITS) - 1);
        let (magnitude, exponent) = match field {
            0 => (fraction, MIN_EXPONENT),
            _ => (fraction | 1 << FRACTION_BITS, field - 1 + MIN_EXPONENT),
        };
        // Removing trailing zeros keeps the number and all results computed from it short.
        let zeros = if magnitude == 0 { 0 } else { magnitude.trailing_zeros() };
        let numerator = BigInt::from((magnitude >> zeros) as i64 * if value.is_sign_negative() { -1 } else { 1 });
        let exponent = if magnitude == 0 { 0 } else { exponent + i64::from(zeros) };
        Some(Self { numerator, denominator: BigInt::one(), exponent })
    }

    /// Converts an integer exactly.
    pub(crate) fn whole(value: i64) -> Self {
        Self { numerator: value.into(), denominator: BigInt::one(), exponent: 0 }
    }

    /// Returns the fraction `numerator` / `denominator`; `None` if the denominator is 0.
    pub(crate) fn ratio(numerator: i64, denominator: i64) -> Option<Self> {
        Self::whole(numerator).divided_by(&Self::whole(denominator))
    }

    /// Whether the number is 0.
    pub(crate) fn is_zero(&self) -> bool {
        self.numerator.is_zero()
    }

    /// Returns the absolute value.
    #[cfg(test)]
    pub(crate) fn abs(&self) -> Self {
        Self { numerator: self.numerator.abs(), ..self.clone() }
    }

    /// Returns the number divided by `other`; `None` for division by 0.
    pub(crate) fn divided_by(&self, other: &Self) -> Option<Self> {
        if other.is_zero() {
            return None;
        }
        let (numerator, denominator) = (&self.numerator * &other.denominator, &self.denominator * &other.numerator);
        let flip = if denominator.is_negative() { -1 } else { 1 };
        let exponent = self.exponent - other.exponent;
        Some(Self { numerator: numerator * flip, denominator: denominator * flip, exponent })
    }

    /// Returns the number times 2^`places`.
    pub(crate) fn shifted(&self, places: i64) -> Self {
        Self { exponent: self.exponent + places, ..self.clone() }
    }

    /// Returns the number as numerator and denominator, with the power of two multiplied in.
    pub(super) fn parts(&self) -> (BigInt, BigInt) {
        let shift = self.exponent.unsigned_abs();
        if self.exponent >= 0 {
            (&self.numerator << shift, self.denominator.clone())
        } else {
            (self.numerator.clone(), &self.denominator << shift)
        }
    }

    /// Returns the largest integer less than or equal to the number.
    pub(crate) fn floor(&self) -> Self {
        let (numerator, denominator) = self.parts();
        Self { numerator: div_floor(&numerator, &denominator), denominator: BigInt::one(), exponent: 0 }
    }

    /// Returns the nearest integer, with ties to even.
    pub(crate) fn round_ties_even(&self) -> Self {
        let below = self.floor();
        let twice_rest = (self - &below).shifted(1);
        match twice_rest.cmp(&Self::whole(1)) {
            Ordering::Less => below,
            Ordering::Equal if !below.numerator.bit(0) => below,
            Ordering::Equal | Ordering::Greater => &below + &Self::whole(1),
        }
    }

    /// Returns the `degree`-th root, truncated to about [`ROOT_BITS`] bits; `None` for a negative number.
    pub(crate) fn root(&self, degree: u32) -> Option<Self> {
        if self.numerator.is_negative() {
            return None;
        }
        let Some(magnitude) = self.floor_log2() else { return Some(self.clone()) };
        // Shifts by enough places for the precision of the root. The shift is a multiple of the degree, so the root can
        // be shifted back.
        let places = (ROOT_BITS - magnitude.div_euclid(i64::from(degree))).max(0);
        let (numerator, denominator) = self.shifted(places * i64::from(degree)).parts();
        Some(Self {
            numerator: (numerator / denominator).nth_root(degree),
            denominator: BigInt::one(),
            exponent: -places,
        })
    }

    /// Returns the number raised to an integer power.
    pub(crate) fn power(&self, exponent: u32) -> Self {
        (0..exponent).fold(Self::whole(1), |product, _| &product * self)
    }

    /// Returns the exponent e of the number x for which 2^e ≤ |x| < 2^(e + 1); `None` for 0.
    pub(crate) fn floor_log2(&self) -> Option<i64> {
        if self.is_zero() {
            return None;
        }
        let bits = |n: &BigInt| n.bits() as i64;
        // A quotient of n and d bits lies between 2^(n − d − 1) and 2^(n − d + 1).
        let guess = bits(&self.numerator) - bits(&self.denominator);
        let (numerator, denominator) = (self.numerator.abs(), &self.denominator);
        let is_less = match u64::try_from(guess) {
            Ok(shift) => numerator < denominator << shift,
            Err(_) => numerator << guess.unsigned_abs() < *denominator,
        };
        Some(guess - i64::from(is_less) + self.exponent)
    }

    /// Returns an f64 that approximates the number.
    pub(crate) fn approximate(&self) -> f64 {
        /// Number of bits kept before the conversion, more than an f64 has, so truncation is negligible.
        const BITS: i64 = 66;
        let Some(magnitude) = self.floor_log2() else { return 0.0 };
        let shift = BITS - magnitude;
        let (numerator, denominator) = self.shifted(shift).parts();
        let whole = (numerator / denominator).to_f64().unwrap_or(f64::NAN);
        // Scales in two steps, because a single power of two could be out of range.
        let half = (-shift / 2) as i32;
        whole * 2.0_f64.powi(half) * 2.0_f64.powi((-shift) as i32 - half)
    }
}

/// Divides two integers, and rounds the quotient toward negative infinity.
fn div_floor(numerator: &BigInt, denominator: &BigInt) -> BigInt {
    let quotient = numerator / denominator;
    if numerator.is_negative() && &quotient * denominator != *numerator { quotient - 1 } else { quotient }
}

impl Add for &ExactNumber {
    type Output = ExactNumber;

    fn add(self, other: &ExactNumber) -> ExactNumber {
        let exponent = self.exponent.min(other.exponent);
        let at = |number: &ExactNumber| &number.numerator << (number.exponent - exponent).unsigned_abs();
        let (a, b) = (at(self), at(other));
        if self.denominator == other.denominator {
            return ExactNumber { numerator: a + b, denominator: self.denominator.clone(), exponent };
        }
        let numerator = a * &other.denominator + b * &self.denominator;
        ExactNumber { numerator, denominator: &self.denominator * &other.denominator, exponent }
    }
}

impl Sub for &ExactNumber {
    type Output = ExactNumber;

    fn sub(self, other: &ExactNumber) -> ExactNumber {
        self + &-other
    }
}

impl Mul for &ExactNumber {
    type Output = ExactNumber;

    fn mul(self, other: &ExactNumber) -> ExactNumber {
        ExactNumber {
            numerator: &self.numerator * &other.numerator,
            denominator: &self.denominator * &other.denominator,
            exponent: self.exponent + other.exponent,
        }
    }
}

impl Div for &ExactNumber {
    type Output = Option<ExactNumber>;

    fn div(self, other: &ExactNumber) -> Option<ExactNumber> {
        self.divided_by(other)
    }
}

impl Neg for &ExactNumber {
    type Output = ExactNumber;

    fn neg(self) -> ExactNumber {
        ExactNumber { numerator: -&self.numerator, denominator: self.denominator.clone(), exponent: self.exponent }
    }
}

impl PartialEq for ExactNumber {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for ExactNumber {}

impl PartialOrd for ExactNumber {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for ExactNumber {
    fn cmp(&self, other: &Self) -> Ordering {
        (self - other).numerator.cmp(&BigInt::zero())
    }
}

#[cfg(test)]
mod tests {
    use num_rational::BigRational;

    use super::*;

    fn exact(value: f64) -> ExactNumber {
        ExactNumber::from_f64(value).unwrap()
    }

    #[test]
    fn arithmetic_matches_that_of_rational_numbers() {
        let mut rng = fastrand::Rng::with_seed(8);
        let rational = |x: &ExactNumber| {
            let (numerator, denominator) = x.parts();
            BigRational::new(numerator, denominator)
        };
        for _ in 0..500 {
            let [a, b] = [(); 2].map(|()| f64::from_bits(rng.u64(..)));
            let [Some(x), Some(y)] = [a, b].map(ExactNumber::from_f64) else { continue };
            let (p, q) = (BigRational::from_float(a).unwrap(), BigRational::from_float(b).unwrap());
            assert_eq!((rational(&x), rational(&y)), (p.clone(), q.clone()));
            assert_eq!(rational(&(&x + &y)), &p + &q);
            assert_eq!(rational(&(&x - &y)), &p - &q);
            assert_eq!(rational(&(&x * &y)), &p * &q);
            assert_eq!((&x / &y).map(|z| rational(&z)), Some(&p / &q));
            assert_eq!(x.cmp(&y), p.cmp(&q));
            assert_eq!(rational(&x.floor()), p.floor());
            assert_eq!(x.approximate(), a, "a float is its own neighbour");
        }
        assert_eq!(&exact(1.0) / &exact(0.0), None);
        assert_eq!(ExactNumber::from_f64(f64::NAN), None);
    }

    #[test]
    fn roots_are_far_more_precise_than_a_float() {
        for (value, degree) in [(2.0, 2), (3e-40, 2), (1e300, 5), (0.25, 12), (0.0, 3)] {
            let x = exact(value);
            let root = x.root(degree).unwrap();
            let error = (&root.power(degree) - &x).abs();
            assert!(error.is_zero() || error.floor_log2() < x.shifted(-150).floor_log2(), "{value} {degree}");
        }
        assert_eq!(exact(9.0).root(2), Some(exact(3.0)));
        assert_eq!(exact(-1.0).root(2), None);
    }

    #[test]
    fn ties_go_to_the_even_neighbour() {
        for (value, rounded) in [(0.5, 0.0), (1.5, 2.0), (-0.5, 0.0), (-1.5, -2.0), (-0.6, -1.0), (2.4, 2.0)] {
            assert_eq!(exact(value).round_ties_even(), exact(rounded), "{value}");
        }
    }

    #[test]
    fn floor_log2_is_the_exponent_of_the_leading_bit() {
        for (value, magnitude) in [(1.0, 0), (0.75, -1), (2.0, 1), (3.99, 1), (-8.0, 3)] {
            assert_eq!(exact(value).floor_log2(), Some(magnitude), "{value}");
        }
        assert_eq!(ExactNumber::ratio(1, 3).unwrap().floor_log2(), Some(-2));
        assert_eq!(ExactNumber::whole(0).floor_log2(), None);
    }
}
