//! [`super::nearest`] on eight pixels at a time: one look into the samples for all rows of a block, and nothing but stores.

use std::arch::x86_64::_mm256_permutevar8x32_epi32;
use std::array;

use fearless_simd::{Avx2, kernel};

use super::lanes::{load_codes, load_words, store_codes, window};
use super::nearest::{Copies, MAX_ROWS};
use crate::image::Rgba8;

/// Pixels of a block, and samples that it may look at.
const BLOCK: usize = 8;

/// Which samples eight neighbouring pixels copy.
struct Gather {
    /// The first of the eight samples that are loaded.
    start: u32,
    /// Which of them each pixel copies.
    index: [u32; BLOCK],
}

/// The copies for pictures of some width.
pub(super) struct CopiesAvx2<'a> {
    avx2: Avx2,
    /// The sample that each pixel of a row copies.
    columns: &'a [u32],
    blocks: Vec<Gather>,
}

impl<'a> CopiesAvx2<'a> {
    /// For rows whose pixels copy these `columns` of so many samples; nothing if there are too few to load eight.
    pub(super) fn new(avx2: Avx2, columns: &'a [u32], samples: u32) -> Option<Self> {
        let last_start = samples.checked_sub(BLOCK as u32)?;
        let gather = |of: &[u32; BLOCK]| {
            let start = of[0].min(last_start);
            Gather { start, index: of.map(|column| column - start) }
        };
        Some(Self { avx2, columns, blocks: columns.as_chunks().0.iter().map(gather).collect() })
    }
}

impl Copies for CopiesAvx2<'_> {
    fn copy(&self, samples: &[Rgba8], rows: &mut [Rgba8]) {
        copy(self.avx2, &self.blocks, self.columns, samples, rows);
    }
}

kernel! {
    /// Writes rows: blocks of eight pixels on lanes, the rest one by one.
    fn copy(avx2: Avx2, blocks: &[Gather], columns: &[u32], samples: &[Rgba8], rows: &mut [Rgba8]) {
        let width = columns.len();
        let mut heads: [&mut [[u8; 4 * BLOCK]]; MAX_ROWS] = array::from_fn(|_| [].as_mut_slice());
        let count = rows.len() / width;
        for (row, head) in rows.chunks_exact_mut(width).zip(&mut heads) {
            let (whole, rest) = row.split_at_mut(blocks.len() * BLOCK);
            for (pixel, column) in rest.iter_mut().zip(&columns[blocks.len() * BLOCK..]) {
                *pixel = samples[*column as usize];
            }
            *head = whole.as_flattened_mut().as_chunks_mut().0;
        }
        let samples = samples.as_flattened();
        match count {
            1 => copy_blocks::<1>(avx2, blocks, samples, heads),
            2 => copy_blocks::<2>(avx2, blocks, samples, heads),
            3 => copy_blocks::<3>(avx2, blocks, samples, heads),
            _ => copy_blocks::<4>(avx2, blocks, samples, heads),
        }
    }
}

/// Writes the blocks of `ROWS` rows.
#[target_feature(enable = "avx2")]
#[inline(never)]
fn copy_blocks<const ROWS: usize>(
    avx2: Avx2,
    blocks: &[Gather],
    samples: &[u8],
    rows: [&mut [[u8; 4 * BLOCK]]; MAX_ROWS],
) {
    let [row_0, row_1, row_2, row_3] = rows;
    for (at, block) in blocks.iter().enumerate() {
        let around = load_codes(avx2, window(samples, 4 * block.start as usize));
        let pixels = _mm256_permutevar8x32_epi32(around, load_words(avx2, &block.index));
        store_codes(avx2, pixels, &mut row_0[at]);
        if ROWS > 1 {
            store_codes(avx2, pixels, &mut row_1[at]);
        }
        if ROWS > 2 {
            store_codes(avx2, pixels, &mut row_2[at]);
        }
        if ROWS > 3 {
            store_codes(avx2, pixels, &mut row_3[at]);
        }
    }
}
