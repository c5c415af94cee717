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

/// Channels, each with the next sample's: [`pair`].
const CHANNELS: usize = 4;

/// What else is known about a sample: slope across and down, straightness, luma.
const PLANES: usize = 4;

/// Where slope across, slope down and straightness stand among the planes.
const SLOPES: Range<usize> = 0..3;

/// Where luma does.
const LUMA: usize = 3;

/// Two lines of the cache. Planes of a row lie an odd number of such pairs apart, and so not at the same places of their pages, whose
/// lines drive each other out of the nearest cache.
const TWO_LINES: usize = 2 * WIDE;

/// Values of a plane of a row of so many samples.
fn stride_of(samples: usize) -> usize {
    ((samples + 2 * MARGIN + AHEAD + WIDE).div_ceil(TWO_LINES) | 1) * TWO_LINES
}

/// Values from the start of a line of the cache on, in memory that is used again.
#[derive(Default)]
struct Values<T> {
    memory: Vec<T>,
    start: usize,
}

impl<T: Copy + Default> Values<T> {
    /// At least so many.
    fn reserve(&mut self, count: usize) {
        let line = 64 / size_of::<T>();
        if self.memory.len() < count + line {
            self.memory = vec![T::default(); count + line];
            self.start = self.memory.as_ptr().align_offset(64).min(line);
        }
    }

    #[inline(always)]
    fn row(&self, row: usize, stride: usize) -> &[T] {
        &self.memory[self.start + row * stride..][..stride]
    }

    #[inline(always)]
    fn row_mut(&mut self, row: usize, stride: usize) -> &mut [T] {
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
    /// Row after row of all channels.
    channels: Values<u32>,
    /// Row after row of all planes.
    planes: Values<f32>,
    /// Whether alpha is full everywhere, so that nobody need weigh it.
    pub(super) opaque: bool,
}

impl Source {
    /// These rows of samples, of a picture of at least one: from the one before the first cells to the second after the last, as
    /// four are looked at. Slopes are found in all of them but the first and the last.
    pub(super) fn read(&mut self, lanes: Lanes, drawn: &Image<Rgba8>, rows: Range<i32>) {
        self.stride = stride_of(drawn.width() as usize);
        self.first_row = rows.start;
        self.channels.reserve(self.stride * CHANNELS * rows.len());
        self.planes.reserve(self.stride * PLANES * rows.len());
        self.opaque = true;
        let last = drawn.height() as i32 - 1;
        for (at, row) in rows.clone().enumerate() {
            let samples = drawn.row(row.clamp(0, last) as u32);
            self.opaque &= on_lanes!(lanes, simd => self.spread(simd, samples, at));
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

    #[inline(always)]
    fn channel_mut(&mut self, row: usize, channel: usize) -> &mut [u32] {
        self.channels.row_mut(row * CHANNELS + channel, self.stride)
    }

    /// Puts a row of samples into the channels and the planes, and says whether all are opaque.
    #[inline(always)]
    fn spread<S: Simd>(&mut self, simd: S, samples: &[Rgba8], row: usize) -> bool {
        let end = MARGIN + samples.len();
        // Beyond this nobody looks.
        let last = end + AHEAD + WIDE;
        let luma = |[r, g, b, _]: Rgba8| 0.5 * (f32::from(r) + f32::from(b)) + f32::from(g);
        let (left, right) = (samples[0], samples[samples.len() - 1]);
        for channel in 0..CHANNELS {
            let values = self.channel_mut(row, channel);
            values[..MARGIN].fill(pair(left[channel], left[channel]));
            values[end - 1..last].fill(pair(right[channel], right[channel]));
        }
        let lumas = self.plane_mut(row, LUMA);
        lumas[..MARGIN].fill(luma(left));
        lumas[end..last].fill(luma(right));
        let (mut at, mut rest) = (MARGIN, samples);
        let mut opaque = u32x16::splat(simd, u32::MAX);
        while let [run @ .., _] = rest
            && let Some(run) = run.first_chunk()
            && let Some(next) = rest[1..].first_chunk()
        {
            let (own, next) = (packed(simd, run), packed(simd, next));
            opaque &= own;
            let [red, green, blue, _] = each!(channel in [0, 1, 2, 3] => {
                let code = (own >> (8 * channel)) & 255;
                let pairs = code | ((next >> (8 * channel)) & 255) << 16;
                pairs.store_slice(&mut self.channel_mut(row, channel as usize)[at..at + WIDE]);
                float_of(code)
            });
            let luma = (red + blue) * 0.5 + green;
            luma.store_slice(&mut self.plane_mut(row, LUMA)[at..at + WIDE]);
            (at, rest) = (at + WIDE, &rest[WIDE..]);
        }
        for (index, sample) in rest.iter().enumerate() {
            let next = rest.get(index + 1).unwrap_or(sample);
            for channel in 0..CHANNELS {
                self.channel_mut(row, channel)[at + index] = pair(sample[channel], next[channel]);
            }
            self.plane_mut(row, LUMA)[at + index] = luma(*sample);
        }
        let full = u32x16::splat(simd, u32::MAX << 24);
        (opaque & full).simd_eq(full).all_true() && rest.iter().all(|sample| sample[3] == 255)
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

    /// Four rows of a channel, from the one before a cell's own on: a sample and the next, as [`pair`] has them.
    #[inline(always)]
    pub(super) fn channel(&self, channel: usize, cell: i32) -> [&[u32]; 4] {
        let first = (cell - 1 - self.first_row) as usize;
        each!(below in [0, 1, 2, 3] => self.channels.row((first + below) * CHANNELS + channel, self.stride))
    }

    /// Slopes, or how straight they run, in a cell's own row and the one below.
    #[inline(always)]
    fn slopes(&self, which: usize, cell: i32) -> [&[f32]; 2] {
        let first = (cell - self.first_row) as usize;
        each!(below in [0, 1] => self.plane(first + below, SLOPES.start + which))
    }
}

/// A sample's code and the next one's, as a product with two weights needs them.
fn pair(own: u8, next: u8) -> u32 {
    u32::from(own) | u32::from(next) << 16
}

/// Sixteen samples, each as its four codes, the first in the lowest byte.
#[inline(always)]
fn packed<S: Simd>(simd: S, samples: &[Rgba8; WIDE]) -> u32x16<S> {
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
    rows: Values<f32>,
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
            let [upper, lower] = source.slopes(which, place.cell);
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
                let [upper, lower] = each!(row in [upper, lower] => u32x16::from_slice(simd, &row[at..at + WIDE]));
                let (upper, lower) = (upper.bitcast::<u16x32<S>>(), lower.bitcast::<u16x32<S>>());
                let [least, greatest]: [u32x16<S>; 2] = [upper.min(lower).bitcast(), upper.max(lower).bitcast()];
                let least = float_of((least & 0xffff).min(least >> 16));
                let greatest = float_of((greatest & 0xffff).max(greatest >> 16));
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
