//! [`super::light`] on eight values at a time: two pixels.

use std::arch::x86_64::{
    __m256, __m256i, _mm256_add_ps, _mm256_castps_si256, _mm256_cvtps_epi32, _mm256_max_epi32, _mm256_max_ps,
    _mm256_min_ps, _mm256_mul_ps, _mm256_packus_epi16, _mm256_packus_epi32, _mm256_permutevar8x32_epi32,
    _mm256_permutevar8x32_ps, _mm256_set1_epi32, _mm256_set1_ps, _mm256_setr_epi32, _mm256_setzero_ps,
    _mm256_setzero_si256, _mm256_srli_epi32, _mm256_sub_ps,
};

use fearless_simd::prelude::*;
use fearless_simd::{Avx2, f32x8, kernel};

use super::light::{FIRST_OCTAVE, LEAST_OF_POWER, Light, MOST, OF_OCTAVE, OFFSET, PER_LIGHT, PER_OCTAVE, POWER};
use crate::image::Rgba8;
use crate::upscale::lanes::store_codes;

/// Pixels of a block: four registers of two.
const BLOCK: usize = 8;

kernel! {
    /// Makes the blocks of a row from widened rows around it, and says how many pixels they are.
    pub(super) fn blend(avx2: Avx2, weights: &[f32], around: &[&[f32]], deringing: bool, row: &mut [Rgba8]) -> usize {
        match (around.len(), deringing) {
            (2, false) => blocks::<2, false>(avx2, weights, around, row),
            (4, false) => blocks::<4, false>(avx2, weights, around, row),
            (6, false) => blocks::<6, false>(avx2, weights, around, row),
            (2, true) => blocks::<2, true>(avx2, weights, around, row),
            (4, true) => blocks::<4, true>(avx2, weights, around, row),
            (6, true) => blocks::<6, true>(avx2, weights, around, row),
            _ => 0,
        }
    }
}

kernel! {
    /// Widens a row of samples to every so many pixels, which are of one phase in neighbouring cells, and says how many
    /// of them.
    pub(super) fn widen(
        avx2: Avx2,
        weights: &[f32],
        samples: &[Light],
        deringing: bool,
        pixels: usize,
        wide: &mut [Light],
    ) -> usize {
        match (weights.len(), deringing) {
            (2, false) => pairs::<2, false>(avx2, weights, samples, pixels, wide),
            (4, false) => pairs::<4, false>(avx2, weights, samples, pixels, wide),
            (6, false) => pairs::<6, false>(avx2, weights, samples, pixels, wide),
            (2, true) => pairs::<2, true>(avx2, weights, samples, pixels, wide),
            (4, true) => pairs::<4, true>(avx2, weights, samples, pixels, wide),
            (6, true) => pairs::<6, true>(avx2, weights, samples, pixels, wide),
            _ => 0,
        }
    }
}

/// Two pixels at a time.
#[target_feature(enable = "avx2")]
#[inline]
fn pairs<const N: usize, const DERINGING: bool>(
    avx2: Avx2,
    weights: &[f32],
    samples: &[Light],
    pixels: usize,
    wide: &mut [Light],
) -> usize {
    let Some(weights) = weights.first_chunk::<N>() else { return 0 };
    let mut taps = [_mm256_setzero_ps(); N];
    for tap in 0..N {
        taps[tap] = _mm256_set1_ps(weights[tap]);
    }
    let mut done = 0;
    let around = samples.windows(N + 1).step_by(2);
    for (pair, around) in wide.chunks_mut(2 * pixels).zip(around) {
        if pair.len() <= pixels {
            break;
        }
        let mut sum = _mm256_mul_ps(taps[0], load_pair(avx2, around, 0));
        for tap in 1..N {
            sum = _mm256_add_ps(sum, _mm256_mul_ps(taps[tap], load_pair(avx2, around, tap)));
        }
        if DERINGING {
            sum = between(sum, load_pair(avx2, around, N / 2 - 1), load_pair(avx2, around, N / 2));
        }
        let (first, second) = f32x8::simd_from(avx2, sum).split();
        (pair[0], pair[pixels]) = (first.to_array(), second.to_array());
        done += 2;
    }
    done
}

/// A sample and the next one.
#[target_feature(enable = "avx2")]
#[inline]
fn load_pair(avx2: Avx2, samples: &[Light], at: usize) -> __m256 {
    f32x8::from_slice(avx2, samples[at..at + 2].as_flattened()).into()
}

/// The nearest to values from `a` to `b`, whichever are the greater.
#[target_feature(enable = "avx2")]
#[inline]
fn between(value: __m256, a: __m256, b: __m256) -> __m256 {
    _mm256_min_ps(_mm256_max_ps(value, _mm256_min_ps(a, b)), _mm256_max_ps(a, b))
}

#[target_feature(enable = "avx2")]
#[inline]
fn blocks<const N: usize, const DERINGING: bool>(
    avx2: Avx2,
    weights: &[f32],
    around: &[&[f32]],
    row: &mut [Rgba8],
) -> usize {
    let (Some(weights), Some(around)) = (weights.first_chunk::<N>(), around.first_chunk::<N>()) else { return 0 };
    let mut taps = [_mm256_setzero_ps(); N];
    let mut wide: [&[[f32; 4 * BLOCK]]; N] = [&[]; N];
    let blocks = row.as_flattened_mut().as_chunks_mut::<{ 4 * BLOCK }>().0;
    for tap in 0..N {
        taps[tap] = _mm256_set1_ps(weights[tap]);
        wide[tap] = &around[tap].as_chunks().0[..blocks.len()];
    }
    for (index, block) in blocks.iter_mut().enumerate() {
        let mut codes = [_mm256_setzero_si256(); 4];
        for (part, codes) in codes.iter_mut().enumerate() {
            let mut sum = _mm256_mul_ps(taps[0], load(avx2, &wide[0][index], part));
            for tap in 1..N {
                sum = _mm256_add_ps(sum, _mm256_mul_ps(taps[tap], load(avx2, &wide[tap][index], part)));
            }
            if DERINGING {
                let (a, b) = (load(avx2, &wide[N / 2 - 1][index], part), load(avx2, &wide[N / 2][index], part));
                sum = between(sum, a, b);
            }
            *codes = encode(avx2, sum);
        }
        let [a, b, c, d] = codes;
        // Two registers are packed half by half, so that pixels come in pairs of every other.
        let packed = _mm256_packus_epi16(_mm256_packus_epi32(a, b), _mm256_packus_epi32(c, d));
        let order = _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7);
        store_codes(avx2, _mm256_permutevar8x32_epi32(packed, order), block);
    }
    BLOCK * blocks.len()
}

/// Two pixels of a block.
#[target_feature(enable = "avx2")]
#[inline]
fn load(avx2: Avx2, block: &[f32; 4 * BLOCK], part: usize) -> __m256 {
    f32x8::load_array_ref(avx2, &block.as_chunks().0[part]).into()
}

/// The codes of two pixels, as words.
#[target_feature(enable = "avx2")]
#[inline]
fn encode(avx2: Avx2, light: __m256) -> __m256i {
    let [r, g, b, a] = PER_LIGHT;
    let light = _mm256_min_ps(_mm256_max_ps(light, _mm256_setzero_ps()), _mm256_set1_ps(MOST));
    let from = _mm256_max_ps(light, _mm256_set1_ps(LEAST_OF_POWER));
    let exponent = _mm256_srli_epi32::<23>(_mm256_castps_si256(from));
    let octave = _mm256_max_epi32(exponent, _mm256_set1_epi32(FIRST_OCTAVE as i32));
    let m = _mm256_mul_ps(from, _mm256_permutevar8x32_ps(f32x8::load_array(avx2, PER_OCTAVE).into(), octave));
    let mut power = _mm256_set1_ps(POWER[4]);
    for coefficient in [POWER[3], POWER[2], POWER[1], POWER[0]] {
        power = _mm256_add_ps(_mm256_mul_ps(power, m), _mm256_set1_ps(coefficient));
    }
    let of_octave = _mm256_permutevar8x32_ps(f32x8::load_array(avx2, OF_OCTAVE).into(), octave);
    let power = _mm256_sub_ps(_mm256_mul_ps(power, of_octave), _mm256_set1_ps(OFFSET));
    let line = _mm256_mul_ps(light, f32x8::load_array(avx2, [r, g, b, a, r, g, b, a]).into());
    _mm256_cvtps_epi32(_mm256_min_ps(power, line))
}
