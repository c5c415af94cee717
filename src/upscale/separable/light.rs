//! Interpolation of linear light by two to six samples along each axis, in 32-bit floats.
//!
//! Codes are decoded by a table; sums are rounded back to codes with an error below a fiftieth of a code. Products and sums
//! are taken one by one in the order written here, so that wider lanes give the same bits. Alpha is linear as it stands.

use fearless_simd::Level;
#[cfg(target_arch = "x86_64")]
use fearless_simd::kernel;

use super::cells::Pass;
use crate::image::Rgba8;
use crate::image::color::Tables;
use crate::upscale::lattice::Place;

/// Light of each channel, and alpha.
type Light = [f32; 4];

/// Values of a row that are finished at a time: few enough to stay in the nearest cache.
const CHUNK: usize = 1024;

/// The passes; `N` samples along each axis.
pub(super) struct Linear<const N: usize> {
    /// Weights at the phases of the lattice.
    weights: Vec<[f32; N]>,
    columns: Vec<Place>,
    decode: &'static [f32; 256],
    deringing: bool,
    level: Level,
}

/// A widened row, and the samples that it was made of, those at the ends repeated.
#[derive(Default)]
pub(super) struct Row {
    samples: Vec<Light>,
    wide: Vec<Light>,
}

impl<const N: usize> Linear<N> {
    /// For the output columns at these places.
    pub(super) fn new(level: Level, weights: &[[f64; N]], columns: Vec<Place>, deringing: bool) -> Self {
        Self {
            weights: weights.iter().map(|weights| weights.map(|weight| weight as f32)).collect(),
            columns,
            decode: &Tables::get().linear_of_code,
            deringing,
            level,
        }
    }

    fn light_of(&self, [r, g, b, a]: Rgba8) -> Light {
        let light = |code: u8| self.decode[code as usize];
        [light(r), light(g), light(b), f32::from(a) / 255.0]
    }
}

impl<const N: usize> Pass for Linear<N> {
    type Row = Row;

    const TAPS: usize = N;

    fn widen(&self, samples: &[Rgba8], row: &mut Row) {
        let light = &mut row.samples;
        light.clear();
        light.resize(N / 2, self.light_of(samples[0]));
        light.extend(samples.iter().map(|sample| self.light_of(*sample)));
        light.resize(samples.len() + N, self.light_of(samples[samples.len() - 1]));
        row.wide.resize(self.columns.len(), Light::default());
        for (pixel, Place { cell, phase }) in row.wide.iter_mut().zip(&self.columns) {
            // The first of the samples around the cell, past as many as were put before.
            let around = &row.samples[(cell + 1) as usize..][..N];
            *pixel = weigh(&self.weights[*phase as usize], around, self.deringing);
        }
    }

    fn mix(&self, around: &[&Row], phases: &[u32], rows: &mut [Rgba8]) {
        let width = self.columns.len();
        for (row, phase) in rows.chunks_exact_mut(width).zip(phases) {
            for (chunk, codes) in row.chunks_mut(CHUNK / 4).enumerate() {
                let around: [&[f32]; N] =
                    std::array::from_fn(|tap| around[tap].wide[chunk * CHUNK / 4..][..codes.len()].as_flattened());
                blend(self.level, &self.weights[*phase as usize], &around, self.deringing, codes);
            }
        }
    }
}

/// Weighs `N` neighbouring samples, and keeps the sum between the inner two if asked.
#[inline(always)]
fn weigh<const N: usize>(weights: &[f32; N], around: &[Light], deringing: bool) -> Light {
    let mut sum = around[0].map(|value| weights[0] * value);
    for (weight, sample) in weights.iter().zip(around).skip(1) {
        for (sum, value) in sum.iter_mut().zip(sample) {
            *sum += weight * value;
        }
    }
    if deringing {
        for (channel, sum) in sum.iter_mut().enumerate() {
            *sum = between(*sum, around[N / 2 - 1][channel], around[N / 2][channel]);
        }
    }
    sum
}

/// The nearest to `value` from `a` to `b`, whichever is the greater.
#[inline(always)]
fn between(value: f32, a: f32, b: f32) -> f32 {
    value.max(a.min(b)).min(a.max(b))
}

/// Part of a row from those of the widened rows around; at most [`CHUNK`] values.
fn blend(level: Level, weights: &[f32], around: &[&[f32]], deringing: bool, row: &mut [Rgba8]) {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = level.as_avx2() {
        return blend_avx2(avx2, weights, around, deringing, row);
    }
    blend_lanes(weights, around, deringing, row);
}

#[cfg(target_arch = "x86_64")]
kernel! {
    /// [`blend_lanes`], compiled for eight lanes.
    fn blend_avx2(avx2: Avx2, weights: &[f32], around: &[&[f32]], deringing: bool, row: &mut [Rgba8]) {
        let _ = avx2;
        blend_lanes(weights, around, deringing, row);
    }
}

/// Loops over whole rows, tap by tap: these a compiler turns into lanes as wide as there are.
#[inline(always)]
fn blend_lanes(weights: &[f32], around: &[&[f32]], deringing: bool, row: &mut [Rgba8]) {
    let mut sums = [0.0_f32; CHUNK];
    let sums = &mut sums[..4 * row.len()];
    for (sum, value) in sums.iter_mut().zip(around[0]) {
        *sum = weights[0] * value;
    }
    for (weight, values) in weights.iter().zip(around).skip(1) {
        for (sum, value) in sums.iter_mut().zip(*values) {
            *sum += weight * value;
        }
    }
    if deringing {
        let inner = around.len() / 2;
        for ((sum, a), b) in sums.iter_mut().zip(around[inner - 1]).zip(around[inner]) {
            *sum = between(*sum, *a, *b);
        }
    }
    for (code, light) in row.as_flattened_mut().iter_mut().zip(sums.iter()) {
        *code = encode(*light);
    }
    for (pixel, light) in row.iter_mut().zip(sums.as_chunks::<4>().0) {
        pixel[3] = round(255.0 * light[3].clamp(0.0, 1.0));
    }
}

/// The code nearest to linear light: the formula of sRGB, its power as a polynomial in the fourth root, which is within
/// 0.02 codes.
#[inline(always)]
fn encode(light: f32) -> u8 {
    /// 255 (1.055 r^(5/3) − 0.055) for r from 0.0031308^(1/4) to 1: interpolated at Chebyshev's points, off by 0.0021.
    const POWER: [f32; 6] = [-15.678_251, 41.691_35, 318.693_9, -144.683_87, 71.647_62, -16.672_062];
    let light = light.clamp(0.0, 1.0);
    let root = light.sqrt().sqrt();
    let mut power = POWER[5];
    for coefficient in [POWER[4], POWER[3], POWER[2], POWER[1], POWER[0]] {
        power = power * root + coefficient;
    }
    round(if light <= 0.003_130_8 { 255.0 * 12.92 * light } else { power })
}

/// The whole number nearest to a value in [0, 255]; halves to the even one.
#[inline(always)]
fn round(value: f32) -> u8 {
    /// Here floats are whole numbers, so that a sum rounds to one, which stands in its last byte.
    const WHOLE: f32 = (1 << 23) as f32;
    (value + WHOLE).to_bits() as u8
}
