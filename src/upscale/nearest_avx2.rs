//! [`super::nearest`] on eight pixels at a time: they copy no more than eight neighbouring samples, which one instruction
//! deals out. Rows that look the same are copies of the first: memory takes one row after the other faster than several side by side.

use std::arch::x86_64::_mm256_permutevar8x32_epi32;

use fearless_simd::{Avx2, kernel};

use super::lanes::{Blocks, load_codes, load_words, store_codes, window};
use crate::image::Rgba8;

/// Pixels of a block, and samples that it may look at.
const BLOCK: usize = 8;

/// How the rows of a picture are filled.
pub(super) struct NearestAvx2<'a> {
    avx2: Avx2,
    /// The samples that pixels before, in and after whole blocks copy.
    head: &'a [u32],
    blocks: Vec<Deal>,
    tail: &'a [u32],
}

/// Which samples the pixels of a block copy.
struct Deal {
    /// The first of eight.
    start: usize,
    /// Which of them each pixel copies.
    places: [u32; BLOCK],
}

impl<'a> NearestAvx2<'a> {
    /// For rows whose pixels copy the samples in these `columns`, which grow by at most one from pixel to pixel; of `samples`,
    /// and with so many pixels before the first at an even address.
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

    /// Fills rows without a gap from one row of samples.
    pub(super) fn fill(&self, samples: &[Rgba8], rows: &mut [Rgba8]) {
        let width = self.head.len() + BLOCK * self.blocks.len() + self.tail.len();
        let (row, copies) = rows.split_at_mut(width);
        let (head, rest) = row.split_at_mut(self.head.len());
        copy(samples, self.head, head);
        let (blocks, tail) = rest.as_flattened_mut().as_chunks_mut();
        deal(self.avx2, samples, &self.blocks, blocks);
        copy(samples, self.tail, tail.as_chunks_mut().0);
        copies.chunks_exact_mut(width).for_each(|copy| copy.copy_from_slice(row));
    }
}

kernel! {
    /// Fills the blocks of a row.
    fn deal(avx2: Avx2, samples: &[Rgba8], deals: &[Deal], blocks: Blocks<'_>) {
        let bytes = samples.as_flattened();
        for (block, deal) in blocks.iter_mut().zip(deals) {
            let around = load_codes(avx2, window(bytes, 4 * deal.start));
            let pixels = _mm256_permutevar8x32_epi32(around, load_words(avx2, &deal.places));
            store_codes(avx2, pixels, block);
        }
    }
}

/// Pixel by pixel.
fn copy(samples: &[Rgba8], columns: &[u32], row: &mut [Rgba8]) {
    for (pixel, column) in row.iter_mut().zip(columns) {
        *pixel = samples[*column as usize];
    }
}
