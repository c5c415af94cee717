//! Loads and stores of 256 bits, without pointers.

use std::arch::x86_64::{__m128i, __m256i};
use std::array;

use fearless_simd::prelude::*;
use fearless_simd::{Avx2, i16x16, u8x16, u8x32, u32x8};

use crate::image::Rgba8;

/// Sixteen values.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) fn load(avx2: Avx2, values: &[i16; 16]) -> __m256i {
    i16x16::load_array_ref(avx2, values).into()
}

/// Sixteen bytes.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) fn load_bytes(avx2: Avx2, bytes: &[u8; 16]) -> __m128i {
    u8x16::load_array_ref(avx2, bytes).into()
}

/// Thirty-two bytes.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) fn load_codes(avx2: Avx2, bytes: &[u8; 32]) -> __m256i {
    u8x32::load_array_ref(avx2, bytes).into()
}

/// Eight words.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) fn load_words(avx2: Avx2, words: &[u32; 8]) -> __m256i {
    u32x8::load_array_ref(avx2, words).into()
}

/// Writes sixteen values.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) fn store(avx2: Avx2, register: __m256i, values: &mut [i16; 16]) {
    i16x16::simd_from(avx2, register).store_array(values);
}

/// Writes thirty-two bytes.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) fn store_codes(avx2: Avx2, register: __m256i, codes: &mut [u8; 32]) {
    u8x32::simd_from(avx2, register).store_array(codes);
}

/// The `N` values from place `at` on. Panics if there are fewer.
#[inline(always)]
pub(super) fn window<const N: usize, T>(values: &[T], at: usize) -> &[T; N] {
    values.get(at..).and_then(<[T]>::first_chunk).unwrap_or_else(|| panic!("fewer than {N} values are left"))
}

/// Most rows that a kernel writes at once.
pub(super) const MAX_ROWS: usize = 4;

/// Pixels of a row, eight by eight.
pub(super) type Blocks<'a> = &'a mut [[u8; 32]];

/// Rows of a picture, at most [`MAX_ROWS`]: of each so many pixels at its head, whole blocks, and the bytes of what is left.
pub(super) struct SplitRows<'a> {
    pub(super) heads: [&'a mut [Rgba8]; MAX_ROWS],
    pub(super) blocks: [Blocks<'a>; MAX_ROWS],
    pub(super) tails: [&'a mut [u8]; MAX_ROWS],
}

impl<'a> SplitRows<'a> {
    /// Splits rows of `width` px without a gap between them.
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

/// The first `count` of some rows with as many blocks as the first has, the others with none: where that is known, no place in
/// them is checked.
#[inline(always)]
pub(super) fn of_one_length(mut rows: [Blocks<'_>; MAX_ROWS], count: usize) -> [Blocks<'_>; MAX_ROWS] {
    let blocks = rows[0].len();
    for (index, row) in rows.iter_mut().enumerate() {
        *row = &mut std::mem::take(row)[..if index < count { blocks } else { 0 }];
    }
    rows
}

/// How many pixels of a row lie before the first whose address is a multiple of 32 bytes; all if it has none. Stores that
/// cross from one cache line into the next take half as long again.
pub(super) fn pixels_to_alignment(row: &[Rgba8]) -> usize {
    row.as_ptr().align_offset(32).min(row.len())
}
