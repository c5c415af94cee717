//! Queue of samples that wait for their texels.

use std::ops::Range;

use super::gather::Taps;
use super::layout::BLOCK;
use super::mipmap::{CoarseTaps, LevelTapsMut};
use super::patch::{ALL, Patch};
use super::target::ColorRows;
use crate::math::lanes::*;

/// Queue of pairs of sample rows that wait for their texels. The indices of all texels are computed before the first
/// texel is read, so that cache misses overlap.
#[derive(Clone, Debug, Default)]
pub(super) struct Queue {
    pub(super) pairs: [QueuedPair; QUEUED],
    /// Texture taps of each pair.
    pub(super) taps: [Taps; QUEUED],
    /// Texture taps of each pair in the coarser mip level. Allocated only in frames with mip-mapping.
    pub(super) coarse: Vec<CoarseTaps>,
    /// Number of texels read from coarser mip levels since the caller last reset it.
    pub(super) coarse_texels: u64,
    pub(super) len: usize,
    /// Index, in the frame's list of shaders, of the shader that all queued rows use.
    pub(super) shader: usize,
}

impl Queue {
    /// Returns the memory use in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of::<Self>() + self.coarse.capacity() * size_of::<CoarseTaps>()
    }

    /// Returns `true` if the queue must be flushed before `pairs` pairs of rows of a shader are added: it is full or
    /// holds rows of another shader.
    #[inline(always)]
    pub(super) fn is_full(&self, shader: usize, pairs: usize) -> bool {
        self.shader != shader || self.len + pairs > QUEUED
    }

    /// Reserves space for `pairs` pairs of rows.
    #[inline(always)]
    pub(super) fn reserve(&mut self, pairs: usize, mipmapped: bool) -> Reserved<'_> {
        let from = self.len;
        self.len += pairs;
        let coarse: &mut [_] = if mipmapped {
            self.coarse.resize_with(QUEUED, CoarseTaps::default);
            &mut self.coarse[from..self.len]
        } else {
            &mut []
        };
        Reserved { pairs: &mut self.pairs[from..self.len], taps: &mut self.taps[from..self.len], coarse }
    }
}

/// Capacity in pairs of rows: four blocks, so that texels have arrived in the cache when the first of them is read.
const QUEUED: usize = 4 * BLOCK / 2;

/// Pairs of rows in the queue, to be filled.
pub(super) struct Reserved<'q> {
    pub(super) pairs: &'q mut [QueuedPair],
    /// Texture taps of each pair.
    pub(super) taps: &'q mut [Taps],
    /// Texture taps of each pair in the coarser mip level; empty without mip-mapping.
    pub(super) coarse: &'q mut [CoarseTaps],
}

/// Pair of rows in the queue, to be filled.
pub(super) struct ReservedPair<'q> {
    pub(super) pair: &'q mut QueuedPair,
    pub(super) taps: LevelTapsMut<'q>,
}

/// Pairs of rows in the queue whose texture taps are known.
#[derive(Clone, Copy)]
pub(super) struct FilledRows<'q> {
    pub(super) pairs: &'q [QueuedPair],
    /// Texture taps of each pair.
    pub(super) taps: &'q [Taps],
    /// Texture taps of each pair in the coarser mip level; empty without mip-mapping.
    pub(super) coarse: &'q [CoarseTaps],
}

/// Interpolated attributes of eight samples in each of two rows.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
pub(super) struct QueuedPair {
    pub(super) light: [f32; WIDE],
    /// Surface colour before it is multiplied by the texture, by channel. Only valid if the mesh has vertex colours.
    pub(super) color: [[f32; WIDE]; 3],
    pub(super) rows: [QueuedRow; 2],
}

/// Destination of the colours of up to eight adjacent samples.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct QueuedRow {
    /// Index of the first sample in the destination rows.
    pub(super) start: u32,
    /// Number of samples that lie within the picture, 1 to 8.
    count: u16,
    /// Bit mask of the samples to write.
    pub(super) mine: u16,
}

impl QueuedRow {
    /// Creates a destination of `count` samples that lie within the picture, 1 to 8. Those selected by `mine` are
    /// written.
    #[inline(always)]
    pub(super) fn new(start: usize, count: usize, mine: u32) -> Self {
        Self { start: start as u32, count: count as u16, mine: (mine & (ALL >> (LANES - count))) as u16 }
    }

    /// Returns the same destination, moved forward by `pixels` pixels in memory.
    #[inline(always)]
    pub(super) fn after(self, pixels: usize) -> Self {
        Self { start: self.start + pixels as u32, ..self }
    }

    /// Returns the same destination, with no sample selected for writing.
    #[inline(always)]
    pub(super) fn none(self) -> Self {
        Self { mine: 0, ..self }
    }

    /// Returns the index range of the samples within the destination rows.
    #[inline(always)]
    pub(super) fn pixels(&self) -> Range<usize> {
        let start = self.start as usize;
        start..start + usize::from(self.count)
    }

    /// Returns the number of samples to write.
    #[inline(always)]
    pub(super) fn written(&self) -> u32 {
        self.mine.count_ones()
    }
}

/// Destinations of the rows of a block, from top to bottom.
pub(super) struct RowTargets {
    next: QueuedRow,
    /// Distance between adjacent rows, in pixels.
    stride: usize,
    /// Number of rows of the block.
    pub(super) rows: usize,
}

impl RowTargets {
    #[inline(always)]
    pub(super) fn new(block: &Patch, picture: &ColorRows<'_>) -> Self {
        let next = QueuedRow::new(picture.start(block, block.first), block.count, block.mine);
        Self { next, stride: picture.stride, rows: block.end - block.first }
    }

    /// Returns the destinations of the next two rows, of which the lower one may be missing.
    #[inline(always)]
    pub(super) fn next_two(&mut self, has_lower: bool) -> [QueuedRow; 2] {
        let upper = self.next;
        self.next = upper.after(2 * self.stride);
        [upper, if has_lower { upper.after(self.stride) } else { upper.none() }]
    }
}
