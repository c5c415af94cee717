//! Interpolation of codes by four or six samples along each axis, in 16-bit fixed point.
//!
//! A code c is carried as (c − 128) · 64: six bits after the point, centred, so that a sum of two fits `i16`. Weights
//! come in mirrored pairs: at t the samples weigh w₀ … wₙ, at 1 − t the same in reverse. With the sums s and differences d
//! of the samples that lie symmetrically,
//!
//! ```text
//!   value(t) = Σ even · s + Σ odd · d      value(1 − t) = Σ even · s − Σ odd · d      even, odd = (wₖ ± wₙ₋ₖ) / 2
//! ```
//!
//! so both places cost the multiplications of one. Each product is rounded once to the unit of the sum ([`times`], what
//! the processor's `pmulhrsw` does); sums are exact. Errors stay below a twelfth of a code, so that a result is that of
//! exact arithmetic or its neighbour. What is written here in plain Rust defines the result; wider lanes must agree with
//! it bit for bit.

use super::cells::Pass;
use crate::image::Rgba8;
use crate::upscale::lattice::Place;

/// Bits after the point of a value.
pub(super) const POINT: u32 = 6;

/// Middle of the codes, which values are relative to.
const MIDDLE: i16 = 128;

/// What is added to a value before its point is cut off: the middle, and a half so that halves go up.
pub(super) const BIAS: i16 = (MIDDLE << POINT) + (1 << (POINT - 1));

/// One, as a sum of `even` weights: half of 2¹⁵, as each counts for two samples.
const ONE: i16 = 1 << 14;

/// The value that carries a code.
#[inline]
pub(super) fn value_of(code: u8) -> i16 {
    (i16::from(code) - MIDDLE) << POINT
}

/// The code nearest to a value, halves up, within 0 to 255.
#[inline]
pub(super) fn code_of(value: i16) -> u8 {
    (value.wrapping_add(BIAS) >> POINT).clamp(0, 255) as u8
}

/// The product of a weight in 2⁻¹⁵ and a value, rounded half up.
#[inline]
pub(super) fn times(weight: i16, value: i16) -> i16 {
    ((i32::from(weight) * i32::from(value) + (1 << 14)) >> 15) as i16
}

/// The weights at one place between samples, outermost pair first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::upscale) struct Phase<const H: usize> {
    /// Mean weight of a pair, in 2⁻¹⁵; sums to exactly one half.
    pub(super) even: [i16; H],
    /// Half the difference of a pair's weights, in 2⁻¹⁵, taken off instead of added where the place is `mirrored`: a
    /// product rounds otherwise than its negative, and 1 − t is made of the products of t.
    pub(super) odd: [i16; H],
    /// Whether the place lies past the middle.
    pub(super) mirrored: bool,
}

impl<const H: usize> Phase<H> {
    /// From weights that sum to one, those of the 2 · `H` samples around.
    pub(in crate::upscale) fn new(weights: &[f64]) -> Self {
        let pair = |k: usize| (weights[k], weights[2 * H - 1 - k]);
        let fixed = |weight: f64| (weight * f64::from(1 << 15)).round() as i16;
        let mut even: [i16; H] = std::array::from_fn(|k| fixed((pair(k).0 + pair(k).1) / 2.0));
        let mirrored = pair(H - 1).0 < pair(H - 1).1;
        let sign = if mirrored { -1.0 } else { 1.0 };
        let odd = std::array::from_fn(|k| fixed(sign * (pair(k).0 - pair(k).1) / 2.0));
        // What rounding took goes to the heaviest pair, lest a plain colour change.
        even[H - 1] += ONE - even.iter().sum::<i16>();
        Self { even, odd, mirrored }
    }

    /// Whether the place is that of a sample, which keeps its value.
    pub(super) fn is_copy(&self) -> bool {
        self.even[H - 1] == ONE && self.odd[H - 1] == ONE && !self.mirrored
    }

    /// Whether the place lies halfway, where there is nothing odd.
    pub(super) fn is_middle(&self) -> bool {
        self.odd == [0; H]
    }

    /// Whether `other` is the place mirrored.
    pub(super) fn mirrors(&self, other: &Self) -> bool {
        self.even == other.even && self.odd == other.odd && self.mirrored != other.mirrored
    }

    /// The value at the place, from those of the samples around.
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

/// The passes over codes in plain Rust; `H` pairs of samples along each axis.
pub(super) struct Fixed<'a, const H: usize> {
    /// Weights at the phases of the lattice.
    pub(super) phases: &'a [Phase<H>],
    /// Where the output columns lie.
    pub(super) columns: Vec<Place>,
    /// Whether values are kept between those of the inner two samples.
    pub(super) deringing: bool,
}

impl<const H: usize> Pass for Fixed<'_, H> {
    type Row = Vec<[i16; 4]>;

    const TAPS: usize = 2 * H;

    fn widen(&self, samples: &[Rgba8], wide: &mut Self::Row) {
        let last = samples.len() as i32 - 1;
        let value = |at: i32, channel: usize| value_of(samples[at.clamp(0, last) as usize][channel]);
        wide.clear();
        wide.extend(self.columns.iter().map(|Place { cell, phase }| {
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
