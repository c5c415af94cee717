//! What is found about samples once, for all pixels that look at them.

use std::ops::Range;

use super::slope;
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::upscale::lattice::{Lattice, Place};

/// How many pixels of one phase, in neighbouring cells, are prepared together; they are made by [`WIDE`].
pub(super) const AHEAD: usize = 4 * WIDE;

/// Cells of a tile: what is known about the samples of so many stays in the nearest cache from row to row.
pub(super) const TILE: usize = 4 * AHEAD;

/// Samples that are repeated around the picture: as far as the kernel reaches, and one more for slopes.
pub(super) const MARGIN: usize = 3;

/// What is known about a sample: four channels, slope across and down, straightness, luma.
const PLANES: usize = 8;

/// Where slope across, slope down and straightness stand among the planes.
const SLOPES: Range<usize> = 4..7;

/// Rows of samples, channel by channel, with a margin, and the slopes there.
pub(super) struct Source {
    /// Values of a row; a whole number of [`WIDE`].
    stride: usize,
    /// The sample row that the planes begin with; rows beyond the picture repeat its outermost.
    first_row: i32,
    planes: [Vec<f32>; PLANES],
    /// Whether alpha is full everywhere, so that nobody need weigh it.
    pub(super) opaque: bool,
}

impl Source {
    /// These rows of samples, of a picture of at least one: from the one before the first cells to the third after the last, as
    /// four are looked at. Slopes are found in all of them but the first and the last.
    pub(super) fn new(lanes: Lanes, drawn: &Image<Rgba8>, rows: Range<i32>) -> Self {
        let stride = (drawn.width() as usize + 2 * MARGIN + AHEAD + WIDE).next_multiple_of(WIDE);
        let planes = std::array::from_fn(|_| vec![0.0; stride * rows.len()]);
        let mut source = Self { stride, first_row: rows.start, planes, opaque: true };
        let last = drawn.height() as i32 - 1;
        for (at, row) in rows.clone().enumerate() {
            let samples = drawn.row(row.clamp(0, last) as u32);
            source.opaque &= samples.iter().all(|sample| sample[3] == 255);
            on_lanes!(lanes, simd => source.spread(simd, samples, at));
        }
        for row in 1..rows.len() - 1 {
            on_lanes!(lanes, simd => source.find_slopes(simd, row));
        }
        source
    }

    /// Puts a row of samples into the planes.
    #[inline(always)]
    fn spread<S: Simd>(&mut self, simd: S, samples: &[Rgba8], row: usize) {
        let of_row = row * self.stride..(row + 1) * self.stride;
        let end = MARGIN + samples.len();
        for channel in 0..4 {
            let plane = &mut self.planes[channel][of_row.clone()];
            plane[..MARGIN].fill(f32::from(samples[0][channel]));
            plane[end..].fill(f32::from(samples[samples.len() - 1][channel]));
            let (runs, rest) = samples.as_chunks::<WIDE>();
            let (wide, narrow) = plane[MARGIN..end].as_chunks_mut::<WIDE>();
            for (values, run) in wide.iter_mut().zip(runs) {
                let codes = (words(simd, run) >> (8 * channel as u32)) & 255;
                f32x16::float_from(codes).store_array(values);
            }
            for (value, sample) in narrow.iter_mut().zip(rest) {
                *value = f32::from(sample[channel]);
            }
        }
        let [red, green, blue, .., luma] = &mut self.planes;
        let [red, green, blue] = [red, green, blue].map(|plane| &plane[of_row.clone()]);
        for (((luma, r), g), b) in luma[of_row.clone()].iter_mut().zip(red).zip(green).zip(blue) {
            *luma = 0.5 * (r + b) + g;
        }
    }

    /// Finds the slopes of a row of the planes that has one above and one below.
    #[inline(always)]
    fn find_slopes<S: Simd>(&mut self, _simd: S, row: usize) {
        let (stride, inner) = (self.stride, self.stride - 2);
        let [.., across, down, straightness, luma] = &mut self.planes;
        let from = |row: usize, column: usize| &luma[row * stride + column..][..inner];
        let (left, own, right) = (from(row, 0), from(row, 1), from(row, 2));
        let (above, below) = (from(row - 1, 1), from(row + 1, 1));
        let [across, down, straightness] =
            [across, down, straightness].map(|plane| &mut plane[row * stride + 1..][..inner]);
        for at in 0..inner {
            let (dx, along_x) = slope(left[at], own[at], right[at]);
            let (dy, along_y) = slope(above[at], own[at], below[at]);
            (across[at], down[at], straightness[at]) = (dx, dy, along_x + along_y);
        }
    }

    /// Four rows of a channel, from the one before a cell's own on.
    #[inline(always)]
    pub(super) fn channel(&self, channel: usize, cell: i32) -> [&[f32]; 4] {
        let first = (cell - 1 - self.first_row) as usize;
        each!(below in [0, 1, 2, 3] => &self.planes[channel][(first + below) * self.stride..][..self.stride])
    }
}

/// Sixteen samples, each as its four codes, the first in the lowest byte.
#[inline(always)]
pub(super) fn words<S: Simd>(simd: S, samples: &[Rgba8; WIDE]) -> u32x16<S> {
    let mut words = [0; WIDE];
    for index in 0..WIDE {
        words[index] = u32::from_le_bytes(samples[index]);
    }
    u32x16::load_array(simd, words)
}

/// What the pixels of one row have in common: what is found once for both neighbours of a cell, or for all phases across. Of the
/// cells of one tile.
pub(super) struct RowOfCells {
    /// The first place in the rows of the source that anything is found for.
    from: usize,
    cell: Option<i32>,
    /// Of each channel the least and the greatest of the four samples at the corners of a cell, by its first sample.
    pub(super) least: [Vec<f32>; 4],
    pub(super) greatest: [Vec<f32>; 4],
    /// Slope across, slope down and straightness in this row of pixels, above and below each other mixed.
    pub(super) slopes: [Vec<f32>; 3],
}

impl RowOfCells {
    /// Of nothing yet.
    pub(super) fn new(source: &Source) -> Self {
        let row = || vec![0.0; source.stride];
        let [least, greatest] = [0, 1].map(|_| std::array::from_fn(|_| row()));
        Self { from: 0, cell: None, least, greatest, slopes: std::array::from_fn(|_| row()) }
    }

    /// Begins a tile with the cell after so many.
    pub(super) fn begin(&mut self, from: usize) {
        (self.from, self.cell) = (from, None);
    }

    /// Finds what a row of pixels needs.
    #[inline(always)]
    pub(super) fn find<S: Simd>(&mut self, simd: S, source: &Source, lattice: Lattice, place: Place) {
        // The last few are looked at by nobody, and have no right neighbours.
        let end = (self.from + TILE + AHEAD).min(source.stride - WIDE);
        let below = place.phase as f32 / lattice.phases() as f32;
        for (mixed, plane) in self.slopes.iter_mut().zip(SLOPES) {
            let [_, upper, lower, _] = source.channel(plane, place.cell);
            for at in (self.from..end).step_by(WIDE) {
                let (upper, lower) = (values(simd, upper, at), values(simd, lower, at));
                (upper * (1.0 - below) + lower * below).store_slice(&mut mixed[at..at + WIDE]);
            }
        }
        if self.cell == Some(place.cell) {
            return;
        }
        self.cell = Some(place.cell);
        for (channel, (least, greatest)) in self.least.iter_mut().zip(&mut self.greatest).enumerate() {
            let [_, upper, lower, _] = source.channel(channel, place.cell);
            for at in (self.from..end).step_by(WIDE) {
                let (f, g) = (values(simd, upper, at), values(simd, upper, at + 1));
                let (j, k) = (values(simd, lower, at), values(simd, lower, at + 1));
                f.min(g).min(j.min(k)).store_slice(&mut least[at..at + WIDE]);
                f.max(g).max(j.max(k)).store_slice(&mut greatest[at..at + WIDE]);
            }
        }
    }
}

/// Sixteen values from place `at` of a row on.
#[inline(always)]
pub(super) fn values<S: Simd>(simd: S, row: &[f32], at: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &row[at..at + WIDE])
}
