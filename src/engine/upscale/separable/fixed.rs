//! Interpolation of 8-bit values with four or six taps along each axis, in 16-bit fixed point.
//!
//! An 8-bit value c is represented as (c − 128) · 64: six fractional bits, centred, so that a sum of two fits `i16`.
//! Weights come in mirrored pairs: the samples have weights w₀ … wₙ at t, and the same weights in reverse at 1 − t.
//! With the sums s and differences d of symmetric samples,
//!
//! ```text
//!   value(t) = Σ even · s + Σ odd · d      value(1 − t) = Σ even · s − Σ odd · d      even, odd = (wₖ ± wₙ₋ₖ) / 2
//! ```
//!
//! so the multiplications for one position serve both. Each product is rounded once to the unit of the sum ([`times`],
//! like the `pmulhrsw` instruction); sums are exact. Errors stay below 1/12 of an 8-bit step, so a result differs from
//! exact arithmetic by at most one. This scalar version defines the result; SIMD versions must be bit-identical.

use super::cells::Pass;
use crate::image::Rgba8;
use crate::upscale::lattice::LatticePosition;

/// Number of fractional bits of a value.
pub(super) const POINT: u32 = 6;

/// 8-bit value that is represented as 0.
const MIDDLE: i16 = 128;

/// Bias added to a value before its fractional bits are dropped: restores the offset and rounds halves up.
pub(super) const BIAS: i16 = (MIDDLE << POINT) + (1 << (POINT - 1));

/// Sum of the `even` weights, which represents 1. It is half of 2¹⁵, because each of these weights applies to two
/// samples.
const ONE: i16 = 1 << 14;

/// Converts an 8-bit value to fixed point.
#[inline]
pub(super) fn value_of(code: u8) -> i16 {
    (i16::from(code) - MIDDLE) << POINT
}

/// Converts a fixed-point value to the nearest 8-bit value, rounding halves up and clamping to [0, 255].
#[inline]
pub(super) fn code_of(value: i16) -> u8 {
    (value.wrapping_add(BIAS) >> POINT).clamp(0, 255) as u8
}

/// Multiplies a value by a weight in units of 2⁻¹⁵, rounding halves up.
#[inline]
pub(super) fn times(weight: i16, value: i16) -> i16 {
    ((i32::from(weight) * i32::from(value) + (1 << 14)) >> 15) as i16
}

/// Weights of the symmetric pairs of samples around one position, outermost pair first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::upscale) struct PhaseWeights<const H: usize> {
    /// Mean weight of each pair of symmetric samples, in units of 2⁻¹⁵; these means sum to exactly ½.
    pub(super) even: [i16; H],
    /// Half the difference between the two weights of each pair, in units of 2⁻¹⁵. The sign does not depend on
    /// `mirrored`, so that t and 1 − t use the same products. If the position is mirrored, the products are subtracted.
    pub(super) odd: [i16; H],
    /// Whether the position lies past the middle between two samples.
    pub(super) mirrored: bool,
}

impl<const H: usize> PhaseWeights<H> {
    /// Creates fixed-point weights from the weights of the 2 · `H` surrounding samples, which must sum to 1.
    pub(in crate::upscale) fn new(weights: &[f64]) -> Self {
        let pair = |k: usize| (weights[k], weights[2 * H - 1 - k]);
        let fixed = |weight: f64| (weight * f64::from(1 << 15)).round() as i16;
        let mut even: [i16; H] = std::array::from_fn(|k| fixed((pair(k).0 + pair(k).1) / 2.0));
        let mirrored = pair(H - 1).0 < pair(H - 1).1;
        let sign = if mirrored { -1.0 } else { 1.0 };
        let odd = std::array::from_fn(|k| fixed(sign * (pair(k).0 - pair(k).1) / 2.0));
        // The rounding error goes to the largest pair, so that uniform colours are preserved.
        even[H - 1] += ONE - even.iter().sum::<i16>();
        Self { even, odd, mirrored }
    }

    /// Whether the position coincides with a sample, whose value is copied.
    pub(super) fn is_copy(&self) -> bool {
        self.even[H - 1] == ONE && self.odd[H - 1] == ONE && !self.mirrored
    }

    /// Whether the position is halfway between two samples, where all `odd` weights are zero.
    pub(super) fn is_middle(&self) -> bool {
        self.odd == [0; H]
    }

    /// Whether `self` and `other` are mirror images: one lies at t and the other at 1 − t.
    pub(super) fn mirrors(&self, other: &Self) -> bool {
        self.even == other.even && self.odd == other.odd && self.mirrored != other.mirrored
    }

    /// Interpolates the 2 · `H` surrounding samples.
    #[inline]
    fn apply(&self, sample: impl Fn(usize) -> i16, deringing: bool) -> i16 {
        let (before, after) = (sample(H - 1), sample(H));
        if self.is_copy() {
            return before;
        }
        let sum = (0..H).fold(0, |sum: i16, k| {
            let (a, b) = (sample(k), sample(2 * H - 1 - k));
            let odd = times(self.odd[k], a - b);
            sum + times(self.even[k], a + b) + if self.mirrored { -odd } else { odd }
        });
        if deringing { sum.clamp(before.min(after), before.max(after)) } else { sum }
    }
}

/// Scalar version of the horizontal and the vertical pass over 8-bit values, with `H` pairs of taps along each axis.
pub(super) struct FixedScalar<'a, const H: usize> {
    /// Weights at each phase of the lattice.
    pub(super) phases: &'a [PhaseWeights<H>],
    /// Positions of the output columns.
    pub(super) columns: Vec<LatticePosition>,
    /// Whether values are clamped to the range of the inner two samples.
    pub(super) deringing: bool,
}

impl<const H: usize> Pass for FixedScalar<'_, H> {
    type Row = Vec<[i16; 4]>;

    const TAPS: usize = 2 * H;

    fn widen(&self, samples: &[Rgba8], wide: &mut Self::Row) {
        let last = samples.len() as i32 - 1;
        let value = |at: i32, channel: usize| value_of(samples[at.clamp(0, last) as usize][channel]);
        wide.clear();
        wide.extend(self.columns.iter().map(|LatticePosition { cell, phase }| {
            let first = cell - (H as i32 - 1);
            let phase = &self.phases[*phase as usize];
            std::array::from_fn(|channel| phase.apply(|tap| value(first + tap as i32, channel), self.deringing))
        }));
    }

    fn mix(&self, around: &[&Self::Row], phases: &[u32], rows: &mut [Rgba8]) {
        for (row, phase) in rows.chunks_exact_mut(self.columns.len()).zip(phases) {
            let phase = &self.phases[*phase as usize];
            for (x, pixel) in row.iter_mut().enumerate() {
                *pixel =
                    std::array::from_fn(|channel| code_of(phase.apply(|tap| around[tap][x][channel], self.deringing)));
            }
        }
    }
}
