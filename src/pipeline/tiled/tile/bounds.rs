//! Bounds of a tile's stored depths, known without reading samples: for each block, or for the whole tile.

use super::super::depths::{DepthPlane, DepthRules, compare_bounds, whole_depths};
use super::super::edge_number::EdgeNumber;
use super::super::lattice::{BLOCK, BLOCKS, Lattice, TILE};
use super::super::setup::Setup;
use super::{STRIDE, Tile};
use crate::math::lanes::*;
use crate::pipeline::depth::Comparison;

/// Full-tile occluder: a triangle that covers a whole tile in front of everything drawn before, or the background.
#[derive(Clone, Copy, Debug)]
pub(super) struct Backdrop {
    /// Least stored depth; `greatest` is the greatest.
    pub(super) least: f32,
    pub(super) greatest: f32,
    /// Depth plane of the triangle; `None` for the background.
    pub(super) plane: Option<DepthPlane>,
}

impl Tile {
    /// Whether a triangle lies behind the full-tile occluder, or replaces it. If neither, the occluder is replaced by
    /// the depth bounds of all blocks.
    #[inline(always)]
    pub(super) fn meets_backdrop<S: Simd, E: EdgeNumber>(
        &mut self,
        simd: S,
        triangle: &Setup<E>,
        plane: &DepthPlane,
        lattice: &Lattice,
        rules: &DepthRules,
    ) -> bool {
        let Some(backdrop) = self.backdrop else { return false };
        let first = (F64::splat(simd, 0.0), 0.0);
        let bounds = plane.bounds(simd, first, lattice.tile_extent(), rules);
        let stored = each!(bound in [backdrop.least, backdrop.greatest] => F32::splat(simd, bound));
        let (hidden, in_front) = compare_bounds(bounds, stored, rules.comparison);
        if hidden != 0 {
            return true;
        }
        if in_front == 0 || !triangle.covers_tile {
            self.part_bounds(simd, lattice, rules);
            return false;
        }
        let [least, greatest] = each!(bound in [0, 1] => bounds[bound].as_slice()[0]);
        self.backdrop = Some(Backdrop { least, greatest, plane: Some(*plane) });
        self.owners = [triangle.slot.0; BLOCKS * BLOCKS];
        self.plain = u64::MAX;
        let rows_of_blocks = triangle.rows[1] / BLOCK + 1 - triangle.rows[0] / BLOCK;
        self.counts.plain += (rows_of_blocks * BLOCK * TILE) as u64;
        true
    }

    /// Replaces the full-tile occluder, if there is one, by the depth bounds of all blocks.
    #[inline(always)]
    pub(super) fn part_bounds<S: Simd>(&mut self, simd: S, lattice: &Lattice, rules: &DepthRules) {
        let Some(Backdrop { least, greatest, plane }) = self.backdrop.take() else { return };
        let Some(plane) = plane else {
            (self.least, self.greatest) = ([least; BLOCKS * BLOCKS], [greatest; BLOCKS * BLOCKS]);
            return;
        };
        let blocks = F64::load_array_ref(simd, &lattice.doubles.blocks);
        for by in 0..BLOCKS {
            let places = (blocks, lattice.doubles.row(by * BLOCK));
            let [low, high] = plane.bounds(simd, places, lattice.doubles.block, rules);
            let here = by * BLOCKS..(by + 1) * BLOCKS;
            low.store_slice(&mut self.least[here.clone()]);
            high.store_slice(&mut self.greatest[here]);
        }
    }

    /// Whether a triangle lies behind everything that the tile holds.
    #[inline(always)]
    pub(super) fn hides<S: Simd>(&self, simd: S, plane: &DepthPlane, lattice: &Lattice, rules: &DepthRules) -> bool {
        // A triangle in front at the first sample is not behind everywhere; in most cases this test suffices.
        let in_front = match rules.comparison {
            Comparison::Always => true,
            Comparison::Less | Comparison::LessEqual => plane.at_first() < self.greatest[0].into(),
            Comparison::Greater | Comparison::GreaterEqual => plane.at_first() > self.least[0].into(),
        };
        if in_front || !self.bounded || !rules.stored {
            return false;
        }
        let first = (F64::splat(simd, 0.0), 0.0);
        let bounds = plane.bounds(simd, first, lattice.tile_extent(), rules);
        // One lane for each of the eight columns of blocks.
        let (mut least, mut greatest) = (F32::splat(simd, f32::INFINITY), F32::splat(simd, f32::NEG_INFINITY));
        for row in 0..BLOCKS {
            let row = row * BLOCKS..(row + 1) * BLOCKS;
            least = least.min(F32::from_slice(simd, &self.least[row.clone()]));
            greatest = greatest.max(F32::from_slice(simd, &self.greatest[row]));
        }
        compare_bounds(bounds, [least, greatest], rules.comparison).0 == 0xFF
    }

    /// Whether a triangle may pass the depth test anywhere in a block.
    #[inline(always)]
    pub(super) fn may_show<E: EdgeNumber>(&self, triangle: &Setup<E>, block: usize, rules: &DepthRules) -> bool {
        let [low, high] = whole_depths(triangle, rules);
        match rules.comparison {
            Comparison::Always => true,
            Comparison::Less => low < self.greatest[block],
            Comparison::LessEqual => low <= self.greatest[block],
            Comparison::Greater => high > self.least[block],
            Comparison::GreaterEqual => high >= self.least[block],
        }
    }

    /// Widens the depth bounds of a block so that they hold after a triangle is drawn into it.
    #[inline(always)]
    pub(super) fn widen_bounds<E: EdgeNumber>(&mut self, triangle: &Setup<E>, block: usize, rules: &DepthRules) {
        let [low, high] = whole_depths(triangle, rules);
        match rules.comparison {
            Comparison::Less | Comparison::LessEqual => self.least[block] = self.least[block].min(low),
            Comparison::Greater | Comparison::GreaterEqual => self.greatest[block] = self.greatest[block].max(high),
            Comparison::Always => {}
        }
    }

    /// Measures the depth bounds of a block from its samples.
    #[inline(always)]
    pub(super) fn measure_bounds<S: Simd>(&mut self, simd: S, (bx, by): (usize, usize)) {
        let (mut least, mut greatest) = (F32::splat(simd, f32::INFINITY), F32::splat(simd, f32::NEG_INFINITY));
        for row in by * BLOCK..(by + 1) * BLOCK {
            let depths = F32::from_slice(simd, &self.depths[row * STRIDE + bx * BLOCK..][..LANES]);
            (least, greatest) = (least.min(depths), greatest.max(depths));
        }
        let block = by * BLOCKS + bx;
        (self.least[block], self.greatest[block]) = (least.reduce_min(), greatest.reduce_max());
    }
}
