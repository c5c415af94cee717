//! Drawing with one sample per pixel, at its centre.

use std::time::Instant;

use super::batch::{BinnedTriangle, GROUP};
use super::canvas::Canvas;
use super::counters::TileWork;
use super::pass::TilePass;
use super::shade::ShadingJob;
use super::target::Target;
use super::{TiledFrame, Workspace};
use crate::math::lanes::*;

impl TiledFrame<'_> {
    /// Draws and shades a tile.
    #[inline(always)]
    pub(super) fn draw_tile<S: Simd>(&self, simd: S, workspace: &mut Workspace, mut target: Target<'_>) {
        let start = Instant::now();
        let Workspace { tile, bin, group, pending, queue, transparency, .. } = workspace;
        let blended = &mut transparency.blended;
        self.gather_bin(target.place, bin);
        if bin.len() == 0 {
            return target.clear_depths(self.rules.clear);
        }
        let setup = self.tile_setup(target.place);
        blended.clear();
        for first in (0..bin.len()).step_by(GROUP) {
            setup.set_up_group(simd, bin, first, group);
            if first == 0 {
                tile.clear(&self.rules, group.uses_hiz(bin.len()));
            }
            let pass = TilePass::new(self, bin, &self.lattice);
            for (number, batch) in group.batches.iter().enumerate() {
                let mut alive = group.alive[number];
                while alive != 0 {
                    let lane = alive.trailing_zeros() as usize;
                    alive &= alive - 1;
                    let triangle = BinnedTriangle { batch, lane, slot: group.slot(number, lane) };
                    pass.draw_triangle(simd, tile, &triangle, blended);
                }
            }
        }
        let pass = TilePass::new(self, bin, &self.lattice);
        if target.depths.is_some() {
            pass.write_depths(simd, tile, &mut target);
        }
        let rasterized = Instant::now();
        let mut canvas = Canvas { frame: self, place: target.place, queue, picture: target.picture };
        let mut shading = ShadingJob::new(pass, pending, canvas.reborrow()).shade_tile(simd, tile);
        if !blended.is_empty() {
            shading += pass.blend(simd, tile, blended, &mut canvas);
        }
        let coverage = tile.counts;
        self.work.add(TileWork { rasterize: rasterized - start, shade: rasterized.elapsed(), coverage, shading });
    }
}
