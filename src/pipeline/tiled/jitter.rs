//! Jittered supersampling: several samples at different positions in each pixel, all of them shaded.
//!
//! The triangles of a tile are set up once for all samples. The samples are then drawn and shaded one after the other,
//! each as if it were the only one, and added to the sums of the pixels. A tile and the sums of its pixels are enough
//! memory for any number of samples.

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

/// Number of positions from which a sample's position is chosen.
pub(crate) const JITTER_POSITIONS: usize = 16;

/// Sums of colours over the samples of sixteen pixels, channel by channel.
pub(crate) type Sums = [[f32; WIDE]; 3];

/// Chooses positions of a sample, given by number, for pixels, given by their columns in the full picture and their
/// row. Writes the index of the chosen position for each pixel.
pub(crate) type JitterChoice<'a> = &'a (dyn Fn(usize, (&[u32], u32), &mut [u8]) + Sync);

/// Functions that combine samples into pixels, sixteen at a time.
#[derive(Clone, Copy)]
pub(crate) struct SumOfSamples<'a> {
    /// Adds one sample of each pixel to the sums.
    pub(crate) add: &'a (dyn Fn(&[Rgba8], &mut [Sums]) + Sync),
    /// Computes the pixels when all samples are added. If all samples of a pixel have one colour, the pixel has it as
    /// well.
    pub(crate) mean: &'a (dyn Fn(&[Sums], &mut [Rgba8]) + Sync),
}

/// Several samples of each pixel, and their combination into one colour.
#[derive(Clone, Copy)]
pub(crate) struct Jittering<'a> {
    /// Possible positions of each sample, in grid steps of 1/256 px right of and below the centre of its pixel.
    pub(crate) places: &'a [[[i32; 2]; JITTER_POSITIONS]],
    /// Choice among these positions.
    pub(crate) chosen: JitterChoice<'a>,
    /// Combination of samples into pixels.
    pub(crate) sum: SumOfSamples<'a>,
}

/// Jittering, prepared for tiles.
pub(super) struct TileJitter<'a> {
    jittering: Jittering<'a>,
    /// The samples of each pixel.
    samples: Vec<JitteredSample>,
}

/// One sample of every pixel.
struct JitteredSample {
    /// Points; the sample lies to the right of and below its point in every pixel.
    lattice: TileLattice,
    /// Possible offsets from the points along each axis, in grid steps.
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

    /// Finds the positions of a sample in the pixels of a tile, as offsets from the lattice points.
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

/// Memory that is reused from tile to tile.
#[derive(Clone, Debug, Default)]
pub(super) struct JitterMemory {
    groups: Vec<TriangleGroup>,
    offsets: Offsets,
    sums: Vec<Sums>,
}

/// A group of a tile's triangles after setup.
#[derive(Clone, Debug, Default)]
struct TriangleGroup {
    batches: [TriangleBatch; BATCHES],
    /// Bit masks of the triangles that may have a sample in the tile, one per batch.
    alive: [u64; BATCHES],
    /// Bit masks of the triangles whose edge values exceed 32 bits, one per batch.
    large: [u64; BATCHES],
}

impl JitterMemory {
    /// Returns the number of bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.groups.capacity() * size_of::<TriangleGroup>()
            + self.offsets.bytes()
            + self.sums.capacity() * size_of::<Sums>()
    }
}

/// Number of [`Sums`], of sixteen pixels each, in a row of a tile.
const SUMS_PER_ROW: usize = TILE / WIDE;

impl TiledFrame<'_> {
    /// Draws and shades a tile of a picture with jittered samples. Until all samples are added, the picture holds the
    /// current one.
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

    /// Draws triangles after setup into a tile, and lists those that are blended.
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
