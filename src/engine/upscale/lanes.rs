//! 256-bit loads and stores without raw pointers.

use std::arch::x86_64::{__m128i, __m256i};
use std::array;

use fearless_simd::prelude::*;
use fearless_simd::{Avx2, i16x16, u8x16, u8x32, u32x8};

use crate::image::Rgba8;

/// Loads sixteen 16-bit values into a 256-bit register.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) fn load(avx2: Avx2, values: &[i16; 16]) -> __m256i {
    i16x16::load_array_ref(avx2, values).into()
}

/// Loads 16 bytes into a 128-bit register.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) fn load_bytes(avx2: Avx2, bytes: &[u8; 16]) -> __m128i {
    u8x16::load_array_ref(avx2, bytes).into()
}

/// Loads 32 bytes into a 256-bit register.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) fn load_codes(avx2: Avx2, bytes: &[u8; 32]) -> __m256i {
    u8x32::load_array_ref(avx2, bytes).into()
}

/// Loads eight 32-bit values into a 256-bit register.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) fn load_words(avx2: Avx2, words: &[u32; 8]) -> __m256i {
    u32x8::load_array_ref(avx2, words).into()
}

/// Stores a 256-bit register as sixteen 16-bit values.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) fn store(avx2: Avx2, register: __m256i, values: &mut [i16; 16]) {
    i16x16::simd_from(avx2, register).store_array(values);
}

/// Stores a 256-bit register as 32 bytes.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) fn store_codes(avx2: Avx2, register: __m256i, codes: &mut [u8; 32]) {
    u8x32::simd_from(avx2, register).store_array(codes);
}

/// Maximum number of rows that a kernel writes at once.
pub(super) const MAX_ROWS: usize = 4;

/// Pixels of an image row in blocks of eight, as bytes.
pub(super) type Blocks<'a> = &'a mut [[u8; 32]];

/// At most [`MAX_ROWS`] image rows, each split into head pixels, whole blocks and the remaining bytes.
pub(super) struct SplitRows<'a> {
    pub(super) heads: [&'a mut [Rgba8]; MAX_ROWS],
    pub(super) blocks: [Blocks<'a>; MAX_ROWS],
    pub(super) tails: [&'a mut [u8]; MAX_ROWS],
}

impl<'a> SplitRows<'a> {
    /// Splits contiguous rows of `width` px: each into `head` pixels, whole blocks and the remaining bytes.
    pub(super) fn new(rows: &'a mut [Rgba8], width: usize, head: usize) -> Self {
        let mut split = Self {
            heads: array::from_fn(|_| [].as_mut_slice()),
            blocks: array::from_fn(|_| [].as_mut_slice()),
            tails: array::from_fn(|_| [].as_mut_slice()),
        };
        for (index, row) in rows.chunks_exact_mut(width).enumerate() {
            let (head, rest) = row.split_at_mut(head);
            split.heads[index] = head;
            (split.blocks[index], split.tails[index]) = rest.as_flattened_mut().as_chunks_mut();
        }
        split
    }
}

/// Truncates each of the first `count` rows to the number of blocks in the first row, and empties the others. Known
/// equal lengths let the compiler remove bounds checks.
#[inline(always)]
pub(super) fn of_one_length(mut rows: [Blocks<'_>; MAX_ROWS], count: usize) -> [Blocks<'_>; MAX_ROWS] {
    let blocks = rows[0].len();
    for (index, row) in rows.iter_mut().enumerate() {
        *row = &mut std::mem::take(row)[..if index < count { blocks } else { 0 }];
    }
    rows
}

/// Returns the number of pixels before the first 32-byte-aligned address of a row, or the row length if there is no
/// such address. Stores that cross a cache line take 1.5 times as long.
pub(super) fn pixels_to_alignment(row: &[Rgba8]) -> usize {
    row.as_ptr().align_offset(32).min(row.len())
}
