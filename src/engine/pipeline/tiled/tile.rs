//! A tile of the picture while it is rasterized: the visible triangle and the depth of each sample.
//!
//! Samples are grouped in blocks of 8 × 8. A block is *uniform* if one triangle covers all of it, in front of
//! everything drawn before. For a uniform block, only that triangle is stored; the samples of the block are written
//! when another triangle first covers the block in part. Lower and upper bounds on the stored depths of each block are
//! kept, so a triangle that is entirely behind a block is skipped there (Greene, Kass and Miller, "Hierarchical
//! Z-buffer visibility", SIGGRAPH 1993). While the whole tile shows a single triangle, or nothing, these bounds are
//! stored once for the whole tile.

mod bounds;
mod draw;
mod samples;
mod tested;

use std::ops::AddAssign;

use bounds::FullTileOccluder;

use super::depths::DepthRules;
use super::layout::{BLOCKS, Block, ROWS, STRIDE, SamplePlace, TILE};
use super::slot::Slot;
use crate::math::lanes::*;

/// Rasterization work of a tile, in samples.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TileCounts {
    /// Number of samples whose coverage was tested individually.
    pub(super) visited: u64,
    /// Number of samples in blocks that were accepted as a whole.
    pub(super) uniform: u64,
}

impl AddAssign for TileCounts {
    fn add_assign(&mut self, more: Self) {
        self.visited += more.visited;
        self.uniform += more.uniform;
    }
}

/// A tile while it is rasterized. Its memory is reused from tile to tile.
#[derive(Clone, Debug)]
pub(super) struct Tile {
    /// Slot of the visible triangle at each sample, row by row.
    ids: Vec<u32>,
    /// Stored depth of each sample, row by row.
    depths: Vec<f32>,
    /// Slot of the visible triangle in each uniform block.
    owners: [u32; BLOCKS * BLOCKS],
    /// Lower bound on the stored depths of each block. Not valid while there is a full-tile occluder.
    min_depths: [f32; BLOCKS * BLOCKS],
    /// Upper bound on the stored depths of each block. Not valid while there is a full-tile occluder.
    max_depths: [f32; BLOCKS * BLOCKS],
    /// Triangle that covers the whole tile in front of everything drawn before, or the background. `None` after another
    /// triangle was drawn into some of the blocks, or if no depth bounds are kept.
    occluder: Option<FullTileOccluder>,
    /// Bit mask of the uniform blocks, row by row.
    uniform: u64,
    /// Whether depth bounds of the blocks are kept. They cost more than they save if triangles are as small as blocks.
    bounded: bool,
    pub(super) counts: TileCounts,
}

impl Tile {
    pub(super) fn new() -> Self {
        Self {
            ids: vec![Slot::NONE.0; STRIDE * ROWS],
            depths: vec![0.0; STRIDE * ROWS],
            owners: [Slot::NONE.0; BLOCKS * BLOCKS],
            min_depths: [0.0; BLOCKS * BLOCKS],
            max_depths: [0.0; BLOCKS * BLOCKS],
            occluder: None,
            uniform: u64::MAX,
            bounded: true,
            counts: TileCounts::default(),
        }
    }

    /// Returns the memory use in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.ids.capacity() * size_of::<u32>() + self.depths.capacity() * size_of::<f32>() + size_of::<Self>()
    }

    /// Clears the tile. If `bounded` is `false`, clears all samples at once and keeps no depth bounds.
    pub(super) fn clear(&mut self, rules: &DepthRules, bounded: bool) {
        self.bounded = bounded;
        self.counts = TileCounts::default();
        if bounded {
            self.uniform = u64::MAX;
            self.owners = [Slot::NONE.0; BLOCKS * BLOCKS];
            self.occluder = Some(FullTileOccluder { min_depth: rules.clear, max_depth: rules.clear, plane: None });
        } else {
            self.uniform = 0;
            self.occluder = None;
            self.ids.fill(Slot::NONE.0);
            if rules.stored {
                self.depths.fill(rules.clear);
            }
            self.min_depths = [f32::NEG_INFINITY; BLOCKS * BLOCKS];
            self.max_depths = [f32::INFINITY; BLOCKS * BLOCKS];
        }
    }

    /// Returns the slot of the visible triangle in a uniform block; `None` if the block is not uniform.
    #[inline(always)]
    pub(super) fn owner(&self, block: Block) -> Option<Slot> {
        let block = block.index();
        (self.uniform >> block & 1 != 0).then(|| Slot(self.owners[block]))
    }

    /// Returns the uniform blocks, whose samples are not yet written.
    pub(super) fn uniform_blocks(&self) -> impl Iterator<Item = Block> + use<> {
        let uniform = self.uniform;
        (0..BLOCKS * BLOCKS).filter(move |block| uniform >> block & 1 != 0).map(Block::new)
    }

    /// Returns the slots of the visible triangles at eight samples of a row. Their block must not be uniform.
    #[inline(always)]
    pub(super) fn slots(&self, column: usize, row: usize) -> &[u32] {
        &self.ids[row * STRIDE + column..][..LANES]
    }

    /// Returns the slots of the visible triangles at eight samples of a row and the eight below. Their block must not
    /// be uniform.
    #[inline(always)]
    pub(super) fn slots_of_two_rows<S: Simd>(&self, simd: S, column: usize, row: usize) -> u32x16<S> {
        let [upper, lower] = each!(y in [row, row + 1] => u32x8::from_slice(simd, self.slots(column, y)));
        upper.combine(lower)
    }

    /// Returns the slots of the visible triangles at eight samples of a row, whether or not their block is uniform.
    #[inline(always)]
    pub(super) fn visible_slots<S: Simd>(&self, simd: S, column: usize, row: usize) -> u32x8<S> {
        match self.owner(Block::around(SamplePlace { column, row })) {
            Some(slot) => u32x8::splat(simd, slot.0),
            None => u32x8::from_slice(simd, self.slots(column, row)),
        }
    }

    /// Marks a block as uniform, with `owner` as its only visible triangle, or as not uniform if `owner` is `None`.
    pub(super) fn set_owner(&mut self, block: Block, owner: Option<Slot>) {
        let block = block.index();
        match owner {
            Some(slot) => {
                self.uniform |= 1 << block;
                self.owners[block] = slot.0;
            }
            None => self.uniform &= !(1 << block),
        }
    }

    /// Stores the slots of the visible triangles at eight samples of a row.
    #[inline(always)]
    pub(super) fn set_seen<S: Simd>(&mut self, column: usize, row: usize, slots: u32x8<S>) {
        slots.store_slice(&mut self.ids[row * STRIDE + column..][..LANES]);
    }

    /// Returns the stored depths of the samples in a row.
    pub(super) fn depths(&self, row: usize) -> &[f32] {
        &self.depths[row * STRIDE..][..TILE]
    }
}
