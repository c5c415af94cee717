//! AVX2 version of [`super::nearest`], eight pixels at a time. Eight pixels copy at most eight adjacent samples, so a
//! single permutation suffices.
//!
//! Identical rows can be produced in two ways: store each computed block to all of them, or compute one row and copy
//! it. Two rows are copied and more are stored together. At ×4, storing together takes two thirds as long as copying on
//! an AMD processor (Zen 3), but 1.1 times as long on an Intel processor (Emerald Rapids). At ×2, copying takes three
//! quarters as long as storing together on the Intel processor, but 1.1 times as long on the AMD processor.

use std::arch::x86_64::_mm256_permutevar8x32_epi32;

use fearless_simd::{Avx2, kernel};

use super::lanes::{Blocks, MAX_ROWS, SplitRows, load_codes, load_words, of_one_length, store_codes};
use super::quads::window;
use crate::image::Rgba8;

/// Number of pixels in a block, and maximum number of samples that a block reads.
const BLOCK: usize = 8;

/// Precomputed permutations that widen rows of samples to rows of pixels.
pub(super) struct NearestAvx2<'a> {
    avx2: Avx2,
    /// Sample index of each pixel before the first block. `blocks` holds the permutations of the blocks, and `tail` the
    /// sample index of each pixel after them.
    head: &'a [u32],
    blocks: Vec<Deal>,
    tail: &'a [u32],
}

/// Permutation that copies samples to the pixels of a block.
struct Deal {
    /// Index of the first of the eight samples that the block reads.
    start: usize,
    /// Index of the sample of each pixel, counted from `start`.
    places: [u32; BLOCK],
}

impl<'a> NearestAvx2<'a> {
    /// Prepares the permutations that fill rows. `columns` holds the sample index of each pixel. Each index is less
    /// than `samples`, and indices increase by at most one from pixel to pixel. `pixels_to_alignment` is the number of
    /// pixels before the first aligned address of a row.
    pub(super) fn new(avx2: Avx2, columns: &'a [u32], samples: usize, pixels_to_alignment: usize) -> Self {
        let head = if samples < BLOCK { columns.len() } else { pixels_to_alignment.min(columns.len()) };
        let (head, rest) = columns.split_at(head);
        let (blocks, tail) = rest.as_chunks();
        let deal = |columns: &[u32; BLOCK]| {
            let start = columns[0].min((samples - BLOCK) as u32);
            Deal { start: start as usize, places: columns.map(|column| column - start) }
        };
        Self { avx2, head, blocks: blocks.iter().map(deal).collect(), tail }
    }

    /// Fills contiguous identical pixel rows from one row of samples.
    pub(super) fn fill(&self, samples: &[Rgba8], rows: &mut [Rgba8]) {
        let width = self.head.len() + BLOCK * self.blocks.len() + self.tail.len();
        for rows in rows.chunks_mut(MAX_ROWS * width) {
            let (rows, second) = rows.split_at_mut(if rows.len() == 2 * width { width } else { rows.len() });
            let count = rows.len() / width;
            let SplitRows { heads, blocks, tails } = SplitRows::new(&mut *rows, width, self.head.len());
            for (head, tail) in heads.into_iter().zip(tails) {
                copy(samples, self.head, head);
                copy(samples, self.tail, tail.as_chunks_mut().0);
            }
            deal(self.avx2, samples, &self.blocks, count, blocks);
            second.copy_from_slice(&rows[..second.len()]);
        }
    }
}

kernel! {
    /// Fills the blocks of the first `count` rows, which must be 1, 3 or 4.
    fn deal(avx2: Avx2, samples: &[Rgba8], deals: &[Deal], count: usize, rows: [Blocks<'_>; MAX_ROWS]) {
        match count {
            1 => deal_to::<1>(avx2, samples, deals, rows),
            3 => deal_to::<3>(avx2, samples, deals, rows),
            _ => deal_to::<4>(avx2, samples, deals, rows),
        }
    }
}

/// Fills the blocks of the first `ROWS` rows, which must be 1, 3 or 4.
#[target_feature(enable = "avx2")]
fn deal_to<const ROWS: usize>(avx2: Avx2, samples: &[Rgba8], deals: &[Deal], rows: [Blocks<'_>; MAX_ROWS]) {
    let bytes = samples.as_flattened();
    let [first, second, third, fourth] = of_one_length(rows, ROWS);
    let deals = &deals[..first.len()];
    for (block, deal) in deals.iter().enumerate() {
        let around = load_codes(avx2, window(bytes, 4 * deal.start));
        let pixels = _mm256_permutevar8x32_epi32(around, load_words(avx2, &deal.places));
        store_codes(avx2, pixels, &mut first[block]);
        if ROWS > 1 {
            store_codes(avx2, pixels, &mut second[block]);
            store_codes(avx2, pixels, &mut third[block]);
        }
        if ROWS > 3 {
            store_codes(avx2, pixels, &mut fourth[block]);
        }
    }
}

/// Copies samples pixel by pixel.
fn copy(samples: &[Rgba8], columns: &[u32], row: &mut [Rgba8]) {
    for (pixel, column) in row.iter_mut().zip(columns) {
        *pixel = samples[*column as usize];
    }
}
