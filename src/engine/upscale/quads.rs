//! Quads: the four numbers of a pixel, which lie together in memory, and their exchange with one vector per number.

use std::ops::Range;

use crate::math::lanes::*;

/// Colour in an upscaler's working space, and a fourth number: alpha of a sample as an 8-bit value, or the accumulated
/// weight of a pixel.
pub(super) type Quad = [f32; 4];

/// Transposes 16 quads into one vector per number.
#[inline(always)]
pub(super) fn columns<S: Simd>(simd: S, quads: &[Quad; WIDE]) -> [f32x16<S>; 4] {
    let numbers = quads.as_flattened();
    let [a, b, c, d] = each!(run in [0, 1, 2, 3] => f32x16::from_slice(simd, &numbers[run * WIDE..][..WIDE]));
    let ((wy, xz), (wy_end, xz_end)) = (a.deinterleave(b), c.deinterleave(d));
    let ((w, y), (x, z)) = (wy.deinterleave(wy_end), xz.deinterleave(xz_end));
    [w, x, y, z]
}

/// Stores one vector per number as 16 quads; the inverse of [`columns`].
#[inline(always)]
pub(super) fn store<S: Simd>([w, x, y, z]: [f32x16<S>; 4], quads: &mut [Quad; WIDE]) {
    let ((wy, wy_end), (xz, xz_end)) = (w.interleave(y), x.interleave(z));
    let ((a, b), (c, d)) = (wy.interleave(xz), wy_end.interleave(xz_end));
    let numbers = quads.as_flattened_mut();
    for (run, quads) in [a, b, c, d].into_iter().enumerate() {
        quads.store_slice(&mut numbers[run * WIDE..][..WIDE]);
    }
}

/// Returns a range that starts at the same index and contains whole vectors of four quads; at most three quads more.
#[inline(always)]
pub(super) fn whole_vectors(range: &Range<usize>) -> Range<usize> {
    range.start..range.start + range.len().next_multiple_of(4)
}

/// Combination of three numbers that stand in the same place of three runs of quads.
#[derive(Clone, Copy, Debug)]
pub(super) enum Combination {
    /// Sum with these weights.
    Weighted([f32; 3]),
    Sum,
    SumOfSquares,
    Least,
    Greatest,
}

/// Combines the numbers of three runs of quads. All must have the length of `to`, a multiple of four.
#[inline(always)]
pub(super) fn combine<S: Simd>(simd: S, runs: [&[Quad]; 3], to: &mut [Quad], by: Combination) {
    // One loop for each, with a closure that is compiled for the instruction set.
    match by {
        Combination::Weighted([u, v, w]) => combine_by(
            simd,
            runs,
            to,
            #[inline(always)]
            |a, b, c| a * u + b * v + c * w,
        ),
        Combination::Sum => combine_by(
            simd,
            runs,
            to,
            #[inline(always)]
            |a, b, c| a + b + c,
        ),
        Combination::SumOfSquares => combine_by(
            simd,
            runs,
            to,
            #[inline(always)]
            |a, b, c| a * a + b * b + c * c,
        ),
        Combination::Least => combine_by(
            simd,
            runs,
            to,
            #[inline(always)]
            |a, b, c| a.min(b).min(c),
        ),
        Combination::Greatest => combine_by(
            simd,
            runs,
            to,
            #[inline(always)]
            |a, b, c| a.max(b).max(c),
        ),
    }
}

#[inline(always)]
fn combine_by<S: Simd>(
    simd: S,
    [first, second, third]: [&[Quad]; 3],
    to: &mut [Quad],
    of: impl Fn(f32x16<S>, f32x16<S>, f32x16<S>) -> f32x16<S>,
) {
    let runs = first.as_chunks::<4>().0.iter().zip(second.as_chunks::<4>().0).zip(third.as_chunks::<4>().0);
    for (to, ((first, second), third)) in to.as_chunks_mut::<4>().0.iter_mut().zip(runs) {
        let [first, second, third] =
            each!(four in [first, second, third] => f32x16::from_slice(simd, four.as_flattened()));
        of(first, second, third).store_slice(to.as_flattened_mut());
    }
}

/// Returns the runs of quads that start one quad before a range, at it, and one quad behind its start.
pub(super) fn around<'a>(row: &'a [Quad], range: &Range<usize>) -> [&'a [Quad]; 3] {
    [0, 1, 2].map(|by| &row[range.start + by - 1..range.end + by - 1])
}

/// Returns the `N` values from index `at` on.
///
/// # Panics
///
/// Panics if fewer than `N` values remain.
#[inline(always)]
pub(super) fn window<const N: usize, T>(values: &[T], at: usize) -> &[T; N] {
    values.get(at..).and_then(<[T]>::first_chunk).unwrap_or_else(|| panic!("fewer than {N} values remain"))
}
