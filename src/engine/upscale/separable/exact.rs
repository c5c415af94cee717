//! Linear interpolation of 8-bit values, exact in integers and rounded once.
//!
//! With D phase steps between samples, the value at steps (i, j) between four samples is a multiple of 1 / D². As an
//! integer in this unit, it is at most 255 · D². Halves are rounded up.
//!
//! The quotient by D² is computed by a multiplication of floats, which is exact for D ≤ 80: numerators are below 2²² and
//! a multiple of ½, no quotient is closer than 1 / (4 D²) to an integer, and rounding changes it by less than
//! 255 · 2⁻²³.

use super::cells::Pass;
use crate::image::Rgba8;
use crate::math::lanes::{Lanes, on_lanes};
use crate::upscale::lattice::LatticePosition;

/// Scalar version of the horizontal and the vertical pass of exact linear interpolation.
pub(super) struct ExactScalar {
    /// Number of phase steps between two samples.
    pub(super) steps: u16,
    /// Positions of the output columns.
    pub(super) columns: Vec<LatticePosition>,
}

impl Pass for ExactScalar {
    type Row = Vec<[u16; 4]>;

    const TAPS: usize = 2;

    fn widen(&self, samples: &[Rgba8], wide: &mut Self::Row) {
        let last = samples.len() as i32 - 1;
        let sample = |at: i32| samples[at.clamp(0, last) as usize].map(u16::from);
        wide.clear();
        wide.extend(self.columns.iter().map(|LatticePosition { cell, phase }| {
            let (a, b, phase) = (sample(*cell), sample(cell + 1), *phase as u16);
            std::array::from_fn(|channel| a[channel] * (self.steps - phase) + b[channel] * phase)
        }));
    }

    fn mix(&self, around: &[&Self::Row], phases: &[u32], rows: &mut [Rgba8]) {
        let [above, below] = [around[0], around[1]].map(|row| row.as_flattened());
        for (row, phase) in rows.chunks_exact_mut(self.columns.len()).zip(phases) {
            on_lanes!(Lanes::best(), _simd => mix_row([above, below], self.steps, *phase as u16, row.as_flattened_mut()));
        }
    }
}

/// Interpolates `phase` of `steps` steps between the values of two widened rows.
#[inline(always)]
fn mix_row([above, below]: [&[u16]; 2], steps: u16, phase: u16, codes: &mut [u8]) {
    let one = u32::from(steps) * u32::from(steps);
    let inverse = 1.0 / (2 * one) as f32;
    for ((code, above), below) in codes.iter_mut().zip(above).zip(below) {
        let sum = u32::from(*above) * u32::from(steps - phase) + u32::from(*below) * u32::from(phase);
        // The added half keeps the quotient away from integers.
        let doubled = (2 * sum + one) as i32 as f32 + 0.5;
        *code = (doubled * inverse) as u8;
    }
}
