//! Interpolation of linear light by two to six samples along each axis, in 32-bit floats.
//!
//! Codes are decoded by a table; sums are rounded back to codes with an error below a fiftieth of a code. Products and sums
//! are taken one by one in the order written here, so that wider lanes give the same bits. Alpha is linear as it stands.

use super::cells::Pass;
use crate::image::Rgba8;
use crate::image::color::Tables;
use crate::upscale::lattice::Place;

/// Light of each channel, and alpha.
type Light = [f32; 4];

/// The passes; `N` samples along each axis.
pub(super) struct Linear<const N: usize> {
    /// Weights at the phases of the lattice.
    weights: Vec<[f32; N]>,
    columns: Vec<Place>,
    decode: &'static [f32; 256],
    deringing: bool,
}

/// A widened row, and the samples that it was made of.
#[derive(Default)]
pub(super) struct Row {
    samples: Vec<Light>,
    wide: Vec<Light>,
}

impl<const N: usize> Linear<N> {
    /// Samples before the one at or left of a place.
    const BEFORE: usize = N / 2 - 1;

    /// For the output columns at these places.
    pub(super) fn new(weights: &[[f64; N]], columns: Vec<Place>, deringing: bool) -> Self {
        Self {
            weights: weights.iter().map(|weights| weights.map(|weight| weight as f32)).collect(),
            columns,
            decode: &Tables::get().linear_of_code,
            deringing,
        }
    }

    fn light_of(&self, [r, g, b, a]: Rgba8) -> Light {
        let light = |code: u8| self.decode[code as usize];
        [light(r), light(g), light(b), f32::from(a) / 255.0]
    }
}

/// Weighs one channel of `N` samples, and keeps it between the inner two if asked.
#[inline(always)]
fn weigh<const N: usize>(weights: &[f32; N], sample: impl Fn(usize) -> f32, deringing: bool) -> f32 {
    let mut sum = weights[0] * sample(0);
    for (tap, weight) in weights.iter().enumerate().skip(1) {
        sum += weight * sample(tap);
    }
    let (a, b) = (sample(N / 2 - 1), sample(N / 2));
    if deringing { sum.max(a.min(b)).min(a.max(b)) } else { sum }
}

/// The code nearest to linear light: the formula of sRGB, its power as a polynomial in the fourth root, which is within
/// 0.02 codes.
#[inline(always)]
fn encode(light: f32) -> u8 {
    /// 255 (1.055 r^(5/3) − 0.055) for r from 0.0031308^(1/4) to 1: interpolated at Chebyshev's points, off by 0.0021.
    const POWER: [f32; 6] = [-15.678_251, 41.691_35, 318.693_9, -144.683_87, 71.647_62, -16.672_062];
    let light = light.clamp(0.0, 1.0);
    let root = light.sqrt().sqrt();
    let power = POWER.iter().rev().fold(0.0, |sum, coefficient| sum * root + coefficient);
    let code = if light <= 0.003_130_8 { 255.0 * 12.92 * light } else { power };
    round(code)
}

/// The whole number nearest to a value in [0, 255], halves up or down by at most 2⁻¹⁵.
#[inline(always)]
fn round(value: f32) -> u8 {
    /// Here floats are whole numbers, so that a sum rounds to one, which stands in its last byte.
    const WHOLE: f32 = (1 << 23) as f32;
    (value + WHOLE).to_bits() as u8
}

impl<const N: usize> Pass for Linear<N> {
    type Row = Row;

    const TAPS: usize = N;

    fn widen(&self, samples: &[Rgba8], row: &mut Row) {
        let light = &mut row.samples;
        light.clear();
        light.extend(samples.iter().map(|sample| self.light_of(*sample)));
        row.wide.resize(self.columns.len(), Light::default());
        let last = samples.len() as i32 - 1;
        for (pixel, Place { cell, phase }) in row.wide.iter_mut().zip(&self.columns) {
            let weights = &self.weights[*phase as usize];
            let first = cell - Self::BEFORE as i32;
            let around: [Light; N] =
                std::array::from_fn(|tap| row.samples[(first + tap as i32).clamp(0, last) as usize]);
            *pixel = std::array::from_fn(|channel| weigh(weights, |tap| around[tap][channel], self.deringing));
        }
    }

    fn mix(&self, around: &[&Row], phases: &[u32], rows: &mut [Rgba8]) {
        let width = self.columns.len();
        let around: [&[f32]; N] = std::array::from_fn(|tap| around[tap].wide[..width].as_flattened());
        for (row, phase) in rows.chunks_exact_mut(width).zip(phases) {
            let weights = &self.weights[*phase as usize];
            blend(weights, &around, self.deringing, row);
        }
    }
}

/// One row from the widened rows around.
#[inline(always)]
fn blend<const N: usize>(weights: &[f32; N], around: &[&[f32]; N], deringing: bool, row: &mut [Rgba8]) {
    let around = around.map(|wide| &wide[..4 * row.len()]);
    for (x, pixel) in row.iter_mut().enumerate() {
        *pixel = std::array::from_fn(|channel| {
            let value = weigh(weights, |tap| around[tap][4 * x + channel], deringing);
            if channel == 3 { round(255.0 * value.clamp(0.0, 1.0)) } else { encode(value) }
        });
    }
}
