//! Multisampling (MSAA): coverage and depth at several samples per pixel, and one colour per triangle visible in the
//! pixel.
//!
//! Each sample of a pixel has its own tile, whose lattice is moved from the pixel centres by the sample's offset.
//! Vertices and samples lie on the same subpixel grid, so a triangle's edges differ between samples only by a
//! translation. A triangle is set up once and then drawn into each tile. If all samples of a pixel show the same
//! triangle, the pixel is shaded once, at its centre. The centre lies between the samples and therefore within the
//! triangle. All other pixels are handled in [`super::mixed`].

use std::time::Instant;

use super::batch::{TriangleBatch, Triangles as _};
use super::lattice::TileLattice;
use super::record::{Slot, TileBin};
use super::shade::{ShadingTarget, shade_tile};
use super::tested::set_bits;
use super::tile::Tile;
use super::{BATCHES, FrameCounters, GROUP, Target, TiledFrame, Workspace, uses_hiz};
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

impl TiledFrame<'_> {
    /// Draws and shades a tile of a multisampled picture.
    #[inline(always)]
    pub(super) fn draw_samples<S: Simd>(
        &self,
        simd: S,
        planes: &SamplePlanes<'_>,
        workspace: &mut Workspace,
        mut target: Target<'_>,
        work: &FrameCounters,
    ) {
        let start = Instant::now();
        let Workspace {
            tile,
            planes: tiles,
            mixed,
            transparency: seen_through,
            bin: entrants,
            batches,
            pending,
            queue,
            ..
        } = workspace;
        let place = target.place;
        self.gather_bin(target.number, entrants);
        if entrants.len() == 0 {
            return target.clear_depths(self.rules.clear);
        }
        tiles.resize_with(planes.lattices.len(), Tile::new);
        self.draw_planes(simd, (planes, tiles), (entrants, batches), place, &mut seen_through.blended);
        let (samples, centres) = tiles.split_at_mut(planes.samples.offsets.len());
        if let [centres] = centres {
            self.write_depths(simd, centres, entrants, &mut target);
        }
        let rasterized = Instant::now();
        let mut picture = target.picture;
        mixed.find(simd, &self.lattice, samples, tile, picture.size);
        let mut shaded = shade_tile(
            simd,
            self,
            ShadingTarget {
                tile,
                locations: &self.lattice,
                bin: entrants,
                pending,
                queue,
                place,
                picture: picture.reborrow(),
            },
        );
        shaded += mixed.shade(simd, self, planes, (entrants, pending, queue), place);
        mixed.write(&mut picture);
        if !seen_through.blended.is_empty() {
            let (seen, memory) = ((&*entrants, place), (seen_through, queue));
            shaded += self.blend_samples(simd, (planes, samples), seen, mixed, memory, &mut picture);
        }
        work.add((rasterized - start, rasterized.elapsed()), tiles.iter().map(|tile| tile.counts), shaded);
    }

    /// Draws the triangles of a tile into the tiles of all samples, and appends those that are blended to `blended`.
    #[inline(always)]
    fn draw_planes<S: Simd>(
        &self,
        simd: S,
        (planes, tiles): (&SamplePlanes<'_>, &mut [Tile]),
        (entrants, batches): (&mut TileBin, &mut [TriangleBatch; BATCHES]),
        place: (usize, usize),
        blended: &mut Vec<Slot>,
    ) {
        blended.clear();
        let origin = self.origin(&self.lattice, place);
        for group in (0..entrants.len()).step_by(GROUP) {
            let (mut alive, large) = self.set_up_group(simd, entrants, batches, group, origin);
            if group == 0 {
                let bounded = uses_hiz(entrants.len(), batches, &alive);
                tiles.iter_mut().for_each(|tile| tile.clear(&self.rules, bounded));
            }
            for (number, batch) in batches.iter().enumerate() {
                let slot = |lane| Slot::new(group + number * LANES + lane, large[number] >> lane & 1 != 0);
                if !self.all_opaque {
                    for lane in set_bits(alive[number]) {
                        if self.transparency(entrants.get(slot(lane))) == Transparency::Blended {
                            alive[number] &= !(1 << lane);
                            blended.push(slot(lane));
                        }
                    }
                }
                if alive[number] == 0 {
                    continue;
                }
                for (tile, lattice) in tiles.iter_mut().zip(&planes.lattices) {
                    let (within, moved) = batch.moved(simd, lattice, origin.1);
                    let owner = self.owner(entrants, lattice, place);
                    let mut alive = alive[number] & within;
                    while alive != 0 {
                        let lane = alive.trailing_zeros() as usize;
                        alive &= alive - 1;
                        let slot = slot(lane);
                        if self.all_opaque || self.transparency(entrants.get(slot)) == Transparency::Opaque {
                            self.draw_opaque(simd, (tile, lattice), (&moved, lane, slot), &owner);
                        } else {
                            let (triangle, seen) = (moved.triangle(lane, slot), (&*entrants, place));
                            self.draw_alpha_tested_sample(simd, planes, (tile, &triangle, lattice), seen, &owner);
                        }
                    }
                }
            }
        }
    }
}
