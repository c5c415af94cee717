//! Linear interpolation of 8-bit values, exact in integers and rounded once.
//!
//! With D ≤ 8 phase steps between samples, the value at steps (i, j) between four samples is a multiple of 1 / D². As
//! an integer in this unit, it is at most 255 · 64, which fits in 16 bits. Halves are rounded up.

use super::cells::Pass;
use crate::image::Rgba8;
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
        let one = u32::from(self.steps * self.steps);
        for (row, phase) in rows.chunks_exact_mut(self.columns.len()).zip(phases) {
            for ((pixel, above), below) in row.iter_mut().zip(around[0]).zip(around[1]) {
                *pixel = std::array::from_fn(|channel| {
                    let sum =
                        u32::from(above[channel]) * (u32::from(self.steps) - phase) + u32::from(below[channel]) * phase;
                    ((2 * sum + one) / (2 * one)) as u8
                });
            }
        }
    }
}
