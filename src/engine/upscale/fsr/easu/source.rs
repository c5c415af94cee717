//! Data of each sample for EASU, such as slopes, computed once for all output pixels that read the sample.

use std::ops::Range;

use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::upscale::lattice::{Lattice, LatticePosition};
use crate::upscale::runs::{BEYOND, MARGIN};

/// Number of adjacent output pixels whose kernels are computed together. They are then filtered [`WIDE`] at a time.
pub(super) const AHEAD: usize = 4 * WIDE;

/// Number of channel planes per row. Each value of a plane packs two adjacent samples; see [`pair`].
const CHANNELS: usize = 4;

/// Number of float planes per row: horizontal slope, vertical slope, straightness and luma.
const PLANES: usize = 4;

/// Plane indices of horizontal slope, vertical slope and straightness.
const SLOPES: Range<usize> = 0..3;

/// Index of the luma plane.
const LUMA: usize = 3;

/// Size of two cache lines, in 4-byte values. The stride of a plane is an odd multiple of it, so that equal positions
/// of adjacent planes do not map to the same L1 cache set.
const TWO_LINES: usize = 2 * WIDE;

/// Returns the stride of a plane in values, for rows of `samples` samples.
fn stride_of(samples: usize) -> usize {
    ((samples + 2 * MARGIN + BEYOND + WIDE).div_ceil(TWO_LINES) | 1) * TWO_LINES
}

/// Reusable buffer whose values start at a cache-line boundary.
#[derive(Default)]
struct Values<T> {
    memory: Vec<T>,
    start: usize,
}

impl<T: Copy + Default> Values<T> {
    /// Makes room for at least `count` values.
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

/// Sample rows with a margin, split by channel, and their slopes.
#[derive(Default)]
pub(super) struct SourceRows {
    /// Number of values per row of each channel and each computed quantity, including padding; a multiple of [`WIDE`].
    stride: usize,
    /// Index of the first stored sample row. Rows outside the image repeat its first or last row.
    first_row: i32,
    /// Channel planes of all rows, in row order.
    channels: Values<u32>,
    /// Float planes of all rows, in row order: slopes, straightness and luma.
    planes: Values<f32>,
    /// Whether alpha is 255 in every sample, so that it needs no filtering.
    pub(super) opaque: bool,
}

impl SourceRows {
    /// Reads the sample rows `rows` of a non-empty image. They range from one row before the first cell to two rows
    /// after the last cell, because the kernel spans four rows. Computes slopes in all rows except the first and the
    /// last.
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

    /// Splits a row of samples into the channel planes and the luma plane. Returns whether all samples are opaque.
    #[inline(always)]
    fn spread<S: Simd>(&mut self, simd: S, samples: &[Rgba8], row: usize) -> bool {
        let end = MARGIN + samples.len();
        // Values beyond this index are never read.
        let last = end + BEYOND + WIDE;
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

    /// Computes slopes and straightness of the `samples` samples of a row and of some border samples. The rows above
    /// and below must be stored already.
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

    /// Returns the plane of a channel in four rows, starting one row above row `cell`. Each value packs two adjacent
    /// samples; see [`pair`].
    #[inline(always)]
    pub(super) fn channel(&self, channel: usize, cell: i32) -> [&[u32]; 4] {
        let first = (cell - 1 - self.first_row) as usize;
        each!(below in [0, 1, 2, 3] => self.channels.row((first + below) * CHANNELS + channel, self.stride))
    }

    /// Returns the plane of a slope or of straightness in row `cell` and in the row below; `which` is its index in
    /// [`SLOPES`].
    #[inline(always)]
    fn slopes(&self, which: usize, cell: i32) -> [&[f32]; 2] {
        let first = (cell - self.first_row) as usize;
        each!(below in [0, 1] => self.plane(first + below, SLOPES.start + which))
    }
}

/// Packs the values of one channel in two neighbouring samples as 16-bit halves, in the layout that the pairwise dot
/// product expects.
fn pair(own: u8, next: u8) -> u32 {
    u32::from(own) | u32::from(next) << 16
}

/// Loads 16 samples in packed RGBA, with red in the lowest byte.
#[inline(always)]
fn packed<S: Simd>(simd: S, samples: &[Rgba8; WIDE]) -> u32x16<S> {
    let mut words = [0; WIDE];
    for index in 0..WIDE {
        words[index] = u32::from_le_bytes(samples[index]);
    }
    u32x16::load_array(simd, words)
}

/// Computes slope and straightness of 16 samples; see [`super::slope`].
#[inline(always)]
fn slopes<S: Simd>(simd: S, before: f32x16<S>, at: f32x16<S>, after: f32x16<S>) -> (f32x16<S>, f32x16<S>) {
    let zero = f32x16::splat(simd, 0.0);
    let slope = after - before;
    let steepest = (after - at).abs().max((at - before).abs());
    let straight = steepest.simd_gt(zero).select(slope.abs() / steepest, zero).min(f32x16::splat(simd, 1.0));
    (slope, straight * straight)
}

/// Data shared by the pixels of one output row within a tile. All pixels of a cell share its bounds. The cells to the
/// left and right of a sample column share its interpolated slopes.
#[derive(Default)]
pub(super) struct CellRow {
    stride: usize,
    /// Indices of the cells of the tile in the rows, and of one more.
    range: Range<usize>,
    cell: Option<i32>,
    /// Per channel, the minimum and maximum of the four samples at the corners of each cell, indexed by the first of
    /// these samples. The last rows hold horizontal slope, vertical slope and straightness of each sample column,
    /// interpolated vertically for this output row.
    rows: Values<f32>,
}

/// Index of the first row of maxima, after the rows of minima; [`MIXED`] is the index of the first row of interpolated
/// slopes.
const GREATEST: usize = 4;
const MIXED: usize = 8;

impl CellRow {
    /// Allocates the rows, each as long as the rows of `source`.
    pub(super) fn prepare(&mut self, source: &SourceRows) {
        self.stride = source.stride;
        self.rows.reserve(source.stride * (MIXED + SLOPES.len()));
    }

    /// Starts a tile that reads these columns of the rows of [`SourceRows`].
    pub(super) fn begin(&mut self, range: Range<usize>) {
        (self.range, self.cell) = (range, None);
    }

    /// Returns the minimum and the maximum of a channel in each cell.
    #[inline(always)]
    pub(super) fn bounds(&self, channel: usize) -> [&[f32]; 2] {
        each!(row in [channel, GREATEST + channel] => self.rows.row(row, self.stride))
    }

    /// Returns the interpolated horizontal slope, vertical slope or straightness, for `which` = 0, 1 or 2.
    #[inline(always)]
    pub(super) fn slopes(&self, which: usize) -> &[f32] {
        self.rows.row(MIXED + which, self.stride)
    }

    /// Computes the data for an output row at vertical position `place`.
    #[inline(always)]
    pub(super) fn find<S: Simd>(&mut self, simd: S, source: &SourceRows, lattice: Lattice, place: LatticePosition) {
        let range = self.range.clone();
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

/// Loads 16 values of a row from index `at` on.
#[inline(always)]
pub(super) fn values<S: Simd>(simd: S, row: &[f32], at: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &row[at..at + WIDE])
}
