//! Multisampling (MSAA): coverage and depth at several samples per pixel, and one colour per triangle visible in the
//! pixel.
//!
//! Each sample of a pixel has its own tile, whose lattice is moved from the pixel centres by the sample's offset.
//! Vertices and samples lie on the same subpixel grid, so a triangle's edges differ between samples only by a
//! translation. A triangle is set up once and then drawn into each tile. If all samples of a pixel show the same
//! triangle, the pixel is shaded once, at its centre. The centre lies between the samples and therefore within the
//! triangle. All other pixels are handled in [`super::mixed`].

use std::time::Instant;

use super::batch::{BinnedTriangle, GROUP};
use super::canvas::Canvas;
use super::counters::TileWork;
use super::lattice::TileLattice;
use super::pass::TilePass;
use super::record::TileBin;
use super::shade::ShadingJob;
use super::target::Target;
use super::tested::set_bits;
use super::tile::{Tile, TileCounts};
use super::{TiledFrame, Workspace};
use crate::image::Rgba8;
use crate::math::lanes::*;
use crate::pipeline::grid::SampleGrid;
use crate::scene::material::Transparency;

/// Indices into a list of colours: the colour of one sample in each of sixteen pixels.
pub(crate) type Picks = [u32; WIDE];

/// Function that combines the samples of pixels into colours, sixteen pixels at a time.
///
/// It receives a list of colours and the [`Picks`] of every sample, and writes the pixel colours. A pixel whose samples
/// all have the same colour gets exactly that colour.
pub(crate) type MeanOfSamples<'a> = &'a (dyn Fn(&[Rgba8], &[Picks], &mut [Rgba8]) + Sync);

/// Multisampling: positions of the samples, and their combination into pixels.
#[derive(Clone, Copy)]
pub(crate) struct Multisampling<'a> {
    /// Sample positions, as offsets from the pixel centre to the right and down, in steps of 1/256 px. Their mean is
    /// the centre, and they are not collinear.
    pub(crate) offsets: &'a [[i32; 2]],
    /// Function that combines the samples of a pixel into one colour.
    pub(crate) mean: MeanOfSamples<'a>,
}

/// Sample planes of a multisampled frame, one per sample of a pixel. Each tile of the picture is drawn once per plane.
pub(super) struct SamplePlanes<'a> {
    pub(super) samples: Multisampling<'a>,
    /// Lattice of each sample, followed by the lattice of the pixel centres if depths are kept.
    pub(super) lattices: Vec<TileLattice>,
    /// Candidate shading positions of a triangle in a pixel, in order of preference: the centre, then the samples. They
    /// are offsets from the centre, in steps of 1/256 px.
    pub(super) shading_places: Vec<[i32; 2]>,
}

impl<'a> SamplePlanes<'a> {
    pub(super) fn new(samples: Multisampling<'a>, grid: SampleGrid, keep_depth: bool) -> Self {
        let centres = TileLattice::new(grid);
        let moved = samples.offsets.iter().map(|offset| centres.moved(*offset));
        Self {
            samples,
            lattices: moved.chain(keep_depth.then_some(centres)).collect(),
            shading_places: [&[[0; 2]], samples.offsets].concat(),
        }
    }
}

/// Tiles of the sample planes, one for each sample of a pixel.
pub(super) struct PlaneTiles<'a> {
    pub(super) planes: &'a SamplePlanes<'a>,
    pub(super) tiles: &'a mut [Tile],
    /// Bin with the triangles of the tile.
    pub(super) bin: &'a TileBin,
}

impl TiledFrame<'_> {
    /// Draws and shades a tile of a multisampled picture.
    #[inline(always)]
    pub(super) fn draw_samples<S: Simd>(
        &self,
        simd: S,
        planes: &SamplePlanes<'_>,
        workspace: &mut Workspace,
        mut target: Target<'_>,
    ) {
        let start = Instant::now();
        self.gather_bin(target.place, &mut workspace.bin);
        if workspace.bin.len() == 0 {
            return target.clear_depths(self.rules.clear);
        }
        self.draw_planes(simd, planes, workspace);
        let Workspace { tile, planes: tiles, mixed, transparency, bin, pending, queue, .. } = workspace;
        let pass = TilePass::new(self, bin, &self.lattice);
        let (samples, centres) = tiles.split_at_mut(planes.samples.offsets.len());
        if let [centres] = centres {
            pass.write_depths(simd, centres, &mut target);
        }
        let rasterized = Instant::now();
        let mut canvas = Canvas { frame: self, place: target.place, queue, picture: target.picture };
        mixed.find(simd, samples, tile, &canvas);
        let mut shading = ShadingJob::new(pass, pending, canvas.reborrow()).shade_tile(simd, tile);
        shading += mixed.shade(simd, planes, ShadingJob::new(pass, pending, canvas.reborrow()));
        mixed.write(&mut canvas.picture);
        if !transparency.blended.is_empty() {
            let planes = PlaneTiles { planes, tiles: samples, bin };
            shading += transparency.blend(simd, planes, mixed, &mut canvas);
        }
        let mut coverage = TileCounts::default();
        tiles.iter().for_each(|tile| coverage += tile.counts);
        self.work.add(TileWork { rasterize: rasterized - start, shade: rasterized.elapsed(), coverage, shading });
    }

    /// Draws the triangles in the bin of the workspace into the tiles of all samples, and lists those that are blended.
    #[inline(always)]
    fn draw_planes<S: Simd>(&self, simd: S, planes: &SamplePlanes<'_>, workspace: &mut Workspace) {
        let Workspace { planes: tiles, transparency, bin, group, .. } = workspace;
        let blended = &mut transparency.blended;
        tiles.resize_with(planes.lattices.len(), Tile::new);
        blended.clear();
        let setup = self.tile_setup(bin.place);
        for first in (0..bin.len()).step_by(GROUP) {
            setup.set_up_group(simd, bin, first, group);
            if first == 0 {
                let bounded = group.uses_hiz(bin.len());
                tiles.iter_mut().for_each(|tile| tile.clear(&self.rules, bounded));
            }
            for (number, batch) in group.batches.iter().enumerate() {
                let mut alive = group.alive[number];
                if !self.all_opaque {
                    for lane in set_bits(alive) {
                        let slot = group.slot(number, lane);
                        if self.transparency(bin.get(slot)) == Transparency::Blended {
                            alive &= !(1 << lane);
                            blended.push(slot);
                        }
                    }
                }
                if alive == 0 {
                    continue;
                }
                for (tile, lattice) in tiles.iter_mut().zip(&planes.lattices) {
                    let (within, moved) = batch.moved(simd, lattice, setup.context.origin.packed);
                    let pass = TilePass::new(self, bin, lattice);
                    let mut alive = alive & within;
                    while alive != 0 {
                        let lane = alive.trailing_zeros() as usize;
                        alive &= alive - 1;
                        let slot = group.slot(number, lane);
                        let triangle = BinnedTriangle { batch: &moved, lane, slot };
                        if self.all_opaque || self.transparency(bin.get(slot)) == Transparency::Opaque {
                            pass.draw_opaque(simd, tile, &triangle);
                        } else {
                            pass.draw_alpha_tested_sample(simd, planes, tile, &triangle.setup());
                        }
                    }
                }
            }
        }
    }
}
