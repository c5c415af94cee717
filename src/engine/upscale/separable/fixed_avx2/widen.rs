//! Horizontal pass: widens rows of samples to the width of the image.

use std::arch::x86_64::{
    __m256i, _mm256_add_epi16, _mm256_permute2x128_si256, _mm256_setzero_si256, _mm256_sub_epi16,
    _mm256_unpackhi_epi64, _mm256_unpacklo_epi64,
};
use std::array;

use fearless_simd::{Avx2, kernel};

use super::super::fixed::PhaseWeights;
use super::cell::{CellWeights, First, TapPairs, dot, places, shape_of, spread, with_shape};
use super::gather::{self, GatherTable};
use super::{BLOCK, Block, GROUP, WINDOW, slot};
use crate::upscale::lanes::{MAX_ROWS, store};
use crate::upscale::quads::window;

/// Widens groups of samples by a factor of 2 or 4. All cells have the same arrangement of output positions.
#[target_feature(enable = "avx2")]
#[inline(never)]
fn widen_cells<const H: usize, const FIRST: u8, const PAIRS: usize, const MIDDLE: bool>(
    avx2: Avx2,
    padded: &[i16],
    weights: &CellWeights<H>,
    wide: &mut [Block],
) {
    let zero = _mm256_setzero_si256();
    let lead = if FIRST == First::None as u8 { 0 } else { 1 };
    let count = lead + 2 * PAIRS + usize::from(MIDDLE);
    for (group, blocks) in wide.chunks_exact_mut(count / 2).enumerate() {
        let around: &[i16; WINDOW] = window(padded, 4 * GROUP * group);
        let of = places::<H, FIRST, PAIRS, MIDDLE>(&TapPairs::group(avx2, around, 0), weights, zero);
        // `one` has the first two output positions of samples 0 and 2 of the group, one sample in each 128-bit half.
        // `next` has those of samples 1 and 3.
        let (one, next) = (_mm256_unpacklo_epi64(of[0], of[1]), _mm256_unpackhi_epi64(of[0], of[1]));
        if let [block] = blocks {
            store(avx2, one, &mut block[0]);
            store(avx2, next, &mut block[1]);
        } else if let [first, second] = blocks {
            let (one_on, next_on) = (_mm256_unpacklo_epi64(of[2], of[3]), _mm256_unpackhi_epi64(of[2], of[3]));
            store(avx2, _mm256_permute2x128_si256::<0x20>(one, next), &mut first[0]);
            store(avx2, _mm256_permute2x128_si256::<0x20>(one_on, next_on), &mut first[1]);
            store(avx2, _mm256_permute2x128_si256::<0x31>(one, next), &mut second[0]);
            store(avx2, _mm256_permute2x128_si256::<0x31>(one_on, next_on), &mut second[1]);
        }
    }
}

/// Returns the interpolated values at one position between samples.
#[target_feature(enable = "avx2")]
#[inline]
fn place<const H: usize>(phase: &PhaseWeights<H>, around: &TapPairs<H>, deringing: bool) -> __m256i {
    if phase.is_copy() {
        return around.inner.0;
    }
    let (even, odd) = (dot(&spread(phase.even), &around.sums), dot(&spread(phase.odd), &around.differences));
    let sum = if phase.mirrored { _mm256_sub_epi16(even, odd) } else { _mm256_add_epi16(even, odd) };
    around.keep(sum, _mm256_setzero_si256(), deringing)
}

/// Widens groups of samples for lattices with any period.
#[target_feature(enable = "avx2")]
fn widen_any<const H: usize>(avx2: Avx2, padded: &[i16], widening: &Widening<'_, H>, wide: &mut [Block]) {
    let Widening { period, samples_per_period, deringing } = *widening;
    let pixels_per_group = GROUP / samples_per_period * period.len();
    for group in 0..wide.len() * BLOCK / pixels_per_group {
        let around: &[i16; WINDOW] = window(padded, 4 * GROUP * group);
        for (index, (cell, phase)) in period.iter().enumerate() {
            let mut values = [0; 16];
            store(avx2, place(phase, &TapPairs::group(avx2, around, *cell), deringing), &mut values);
            for (repeat, of_sample) in values.chunks_exact(4 * samples_per_period).enumerate() {
                let (block, register, first) = slot(group * pixels_per_group + repeat * period.len() + index);
                wide[block][register][first..first + 4].copy_from_slice(&of_sample[..4]);
            }
        }
    }
}

/// Parameters for widening a row of samples.
pub(super) struct Widening<'a, const H: usize> {
    pub(super) period: &'a [(usize, &'a PhaseWeights<H>)],
    pub(super) samples_per_period: usize,
    pub(super) deringing: bool,
}

#[target_feature(enable = "avx2")]
fn widen<const H: usize>(avx2: Avx2, padded: &[i16], widening: &Widening<'_, H>, wide: &mut [Block]) {
    let Widening { period, samples_per_period, deringing } = *widening;
    let phases: [&PhaseWeights<H>; MAX_ROWS] = array::from_fn(|at| period[at.min(period.len() - 1)].1);
    let phases = &phases[..period.len()];
    match shape_of(phases).filter(|_| samples_per_period == 1 && matches!(period.len(), 2 | 4)) {
        Some(shape) => {
            let weights = CellWeights::new(phases, shape, deringing);
            with_shape!(shape, widen_cells::<H>(avx2, padded, &weights, wide));
        }
        None => widen_any(avx2, padded, widening, wide),
    }
}

kernel! {
    pub(super) fn gather_by_four(avx2: Avx2, padded: &[i16], table: &GatherTable<2>, wide: &mut [Block]) {
        gather::widen(avx2, padded, table, wide);
    }
}

kernel! {
    pub(super) fn gather_by_six(avx2: Avx2, padded: &[i16], table: &GatherTable<3>, wide: &mut [Block]) {
        gather::widen(avx2, padded, table, wide);
    }
}

kernel! {
    pub(super) fn widen_by_four(avx2: Avx2, padded: &[i16], widening: &Widening<'_, 2>, wide: &mut [Block]) {
        widen(avx2, padded, widening, wide);
    }
}

kernel! {
    pub(super) fn widen_by_six(avx2: Avx2, padded: &[i16], widening: &Widening<'_, 3>, wide: &mut [Block]) {
        widen(avx2, padded, widening, wide);
    }
}
