//! Lattice of a tile's samples: the sample positions of a [`SampleGrid`], as tables of distances for SIMD code.

use std::ops::Mul;

use super::layout::{BLOCK, BLOCKS, SamplePlace, TILE, TilePlace};
use crate::math::fixed::{HALF_PIXEL, SUBPIXELS};
use crate::math::lanes::{F32, LANES, Simd, SimdBase as _, SimdFloat as _, i32x8};
use crate::pipeline::grid::SampleGrid;

/// Number of rows after which the horizontal shifts of a checkerboard's rows repeat.
const SHIFTS: usize = 4;

/// Place of a tile's first sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileOrigin {
    /// Position of the sample in the full picture, in steps of 1/256 px.
    pub(super) position: [f64; 2],
    /// Column and row of the sample in the packed picture.
    pub(super) packed: [f32; 2],
}

/// Sample positions in a tile relative to its first sample, in steps of 1/256 px.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileLattice {
    grid: SampleGrid,
    /// Distances between samples as doubles.
    pub(super) doubles: LatticeSteps<f64>,
    /// Distances between samples as 32-bit integers.
    pub(super) integers: LatticeSteps<i32>,
    /// Whether the distance between rows is a power of two, so that its reciprocal is exact.
    has_exact_reciprocal: bool,
    /// Offset of the lattice points from the pixel centres, in steps of 1/256 px. Samples lie on the points, or are
    /// jittered around them.
    offset: [i32; 2],
    /// Minimum and maximum offset of any sample from its pixel centre along each axis, in steps of 1/256 px.
    reach: [[f32; 2]; 2],
}

/// Distances of samples from a tile's first sample, in steps of 1/256 px. All numbers are integers.
#[derive(Clone, Copy, Debug)]
pub(super) struct LatticeSteps<T> {
    /// Vertical distance between adjacent rows, in steps of 1/256 px.
    row_step: T,
    /// Vertical distance to the next row, in steps of 1/256 px, repeated in all lanes so that it can be loaded as a
    /// vector.
    pub(super) next_row: [T; LANES],
    /// Vertical distance to the row after the next, in steps of 1/256 px, repeated in all lanes.
    pub(super) row_after_next: [T; LANES],
    /// Whether the samples of all rows are vertically aligned.
    pub(super) are_straight: bool,
    /// Horizontal distances of eight adjacent samples of a row from the first of them, in steps of 1/256 px.
    pub(super) lanes: [T; LANES],
    /// Vertical distances of eight adjacent rows from the first of them, in steps of 1/256 px.
    pub(super) rows: [T; LANES],
    /// Horizontal shifts of eight adjacent rows relative to the leftmost rows, in steps of 1/256 px. The index is the
    /// first of the eight rows modulo [`SHIFTS`].
    shifts: [[T; LANES]; SHIFTS],
    /// Horizontal and vertical distances from the first sample, for four samples of a row and the four below, in steps
    /// of 1/256 px.
    pub(super) two_rows: [[T; LANES]; 2],
    /// Horizontal distances of the blocks in a row of blocks from the first of them, in steps of 1/256 px.
    pub(super) blocks: [T; BLOCKS],
    /// Width and height of a block, from its first to its last sample, in steps of 1/256 px. The width includes the
    /// shift between rows. Both include the offsets of samples from the lattice points.
    pub(super) block: [T; 2],
}

impl<T: Copy + From<i32> + Mul<Output = T>> LatticeSteps<T> {
    fn new(grid: SampleGrid) -> Self {
        let of = |steps: i64| T::from(steps as i32);
        let column = |column: usize| i64::from(grid.pixel(column as u32, 0).0 - grid.pixel(0, 0).0) * SUBPIXELS;
        let row = |row: usize| i64::from(grid.pixel(0, row as u32).1) * SUBPIXELS;
        let are_straight = matches!(grid, SampleGrid::Block { .. });
        let shift = if are_straight { 0 } else { 2 * SUBPIXELS };
        Self {
            row_step: of(row(1)),
            next_row: [of(row(1)); LANES],
            row_after_next: [of(row(2)); LANES],
            are_straight,
            lanes: std::array::from_fn(|lane| of(column(lane))),
            rows: std::array::from_fn(|index| of(row(index))),
            shifts: std::array::from_fn(|first| std::array::from_fn(|index| of(shift_of(grid, first + index)))),
            two_rows: [std::array::from_fn(|lane| of(column(lane % 4))), std::array::from_fn(|lane| of(row(lane / 4)))],
            blocks: std::array::from_fn(|block| of(column(block * BLOCK))),
            block: [of(column(LANES - 1) + shift), of(row(LANES - 1))],
        }
    }

    /// Returns the horizontal distance of a column from the first one in an unshifted row, in steps of 1/256 px.
    #[inline(always)]
    pub(super) fn column(&self, column: usize) -> T {
        // A checkerboard samples two of every four pixels in a row. On both kinds of grid, pixel columns are as far
        // apart as rows.
        let pixel = if self.are_straight { column } else { column / 2 * 4 + column % 2 };
        T::from(pixel as i32) * self.row_step
    }

    /// Returns the vertical distance of a row from the first one, in steps of 1/256 px.
    #[inline(always)]
    pub(super) fn row(&self, row: usize) -> T {
        T::from(row as i32) * self.row_step
    }

    /// Returns the horizontal shift of a row relative to the leftmost rows, in steps of 1/256 px.
    #[inline(always)]
    pub(super) fn shift(&self, row: usize) -> T {
        self.shifts[0][row % SHIFTS]
    }

    /// Returns the horizontal shifts of eight rows, starting at row `first`, in steps of 1/256 px.
    #[inline(always)]
    pub(super) fn shifts(&self, first: usize) -> &[T; LANES] {
        &self.shifts[first % SHIFTS]
    }
}

#[inline(always)]
fn shift_of(grid: SampleGrid, row: usize) -> i64 {
    match grid {
        SampleGrid::Block { .. } => 0,
        // Columns count from the start of the leftmost rows. Every tile begins on a row with the shift of the picture's
        // first row.
        SampleGrid::Checkerboard | SampleGrid::OddCheckerboard => i64::from(grid.first_drawn(row as u32)) * SUBPIXELS,
    }
}

impl TileLattice {
    /// Creates the lattice of the pixel centres of a sample grid.
    pub(super) fn new(grid: SampleGrid) -> Self {
        let doubles = LatticeSteps::<f64>::new(grid);
        Self {
            grid,
            doubles,
            integers: LatticeSteps::new(grid),
            has_exact_reciprocal: (doubles.row_step as u64).is_power_of_two(),
            offset: [0; 2],
            reach: [[0.0; 2]; 2],
        }
    }

    /// Returns the lattice with each sample moved from the pixel centre by an offset, in steps of 1/256 px.
    pub(super) fn moved(self, offset: [i32; 2]) -> Self {
        Self { offset, reach: offset.map(|along| [along as f32; 2]), ..self }
    }

    /// Returns the lattice for pixels with several samples, given their offsets from the pixel centre in steps of 1/256
    /// px. The lattice points stay at the pixel centres, but [`TileLattice::range`] includes all samples.
    pub(super) fn with_samples(self, offsets: &[[i32; 2]]) -> Self {
        let reach = [0, 1].map(|axis| {
            let along = || offsets.iter().map(|offset| offset[axis]);
            [along().fold(0, i32::min) as f32, along().fold(0, i32::max) as f32]
        });
        Self { reach, ..self }
    }

    /// Returns the lattice for jittered samples, given their minimum and maximum offset from the pixel centre in steps
    /// of 1/256 px. The lattice points are at the minimum offset. The size of a block includes all offsets.
    pub(super) fn spread(mut self, [least, greatest]: [[i32; 2]; 2]) -> Self {
        for axis in 0..2 {
            let spread = greatest[axis] - least[axis];
            self.integers.block[axis] += spread;
            self.doubles.block[axis] += f64::from(spread);
        }
        Self { offset: least, reach: [0, 1].map(|axis| [least[axis] as f32, greatest[axis] as f32]), ..self }
    }

    /// Returns the offset of the lattice points from the pixel centres, in steps of 1/256 px.
    pub(super) fn offset(&self) -> [i32; 2] {
        self.offset
    }

    /// Returns the greatest distance between two sample positions of the same pixel along either axis, in steps of
    /// 1/256 px.
    pub(super) fn extent(&self) -> f64 {
        let [across, down] = self.reach.map(|[least, greatest]| greatest - least);
        across.max(down).into()
    }

    /// Returns the place of a tile's first sample.
    pub(super) fn origin(&self, tile: TilePlace) -> TileOrigin {
        let (column, row) = tile.packed(SamplePlace::default());
        let (x, y) = self.grid.pixel(column, row);
        let x = x - self.grid.pixel(0, 0).0;
        let step = |pixel: u32| (i64::from(pixel) * SUBPIXELS + HALF_PIXEL) as f64;
        TileOrigin {
            position: [step(x) + f64::from(self.offset[0]), step(y) + f64::from(self.offset[1])],
            packed: [column as f32, row as f32],
        }
    }

    /// Returns the distance from the first sample of a tile to the last one along both axes, in steps of 1/256 px.
    #[inline(always)]
    pub(super) fn tile_extent(&self) -> [f64; 2] {
        let LatticeSteps { blocks, block: [width, height], .. } = &self.doubles;
        [blocks[BLOCKS - 1] + width, self.doubles.row((BLOCKS - 1) * BLOCK) + height]
    }

    /// Returns an upper bound on the distance of a tile's samples from its first pixel along either axis, in steps of
    /// 1/256 px.
    ///
    /// The bound includes samples beyond the tile that are computed only because samples are processed eight at a time
    /// or two rows at a time. The bound is valid only if the lattice includes all samples of a pixel: see
    /// [`TileLattice::with_samples`].
    #[inline(always)]
    pub(super) fn farthest(&self) -> f64 {
        let (columns, rows) = (self.doubles.column(TILE + LANES), self.doubles.row(TILE + LANES));
        columns.max(rows) + 2.0 * self.extent()
    }

    /// Returns the horizontal positions of eight columns of an unshifted row, starting at `column`, in steps of
    /// 1/256 px.
    #[inline(always)]
    pub(super) fn columns_i32<S: Simd>(&self, simd: S, column: usize) -> i32x8<S> {
        i32x8::load_array(simd, self.integers.lanes) + self.integers.column(column)
    }

    /// Returns the vertical positions of eight rows, starting at row `first`, and their horizontal shifts, in steps of
    /// 1/256 px.
    #[inline(always)]
    pub(super) fn rows_i32<S: Simd>(&self, simd: S, first: usize) -> [i32x8<S>; 2] {
        let rows = i32x8::load_array(simd, self.integers.rows) + self.integers.row(first);
        [rows, i32x8::load_array_ref(simd, self.integers.shifts(first))]
    }

    /// Returns the position of a sample relative to the tile's first sample, in steps of 1/256 px.
    #[inline(always)]
    pub(super) fn place(&self, SamplePlace { column, row }: SamplePlace) -> [i32; 2] {
        let steps = &self.integers;
        [steps.column(column) + steps.shift(row), steps.row(row)]
    }

    /// Returns the first and the last column (axis 0) or row (axis 1) of the packed picture whose samples lie between
    /// the positions `least` and `greatest`, in steps of 1/256 px.
    ///
    /// Both may lie outside the picture. The range never omits a sample, and is rarely larger than necessary.
    #[inline(always)]
    pub(super) fn range(&self, axis: usize, least: f32, greatest: f32) -> [f32; 2] {
        let half = HALF_PIXEL as f32;
        let [before, behind] = self.reach[axis];
        let (least, greatest) = (least - behind, greatest - before);
        match self.grid {
            SampleGrid::Checkerboard | SampleGrid::OddCheckerboard if axis == 0 => {
                // Four pixels in a row hold two samples.
                let four = 4.0 * SUBPIXELS as f32;
                [((least - half) / four).floor() * 2.0, ((greatest - half) / four).floor() * 2.0 + 1.0]
            }
            _ => {
                let step = self.doubles.row_step as f32;
                [((least - half) / step).ceil(), ((greatest - half) / step).floor()]
            }
        }
    }
}

impl TileLattice {
    /// Divides distances by the distance between rows. Multiplies by the reciprocal where it is exact, because that is
    /// faster.
    #[inline(always)]
    fn per_row<S: Simd>(&self, steps: F32<S>) -> F32<S> {
        let step = self.doubles.row_step as f32;
        if self.has_exact_reciprocal { steps * (1.0 / step) } else { steps / step }
    }

    /// Computes [`TileLattice::range`] for eight ranges.
    #[inline(always)]
    pub(super) fn range_lanes<S: Simd>(&self, simd: S, axis: usize, least: F32<S>, greatest: F32<S>) -> [F32<S>; 2] {
        let half = F32::splat(simd, HALF_PIXEL as f32);
        let [before, behind] = self.reach[axis];
        let (least, greatest) = (least - behind, greatest - before);
        match self.grid {
            SampleGrid::Checkerboard | SampleGrid::OddCheckerboard if axis == 0 => {
                let per_four = 1.0 / (4.0 * SUBPIXELS as f32);
                [((least - half) * per_four).floor() * 2.0, ((greatest - half) * per_four).floor() * 2.0 + 1.0]
            }
            _ => [self.per_row(least - half).ceil(), self.per_row(greatest - half).floor()],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::lanes::{Lanes, each, on_lanes};

    #[test]
    fn vectorized_ranges_equal_scalar_ranges() {
        let grids = [1, 2, 3, 4, 5].map(|step| SampleGrid::Block { step });
        let mut random = fastrand::Rng::with_seed(9);
        for grid in grids.into_iter().chain([SampleGrid::Checkerboard, SampleGrid::OddCheckerboard]) {
            let centres = TileLattice::new(grid);
            let samples = [
                centres.moved([-33, 5]),
                centres.with_samples(&[[-96, 32], [97, -128]]),
                centres.spread([[-112, 16], [-16, 112]]),
            ];
            for lattice in [centres].into_iter().chain(samples) {
                for _ in 0..200 {
                    let ends: [[f32; 2]; LANES] = std::array::from_fn(|_| {
                        let (least, bits) = (random.i32(-(1 << 14)..1 << 22), random.u32(..22));
                        [least, least + random.i32(0..1 << bits)].map(|step| step as f32)
                    });
                    for (lanes, axis) in Lanes::all().flat_map(|lanes| [(lanes, 0), (lanes, 1)]) {
                        let [first, last] = on_lanes!(lanes, simd => {
                            let [least, greatest] =
                                each!(i in [0, 1] => F32::load_array(simd, ends.map(|ends| ends[i])));
                            let [first, last] = lattice.range_lanes(simd, axis, least, greatest);
                            [first.to_array(), last.to_array()]
                        });
                        for lane in 0..LANES {
                            let [least, greatest] = ends[lane];
                            assert_eq!([first[lane], last[lane]], lattice.range(axis, least, greatest), "{grid:?}");
                        }
                    }
                }
            }
        }
    }
}
