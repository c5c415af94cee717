//! What is found about samples once, for all pixels that look at them.

use std::ops::Range;

use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::upscale::lattice::{Lattice, Place};

/// How many pixels of one phase, in neighbouring cells, are prepared together; they are made by [`WIDE`].
pub(super) const AHEAD: usize = 4 * WIDE;

/// Cells of a tile: what is known about the samples of so many stays in the nearest cache from row to row.
pub(super) const TILE: usize = 4 * AHEAD;

/// Samples that are repeated around the picture: more than the kernel reaches and one more for slopes, so that cells begin with
/// lines of the cache.
pub(super) const MARGIN: usize = WIDE;

/// What is known about a sample: four channels, slope across and down, straightness, luma.
const PLANES: usize = 8;

/// Where slope across, slope down and straightness stand among the planes.
const SLOPES: Range<usize> = 4..7;

/// Where luma does.
const LUMA: usize = 7;

/// Two lines of the cache. Planes of a row lie an odd number of such pairs apart, and so not at the same places of their pages, whose
/// lines drive each other out of the nearest cache.
const PAIR: usize = 2 * WIDE;

/// Values of a plane of a row of so many samples.
fn stride_of(samples: usize) -> usize {
    ((samples + 2 * MARGIN + AHEAD + WIDE).div_ceil(PAIR) | 1) * PAIR
}

/// Values from the start of a line of the cache on, in memory that is used again.
#[derive(Default)]
struct Values {
    memory: Vec<f32>,
    start: usize,
}

impl Values {
    /// At least so many.
    fn reserve(&mut self, count: usize) {
        /// As many values as a line of the cache has.
        const LINE: usize = 64 / size_of::<f32>();
        if self.memory.len() < count + LINE {
            self.memory = vec![0.0; count + LINE];
            self.start = self.memory.as_ptr().align_offset(64).min(LINE);
        }
    }

    #[inline(always)]
    fn row(&self, row: usize, stride: usize) -> &[f32] {
        &self.memory[self.start + row * stride..][..stride]
    }

    #[inline(always)]
    fn row_mut(&mut self, row: usize, stride: usize) -> &mut [f32] {
        &mut self.memory[self.start + row * stride..][..stride]
    }
}

/// Rows of samples, channel by channel, with a margin, and the slopes there.
#[derive(Default)]
pub(super) struct Source {
    /// Values of a plane of a row; a whole number of [`WIDE`].
    stride: usize,
    /// The sample row that the planes begin with; rows beyond the picture repeat its outermost.
    first_row: i32,
    /// Row after row of all planes.
    planes: Values,
    /// Whether alpha is full everywhere, so that nobody need weigh it.
    pub(super) opaque: bool,
}

impl Source {
    /// These rows of samples, of a picture of at least one: from the one before the first cells to the third after the last, as
    /// four are looked at. Slopes are found in all of them but the first and the last.
    pub(super) fn read(&mut self, lanes: Lanes, drawn: &Image<Rgba8>, rows: Range<i32>) {
        self.stride = stride_of(drawn.width() as usize);
        self.first_row = rows.start;
        self.planes.reserve(self.stride * PLANES * rows.len());
        self.opaque = true;
        let last = drawn.height() as i32 - 1;
        for (at, row) in rows.clone().enumerate() {
            let samples = drawn.row(row.clamp(0, last) as u32);
            self.opaque &= samples.iter().fold(255, |least, sample| least & sample[3]) == 255;
            on_lanes!(lanes, simd => self.spread(simd, samples, at));
        }
        let width = drawn.width() as usize;
        for row in 1..rows.len() - 1 {
            on_lanes!(lanes, simd => self.find_slopes(simd, row, width));
        }
    }

    #[inline(always)]
    fn plane(&self, row: usize, plane: usize) -> &[f32] {
        self.planes.row(row * PLANES + plane, self.stride)
    }

    #[inline(always)]
    fn plane_mut(&mut self, row: usize, plane: usize) -> &mut [f32] {
        self.planes.row_mut(row * PLANES + plane, self.stride)
    }

    /// Puts a row of samples into the planes.
    #[inline(always)]
    fn spread<S: Simd>(&mut self, simd: S, samples: &[Rgba8], row: usize) {
        let end = MARGIN + samples.len();
        // Beyond this nobody looks.
        let last = end + AHEAD + WIDE;
        let luma = |[r, g, b, _]: Rgba8| 0.5 * (f32::from(r) + f32::from(b)) + f32::from(g);
        let (left, right) = (samples[0], samples[samples.len() - 1]);
        for plane in [0, 1, 2, 3, LUMA] {
            let value = |sample: Rgba8| if plane == LUMA { luma(sample) } else { f32::from(sample[plane]) };
            let values = self.plane_mut(row, plane);
            values[..MARGIN].fill(value(left));
            values[end..last].fill(value(right));
        }
        let (runs, rest) = samples.as_chunks::<WIDE>();
        let mut at = MARGIN;
        for run in runs {
            let words = words(simd, run);
            let [red, green, blue, alpha] = each!(channel in [0, 8, 16, 24] => float_of((words >> channel) & 255));
            let luma = (red + blue) * 0.5 + green;
            for (plane, values) in [(0, red), (1, green), (2, blue), (3, alpha), (LUMA, luma)] {
                values.store_slice(&mut self.plane_mut(row, plane)[at..at + WIDE]);
            }
            at += WIDE;
        }
        for sample in rest {
            for (channel, code) in sample.iter().enumerate() {
                self.plane_mut(row, channel)[at] = f32::from(*code);
            }
            self.plane_mut(row, LUMA)[at] = luma(*sample);
            at += 1;
        }
    }

    /// Finds the slopes of a row of the planes that has one above and one below, at so many samples and those beside them.
    #[inline(always)]
    fn find_slopes<S: Simd>(&mut self, simd: S, row: usize, samples: usize) {
        for at in (MARGIN - WIDE / 2..MARGIN + samples + 2).step_by(WIDE) {
            let [left, own, right] = each!(by in [0, 1, 2] => values(simd, self.plane(row, LUMA), at + by - 1));
            let [above, below] = each!(row in [row - 1, row + 1] => values(simd, self.plane(row, LUMA), at));
            let (across, along_x) = slopes(simd, left, own, right);
            let (down, along_y) = slopes(simd, above, own, below);
            for (plane, values) in SLOPES.zip([across, down, along_x + along_y]) {
                values.store_slice(&mut self.plane_mut(row, plane)[at..at + WIDE]);
            }
        }
    }

    /// Four rows of a channel, from the one before a cell's own on.
    #[inline(always)]
    pub(super) fn channel(&self, channel: usize, cell: i32) -> [&[f32]; 4] {
        let first = (cell - 1 - self.first_row) as usize;
        each!(below in [0, 1, 2, 3] => self.plane(first + below, channel))
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

/// [`super::slope`] in lanes.
#[inline(always)]
fn slopes<S: Simd>(simd: S, before: f32x16<S>, at: f32x16<S>, after: f32x16<S>) -> (f32x16<S>, f32x16<S>) {
    let zero = f32x16::splat(simd, 0.0);
    let slope = after - before;
    let steepest = (after - at).abs().max((at - before).abs());
    let straight = steepest.simd_gt(zero).select(slope.abs() / steepest, zero).min(f32x16::splat(simd, 1.0));
    (slope, straight * straight)
}

/// What the pixels of one row have in common: what is found once for both neighbours of a cell, or for all phases across. Of the
/// cells of one tile.
#[derive(Default)]
pub(super) struct RowOfCells {
    stride: usize,
    /// The first place in the rows of the source that anything is found for.
    from: usize,
    cell: Option<i32>,
    /// Of each channel the least and the greatest of the four samples at the corners of a cell, by its first sample; then slope
    /// across, slope down and straightness in this row of pixels, above and below each other mixed.
    rows: Values,
}

/// Where the greatest and the slopes stand among the rows, after the least.
const GREATEST: usize = 4;
const MIXED: usize = 8;

impl RowOfCells {
    /// Begins rows of a source.
    pub(super) fn prepare(&mut self, source: &Source) {
        self.stride = source.stride;
        self.rows.reserve(source.stride * (MIXED + SLOPES.len()));
    }

    /// Begins a tile with the cell after so many.
    pub(super) fn begin(&mut self, from: usize) {
        (self.from, self.cell) = (from, None);
    }

    /// The least and the greatest of a channel.
    #[inline(always)]
    pub(super) fn bounds(&self, channel: usize) -> [&[f32]; 2] {
        each!(row in [channel, GREATEST + channel] => self.rows.row(row, self.stride))
    }

    /// Slope across, slope down and straightness, in this order.
    #[inline(always)]
    pub(super) fn slopes(&self, which: usize) -> &[f32] {
        self.rows.row(MIXED + which, self.stride)
    }

    /// Finds what a row of pixels needs.
    #[inline(always)]
    pub(super) fn find<S: Simd>(&mut self, simd: S, source: &Source, lattice: Lattice, place: Place) {
        let range = self.from + MARGIN - WIDE..self.from + MARGIN + TILE + WIDE;
        let range = range.start..range.end.min(source.stride - WIDE);
        let below = place.phase as f32 / lattice.phases() as f32;
        for which in 0..SLOPES.len() {
            let [_, upper, lower, _] = source.channel(SLOPES.start + which, place.cell);
            let mixed = self.rows.row_mut(MIXED + which, source.stride);
            for at in range.clone().step_by(WIDE) {
                let (upper, lower) = (values(simd, upper, at), values(simd, lower, at));
                (upper * (1.0 - below) + lower * below).store_slice(&mut mixed[at..at + WIDE]);
            }
        }
        if self.cell == Some(place.cell) {
            return;
        }
        self.cell = Some(place.cell);
        let channels = if source.opaque { 3 } else { 4 };
        for channel in 0..channels {
            let [_, upper, lower, _] = source.channel(channel, place.cell);
            for at in range.clone().step_by(WIDE) {
                let (f, g) = (values(simd, upper, at), values(simd, upper, at + 1));
                let (j, k) = (values(simd, lower, at), values(simd, lower, at + 1));
                let (least, greatest) = (f.min(g).min(j.min(k)), f.max(g).max(j.max(k)));
                least.store_slice(&mut self.rows.row_mut(channel, source.stride)[at..at + WIDE]);
                greatest.store_slice(&mut self.rows.row_mut(GREATEST + channel, source.stride)[at..at + WIDE]);
            }
        }
    }
}

/// Sixteen values from place `at` of a row on.
#[inline(always)]
pub(super) fn values<S: Simd>(simd: S, row: &[f32], at: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &row[at..at + WIDE])
}
