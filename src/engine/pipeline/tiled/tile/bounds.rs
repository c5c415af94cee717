//! Hierarchical Z: lower and upper bounds on the stored depths of each block, or of the whole tile. They are used to
//! reject triangles without reading samples.

use super::super::depths::{DepthPlane, DepthRules, EightPositions, compare_bounds, whole_depths};
use super::super::edge_number::EdgeNumber;
use super::super::lattice::TileLattice;
use super::super::layout::{BLOCK, BLOCKS, Block, STRIDE, TILE};
use super::super::sample_positions::SamplePositions;
use super::super::setup::Setup;
use super::Tile;
use super::samples::TileDepthTest;
use crate::math::lanes::*;
use crate::pipeline::depth::DepthComparison;

/// Full-tile occluder: a triangle that covers the whole tile in front of everything drawn before, or the background.
#[derive(Clone, Copy, Debug)]
pub(super) struct FullTileOccluder {
    /// Lower bound on the stored depths in the tile.
    pub(super) min_depth: f32,
    /// Upper bound on the stored depths in the tile.
    pub(super) max_depth: f32,
    /// Depth plane of the triangle; `None` for the background.
    pub(super) plane: Option<DepthPlane>,
}

impl Tile {
    /// Tests a triangle against the full-tile occluder. Returns `true` if the triangle is hidden behind the occluder,
    /// or becomes the occluder itself; in both cases nothing remains to be drawn.
    ///
    /// Otherwise replaces the occluder, if there is one, with the depth bounds of all blocks.
    #[inline(always)]
    pub(super) fn test_occluder<S: Simd, E: EdgeNumber>(
        &mut self,
        simd: S,
        triangle: &Setup<E>,
        plane: &DepthPlane,
        TileDepthTest { locations, rules }: TileDepthTest<'_, impl SamplePositions>,
    ) -> bool {
        let lattice = locations.lattice();
        let Some(backdrop) = self.occluder else { return false };
        let bounds = plane.bounds(simd, EightPositions::first(simd), lattice.tile_extent(), rules);
        let stored = each!(bound in [backdrop.min_depth, backdrop.max_depth] => F32::splat(simd, bound));
        let (hidden, in_front) = compare_bounds(bounds, stored, rules.comparison);
        if hidden != 0 {
            return true;
        }
        if in_front == 0 || !triangle.covers_tile {
            self.replace_occluder(simd, lattice, rules);
            return false;
        }
        let [least, greatest] = each!(bound in [0, 1] => bounds[bound].as_slice()[0]);
        self.occluder = Some(FullTileOccluder { min_depth: least, max_depth: greatest, plane: Some(*plane) });
        self.owners = [triangle.slot.0; BLOCKS * BLOCKS];
        self.uniform = u64::MAX;
        let rows_of_blocks = triangle.rows[1] / BLOCK + 1 - triangle.rows[0] / BLOCK;
        self.counts.uniform += (rows_of_blocks * BLOCK * TILE) as u64;
        true
    }

    /// Replaces the full-tile occluder, if there is one, with the depth bounds of all blocks.
    #[inline(always)]
    pub(super) fn replace_occluder<S: Simd>(&mut self, simd: S, lattice: &TileLattice, rules: &DepthRules) {
        let Some(FullTileOccluder { min_depth: least, max_depth: greatest, plane }) = self.occluder.take() else {
            return;
        };
        let Some(plane) = plane else {
            (self.min_depths, self.max_depths) = ([least; BLOCKS * BLOCKS], [greatest; BLOCKS * BLOCKS]);
            return;
        };
        let blocks = F64::load_array_ref(simd, &lattice.doubles.blocks);
        for by in 0..BLOCKS {
            let places = EightPositions { x: blocks, y: lattice.doubles.row(by * BLOCK) };
            let [low, high] = plane.bounds(simd, places, lattice.doubles.block, rules);
            let here = by * BLOCKS..(by + 1) * BLOCKS;
            low.store_slice(&mut self.min_depths[here.clone()]);
            high.store_slice(&mut self.max_depths[here]);
        }
    }

    /// Returns `true` if a triangle, given by its depth plane, lies behind all stored depths of the tile.
    #[inline(always)]
    pub(super) fn hides<S: Simd>(
        &self,
        simd: S,
        plane: &DepthPlane,
        lattice: &TileLattice,
        rules: &DepthRules,
    ) -> bool {
        // In most cases this test suffices: a triangle that is in front at the tile's first sample is not hidden
        // everywhere.
        let in_front = match rules.comparison {
            DepthComparison::Always => true,
            DepthComparison::Less | DepthComparison::LessEqual => plane.at_first() < self.max_depths[0].into(),
            DepthComparison::Greater | DepthComparison::GreaterEqual => plane.at_first() > self.min_depths[0].into(),
        };
        if in_front || !self.bounded || !rules.stored {
            return false;
        }
        let bounds = plane.bounds(simd, EightPositions::first(simd), lattice.tile_extent(), rules);
        // Each lane holds one of the eight columns of blocks.
        let (mut least, mut greatest) = (F32::splat(simd, f32::INFINITY), F32::splat(simd, f32::NEG_INFINITY));
        for row in 0..BLOCKS {
            let row = row * BLOCKS..(row + 1) * BLOCKS;
            least = least.min(F32::from_slice(simd, &self.min_depths[row.clone()]));
            greatest = greatest.max(F32::from_slice(simd, &self.max_depths[row]));
        }
        compare_bounds(bounds, [least, greatest], rules.comparison).0 == 0xFF
    }

    /// Returns `true` if a triangle may pass the depth test anywhere in a block.
    #[inline(always)]
    pub(super) fn may_show<E: EdgeNumber>(&self, triangle: &Setup<E>, block: Block, rules: &DepthRules) -> bool {
        let ([low, high], block) = (whole_depths(triangle, rules), block.index());
        match rules.comparison {
            DepthComparison::Always => true,
            DepthComparison::Less => low < self.max_depths[block],
            DepthComparison::LessEqual => low <= self.max_depths[block],
            DepthComparison::Greater => high > self.min_depths[block],
            DepthComparison::GreaterEqual => high >= self.min_depths[block],
        }
    }

    /// Widens the depth bounds of a block so that they still hold after a triangle is drawn into it.
    #[inline(always)]
    pub(super) fn widen_bounds<E: EdgeNumber>(&mut self, triangle: &Setup<E>, block: Block, rules: &DepthRules) {
        let ([low, high], block) = (whole_depths(triangle, rules), block.index());
        match rules.comparison {
            DepthComparison::Less | DepthComparison::LessEqual => {
                self.min_depths[block] = self.min_depths[block].min(low);
            }
            DepthComparison::Greater | DepthComparison::GreaterEqual => {
                self.max_depths[block] = self.max_depths[block].max(high);
            }
            DepthComparison::Always => {}
        }
    }

    /// Computes the depth bounds of a block from its samples.
    #[inline(always)]
    pub(super) fn measure_bounds<S: Simd>(&mut self, simd: S, block: Block) {
        let (mut least, mut greatest) = (F32::splat(simd, f32::INFINITY), F32::splat(simd, f32::NEG_INFINITY));
        for row in block.rows() {
            let depths = F32::from_slice(simd, &self.depths[row * STRIDE + block.first_column()..][..LANES]);
            (least, greatest) = (least.min(depths), greatest.max(depths));
        }
        let block = block.index();
        (self.min_depths[block], self.max_depths[block]) = (least.reduce_min(), greatest.reduce_max());
    }
}
