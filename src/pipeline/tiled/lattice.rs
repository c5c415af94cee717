//! Where the samples of a tile lie: the packed samples of a [`SampleGrid`] in steps that lanes can take.

use super::edge_number::EdgeNumber;
use crate::math::fixed::{HALF_PIXEL, SUBPIXELS};
use crate::math::lanes::{F32, LANES, Simd, SimdBase as _, SimdFloat as _, i32x8};
use crate::pipeline::grid::SampleGrid;

/// Side of a tile in packed samples.
pub(super) const TILE: usize = 64;

/// Samples of a tile.
pub(super) const TILE_SAMPLES: usize = TILE * TILE;

/// Side of a block in packed samples: as many as there are lanes.
pub(super) const BLOCK: usize = LANES;

/// Blocks along a side of a tile.
pub(super) const BLOCKS: usize = TILE / BLOCK;

/// Rows after which shifts repeat.
const SHIFTS: usize = 4;

/// Samples by their distance from a tile's first one, in grid steps of 1/256 px.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    grid: SampleGrid,
    /// Distances as doubles and as integers.
    pub(super) doubles: Steps<f64>,
    pub(super) integers: Steps<i32>,
    /// Whether what lies between rows is a power of two.
    has_exact_reciprocal: bool,
    /// Where samples, or the points that they lie near, are from the centres of their pixels.
    offset: [i32; 2],
    /// Along each axis how far before and behind that others of the same pixel lie: the least and the greatest offset.
    reach: [[f32; 2]; 2],
}

/// Distances of samples from a tile's first one. All numbers are whole.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps<T> {
    /// From one row to the next.
    row_step: T,
    /// The same, and that to the row after the next, eight times: loaded as they are, for products on lanes.
    pub(super) next_row: [T; LANES],
    pub(super) row_after_next: [T; LANES],
    /// Whether samples stand below each other.
    pub(super) are_straight: bool,
    /// Of the eight samples of a block's row, from the first.
    pub(super) lanes: [T; LANES],
    /// Of the eight rows of a block, from the first.
    pub(super) rows: [T; LANES],
    /// How far the samples of eight rows stand to the right of those of a tile's first row, by the first of the rows.
    shifts: [[T; LANES]; SHIFTS],
    /// Of four samples of a row and the four below: columns, rows.
    pub(super) two_rows: [[T; LANES]; 2],
    /// Of the first samples of the blocks of a row.
    pub(super) blocks: [T; BLOCKS],
    /// From the first sample of a block's row to the last one, what shifts rows against each other, and how far samples may lie
    /// from their points; and from the first row of a block to the last one, and how far samples may lie from their points.
    pub(super) block: [T; 2],
}

impl<T: EdgeNumber> Steps<T> {
    fn new(grid: SampleGrid) -> Self {
        let of = |steps: i64| T::of(steps as i32);
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

    /// Of a column of rows that are not shifted.
    #[inline(always)]
    pub(super) fn column(&self, column: usize) -> T {
        // Of four pixels in a row a checkerboard samples two; both ways steps are as long as those between rows.
        let pixel = if self.are_straight { column } else { column / 2 * 4 + column % 2 };
        T::of(pixel as i32) * self.row_step
    }

    /// Of a row.
    #[inline(always)]
    pub(super) fn row(&self, row: usize) -> T {
        T::of(row as i32) * self.row_step
    }

    /// How far the samples of a row stand to the right of those of a tile's first row.
    #[inline(always)]
    pub(super) fn shift(&self, row: usize) -> T {
        self.shifts[0][row % SHIFTS]
    }

    /// The shifts of eight rows.
    #[inline(always)]
    pub(super) fn shifts(&self, first: usize) -> &[T; LANES] {
        &self.shifts[first % SHIFTS]
    }
}

#[inline(always)]
fn shift_of(grid: SampleGrid, row: usize) -> i64 {
    match grid {
        SampleGrid::Block { .. } => 0,
        // Columns count from where the rows that begin farthest to the left do; tiles begin on a row of the first kind.
        SampleGrid::Checkerboard | SampleGrid::OddCheckerboard => i64::from(grid.first_drawn(row as u32)) * SUBPIXELS,
    }
}

impl Lattice {
    /// The centres of pixels.
    pub(super) fn new(grid: SampleGrid) -> Self {
        let doubles = Steps::<f64>::new(grid);
        Self {
            grid,
            doubles,
            integers: Steps::new(grid),
            has_exact_reciprocal: (doubles.row_step as u64).is_power_of_two(),
            offset: [0; 2],
            reach: [[0.0; 2]; 2],
        }
    }

    /// The same pixels, each with its sample at an offset from the centre.
    pub(super) fn moved(self, offset: [i32; 2]) -> Self {
        Self { offset, reach: offset.map(|along| [along as f32; 2]), ..self }
    }

    /// The same pixels, each with samples at all of these offsets from the centre, which stands for them: ranges are those of
    /// any of the samples.
    pub(super) fn with_samples(self, offsets: &[[i32; 2]]) -> Self {
        let reach = [0, 1].map(|axis| {
            let along = || offsets.iter().map(|offset| offset[axis]);
            [along().fold(0, i32::min) as f32, along().fold(0, i32::max) as f32]
        });
        Self { reach, ..self }
    }

    /// The same pixels, each with its sample somewhere from a least to a greatest offset from the centre. The points of the
    /// lattice are those of the least offset; its blocks reach to the greatest.
    pub(super) fn spread(mut self, [least, greatest]: [[i32; 2]; 2]) -> Self {
        for axis in 0..2 {
            let spread = greatest[axis] - least[axis];
            self.integers.block[axis] += spread;
            self.doubles.block[axis] += f64::from(spread);
        }
        Self { offset: least, reach: [0, 1].map(|axis| [least[axis] as f32, greatest[axis] as f32]), ..self }
    }

    /// From the centres of pixels to their samples.
    pub(super) fn offset(&self) -> [i32; 2] {
        self.offset
    }

    /// The greatest distance along an axis between places of one pixel that are sampled.
    pub(super) fn extent(&self) -> f64 {
        let [across, down] = self.reach.map(|[least, greatest]| greatest - least);
        across.max(down).into()
    }

    /// Position of a tile's first sample, in grid steps.
    pub(super) fn origin(&self, tile: (usize, usize)) -> [f64; 2] {
        let (x, y) = self.grid.pixel((tile.0 * TILE) as u32, (tile.1 * TILE) as u32);
        let x = x - self.grid.pixel(0, 0).0;
        let step = |pixel: u32| (i64::from(pixel) * SUBPIXELS + HALF_PIXEL) as f64;
        [step(x) + f64::from(self.offset[0]), step(y) + f64::from(self.offset[1])]
    }

    /// From the first sample of a tile to the last one, along both axes.
    #[inline(always)]
    pub(super) fn tile_extent(&self) -> [f64; 2] {
        let Steps { blocks, block: [width, height], .. } = &self.doubles;
        [blocks[BLOCKS - 1] + width, self.doubles.row((BLOCKS - 1) * BLOCK) + height]
    }

    /// Farther than any sample of a tile lies from the tile's first pixel along either axis, and any beyond that which eight at a
    /// time or two rows at a time take in. Of a lattice that reaches to all samples of its pixels.
    #[inline(always)]
    pub(super) fn farthest(&self) -> f64 {
        let (columns, rows) = (self.doubles.column(TILE + LANES), self.doubles.row(TILE + LANES));
        columns.max(rows) + 2.0 * self.extent()
    }

    /// Eight columns of a row from `column` on, not shifted, as integers.
    #[inline(always)]
    pub(super) fn columns_i32<S: Simd>(&self, simd: S, column: usize) -> i32x8<S> {
        i32x8::load_array(simd, self.integers.lanes) + self.integers.column(column)
    }

    /// Eight rows from `first` on, and how far their samples are shifted to the right, as integers.
    #[inline(always)]
    pub(super) fn rows_i32<S: Simd>(&self, simd: S, first: usize) -> [i32x8<S>; 2] {
        let rows = i32x8::load_array(simd, self.integers.rows) + self.integers.row(first);
        [rows, i32x8::load_array_ref(simd, self.integers.shifts(first))]
    }

    /// Distance of a sample from the tile's first one, by its column and row.
    #[inline(always)]
    pub(super) fn place(&self, (column, row): (usize, usize)) -> [i32; 2] {
        let steps = &self.integers;
        [steps.column(column) + steps.shift(row), steps.row(row)]
    }

    /// Packed columns or rows from the first to the last that may lie within a range of grid steps; both may be beyond the
    /// picture. Never too few, seldom too many.
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

impl Lattice {
    /// Grid steps divided by those between rows. Where that is a power of two its reciprocal is exact, and multiplies faster.
    #[inline(always)]
    fn per_row<S: Simd>(&self, steps: F32<S>) -> F32<S> {
        let step = self.doubles.row_step as f32;
        if self.has_exact_reciprocal { steps * (1.0 / step) } else { steps / step }
    }

    /// [`Lattice::range`] for eight ranges.
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
    fn eight_ranges_are_the_same_as_one_by_one() {
        let grids = [1, 2, 3, 4, 5].map(|step| SampleGrid::Block { step });
        let mut random = fastrand::Rng::with_seed(9);
        for grid in grids.into_iter().chain([SampleGrid::Checkerboard, SampleGrid::OddCheckerboard]) {
            let centres = Lattice::new(grid);
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
