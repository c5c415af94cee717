//! Interpolation in linear light with two to six taps along each axis, in 32-bit floats.
//!
//! Samples are decoded by a table; weighted sums are encoded again with an error below 1/50 of an 8-bit step. Products
//! and sums are evaluated in the order written here, without fused operations, in lanes of 16 values of one channel.
//! Alpha is stored linearly and needs no decoding.

use fearless_simd::Level;

use super::cells::Pass;
use crate::image::Rgba8;
use crate::image::color::Tables;
use crate::math::lanes::*;
use crate::upscale::Scale;
use crate::upscale::lattice::LatticePosition;

/// Horizontal and vertical pass in linear light, with `N` taps along each axis.
pub(super) struct Linear<const N: usize> {
    /// Weights at each phase of the lattice.
    weights: Vec<[f32; N]>,
    columns: Vec<LatticePosition>,
    /// Number of output pixels and number of samples in a period of the lattice.
    period: (usize, usize),
    decode: &'static [f32; 256],
    deringing: bool,
    lanes: Lanes,
}

/// A widened row, split by channel, and the samples from which it was computed, padded with copies of the border
/// samples.
#[derive(Default)]
pub(super) struct LinearRow {
    samples: [Vec<f32>; 4],
    wide: [Vec<f32>; 4],
    /// Whether alpha is 255 in every sample, so that it needs no filtering.
    is_opaque: bool,
}

impl LinearRow {
    /// Returns the number of channels to filter.
    fn channels(&self) -> usize {
        if self.is_opaque { 3 } else { 4 }
    }
}

/// Returns the widest SIMD lanes that `level` supports.
fn lanes_of(level: Level) -> Lanes {
    #[cfg(target_arch = "x86_64")]
    if let Some(lanes) = level.as_avx512().map(Lanes::Avx512).or(level.as_avx2().map(Lanes::Avx2)) {
        return lanes;
    }
    let _ = level;
    Lanes::baseline()
}

impl<const N: usize> Linear<N> {
    /// Prepares passes for consecutive output columns at these positions.
    pub(super) fn new(
        level: Level,
        weights: &[[f64; N]],
        scale: Scale,
        columns: Vec<LatticePosition>,
        deringing: bool,
    ) -> Self {
        let (pixels, samples) = scale.ratio();
        Self {
            period: (pixels as usize, samples as usize),
            weights: weights.iter().map(|weights| weights.map(|weight| weight as f32)).collect(),
            columns,
            decode: &Tables::get().linear_of_code.values,
            deringing,
            lanes: lanes_of(level),
        }
    }

    /// Decodes samples to linear light, splits them by channel, and pads them with copies of the border samples.
    fn read(&self, samples: &[Rgba8], row: &mut LinearRow) {
        row.is_opaque = samples.iter().fold(255, |least, sample| least & sample[3]) == 255;
        let (Some(first), Some(last)) = (samples.first(), samples.last()) else { return };
        let channels = row.channels();
        for (channel, light) in row.samples.iter_mut().enumerate().take(channels) {
            light.resize(samples.len() + N + WIDE, 0.0);
            let (before, rest) = light.split_at_mut(N / 2);
            let (own, after) = rest.split_at_mut(samples.len());
            if channel == 3 {
                let light_of = |sample: &Rgba8| f32::from(sample[3]) * (1.0 / 255.0);
                own.iter_mut().zip(samples).for_each(|(light, sample)| *light = light_of(sample));
                before.fill(light_of(first));
                after.fill(light_of(last));
            } else {
                let light_of = |sample: &Rgba8| self.decode[sample[channel] as usize];
                own.iter_mut().zip(samples).for_each(|(light, sample)| *light = light_of(sample));
                before.fill(light_of(first));
                after.fill(light_of(last));
            }
        }
    }

    /// Widens a channel, 16 periods of the lattice at a time. A period has `PIXELS` pixels and one sample. Pixels at
    /// the same position in adjacent periods read adjacent samples, so 16 of them are computed together. Returns the
    /// number of pixels written.
    #[inline(always)]
    fn widen_runs<S: Simd, const PIXELS: usize>(&self, simd: S, samples: &[f32], wide: &mut [f32]) -> usize {
        let Some(columns) = self.columns.first_chunk::<PIXELS>() else { return 0 };
        let mut done = 0;
        // Index, in the padded samples, of the first sample that each phase reads.
        let mut from = columns.map(|place| (place.cell + 1) as usize);
        for run in wide.chunks_exact_mut(PIXELS * WIDE) {
            let mut sums = [f32x16::splat(simd, 0.0); PIXELS];
            for phase in 0..PIXELS {
                let weights = &self.weights[columns[phase].phase as usize];
                let Some(around) = samples.get(from[phase]..from[phase] + N - 1 + WIDE) else { return done };
                sums[phase] = weigh(simd, weights, self.deringing, each_tap(simd, around));
                from[phase] += WIDE;
            }
            interleave(simd, &sums, run);
            done += PIXELS * WIDE;
        }
        done
    }
}

/// Loads 16 values starting at each of `N` adjacent samples.
#[inline(always)]
fn each_tap<S: Simd, const N: usize>(simd: S, samples: &[f32]) -> [f32x16<S>; N] {
    let mut taps = [f32x16::splat(simd, 0.0); N];
    for tap in 0..N {
        taps[tap] = f32x16::from_slice(simd, &samples[tap..tap + WIDE]);
    }
    taps
}

/// Computes the weighted sum of `N` adjacent values, clamped to the range of the inner two if `deringing` is set.
#[inline(always)]
fn weigh<S: Simd, const N: usize>(_simd: S, weights: &[f32; N], deringing: bool, around: [f32x16<S>; N]) -> f32x16<S> {
    let mut sum = around[0] * weights[0];
    for tap in 1..N {
        sum += around[tap] * weights[tap];
    }
    if deringing {
        let (a, b) = (around[N / 2 - 1], around[N / 2]);
        sum = sum.max(a.min(b)).min(a.max(b));
    }
    sum
}

/// Interleaves the values of several phases and stores them.
#[inline(always)]
fn interleave<S: Simd>(_simd: S, phases: &[f32x16<S>], to: &mut [f32]) {
    match *phases {
        [a, b] => {
            let (first, second) = a.interleave(b);
            first.store_slice(&mut to[..WIDE]);
            second.store_slice(&mut to[WIDE..]);
        }
        [a, b, c, d] => {
            let ((ac, ac_end), (bd, bd_end)) = (a.interleave(c), b.interleave(d));
            let ((first, second), (third, fourth)) = (ac.interleave(bd), ac_end.interleave(bd_end));
            for (run, values) in [first, second, third, fourth].into_iter().enumerate() {
                values.store_slice(&mut to[run * WIDE..][..WIDE]);
            }
        }
        _ => {
            for (phase, values) in phases.iter().enumerate() {
                for (value, to) in values.to_array().into_iter().zip(to[phase..].iter_mut().step_by(phases.len())) {
                    *to = value;
                }
            }
        }
    }
}

impl<const N: usize> Pass for Linear<N> {
    type Row = LinearRow;

    const TAPS: usize = N;

    fn widen(&self, samples: &[Rgba8], row: &mut LinearRow) {
        self.read(samples, row);
        let width = self.columns.len();
        for channel in 0..row.channels() {
            let (samples, wide) = (&row.samples[channel], &mut row.wide[channel]);
            wide.resize(width.next_multiple_of(WIDE), 0.0);
            let wide = &mut wide[..width];
            let done = match self.period {
                (2, 1) => on_lanes!(self.lanes, simd => self.widen_runs::<_, 2>(simd, samples, wide)),
                (3, 1) => on_lanes!(self.lanes, simd => self.widen_runs::<_, 3>(simd, samples, wide)),
                (4, 1) => on_lanes!(self.lanes, simd => self.widen_runs::<_, 4>(simd, samples, wide)),
                _ => 0,
            };
            for (value, place) in wide.iter_mut().zip(&self.columns).skip(done) {
                let around = &samples[(place.cell + 1) as usize..][..N];
                *value = weigh_one(&self.weights[place.phase as usize], around, self.deringing);
            }
        }
    }

    fn mix(&self, around: &[&LinearRow], phases: &[u32], rows: &mut [Rgba8]) {
        let Some(around) = around.first_chunk::<N>() else { return };
        for (row, phase) in rows.chunks_exact_mut(self.columns.len()).zip(phases) {
            let weights = &self.weights[*phase as usize];
            let mix = RowMix::new(weights, around, self.deringing);
            on_lanes!(self.lanes, simd => mix.fill(simd, row));
        }
    }
}

/// Computes the weighted sum of `N` adjacent values for one pixel; see [`weigh`].
fn weigh_one<const N: usize>(weights: &[f32; N], around: &[f32], deringing: bool) -> f32 {
    let mut sum = weights[0] * around[0];
    for (weight, value) in weights.iter().zip(around).skip(1) {
        sum += weight * value;
    }
    if deringing {
        let (a, b) = (around[N / 2 - 1], around[N / 2]);
        sum = sum.max(a.min(b)).min(a.max(b));
    }
    sum
}

/// An output row, as the weighted sum of the surrounding widened rows.
#[derive(Clone, Copy)]
struct RowMix<'a, const N: usize> {
    weights: &'a [f32; N],
    around: &'a [&'a LinearRow; N],
    deringing: bool,
    /// Whether all surrounding rows are opaque.
    is_opaque: bool,
}

impl<'a, const N: usize> RowMix<'a, N> {
    fn new(weights: &'a [f32; N], around: &'a [&'a LinearRow; N], deringing: bool) -> Self {
        Self { weights, around, deringing, is_opaque: around.iter().all(|row| row.is_opaque) }
    }

    /// Computes the pixels of the row.
    #[inline(always)]
    fn fill<S: Simd>(self, simd: S, row: &mut [Rgba8]) {
        let (runs, rest) = row.as_chunks_mut::<WIDE>();
        let mut at = 0;
        for run in runs {
            let codes = self.codes(simd, at);
            codes.bitcast::<u8x64<S>>().store_slice(run.as_flattened_mut());
            at += WIDE;
        }
        if !rest.is_empty() {
            let mut run = [[0; 4]; WIDE];
            let codes = self.codes(simd, at);
            codes.bitcast::<u8x64<S>>().store_slice(run.as_flattened_mut());
            rest.copy_from_slice(&run[..rest.len()]);
        }
    }

    /// Computes 16 pixels from column `at` on in packed RGBA, with red in the lowest byte.
    #[inline(always)]
    fn codes<S: Simd>(self, simd: S, at: usize) -> u32x16<S> {
        let Self { weights, around, deringing, is_opaque } = self;
        let [red, green, blue] = each!(channel in [0, 1, 2] => {
            encode(simd, weigh(simd, weights, deringing, values(simd, around, channel, at)))
        });
        let color = (red & 255) | green << 8 | blue << 16;
        if is_opaque {
            return color | 0xff00_0000;
        }
        let alpha = weigh(simd, weights, deringing, alphas(simd, around, at));
        let alpha = whole(alpha.max(0.0).min(BELOW_ONE) * 255.0);
        (color & 0x00ff_ffff) | alpha << 24
    }
}

#[inline(always)]
fn values<S: Simd, const N: usize>(simd: S, around: &[&LinearRow; N], channel: usize, at: usize) -> [f32x16<S>; N] {
    let mut taps = [f32x16::splat(simd, 0.0); N];
    for tap in 0..N {
        taps[tap] = f32x16::from_slice(simd, &around[tap].wide[channel][at..at + WIDE]);
    }
    taps
}

/// Loads 16 alpha values from each of the surrounding rows. Opaque rows store no alpha and give 1.
#[inline(always)]
fn alphas<S: Simd, const N: usize>(simd: S, around: &[&LinearRow; N], at: usize) -> [f32x16<S>; N] {
    let mut taps = [f32x16::splat(simd, 1.0); N];
    for tap in 0..N {
        if !around[tap].is_opaque {
            taps[tap] = f32x16::from_slice(simd, &around[tap].wide[3][at..at + WIDE]);
        }
    }
    taps
}

/// Number of 8-bit steps per unit of linear light, in the linear part of the sRGB transfer function.
const PER_LIGHT: f32 = 255.0 * 12.92;

/// Linear light above which the sRGB transfer function is a power function.
const POWER_THRESHOLD: f32 = 0.003_130_8;

/// Largest float below 1. It encodes like 1, and all exponents remain negative.
const BELOW_ONE: f32 = 1.0_f32.next_down();

/// Biased float exponent of the octave that starts at 2⁻⁸. Smaller values use this octave, too.
const FIRST_OCTAVE: u32 = 119;

/// Sum of the biased exponents of a value and of the factor that scales it to [1, 2).
const EXPONENTS: u32 = 254;

/// 255 · 1.055 · 2^(5 e / 12) for octave e. The index is the lowest three bits of the exponent, so the order is −7 to
/// −1, then −8.
const OCTAVE_SCALE: [f32; 8] =
    [35.627_758, 47.557_35, 63.481_445, 84.737_564, 113.111_08, 150.985_18, 201.541_03, 26.690_66];

/// Minimax polynomial for m^(5/12) with m in [1, 2]: maximum error 1.1 · 10⁻⁵, and 7 · 10⁻⁴ for m down to 0.8.
const POWER: [f32; 5] = [0.411_229_34, 0.828_860_2, -0.318_287_25, 0.089_037_69, -0.010_829_55];

/// Offset subtracted from the power term, in 8-bit steps.
const OFFSET: f32 = 255.0 * 0.055;

/// 2²³: adding it to a float rounds the float to an integer, ties to even.
const WHOLE: f32 = (1 << 23) as f32;

/// Rounds small non-negative numbers to integers, which are returned in the low bytes.
#[inline(always)]
fn whole<S: Simd>(number: f32x16<S>) -> u32x16<S> {
    (number + WHOLE).bitcast()
}

/// Encodes linear light as the nearest 8-bit sRGB values, which are returned in the low bytes. The power is
/// approximated by a polynomial per octave; the error is below 1/50 of an 8-bit step.
///
/// The result is the smaller of the linear part and the power function: below the threshold the former is smaller,
/// above it the latter.
#[inline(always)]
fn encode<S: Simd>(simd: S, light: f32x16<S>) -> u32x16<S> {
    let light = light.max(0.0).min(BELOW_ONE);
    let from = light.max(POWER_THRESHOLD);
    let octave = (from.bitcast::<u32x16<S>>() >> 23).max(FIRST_OCTAVE);
    let m = from * ((u32x16::splat(simd, EXPONENTS) - octave) << 23).bitcast::<f32x16<S>>();
    let mut power = f32x16::splat(simd, POWER[4]);
    for degree in 0..4 {
        power = power * m + POWER[3 - degree];
    }
    whole((power * of_octave(simd, octave) - OFFSET).min(light * PER_LIGHT))
}

/// Looks up [`OCTAVE_SCALE`] for 16 biased exponents.
#[inline(always)]
fn of_octave<S: Simd>(simd: S, octave: u32x16<S>) -> f32x16<S> {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = simd.level().as_avx512() {
        let octave = u32x16::load_array(avx512, octave.to_array());
        let factors: f32x16<_> = x86::of_octave_wide(avx512, octave.into()).simd_into(avx512);
        return f32x16::load_array(simd, factors.to_array());
    }
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = simd.level().as_avx2() {
        let (low, high) = octave.split();
        let [low, high] = each!(octave in [low, high] => {
            let octave = u32x8::load_array(avx2, octave.to_array());
            let factors: f32x8<_> = x86::of_octave(avx2, octave.into()).simd_into(avx2);
            f32x8::load_array(simd, factors.to_array())
        });
        return low.combine(high);
    }
    let (octaves, mut factors) = (octave.to_array(), [0.0; WIDE]);
    for lane in 0..WIDE {
        factors[lane] = OCTAVE_SCALE[octaves[lane] as usize % OCTAVE_SCALE.len()];
    }
    f32x16::load_array(simd, factors)
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use fearless_simd::prelude::*;
    use fearless_simd::{f32x8, f32x16, kernel};

    use super::OCTAVE_SCALE;

    kernel! {
        /// Looks up [`OCTAVE_SCALE`] by the lowest four bits of each exponent.
        #[inline]
        pub(super) fn of_octave_wide(avx512: Avx512, octave: __m512i) -> __m512 {
            let [a, b, c, d, e, f, g, h] = OCTAVE_SCALE;
            let table = f32x16::load_array(avx512, [a, b, c, d, e, f, g, h, a, b, c, d, e, f, g, h]);
            _mm512_permutexvar_ps(octave, table.into())
        }
    }

    kernel! {
        /// Looks up [`OCTAVE_SCALE`] by the lowest three bits of each exponent.
        #[inline]
        pub(super) fn of_octave(avx2: Avx2, octave: __m256i) -> __m256 {
            _mm256_permutevar8x32_ps(f32x8::load_array(avx2, OCTAVE_SCALE).into(), octave)
        }
    }
}
