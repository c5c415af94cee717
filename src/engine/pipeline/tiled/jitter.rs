//! Jittered supersampling: several samples at different positions in each pixel, all of them shaded.
//!
//! The triangles of a tile are set up once for all samples. Each sample is then drawn and shaded as if it were the only
//! one, and its colours are added to per-pixel sums. Memory use therefore does not depend on the number of samples.

use std::time::{Duration, Instant};

use super::batch::TriangleBatch;
use super::lattice::{TILE, TileLattice};
use super::multisample_transparency::TransparencyMemory;
use super::record::{Slot, TileBin};
use super::sample_positions::{JitteredPositions, Offsets, SamplePositions};
use super::shade::{ShadingTarget, ShadingWork, shade_tile};
use super::tile::{Tile, TileCounts};
use super::{BATCHES, FrameCounters, GROUP, Target, TiledFrame, Workspace, uses_hiz};
use crate::image::Rgba8;
use crate::math::lanes::*;
use crate::pipeline::grid::SampleGrid;

/// Number of candidate positions of each sample.
pub(crate) const JITTER_POSITIONS: usize = 16;

/// Sums of the sample colours of sixteen pixels: red, green and blue.
pub(crate) type Sums = [[f32; WIDE]; 3];

/// Function that chooses the position of a sample in each pixel.
///
/// It receives the number of the sample, and the columns and the row of the pixels in the full picture. For each pixel,
/// it writes the index of the chosen candidate position.
pub(crate) type JitterChoice<'a> = &'a (dyn Fn(usize, (&[u32], u32), &mut [u8]) + Sync);

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
    fn place(&self, number: usize, grid: SampleGrid, tile: (usize, usize), offsets: &mut Offsets) {
        let [across, down] = &self.samples[number].offsets;
        let mut chosen = [0; TILE];
        offsets.reserve();
        for row in 0..TILE {
            let packed_row = (tile.1 * TILE + row) as u32;
            let columns: [u32; TILE] = std::array::from_fn(|i| grid.pixel((tile.0 * TILE + i) as u32, packed_row).0);
            (self.jittering.chosen)(number, (&columns, grid.pixel(0, packed_row).1), &mut chosen);
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

/// Group of up to [`GROUP`] triangles of a tile, after setup.
#[derive(Clone, Debug, Default)]
struct TriangleGroup {
    batches: [TriangleBatch; BATCHES],
    /// For each batch, the bit mask of the triangles that may cover a sample of the tile.
    alive: [u64; BATCHES],
    /// For each batch, the bit mask of the triangles whose edge values may exceed 32 bits.
    large: [u64; BATCHES],
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
        work: &FrameCounters,
    ) {
        let mut start = Instant::now();
        let Workspace { tile, bin: entrants, pending, queue, transparency: seen_through, jitter, .. } = workspace;
        let JitterMemory { groups, offsets, sums } = jitter;
        let TransparencyMemory { blended, .. } = seen_through;
        let place = target.place;
        self.gather_bin(target.number, entrants);
        if entrants.len() == 0 {
            return target.clear_depths(self.rules.clear);
        }
        groups.resize_with(entrants.len().div_ceil(GROUP), TriangleGroup::default);
        for (number, TriangleGroup { batches, alive, large }) in groups.iter_mut().enumerate() {
            let origin = self.origin(&self.lattice, place);
            (*alive, *large) = self.set_up_group(simd, entrants, batches, number * GROUP, origin);
        }
        let (mut times, mut counts, mut shaded) = ([Duration::ZERO; 2], TileCounts::default(), ShadingWork::default());
        if target.depths.is_some() {
            self.draw_groups(simd, (tile, &self.lattice), groups, (entrants, place), blended);
            self.write_depths(simd, tile, entrants, &mut target);
            counts += tile.counts;
        }
        let mut picture = target.picture;
        sums.clear();
        sums.resize(TILE * SUMS_PER_ROW, [[0.0; WIDE]; 3]);
        for (number, JitteredSample { lattice, .. }) in jittered.samples.iter().enumerate() {
            jittered.place(number, self.grid, place, offsets);
            let locations = JitteredPositions { lattice, offsets };
            self.draw_groups(simd, (tile, locations), groups, (entrants, place), blended);
            counts += tile.counts;
            let rasterized = Instant::now();
            let canvas =
                ShadingTarget { tile, locations, bin: entrants, pending, queue, place, picture: picture.reborrow() };
            shaded += shade_tile(simd, self, canvas);
            if !blended.is_empty() {
                shaded += self.blend(simd, (tile, locations), (entrants, blended), place, queue, &mut picture);
            }
            for (row, sums) in picture.rows().zip(sums.chunks_exact_mut(SUMS_PER_ROW)) {
                (jittered.jittering.sum.add)(row, sums);
                row.fill(self.background);
            }
            let finished = Instant::now();
            times[0] += rasterized - start;
            times[1] += finished - rasterized;
            start = finished;
        }
        for (row, sums) in picture.rows().zip(sums.chunks_exact(SUMS_PER_ROW)) {
            (jittered.jittering.sum.mean)(sums, row);
        }
        times[1] += start.elapsed();
        work.add((times[0], times[1]), [counts], shaded);
    }

    /// Draws triangles that are already set up into a tile, and appends those that are blended to `blended`.
    #[inline(always)]
    fn draw_groups<S: Simd>(
        &self,
        simd: S,
        (tile, locations): (&mut Tile, impl SamplePositions),
        groups: &[TriangleGroup],
        (entrants, place): (&TileBin, (usize, usize)),
        blended: &mut Vec<Slot>,
    ) {
        let bounded = groups.first().is_none_or(|first| uses_hiz(entrants.len(), &first.batches, &first.alive));
        tile.clear(&self.rules, bounded);
        blended.clear();
        let lattice = locations.lattice();
        let (_, first) = self.origin(lattice, place);
        let owner = self.owner(entrants, lattice, place);
        for (group, TriangleGroup { batches, alive, large }) in groups.iter().enumerate() {
            for (number, batch) in batches.iter().enumerate().filter(|(number, _)| alive[*number] != 0) {
                let (within, moved) = batch.moved(simd, lattice, first);
                let mut alive = alive[number] & within;
                while alive != 0 {
                    let lane = alive.trailing_zeros() as usize;
                    alive &= alive - 1;
                    let slot = Slot::new(group * GROUP + number * LANES + lane, large[number] >> lane & 1 != 0);
                    let triangle = (&moved, lane, slot);
                    self.draw_triangle(simd, (tile, locations), triangle, (entrants, place), &owner, blended);
                }
            }
        }
    }
}
