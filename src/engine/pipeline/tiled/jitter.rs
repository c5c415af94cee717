//! Jittered supersampling: several samples at different positions in each pixel, all of them shaded.
//!
//! The triangles of a tile are set up once for all samples. Each sample is then drawn and shaded as if it were the only
//! one, and its colours are added to per-pixel sums. Memory use therefore does not depend on the number of samples.

use std::time::Instant;

use super::batch::{BinnedTriangle, GROUP, TriangleGroup};
use super::canvas::Canvas;
use super::counters::TileWork;
use super::lattice::TileLattice;
use super::layout::{SamplePlace, TILE, TilePlace};
use super::pass::TilePass;
use super::sample_positions::{JitteredPositions, Offsets, SamplePositions};
use super::shade::ShadingJob;
use super::slot::Slot;
use super::target::Target;
use super::tile::Tile;
use super::{TiledFrame, Workspace};
use crate::image::Rgba8;
use crate::math::lanes::*;
use crate::pipeline::grid::SampleGrid;

/// Number of candidate positions of each sample.
pub(crate) const JITTER_POSITIONS: usize = 16;

/// Sums of the sample colours of sixteen pixels: red, green and blue.
pub(crate) type Sums = [[f32; WIDE]; 3];

/// Function that chooses the position of a sample in each pixel.
///
/// Its arguments are the number of the sample, and the columns and the row of the pixels in the full picture. For each
/// pixel, it writes the index of the chosen candidate position to the last argument.
pub(crate) type JitterChoice<'a> = &'a (dyn Fn(usize, &[u32], u32, &mut [u8]) + Sync);

/// Functions that combine the samples of pixels into colours, sixteen pixels at a time.
#[derive(Clone, Copy)]
pub(crate) struct SumOfSamples<'a> {
    /// Function that adds the colour of one sample per pixel to the sums.
    pub(crate) add: &'a (dyn Fn(&[Rgba8], &mut [Sums]) + Sync),
    /// Function that computes the pixel colours from the sums of all samples. A pixel whose samples all have the same
    /// colour gets exactly that colour.
    pub(crate) mean: &'a (dyn Fn(&[Sums], &mut [Rgba8]) + Sync),
}

/// Jittered supersampling: positions of the samples, and their combination into pixels.
#[derive(Clone, Copy)]
pub(crate) struct Jittering<'a> {
    /// Candidate positions of each sample, as offsets from the pixel centre to the right and down, in steps of 1/256
    /// px.
    pub(crate) places: &'a [[[i32; 2]; JITTER_POSITIONS]],
    /// Function that chooses one of the candidate positions in each pixel.
    pub(crate) chosen: JitterChoice<'a>,
    /// Functions that combine the samples of a pixel into one colour.
    pub(crate) sum: SumOfSamples<'a>,
}

/// Jittered supersampling, with the lattices on which tiles are drawn.
pub(super) struct TileJitter<'a> {
    jittering: Jittering<'a>,
    /// Lattice and candidate offsets of each sample of a pixel.
    samples: Vec<JitteredSample>,
}

/// Lattice and candidate offsets of one sample of every pixel.
struct JitteredSample {
    /// Lattice of reference points, one per pixel. The offset of the sample from its reference point is never negative.
    lattice: TileLattice,
    /// Candidate offsets from the reference point along each axis, in steps of 1/256 px.
    offsets: [[f32; JITTER_POSITIONS]; 2],
}

impl<'a> TileJitter<'a> {
    pub(super) fn new(jittering: Jittering<'a>, grid: SampleGrid) -> Self {
        let centres = TileLattice::new(grid);
        let sample = |places: &[[i32; 2]; JITTER_POSITIONS]| {
            let along = |axis: usize| places.iter().map(move |place| place[axis]);
            let least = [0, 1].map(|axis| along(axis).fold(i32::MAX, i32::min));
            let greatest = [0, 1].map(|axis| along(axis).fold(i32::MIN, i32::max));
            JitteredSample {
                lattice: centres.spread([least, greatest]),
                offsets: [0, 1].map(|axis| places.map(|place| (place[axis] - least[axis]) as f32)),
            }
        };
        Self { jittering, samples: jittering.places.iter().map(sample).collect() }
    }

    /// Computes the positions of a sample in all pixels of a tile, as offsets from the lattice points.
    fn place(&self, number: usize, grid: SampleGrid, tile: TilePlace, offsets: &mut Offsets) {
        let [across, down] = &self.samples[number].offsets;
        let mut chosen = [0; TILE];
        offsets.reserve();
        for row in 0..TILE {
            let (first_column, packed_row) = tile.packed(SamplePlace { column: 0, row });
            let columns: [u32; TILE] = std::array::from_fn(|i| grid.pixel(first_column + i as u32, packed_row).0);
            (self.jittering.chosen)(number, &columns, grid.pixel(0, packed_row).1, &mut chosen);
            let [right, below] = offsets.row_mut(row);
            for ((right, below), place) in right.iter_mut().zip(below).zip(chosen) {
                let place = usize::from(place) % JITTER_POSITIONS;
                (*right, *below) = (across[place], down[place]);
            }
        }
    }
}

/// Buffers of jittered supersampling, reused from tile to tile.
#[derive(Clone, Debug, Default)]
pub(super) struct JitterMemory {
    groups: Vec<TriangleGroup>,
    offsets: Offsets,
    sums: Vec<Sums>,
}

impl JitterMemory {
    /// Returns the memory use of the buffers in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.groups.capacity() * size_of::<TriangleGroup>()
            + self.offsets.bytes()
            + self.sums.capacity() * size_of::<Sums>()
    }
}

/// Number of [`Sums`], of sixteen pixels each, in a row of a tile.
const SUMS_PER_ROW: usize = TILE / WIDE;

impl TiledFrame<'_> {
    /// Draws and shades a tile of a picture with jittered samples. While samples are added to the sums, the picture
    /// holds the colours of the current sample.
    #[inline(always)]
    pub(super) fn draw_jittered<S: Simd>(
        &self,
        simd: S,
        jittered: &TileJitter<'_>,
        workspace: &mut Workspace,
        mut target: Target<'_>,
    ) {
        let mut start = Instant::now();
        let Workspace { tile, bin, pending, queue, transparency, jitter, .. } = workspace;
        let JitterMemory { groups, offsets, sums } = jitter;
        let blended = &mut transparency.blended;
        let place = target.place;
        self.gather_bin(place, bin);
        if bin.len() == 0 {
            return target.clear_depths(self.rules.clear);
        }
        groups.resize_with(bin.len().div_ceil(GROUP), TriangleGroup::default);
        let setup = self.tile_setup(place);
        for (number, group) in groups.iter_mut().enumerate() {
            setup.set_up_group(simd, bin, number * GROUP, group);
        }
        let mut done = TileWork::default();
        if target.depths.is_some() {
            let pass = TilePass::new(self, bin, &self.lattice);
            pass.draw_groups(simd, tile, groups, blended);
            pass.write_depths(simd, tile, &mut target);
            done.coverage += tile.counts;
        }
        let mut canvas = Canvas { frame: self, place, queue, picture: target.picture };
        sums.clear();
        sums.resize(TILE * SUMS_PER_ROW, [[0.0; WIDE]; 3]);
        for (number, JitteredSample { lattice, .. }) in jittered.samples.iter().enumerate() {
            jittered.place(number, self.grid, place, offsets);
            let pass = TilePass::new(self, bin, JitteredPositions { lattice, offsets });
            pass.draw_groups(simd, tile, groups, blended);
            done.coverage += tile.counts;
            let rasterized = Instant::now();
            done.shading += ShadingJob::new(pass, pending, canvas.reborrow()).shade_tile(simd, tile);
            if !blended.is_empty() {
                done.shading += pass.blend(simd, tile, blended, &mut canvas);
            }
            for (row, sums) in canvas.picture.rows().zip(sums.chunks_exact_mut(SUMS_PER_ROW)) {
                (jittered.jittering.sum.add)(row, sums);
                row.fill(self.background);
            }
            let finished = Instant::now();
            done.rasterize += rasterized - start;
            done.shade += finished - rasterized;
            start = finished;
        }
        for (row, sums) in canvas.picture.rows().zip(sums.chunks_exact(SUMS_PER_ROW)) {
            (jittered.jittering.sum.mean)(sums, row);
        }
        done.shade += start.elapsed();
        self.work.add(done);
    }
}

impl<L: SamplePositions> TilePass<'_, L> {
    /// Draws triangles that are already set up into a tile, and lists those that are blended in `blended`.
    #[inline(always)]
    fn draw_groups<S: Simd>(&self, simd: S, tile: &mut Tile, groups: &[TriangleGroup], blended: &mut Vec<Slot>) {
        let bounded = groups.first().is_none_or(|first| first.uses_hiz(self.bin.len()));
        tile.clear(self.rules(), bounded);
        blended.clear();
        for group in groups {
            for (number, batch) in group.batches.iter().enumerate().filter(|(number, _)| group.alive[*number] != 0) {
                let (within, moved) = batch.moved(simd, self.locations.lattice(), self.origin.packed);
                let mut alive = group.alive[number] & within;
                while alive != 0 {
                    let lane = alive.trailing_zeros() as usize;
                    alive &= alive - 1;
                    let triangle = BinnedTriangle { batch: &moved, lane, slot: group.slot(number, lane) };
                    self.draw_triangle(simd, tile, &triangle, blended);
                }
            }
        }
    }
}
