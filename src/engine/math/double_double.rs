//! Double-double arithmetic: numbers with about 106 significand bits, stored as the sum of two floats.
//!
//! Results are correct to the last bit of an `f64` even if large intermediate terms cancel.
//!
//! Algorithms and error bounds from Joldes, Muller and Popescu, "Tight and rigorous error bounds for basic building
//! blocks of double-word arithmetic" (2017). With u = 2⁻⁵³, the relative error of each operation is below 10 u².

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::expansion::{two_product, two_sum};

/// Number with about 106 significand bits: `hi` + `lo`, where `hi` is the float nearest to the sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DoubleDouble {
    hi: f64,
    lo: f64,
}

impl DoubleDouble {
    /// The number 0.
    pub(crate) const ZERO: Self = Self { hi: 0.0, lo: 0.0 };

    /// The number 1.
    pub(crate) const ONE: Self = Self { hi: 1.0, lo: 0.0 };

    /// Returns `a` − `b` without rounding error.
    pub(crate) fn difference(a: f64, b: f64) -> Self {
        let (hi, lo) = two_sum(a, -b);
        Self { hi, lo }
    }

    /// Returns `a` · `b` without rounding error.
    pub(crate) fn product(a: f64, b: f64) -> Self {
        let (hi, lo) = two_product(a, b);
        Self { hi, lo }
    }

    /// Returns the nearest `f64`.
    pub(crate) fn rounded(self) -> f64 {
        self.hi
    }

    /// Returns the absolute value.
    pub(crate) fn abs(self) -> Self {
        if self.hi < 0.0 { -self } else { self }
    }

    /// Renormalises `hi` + `lo` (Dekker). The magnitude of `lo` must be less than about one unit in the last place of
    /// `hi`.
    fn normalized(hi: f64, lo: f64) -> Self {
        let sum = hi + lo;
        Self { hi: sum, lo: lo - (sum - hi) }
    }
}

impl From<f64> for DoubleDouble {
    fn from(float: f64) -> Self {
        Self { hi: float, lo: 0.0 }
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (hi, hi_lost) = two_sum(self.hi, other.hi);
        let (lo, lo_lost) = two_sum(self.lo, other.lo);
        let sum = Self::normalized(hi, hi_lost + lo);
        Self::normalized(sum.hi, sum.lo + lo_lost)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let (hi, lost) = two_product(self.hi, other.hi);
        let cross = self.lo.mul_add(other.hi, self.hi.mul_add(other.lo, self.lo * other.lo));
        Self::normalized(hi, lost + cross)
    }
}

impl Div for DoubleDouble {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let quotient = self.hi / other.hi;
        let rest = self - other * Self::from(quotient);
        Self::normalized(quotient, rest.hi / other.hi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_hold_twice_the_digits_of_a_float() {
        let third = DoubleDouble::ONE / DoubleDouble::from(3.0);
        let error = third * DoubleDouble::from(3.0) - DoubleDouble::ONE;
        assert!(error.abs().rounded() < 1e-31, "{error:?}");
        let (a, b) = (DoubleDouble::difference(1.0, -1e-25), DoubleDouble::difference(1.0, 1e-25));
        assert_eq!((a - b).rounded(), 2e-25);
        // (1 + d)(1 − d) = 1 − d².
        let d = 2.0_f64.powi(-40);
        let product = DoubleDouble::difference(1.0, -d) * DoubleDouble::difference(1.0, d);
        assert_eq!((DoubleDouble::ONE - product).rounded(), d * d);
    }

    #[test]
    fn sums_and_products_agree_with_integers_of_ninety_bits() {
        let mut random = fastrand::Rng::with_seed(42);
        let exact = |n: i128| {
            let hi = n as f64;
            DoubleDouble { hi, lo: (n - hi as i128) as f64 }
        };
        for _ in 0..5_000 {
            let (a, b) = (random.i128(-(1 << 90)..1 << 90), random.i128(-(1 << 90)..1 << 90));
            assert_eq!(exact(a) + exact(b), exact(a + b));
            assert_eq!(exact(a) - exact(b), exact(a - b));
            let (a, b) = (a >> 45, b >> 45);
            assert_eq!(exact(a) * exact(b), exact(a * b));
            let quotient = exact(a * b) / exact(b);
            assert_eq!((quotient - exact(a)).rounded(), 0.0);
        }
    }
}
