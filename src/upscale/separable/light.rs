//! Interpolation of linear light by two to six samples along each axis, in 32-bit floats.
//!
//! Codes are decoded by a table; sums are rounded back to codes with an error below a fiftieth of a code. Products and sums
//! are taken one by one in the order written here, in lanes of sixteen values of one channel. Alpha is linear as it stands.

use fearless_simd::Level;

use super::cells::Pass;
use crate::image::Rgba8;
use crate::image::color::Tables;
use crate::math::lanes::*;
use crate::upscale::Scale;
use crate::upscale::lattice::Place;

/// The passes; `N` samples along each axis.
pub(super) struct Linear<const N: usize> {
    /// Weights at the phases of the lattice.
    weights: Vec<[f32; N]>,
    columns: Vec<Place>,
    /// Pixels from one to the next of the same phase, and samples.
    period: (usize, usize),
    decode: &'static [f32; 256],
    deringing: bool,
    lanes: Lanes,
}

/// A widened row channel by channel, and the samples that it was made of, those at the ends repeated.
#[derive(Default)]
pub(super) struct Row {
    samples: [Vec<f32>; 4],
    wide: [Vec<f32>; 4],
    /// Whether alpha is full everywhere, so that nobody need weigh it.
    is_opaque: bool,
}

impl Row {
    /// How many channels are weighed.
    fn channels(&self) -> usize {
        if self.is_opaque { 3 } else { 4 }
    }
}

/// The lanes of a level.
fn lanes_of(level: Level) -> Lanes {
    #[cfg(target_arch = "x86_64")]
    if let Some(lanes) = level.as_avx512().map(Lanes::Avx512).or(level.as_avx2().map(Lanes::Avx2)) {
        return lanes;
    }
    let _ = level;
    Lanes::baseline()
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
            lanes: lanes_of(level),
        }
    }

    /// Spreads samples over channels.
    fn read(&self, samples: &[Rgba8], row: &mut Row) {
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

    /// Widens a channel where pixels of one phase look at neighbouring samples, all phases together; says how many pixels.
    #[inline(always)]
    fn widen_runs<S: Simd, const PIXELS: usize>(&self, simd: S, samples: &[f32], wide: &mut [f32]) -> usize {
        let Some(columns) = self.columns.first_chunk::<PIXELS>() else { return 0 };
        let mut done = 0;
        // From the first of the samples around the cell on, past as many as were put before.
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

/// Sixteen values from each of `N` neighbouring samples on.
#[inline(always)]
fn each_tap<S: Simd, const N: usize>(simd: S, samples: &[f32]) -> [f32x16<S>; N] {
    let mut taps = [f32x16::splat(simd, 0.0); N];
    for tap in 0..N {
        taps[tap] = f32x16::from_slice(simd, &samples[tap..tap + WIDE]);
    }
    taps
}

/// Weighs `N` neighbouring values, and keeps the sum between the inner two if asked.
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

/// Writes values of some phases in turns.
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
    type Row = Row;

    const TAPS: usize = N;

    fn widen(&self, samples: &[Rgba8], row: &mut Row) {
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

    fn mix(&self, around: &[&Row], phases: &[u32], rows: &mut [Rgba8]) {
        let Some(around) = around.first_chunk::<N>() else { return };
        for (row, phase) in rows.chunks_exact_mut(self.columns.len()).zip(phases) {
            let weights = &self.weights[*phase as usize];
            on_lanes!(self.lanes, simd => blend(simd, weights, around, self.deringing, row));
        }
    }
}

/// [`weigh`] for one value.
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

/// A row from the widened rows around.
#[inline(always)]
fn blend<S: Simd, const N: usize>(simd: S, weights: &[f32; N], around: &[&Row; N], deringing: bool, row: &mut [Rgba8]) {
    let mut opaque = true;
    for of in around {
        opaque &= of.is_opaque;
    }
    let (runs, rest) = row.as_chunks_mut::<WIDE>();
    let mut at = 0;
    for run in runs {
        let codes = codes(simd, weights, around, (deringing, opaque), at);
        codes.bitcast::<u8x64<S>>().store_slice(run.as_flattened_mut());
        at += WIDE;
    }
    if !rest.is_empty() {
        let mut run = [[0; 4]; WIDE];
        let codes = codes(simd, weights, around, (deringing, opaque), at);
        codes.bitcast::<u8x64<S>>().store_slice(run.as_flattened_mut());
        rest.copy_from_slice(&run[..rest.len()]);
    }
}

/// Sixteen pixels from place `at` on, each as its four codes, the first in the lowest byte.
#[inline(always)]
fn codes<S: Simd, const N: usize>(
    simd: S,
    weights: &[f32; N],
    around: &[&Row; N],
    (deringing, opaque): (bool, bool),
    at: usize,
) -> u32x16<S> {
    let [red, green, blue] = each!(channel in [0, 1, 2] => {
        encode(simd, weigh(simd, weights, deringing, values(simd, around, channel, at)))
    });
    let color = (red & 255) | green << 8 | blue << 16;
    if opaque {
        return color | 0xff00_0000;
    }
    let alpha = weigh(simd, weights, deringing, alphas(simd, around, at));
    let alpha = whole(alpha.max(0.0).min(MOST) * 255.0);
    (color & 0x00ff_ffff) | alpha << 24
}

#[inline(always)]
fn values<S: Simd, const N: usize>(simd: S, around: &[&Row; N], channel: usize, at: usize) -> [f32x16<S>; N] {
    let mut taps = [f32x16::splat(simd, 0.0); N];
    for tap in 0..N {
        taps[tap] = f32x16::from_slice(simd, &around[tap].wide[channel][at..at + WIDE]);
    }
    taps
}

/// [`values`] of alpha, where some rows may be opaque and others not.
#[inline(always)]
fn alphas<S: Simd, const N: usize>(simd: S, around: &[&Row; N], at: usize) -> [f32x16<S>; N] {
    let mut taps = [f32x16::splat(simd, 1.0); N];
    for tap in 0..N {
        if !around[tap].is_opaque {
            taps[tap] = f32x16::from_slice(simd, &around[tap].wide[3][at..at + WIDE]);
        }
    }
    taps
}

/// Codes per unit of light at the dark end of sRGB.
const PER_LIGHT: f32 = 255.0 * 12.92;

/// Light from which codes are those of a power.
const LEAST_OF_POWER: f32 = 0.003_130_8;

/// The greatest light below one, which has its code, too: so that all exponents are negative.
const MOST: f32 = 1.0_f32.next_down();

/// Exponent, as floats keep it, of the octave of light that begins at 2⁻⁸. What lies below is taken with it.
const FIRST_OCTAVE: u32 = 119;

/// The exponents of an octave and of what makes numbers from 1 to 2 of it add up to this.
const EXPONENTS: u32 = 254;

/// 255 · 1.055 · 2^(5 e / 12) for octaves e from −7 to −1, then for −8: in the order of the last three bits of the exponent.
const OF_OCTAVE: [f32; 8] =
    [35.627_758, 47.557_35, 63.481_445, 84.737_564, 113.111_08, 150.985_18, 201.541_03, 26.690_66];

/// m^(5/12) for m from 1 to 2: the polynomial that is off by the least, 1.1 · 10⁻⁵; down to 0.8, 7 · 10⁻⁴.
const POWER: [f32; 5] = [0.411_229_34, 0.828_860_2, -0.318_287_25, 0.089_037_69, -0.010_829_55];

/// What the power is less.
const OFFSET: f32 = 255.0 * 0.055;

/// From here on floats are whole numbers, so that a sum rounds to one, to an even one of two that are as near.
const WHOLE: f32 = (1 << 23) as f32;

/// The whole numbers nearest to small ones, in the lower bytes.
#[inline(always)]
fn whole<S: Simd>(number: f32x16<S>) -> u32x16<S> {
    (number + WHOLE).bitcast()
}

/// The codes nearest to linear light, in the last bytes: the formula of sRGB, its power by a polynomial for each octave, within a
/// fiftieth of a code.
///
/// Up to where the power begins the straight line is the smaller of the two, and from there on the power is.
#[inline(always)]
fn encode<S: Simd>(simd: S, light: f32x16<S>) -> u32x16<S> {
    let light = light.max(0.0).min(MOST);
    let from = light.max(LEAST_OF_POWER);
    let octave = (from.bitcast::<u32x16<S>>() >> 23).max(FIRST_OCTAVE);
    let m = from * ((u32x16::splat(simd, EXPONENTS) - octave) << 23).bitcast::<f32x16<S>>();
    let mut power = f32x16::splat(simd, POWER[4]);
    for degree in 0..4 {
        power = power * m + POWER[3 - degree];
    }
    whole((power * of_octave(simd, octave) - OFFSET).min(light * PER_LIGHT))
}

/// [`OF_OCTAVE`] for sixteen exponents.
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
        factors[lane] = OF_OCTAVE[octaves[lane] as usize % OF_OCTAVE.len()];
    }
    f32x16::load_array(simd, factors)
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use fearless_simd::prelude::*;
    use fearless_simd::{f32x8, f32x16, kernel};

    use super::OF_OCTAVE;

    kernel! {
        /// The instruction looks at the last four bits.
        #[inline]
        pub(super) fn of_octave_wide(avx512: Avx512, octave: __m512i) -> __m512 {
            let [a, b, c, d, e, f, g, h] = OF_OCTAVE;
            let table = f32x16::load_array(avx512, [a, b, c, d, e, f, g, h, a, b, c, d, e, f, g, h]);
            _mm512_permutexvar_ps(octave, table.into())
        }
    }

    kernel! {
        /// The instruction looks at the last three bits.
        #[inline]
        pub(super) fn of_octave(avx2: Avx2, octave: __m256i) -> __m256 {
            _mm256_permutevar8x32_ps(f32x8::load_array(avx2, OF_OCTAVE).into(), octave)
        }
    }
}
