//! Quads: the four numbers of a pixel, which lie together in memory, and their exchange with one vector per number.

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

/// Returns a number of every column, and that of the last column [`WIDE`] more times, so that a vector can be loaded from
/// every column.
pub(super) fn with_spare<T, N: Clone>(columns: &[T], number: impl Fn(&T) -> N) -> Vec<N> {
    let spare = columns.last().into_iter().cycle().take(WIDE);
    columns.iter().chain(spare).map(number).collect()
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
