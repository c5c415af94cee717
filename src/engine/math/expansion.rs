//! Exact sums and products of floats (Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
//! Predicates", 1997).
//!
//! Geometric predicates use plain floats where the error bound permits a decision, and expansions otherwise. Results
//! are exact as long as no product leaves the range of `f64`. This holds in particular for polynomials of degree four
//! in numbers that are zero or of a magnitude from 2⁻¹⁴⁹ to 2¹²⁸.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Sub};

/// Returns the rounded sum of `a` and `b`, and the rounding error (Knuth). The two add up to exactly a + b.
#[inline]
pub(crate) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let from_b = sum - a;
    (sum, (a - (sum - from_b)) + (b - from_b))
}

/// Returns the rounded product of `a` and `b`, and the rounding error. The two add up to exactly a · b.
#[inline]
pub(crate) fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

/// Exact number, stored as a sum of non-overlapping floats: each is smaller than the last bit of the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expansion {
    /// Terms in ascending order of magnitude, none of them zero.
    parts: Vec<f64>,
}

impl Expansion {
    /// Returns `a` − `b` without rounding error.
    pub(crate) fn difference(a: f64, b: f64) -> Self {
        let mut exact = Self::default();
        exact.grow(a);
        exact.grow(-b);
        exact
    }

    /// Returns the sign as an order relative to zero. It is the sign of the largest part, which outweighs all others
    /// together.
    pub(crate) fn sign(&self) -> Ordering {
        self.parts.last().map_or(Ordering::Equal, |largest| largest.total_cmp(&0.0))
    }

    /// Adds one float without rounding error.
    fn grow(&mut self, float: f64) {
        let mut carry = float;
        let mut kept = 0;
        for index in 0..self.parts.len() {
            let (sum, lost) = two_sum(carry, self.parts[index]);
            carry = sum;
            if lost != 0.0 {
                self.parts[kept] = lost;
                kept += 1;
            }
        }
        self.parts.truncate(kept);
        if carry != 0.0 {
            self.parts.push(carry);
        }
    }
}

impl Add for &Expansion {
    type Output = Expansion;

    fn add(self, other: Self) -> Expansion {
        let mut sum = self.clone();
        other.parts.iter().for_each(|part| sum.grow(*part));
        sum
    }
}

impl Sub for &Expansion {
    type Output = Expansion;

    fn sub(self, other: Self) -> Expansion {
        let mut difference = self.clone();
        other.parts.iter().for_each(|part| difference.grow(-part));
        difference
    }
}

impl Mul for &Expansion {
    type Output = Expansion;

    fn mul(self, other: Self) -> Expansion {
        let mut total = Expansion::default();
        for (a, b) in self.parts.iter().flat_map(|a| other.parts.iter().map(move |b| (a, b))) {
            let (product, lost) = two_product(*a, *b);
            total.grow(lost);
            total.grow(product);
        }
        total
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the value of an expansion that is an integer.
    fn integer(expansion: &Expansion) -> i128 {
        expansion.parts.iter().map(|part| *part as i128).sum()
    }

    #[test]
    fn polynomials_of_integers_are_exact() {
        let mut random = fastrand::Rng::with_seed(41);
        for round in 0..2_000 {
            // A degree-four polynomial of 31-bit integers has up to 124 bits, far more than a float can hold.
            let numbers: [i64; 4] = std::array::from_fn(|_| random.i64(-(1 << 30)..1 << 30) >> (round % 30));
            let [a, b, c, d] = numbers.map(|n| n as f64);
            let (ab, cd) = (Expansion::difference(a, b), Expansion::difference(c, d));
            let [ia, ib, ic, id] = numbers.map(i128::from);
            let exact = (ia - ib).pow(2) * (ic - id) * (ia - ib) - (ic - id).pow(3) + (ia - ib);
            let computed = &(&(&(&(&ab * &ab) * &cd) * &ab) - &(&(&cd * &cd) * &cd)) + &ab;
            assert_eq!(integer(&computed), exact, "{numbers:?}");
            assert_eq!(computed.sign(), exact.cmp(&0), "{numbers:?}");
        }
    }

    #[test]
    fn rounding_errors_are_kept_across_the_range_of_single_precision() {
        let (least, greatest) = (2.0_f64.powi(-149), 3e38_f32.into());
        let sum = Expansion::difference(greatest, -least);
        let square = &sum * &sum;
        let fourth = &square * &square;
        // With s = `greatest` + `least`, s⁴ + `least`⁴ − s⁴ must be `least`⁴, although s⁴ is about 1e154 and `least`⁴
        // about 1e-180.
        let tiny = Expansion::difference(least, 0.0);
        let tiny = &(&tiny * &tiny) * &(&tiny * &tiny);
        let rest = &(&(&fourth + &tiny) - &fourth) - &tiny;
        assert_eq!(rest.sign(), Ordering::Equal);
        assert_eq!((&(&fourth + &tiny) - &fourth).sign(), Ordering::Greater);
        assert_eq!((&(&fourth - &tiny) - &fourth).sign(), Ordering::Less);
    }
}
