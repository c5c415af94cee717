//! Interpolation of linear light by two to six samples along each axis, in 32-bit floats.
//!
//! Codes are decoded by a table; sums are rounded back to codes with an error below a fiftieth of a code. Products and sums
//! are taken one by one in the order written here, so that wider lanes give the same bits. Alpha is linear as it stands.

use fearless_simd::Level;

use super::cells::Pass;
#[cfg(target_arch = "x86_64")]
use super::light_avx2;
use crate::image::Rgba8;
use crate::image::color::Tables;
use crate::upscale::Scale;
use crate::upscale::lattice::Place;

/// Light of each channel, and alpha.
pub(super) type Light = [f32; 4];

/// Values of a row that are finished at a time: few enough to stay in the nearest cache.
const CHUNK: usize = 1024;

/// The passes; `N` samples along each axis.
pub(super) struct Linear<const N: usize> {
    /// Weights at the phases of the lattice.
    weights: Vec<[f32; N]>,
    columns: Vec<Place>,
    /// Pixels from one to the next of the same phase, and samples.
    period: (usize, usize),
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
    /// For the output columns at these places, one after the other.
    pub(super) fn new(level: Level, weights: &[[f64; N]], scale: Scale, columns: Vec<Place>, deringing: bool) -> Self {
        let (pixels, samples) = scale.ratio();
        Self {
            period: (pixels as usize, samples as usize),
            weights: weights.iter().map(|weights| weights.map(|weight| weight as f32)).collect(),
            columns,
            decode: &Tables::get().linear_of_code,
            deringing,
            level,
        }
    }

    fn light_of(&self, [r, g, b, a]: Rgba8) -> Light {
        let light = |code: u8| self.decode[code as usize];
        [light(r), light(g), light(b), f32::from(a) * (1.0 / 255.0)]
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
        // Phase after phase: every so many pixels the pattern repeats, so many samples on.
        let (pixels, samples) = self.period;
        for (first, Place { cell, phase }) in self.columns.iter().enumerate().take(pixels) {
            let weights = &self.weights[*phase as usize];
            // From the first of the samples around the cell on, past as many as were put before.
            let light = &row.samples[(cell + 1) as usize..];
            let wide = &mut row.wide[first..];
            #[cfg(target_arch = "x86_64")]
            let done = match self.level.as_avx2() {
                Some(avx2) if samples == 1 => light_avx2::widen(avx2, weights, light, self.deringing, pixels, wide),
                _ => 0,
            };
            #[cfg(not(target_arch = "x86_64"))]
            let done = 0;
            for (index, pixel) in wide.iter_mut().step_by(pixels).enumerate().skip(done) {
                *pixel = weigh(weights, &light[index * samples..][..N], self.deringing);
            }
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
    let done = level.as_avx2().map_or(0, |avx2| light_avx2::blend(avx2, weights, around, deringing, row));
    #[cfg(not(target_arch = "x86_64"))]
    let done = 0;
    let mut sums = [0.0_f32; CHUNK];
    let sums = &mut sums[..4 * (row.len() - done)];
    for (sum, value) in sums.iter_mut().zip(&around[0][4 * done..]) {
        *sum = weights[0] * value;
    }
    for (weight, values) in weights.iter().zip(around).skip(1) {
        for (sum, value) in sums.iter_mut().zip(&values[4 * done..]) {
            *sum += weight * value;
        }
    }
    if deringing {
        let inner = around.len() / 2;
        let beside = around[inner - 1][4 * done..].iter().zip(&around[inner][4 * done..]);
        for (sum, (a, b)) in sums.iter_mut().zip(beside) {
            *sum = between(*sum, *a, *b);
        }
    }
    for (pixel, light) in row[done..].iter_mut().zip(sums.as_chunks().0) {
        *pixel = encode(*light);
    }
}

/// Codes per unit of light at the dark end of sRGB, and of alpha everywhere.
pub(super) const PER_LIGHT: [f32; 4] = [255.0 * 12.92, 255.0 * 12.92, 255.0 * 12.92, 255.0];

/// Light from which codes are those of a power.
pub(super) const LEAST_OF_POWER: f32 = 0.003_130_8;

/// The greatest light below one, which has its code, too: so that all exponents are negative.
pub(super) const MOST: f32 = 1.0_f32.next_down();

/// Exponent, as floats keep it, of the octave of light that begins at 2⁻⁸. What lies below is taken with it.
pub(super) const FIRST_OCTAVE: u32 = 119;

/// 2⁻ᵉ for octaves e from −7 to −1, then for −8: in the order of the last three bits of the exponent.
pub(super) const PER_OCTAVE: [f32; 8] = [128.0, 64.0, 32.0, 16.0, 8.0, 4.0, 2.0, 256.0];

/// 255 · 1.055 · 2^(5 e / 12) for the same octaves.
pub(super) const OF_OCTAVE: [f32; 8] =
    [35.627_758, 47.557_35, 63.481_445, 84.737_564, 113.111_08, 150.985_18, 201.541_03, 26.690_66];

/// m^(5/12) for m from 1 to 2: the polynomial that is off by the least, 1.1 · 10⁻⁵; down to 0.8, 7 · 10⁻⁴.
pub(super) const POWER: [f32; 5] = [0.411_229_34, 0.828_860_2, -0.318_287_25, 0.089_037_69, -0.010_829_55];

/// What the power is less.
pub(super) const OFFSET: f32 = 255.0 * 0.055;

/// The codes nearest to linear light: the formula of sRGB, its power by a polynomial for each octave, within a fiftieth of a code.
///
/// Up to where the power begins the straight line is the smaller of the two, and from there on the power is; the straight line of
/// alpha is smaller than the power everywhere.
fn encode(light: Light) -> Rgba8 {
    std::array::from_fn(|channel| {
        let light = light[channel].clamp(0.0, MOST);
        let from = light.max(LEAST_OF_POWER);
        let octave = ((from.to_bits() >> 23).max(FIRST_OCTAVE) & 7) as usize;
        let m = from * PER_OCTAVE[octave];
        let mut power = POWER[4];
        for coefficient in [POWER[3], POWER[2], POWER[1], POWER[0]] {
            power = power * m + coefficient;
        }
        let code = (power * OF_OCTAVE[octave] - OFFSET).min(light * PER_LIGHT[channel]);
        code.round_ties_even() as u8
    })
}
