//! [`super::nearest`] on eight pixels at a time: they copy no more than eight neighbouring samples, which one instruction
//! deals out.

use std::arch::x86_64::{_mm256_permutevar8x32_epi32, _mm256_set1_epi32, _mm256_sub_epi32};

use fearless_simd::kernel;

use super::lanes::{load_codes, load_words, pixels_to_alignment, store_codes, window};
use crate::image::Rgba8;

/// Pixels of a block, and samples that it may look at.
const BLOCK: usize = 8;

kernel! {
    /// Fills a row whose pixels copy the samples in these `columns`, which grow by at most one from pixel to pixel.
    pub(super) fn widen(avx2: Avx2, samples: &[Rgba8], columns: &[u32], row: &mut [Rgba8]) {
        let Some(last_start) = samples.len().checked_sub(BLOCK) else {
            copy(samples, columns, row);
            return;
        };
        let (columns_of_head, columns) = columns.split_at(pixels_to_alignment(row));
        let (head, row) = row.split_at_mut(columns_of_head.len());
        copy(samples, columns_of_head, head);
        let (blocks, tail) = row.as_flattened_mut().as_chunks_mut::<{ 4 * BLOCK }>();
        let (columns, columns_of_tail) = columns.as_chunks::<BLOCK>();
        let bytes = samples.as_flattened();
        for (block, columns) in blocks.iter_mut().zip(columns) {
            let start = (columns[0] as usize).min(last_start);
            let around = load_codes(avx2, window(bytes, 4 * start));
            let places = _mm256_sub_epi32(load_words(avx2, columns), _mm256_set1_epi32(start as i32));
            store_codes(avx2, _mm256_permutevar8x32_epi32(around, places), block);
        }
        copy(samples, columns_of_tail, tail.as_chunks_mut().0);
    }
}

/// Pixel by pixel.
fn copy(samples: &[Rgba8], columns: &[u32], row: &mut [Rgba8]) {
    for (pixel, column) in row.iter_mut().zip(columns) {
        *pixel = samples[*column as usize];
    }
}
