//! Edge detection, and rows and columns of edges as bits.

use std::ops::Range;

use rayon::prelude::*;

use crate::antialias::luma::{BLOCK, fill_luma};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;

/// Minimum luma difference of an edge, in 8-bit codes: 0.1 of the range.
const MIN_DIFFERENCE: i16 = 26;

/// Number of bits before the first pixel of a row or column, and after the last one. A line is followed over fewer.
pub(super) const MARGIN: usize = 64;

/// Number of rows and columns around the picture in which edges are found. The picture continues there with its border
/// pixels.
const AROUND: usize = 40;

/// Number of lumas before those of the bits of a row, and after them.
const LUMA_MARGIN: usize = 8;

/// Number of rows whose edges are found together.
const BAND: usize = 32;

/// A bit for every pixel of a picture with margins, row by row or column by column.
#[derive(Default)]
pub(super) struct BitRows {
    /// Number of words per row.
    words: usize,
    bits: Vec<u64>,
}

impl BitRows {
    /// Makes these rows of zeros for `width` × `height` px, unless they have that size already.
    fn resize(&mut self, width: usize, height: usize) {
        let (words, length) = (words_of(width), words_of(width) * (height + 2 * MARGIN));
        if (self.words, self.bits.len()) != (words, length) {
            *self = Self { words, bits: vec![0; length] };
        }
    }

    /// Returns row `y`, which may lie in the margin, as words. Bit [`MARGIN`] belongs to the first pixel.
    pub(super) fn row(&self, y: isize) -> &[u64] {
        &self.bits[y.wrapping_add_unsigned(MARGIN) as usize * self.words..][..self.words]
    }

    /// Returns the columns, numbered by their bits, with a bit in any of the given rows.
    pub(super) fn columns_in(&self, rows: Range<usize>) -> impl Iterator<Item = usize> {
        let mut columns = vec![0; self.words];
        for row in rows {
            for (columns, bits) in columns.iter_mut().zip(self.row(row as isize)) {
                *columns |= bits;
            }
        }
        columns.into_iter().enumerate().flat_map(|(word, bits)| {
            let lower = std::iter::successors(Some(bits), |bits| Some(bits & bits.wrapping_sub(1)));
            lower.take_while(|bits| *bits != 0).map(move |bits| word * 64 + bits.trailing_zeros() as usize)
        })
    }

    /// Returns whether bit `x` of row `y` is set.
    pub(super) fn has(&self, x: isize, y: isize) -> bool {
        let x = x as usize;
        self.row(y)[x / 64] >> (x % 64) & 1 != 0
    }

    /// Makes these the columns of `rows`, for a picture of `width` × `height` px.
    fn transpose(&mut self, rows: &Self, width: usize, height: usize) {
        self.resize(height, width);
        let count = self.words;
        self.bits.par_chunks_mut(64 * count).enumerate().for_each(|(word, columns)| {
            for (part, first) in (0..height + 2 * MARGIN).step_by(64).enumerate() {
                let mut block: [u64; 64] = std::array::from_fn(|row| {
                    rows.bits.get((first + row) * rows.words + word).copied().unwrap_or_default()
                });
                if block.iter().any(|row| *row != 0) {
                    transpose(&mut block);
                }
                for (column, bits) in columns.chunks_exact_mut(count).zip(block) {
                    column[part] = bits;
                }
            }
        });
    }
}

/// Returns the number of words of a row of `width` px with its margins.
pub(super) fn words_of(width: usize) -> usize {
    (width + 2 * MARGIN).div_ceil(64)
}

/// Transposes a matrix of 64 × 64 bits, by swapping halves of ever smaller blocks.
fn transpose(rows: &mut [u64; 64]) {
    let (mut size, mut mask) = (32, 0xffff_ffff_u64);
    while size > 0 {
        for row in (0..64).filter(|row| row & size == 0) {
            let swapped = (rows[row] >> size ^ rows[row + size]) & mask;
            rows[row] ^= swapped << size;
            rows[row + size] ^= swapped;
        }
        size /= 2;
        mask ^= mask << size;
    }
}

/// Edges above and to the left of every pixel, by rows and by columns.
#[derive(Default)]
pub(super) struct Edges {
    pub(super) top: BitRows,
    pub(super) left: BitRows,
    pub(super) top_columns: BitRows,
    pub(super) left_columns: BitRows,
}

impl Edges {
    /// Finds the edges of a picture.
    pub(super) fn find(&mut self, lanes: Lanes, picture: &Image<Rgba8>) {
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let Self { top, left, top_columns, left_columns } = self;
        top.resize(width, height);
        left.resize(width, height);
        let words = top.words;
        let skipped = (MARGIN - AROUND) * words;
        let used = (height + 2 * AROUND) * words;
        let bands = top.bits[skipped..][..used].par_chunks_mut(BAND * words);
        let bands = bands.zip(left.bits[skipped..][..used].par_chunks_mut(BAND * words)).enumerate();
        bands.for_each_init(Vec::new, |luma, (band, (top, left))| {
            let first = (band * BAND) as i64 - AROUND as i64;
            let rows = top.chunks_exact_mut(words).zip(left.chunks_exact_mut(words));
            on_lanes!(lanes, simd => find_in_band(simd, picture, first, luma, rows));
        });
        rayon::join(|| top_columns.transpose(top, width, height), || left_columns.transpose(left, width, height));
    }
}

/// Finds the edges of consecutive rows, of which the first is row `first` of the picture.
#[inline(always)]
fn find_in_band<'a, S: Simd>(
    simd: S,
    picture: &Image<Rgba8>,
    first: i64,
    luma: &mut Vec<i16>,
    rows: impl ExactSizeIterator<Item = (&'a mut [u64], &'a mut [u64])>,
) {
    let last = i64::from(picture.height()) - 1;
    let width = (picture.width() as usize + 2 * MARGIN).next_multiple_of(64);
    let stride = width + 2 * LUMA_MARGIN;
    luma.resize((rows.len() + 3) * stride, 0);
    for (row, y) in luma.chunks_exact_mut(stride).zip(first - 2..) {
        fill_luma(simd, picture.row(y.clamp(0, last) as u32), LUMA_MARGIN + MARGIN, row);
    }
    for (index, (top, left)) in rows.enumerate() {
        let own = (index + 2) * stride + LUMA_MARGIN;
        for word in 0..top.len() {
            let halves = each!(half in [0, BLOCK] => edges_of_block(simd, luma, own + word * 64 + half, stride));
            let bits = |which: usize| u64::from(halves[0][which]) | u64::from(halves[1][which]) << BLOCK;
            (top[word], left[word]) = (bits(0), bits(1));
        }
    }
}

/// Finds the edges above and to the left of [`BLOCK`] pixels, as bits. An edge is dropped if a neighbouring difference is
/// more than twice as large, because that edge is the visible one.
#[inline(always)]
fn edges_of_block<S: Simd>(simd: S, luma: &[i16], at: usize, stride: usize) -> [u32; 2] {
    let row = |from: usize| i16x32::from_slice(simd, &luma[from..from + BLOCK]);
    let own = row(at);
    let (above, before) = (row(at - stride), row(at - 1));
    let (top, left) = ((own - above).abs(), (own - before).abs());
    let is_edge = top.max(left).simd_ge(MIN_DIFFERENCE);
    if !is_edge.any_true() {
        return [0; 2];
    }
    let (bottom, right) = ((own - row(at + stride)).abs(), (own - row(at + 1)).abs());
    let (top_of_above, left_of_before) = ((above - row(at - 2 * stride)).abs(), (before - row(at - 2)).abs());
    let most = top.max(left).max(bottom.max(right)).max(top_of_above.max(left_of_before));
    each!(difference in [top, left] => {
        (difference.simd_ge(MIN_DIFFERENCE) & (difference * 2).simd_ge(most)).to_bitmask() as u32
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transposing_exchanges_rows_and_columns() {
        let mut random = fastrand::Rng::with_seed(2);
        let rows: [u64; 64] = std::array::from_fn(|_| random.u64(..));
        let mut columns = rows;
        transpose(&mut columns);
        for (row, column) in (0..64).flat_map(|row| (0..64).map(move |column| (row, column))) {
            assert_eq!(rows[row] >> column & 1, columns[column] >> row & 1, "{row} {column}");
        }
    }
}
