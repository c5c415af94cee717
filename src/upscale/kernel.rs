//! Interpolation along rows, then along columns, exact in integers.
//!
//! In: a packed picture that holds the top-left pixel of every block of `scale` × `scale` px. Out: the full picture, in
//! which each drawn pixel stands unchanged where it was drawn (corner phase: `out[scale · i] = in[i]`).
//!
//! The place of an output pixel is a whole number of quarters of the way from one sample to the next, and there all
//! weights are multiples of a power of two, such as 1/128. So nothing is rounded until the very end, where the sum is
//! rounded half up once and clamped, and the order of the two passes does not matter. At the borders the outermost
//! sample repeats.
//!
//! Codes are filtered less 128: then the sums of the first pass fit `i16`, which halves the traffic between the passes.

use std::array;
use std::iter::Sum;
use std::ops::Mul;

use rayon::prelude::*;

use super::Tap;
use crate::image::{Image, Rgba8};

/// Enlargements that a [`Kernel`] does: those whose output pixels lie on quarters.
pub(super) const SCALES: &[u32] = &[2, 4];

/// Middle of the codes.
const MIDDLE: i16 = 128;

/// Rows of samples that are filled in at a time: enough to make good the few that neighbouring bands both widen.
const SAMPLE_ROWS_PER_BAND: usize = 16;

/// A pixel in the middle of the calculation: each channel a code less [`MIDDLE`], whole or in units of a weight.
type Centred = [i16; 4];

/// Weights of the `N` samples around a place, `N` even: as many on the one side as on the other.
pub(super) struct Kernel<const N: usize, const WEIGHT_BITS: u32> {
    /// Row `q`: the place lies `q` quarters of the way from sample `N / 2 − 1` to the next. In units of
    /// 2^−`WEIGHT_BITS`, summing to one; magnitudes sum to at most 255 units, so that sums of centred codes fit `i16`.
    pub(super) quarters: [[i16; N]; 4],
}

impl<const N: usize, const WEIGHT_BITS: u32> Kernel<N, WEIGHT_BITS> {
    /// Bits after the point in sums of both passes.
    const SUM_BITS: u32 = 2 * WEIGHT_BITS;

    /// Samples before the one at or left of the place.
    const BEFORE: usize = N / 2 - 1;

    /// Fills a picture of `width` × `height` px.
    pub(super) fn upscale(&self, drawn: &Image<Rgba8>, scale: u32, width: u32, height: u32) -> Image<Rgba8> {
        let mut full = Image::filled(width, height, [0; 4]);
        let (width, scale) = (width as usize, scale as usize);
        let band_pixels = width * scale * SAMPLE_ROWS_PER_BAND;
        // A band of no pixels is no band; then the picture is empty, too.
        full.pixels_mut().par_chunks_mut(band_pixels.max(1)).enumerate().for_each(|(band, pixels)| {
            self.fill_band(drawn, scale, width, band * SAMPLE_ROWS_PER_BAND, pixels);
        });
        full
    }

    /// Fills the rows that start at sample row `first`.
    fn fill_band(&self, drawn: &Image<Rgba8>, scale: usize, width: usize, first: usize, band: &mut [Rgba8]) {
        let sample_rows = band.len().div_ceil(width * scale);
        let last = drawn.height() as usize - 1;
        let widened: Vec<_> = (first..first + sample_rows + N - 1)
            .map(|row| row.saturating_sub(Self::BEFORE).min(last))
            .map(|row| self.widen(drawn.row(row as u32), scale, width))
            .collect();
        for (around, block) in widened.windows(N).zip(band.chunks_mut(width * scale)) {
            for (row, weights) in block.chunks_exact_mut(width).zip(self.phases(scale)) {
                Self::mix(around, weights, row);
            }
        }
    }

    /// One row of samples as a row of `width` pixels, in units of a weight.
    fn widen(&self, samples: &[Rgba8], scale: usize, width: usize) -> Vec<Centred> {
        let padded = Self::pad(samples);
        let mut wide = vec![[0; 4]; width];
        let mut of_phase = vec![[0; 4]; samples.len()];
        for (phase, weights) in self.phases(scale).enumerate().take(width) {
            weigh_neighbours(padded.as_flattened(), weights, of_phase.as_flattened_mut());
            for (block, pixel) in wide[phase..].chunks_mut(scale).zip(&of_phase) {
                block[0] = *pixel;
            }
        }
        wide
    }

    /// A row of samples, centred, with the outermost ones repeated as far as the weights reach.
    fn pad(samples: &[Rgba8]) -> Vec<Centred> {
        let centred = |code: u8| i16::from(code) - MIDDLE;
        let mut padded = vec![samples[samples.len() - 1].map(centred); samples.len() + N - 1];
        padded[..Self::BEFORE].fill(samples[0].map(centred));
        for (value, code) in padded[Self::BEFORE..].as_flattened_mut().iter_mut().zip(samples.as_flattened()) {
            *value = centred(*code);
        }
        padded
    }

    /// One finished row from the `N` widened rows around it.
    fn mix(around: &[Vec<Centred>], weights: &[i16; N], row: &mut [Rgba8]) {
        // The shift rounds negative sums down, too, so adding a half rounds half up everywhere.
        if Self::SUM_BITS <= 4 {
            // Half the width, so twice the lanes; with the centre and the half added, sums stay below 2^13.
            let offset = (MIDDLE << Self::SUM_BITS) + (1 << Self::SUM_BITS >> 1);
            weigh_rows(around, weights, row, |sum: i16| ((sum + offset) >> Self::SUM_BITS).clamp(0, 255) as u8);
        } else {
            let offset = (i32::from(MIDDLE) << Self::SUM_BITS) + (1 << Self::SUM_BITS >> 1);
            weigh_rows(around, weights, row, |sum: i32| ((sum + offset) >> Self::SUM_BITS).clamp(0, 255) as u8);
        }
    }

    /// Weights of the `scale` places from one sample up to the next.
    fn phases(&self, scale: usize) -> impl Iterator<Item = &[i16; N]> {
        self.quarters.iter().step_by(self.quarters.len() / scale)
    }

    /// The drawn pixels that output pixel (x, y) is made of.
    pub(super) fn taps(&self, x: u32, y: u32, scale: u32, width: u32, height: u32) -> Vec<Tap> {
        let one = (1 << Self::SUM_BITS) as f32;
        let across = self.axis_taps(x, scale, width);
        let down = self.axis_taps(y, scale, height);
        let mut taps = Vec::with_capacity(across.len() * down.len());
        for &(y, weight_y) in &down {
            for &(x, weight_x) in &across {
                taps.push(Tap { x, y, weight: (weight_x * weight_y) as f32 / one });
            }
        }
        taps
    }

    /// The drawn places along one axis of `length` px that pixel `at` is made of, each once, with its weight.
    fn axis_taps(&self, at: u32, scale: u32, length: u32) -> Vec<(u32, i32)> {
        let (cell, phase) = (at / scale, at % scale);
        let last = length.div_ceil(scale) - 1;
        let mut taps: Vec<(u32, i32)> = Vec::with_capacity(N);
        for (n, weight) in (0..).zip(self.quarters[(phase * 4 / scale) as usize]) {
            let place = (cell + n).saturating_sub(Self::BEFORE as u32).min(last) * scale;
            match taps.last_mut() {
                Some((same, sum)) if *same == place => *sum += i32::from(weight),
                _ => taps.push((place, i32::from(weight))),
            }
        }
        taps.retain(|(_, weight)| *weight != 0);
        taps
    }
}

/// Weighs `N` neighbouring samples for every sample, channel by channel. A flat loop over one phase at a time compiles
/// to vector code, which a loop over the pixels as they will stand does not.
fn weigh_neighbours<const N: usize>(padded: &[i16], weights: &[i16; N], sums: &mut [i16]) {
    let around: [&[i16]; N] = array::from_fn(|n| &padded[4 * n..4 * n + sums.len()]);
    for (i, sum) in sums.iter_mut().enumerate() {
        *sum = (0..N).map(|n| weights[n] * around[n][i]).sum();
    }
}

/// Weighs `N` rows, channel by channel, and makes codes of the sums.
fn weigh_rows<const N: usize, S: From<i16> + Mul<Output = S> + Sum>(
    around: &[Vec<Centred>],
    weights: &[i16; N],
    row: &mut [Rgba8],
    code_of: impl Fn(S) -> u8,
) {
    let codes = row.as_flattened_mut();
    let around: [&[i16]; N] = array::from_fn(|n| &around[n].as_flattened()[..codes.len()]);
    for (i, code) in codes.iter_mut().enumerate() {
        *code = code_of((0..N).map(|n| S::from(weights[n]) * S::from(around[n][i])).sum());
    }
}
