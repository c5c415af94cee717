//! Horizontal pass for lattices with long periods: four output pixels at a time, each with its
//! own samples and weights.
//!
//! Products of mirrored positions change their sign after rounding, as in [`PhaseWeights`]. A position that coincides
//! with a sample needs no special case: samples are multiples of 2⁶, so half of a sum or a difference is exact.

use std::arch::x86_64::{
    __m256i, _mm256_add_epi16, _mm256_max_epi16, _mm256_min_epi16, _mm256_mulhrs_epi16, _mm256_setzero_si256,
    _mm256_sign_epi16, _mm256_sub_epi16,
};

use fearless_simd::Avx2;

use super::super::fixed::PhaseWeights;
use super::{BLOCK, Block, slot};
use crate::upscale::lanes::{load, store};

/// Samples and weights of all blocks in a period of the lattice.
pub(super) struct GatherTable<const H: usize> {
    blocks: Vec<[PixelTaps<H>; 2]>,
    /// Number of samples per period of blocks.
    samples: usize,
    /// Whether values are clamped to the range of the inner two samples.
    deringing: bool,
}

/// Samples and weights of the four output pixels in a register of a block.
struct PixelTaps<const H: usize> {
    /// Index of the first sample of each pixel, in the first period.
    first: [usize; 4],
    even: [[i16; 16]; H],
    odd: [[i16; 16]; H],
    /// −1 for the values of mirrored positions, otherwise 1.
    sign: [i16; 16],
}

impl<const H: usize> GatherTable<H> {
    /// Creates the table for a period of pixels, given by the cell and the weights of each. The period has `samples`
    /// samples.
    pub(super) fn new(period: &[(usize, &PhaseWeights<H>)], samples: usize, deringing: bool) -> Self {
        // A run of `BLOCK` periods has a whole number of blocks.
        let taps = |block: usize, register: usize| {
            let mut taps = PixelTaps { first: [0; 4], even: [[0; 16]; H], odd: [[0; 16]; H], sign: [0; 16] };
            for pixel in (0..BLOCK).filter(|pixel| slot(*pixel).1 == register) {
                let at = block * BLOCK + pixel;
                let (cell, weights) = period[at % period.len()];
                let (_, _, values) = slot(pixel);
                taps.first[values / 4] = cell + at / period.len() * samples;
                for k in 0..H {
                    taps.even[k][values..values + 4].fill(weights.even[k]);
                    taps.odd[k][values..values + 4].fill(weights.odd[k]);
                }
                taps.sign[values..values + 4].fill(if weights.mirrored { -1 } else { 1 });
            }
            taps
        };
        let blocks = (0..period.len()).map(|block| [taps(block, 0), taps(block, 1)]).collect();
        Self { blocks, samples: BLOCK * samples, deringing }
    }
}

/// Loads one sample of each of four pixels.
#[target_feature(enable = "avx2")]
#[inline]
fn gather(avx2: Avx2, padded: &[[i16; 4]], at: [usize; 4]) -> __m256i {
    let [a, b, c, d] = at.map(|at| padded[at]);
    let mut values = [0; 16];
    values[..4].copy_from_slice(&a);
    values[4..8].copy_from_slice(&b);
    values[8..12].copy_from_slice(&c);
    values[12..].copy_from_slice(&d);
    load(avx2, &values)
}

/// Interpolates the four pixels of a register. `period` is the index of the first sample of their period.
#[target_feature(enable = "avx2")]
#[inline]
fn pixels<const H: usize>(
    avx2: Avx2,
    padded: &[[i16; 4]],
    period: usize,
    taps: &PixelTaps<H>,
    deringing: bool,
) -> __m256i {
    let (mut sum, sign) = (_mm256_setzero_si256(), load(avx2, &taps.sign));
    let (mut before, mut after) = (sum, sum);
    let [a, b, c, d] = taps.first;
    for k in 0..H {
        let from = period + k;
        before = gather(avx2, padded, [a + from, b + from, c + from, d + from]);
        let from = period + 2 * H - 1 - k;
        after = gather(avx2, padded, [a + from, b + from, c + from, d + from]);
        let even = _mm256_mulhrs_epi16(_mm256_add_epi16(before, after), load(avx2, &taps.even[k]));
        let odd = _mm256_mulhrs_epi16(_mm256_sub_epi16(before, after), load(avx2, &taps.odd[k]));
        sum = _mm256_add_epi16(sum, _mm256_add_epi16(even, _mm256_sign_epi16(odd, sign)));
    }
    if deringing {
        let (least, greatest) = (_mm256_min_epi16(before, after), _mm256_max_epi16(before, after));
        sum = _mm256_min_epi16(_mm256_max_epi16(sum, least), greatest);
    }
    sum
}

/// Widens padded samples to whole blocks.
#[target_feature(enable = "avx2")]
pub(super) fn widen<const H: usize>(avx2: Avx2, padded: &[i16], table: &GatherTable<H>, wide: &mut [Block]) {
    let (padded, _) = padded.as_chunks::<4>();
    for (period, blocks) in wide.chunks_mut(table.blocks.len()).enumerate() {
        for (block, taps) in blocks.iter_mut().zip(&table.blocks) {
            for (register, taps) in block.iter_mut().zip(taps) {
                store(avx2, pixels(avx2, padded, period * table.samples, taps, table.deringing), register);
            }
        }
    }
}
