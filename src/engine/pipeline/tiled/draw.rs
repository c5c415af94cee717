//! Drawing of a tile's triangles, and output of its depths.

use super::batch::{BinnedTriangle, Triangles};
use super::pass::TilePass;
use super::sample_positions::SamplePositions;
use super::slot::Slot;
use super::target::{Target, TileRows};
use super::tile::Tile;
use crate::math::lanes::*;
use crate::scene::material::Transparency;

impl<L: SamplePositions> TilePass<'_, L> {
    /// Draws one triangle of a batch into a tile, or appends it to `blended` if its material is blended.
    #[inline(always)]
    pub(super) fn draw_triangle<S: Simd>(
        &self,
        simd: S,
        tile: &mut Tile,
        triangle: &BinnedTriangle<'_, impl Triangles>,
        blended: &mut Vec<Slot>,
    ) {
        let (frame, slot) = (self.frame, triangle.slot);
        let transparency = if frame.all_opaque { Transparency::Opaque } else { frame.transparency(self.bin.get(slot)) };
        match transparency {
            Transparency::Opaque => self.draw_opaque(simd, tile, triangle),
            Transparency::AlphaTested => self.draw_alpha_tested(simd, tile, &triangle.setup()),
            Transparency::Blended => blended.push(slot),
        }
    }

    /// Draws one opaque triangle of a batch into a tile, with integer edge values if these fit into 32 bits.
    #[inline(always)]
    pub(super) fn draw_opaque<S: Simd>(&self, simd: S, tile: &mut Tile, triangle: &BinnedTriangle<'_, impl Triangles>) {
        if triangle.fits() {
            tile.draw(simd, &triangle.setup::<i32>(), self);
        } else {
            tile.draw(simd, &triangle.setup::<f64>(), self);
        }
    }

    /// Copies the depths of a tile, sampled at pixel centres, to its target.
    #[inline(always)]
    pub(super) fn write_depths<S: Simd>(&self, simd: S, tile: &mut Tile, target: &mut Target<'_>) {
        for block in tile.uniform_blocks() {
            tile.expand_block(simd, block, self);
        }
        for (row, out) in target.depths.iter_mut().flat_map(TileRows::rows).enumerate() {
            out.copy_from_slice(&tile.depths(row)[..out.len()]);
        }
    }
}
