//! Sample positions of a tile: on a regular lattice, or jittered around its points.
//!
//! In fixed point, a sample's offset from its lattice point changes each edge value by an integer. Edge values of
//! samples off the lattice therefore stay exact.

use super::edge_number::EdgeNumber;
use super::lattice::TileLattice;
use super::layout::{ROWS, STRIDE, SamplePlace, TILE};
use super::setup::EdgeFunctions;
use crate::math::lanes::*;

/// Sample positions in a tile, one for each point of a lattice.
pub(super) trait SamplePositions: Copy {
    /// Whether all samples lie exactly on the lattice points.
    const ON_LATTICE: bool;

    /// Returns the lattice. Its block size includes the jitter of the samples.
    fn lattice(&self) -> &TileLattice;

    /// Converts the edge values at eight lattice points of a row to the edge values at the corresponding samples.
    /// `first` is the place of the first sample.
    fn jittered<S: Simd, E: EdgeNumber>(
        self,
        simd: S,
        edges: &EdgeFunctions<E>,
        e: [E::Eight<S>; 3],
        first: SamplePlace,
    ) -> [E::Eight<S>; 3];

    /// Converts edge values like [`SamplePositions::jittered`], for four samples of a row and the four below.
    fn jittered_in_two_rows<S: Simd, E: EdgeNumber>(
        self,
        simd: S,
        edges: &EdgeFunctions<E>,
        e: [E::Eight<S>; 3],
        first: SamplePlace,
    ) -> [E::Eight<S>; 3];

    /// Returns the positions of eight samples in each of two rows, starting at `column`. They are relative to the
    /// centre of the tile's first pixel, to the right and down, in steps of 1/256 px.
    fn positions<S: Simd>(self, simd: S, column: usize, rows: [usize; 2]) -> [i32x16<S>; 2];
}

impl SamplePositions for &TileLattice {
    const ON_LATTICE: bool = true;

    #[inline(always)]
    fn lattice(&self) -> &TileLattice {
        self
    }

    #[inline(always)]
    fn jittered<S: Simd, E: EdgeNumber>(
        self,
        _: S,
        _: &EdgeFunctions<E>,
        e: [E::Eight<S>; 3],
        _: SamplePlace,
    ) -> [E::Eight<S>; 3] {
        e
    }

    #[inline(always)]
    fn jittered_in_two_rows<S: Simd, E: EdgeNumber>(
        self,
        _: S,
        _: &EdgeFunctions<E>,
        e: [E::Eight<S>; 3],
        _: SamplePlace,
    ) -> [E::Eight<S>; 3] {
        e
    }

    #[inline(always)]
    fn positions<S: Simd>(self, simd: S, column: usize, rows: [usize; 2]) -> [i32x16<S>; 2] {
        let ([right, down], columns) = (self.offset(), self.columns_i32(simd, column));
        let [upper, lower] = each!(row in [rows[0], rows[1]] => {
            let steps = &self.integers;
            (columns + (steps.shift(row) + right), i32x8::splat(simd, steps.row(row) + down))
        });
        [upper.0.combine(lower.0), upper.1.combine(lower.1)]
    }
}

/// Offsets of a tile's samples from the lattice points, to the right and down, in steps of 1/256 px. The memory is
/// reused from tile to tile.
#[derive(Clone, Debug, Default)]
pub(super) struct Offsets {
    /// Offsets along each axis, in the memory layout of a [`super::tile::Tile`].
    along: [Vec<f32>; 2],
}

impl Offsets {
    /// Returns the memory use in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.along.iter().map(|offsets| offsets.capacity() * size_of::<f32>()).sum()
    }

    /// Allocates memory for the offsets of a tile.
    pub(super) fn reserve(&mut self) {
        for offsets in &mut self.along {
            offsets.resize(STRIDE * ROWS, 0.0);
        }
    }

    /// Returns the offsets of the samples in a row along each axis, for the caller to fill.
    pub(super) fn row_mut(&mut self, row: usize) -> [&mut [f32]; 2] {
        self.along.each_mut().map(|offsets| &mut offsets[row * STRIDE..][..TILE])
    }

    #[inline(always)]
    fn eight<S: Simd>(&self, simd: S, first: SamplePlace) -> [F32<S>; 2] {
        each!(axis in [0, 1] => F32::from_slice(simd, &self.along[axis][first.memory_index()..][..LANES]))
    }

    #[inline(always)]
    fn four_by_two<S: Simd>(&self, simd: S, first: SamplePlace) -> [F32<S>; 2] {
        const HALF: usize = LANES / 2;
        each!(axis in [0, 1] => {
            let offsets = &self.along[axis][first.memory_index()..][..STRIDE + HALF];
            f32x4::from_slice(simd, &offsets[..HALF]).combine(f32x4::from_slice(simd, &offsets[STRIDE..]))
        })
    }
}

/// Jittered sample positions, different in each pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct JitteredPositions<'a> {
    pub(super) lattice: &'a TileLattice,
    /// Offsets of the samples from the lattice points.
    pub(super) offsets: &'a Offsets,
}

impl SamplePositions for JitteredPositions<'_> {
    const ON_LATTICE: bool = false;

    #[inline(always)]
    fn lattice(&self) -> &TileLattice {
        self.lattice
    }

    #[inline(always)]
    fn jittered<S: Simd, E: EdgeNumber>(
        self,
        simd: S,
        edges: &EdgeFunctions<E>,
        e: [E::Eight<S>; 3],
        first: SamplePlace,
    ) -> [E::Eight<S>; 3] {
        moved(simd, edges, e, self.offsets.eight(simd, first))
    }

    #[inline(always)]
    fn jittered_in_two_rows<S: Simd, E: EdgeNumber>(
        self,
        simd: S,
        edges: &EdgeFunctions<E>,
        e: [E::Eight<S>; 3],
        first: SamplePlace,
    ) -> [E::Eight<S>; 3] {
        moved(simd, edges, e, self.offsets.four_by_two(simd, first))
    }

    #[inline(always)]
    fn positions<S: Simd>(self, simd: S, column: usize, rows: [usize; 2]) -> [i32x16<S>; 2] {
        let points = self.lattice.positions(simd, column, rows);
        let [upper, lower] = each!(row in [rows[0], rows[1]] => self.offsets.eight(simd, SamplePlace { column, row }));
        each!(axis in [0, 1] => points[axis] + upper[axis].combine(lower[axis]).to_int::<i32x16<S>>())
    }
}

/// Returns the edge values after each sample is moved to the right and down by an offset, in steps of 1/256 px. Their
/// sum, the doubled area, is unchanged.
#[inline(always)]
fn moved<S: Simd, E: EdgeNumber>(
    simd: S,
    edges: &EdgeFunctions<E>,
    e: [E::Eight<S>; 3],
    [right, down]: [F32<S>; 2],
) -> [E::Eight<S>; 3] {
    let (right, down) = (E::of_floats(simd, right), E::of_floats(simd, down));
    let [first, second] = each!(i in [0, 1] => right * edges.a[i] + down * edges.b[i]);
    [e[0] + first, e[1] + second, e[2] - (first + second)]
}

/// Edge values at eight lattice points in successive rows. They are integers, so incremental steps add no error.
pub(super) struct EdgeValueRows<S: Simd, E: EdgeNumber> {
    /// Edge values of the next row, before its horizontal shift.
    next: [E::Eight<S>; 3],
    /// Change of the edge values from one row to the next.
    step: [E::Eight<S>; 3],
    are_straight: bool,
}

impl<S: Simd, E: EdgeNumber> EdgeValueRows<S, E> {
    /// Creates the edge values, starting at row `first`. `x` has the horizontal positions of the lattice points in an
    /// unshifted row, in steps of 1/256 px.
    #[inline(always)]
    pub(super) fn new(simd: S, edges: &EdgeFunctions<E>, x: E::Eight<S>, first: usize, lattice: &TileLattice) -> Self {
        let (steps, EdgeFunctions { a, b, c }) = (E::steps(lattice), edges);
        let y = steps.row(first);
        Self {
            next: each!(i in [0, 1, 2] => x * a[i] + (c[i] + b[i] * y)),
            step: each!(i in [0, 1, 2] => E::repeat(simd, b[i]) * E::load(simd, &steps.next_row)),
            are_straight: steps.are_straight,
        }
    }

    /// Returns the edge values of the next row, which must be `row`, and advances by one row.
    #[inline(always)]
    pub(super) fn next(&mut self, edges: &EdgeFunctions<E>, row: usize, lattice: &TileLattice) -> [E::Eight<S>; 3] {
        let e = self.next;
        self.next = each!(i in [0, 1, 2] => e[i] + self.step[i]);
        if self.are_straight {
            return e;
        }
        let shift = E::steps(lattice).shift(row);
        each!(i in [0, 1, 2] => e[i] + edges.a[i] * shift)
    }
}

/// Returns the edge values at eight samples of a row, given the place of the first one.
#[inline(always)]
pub(super) fn edge_values<S: Simd>(
    simd: S,
    edges: &EdgeFunctions,
    first: SamplePlace,
    locations: impl SamplePositions,
) -> [F64<S>; 3] {
    let lattice = locations.lattice();
    let steps = &lattice.doubles;
    let x = F64::load_array_ref(simd, &steps.lanes) + (steps.column(first.column) + steps.shift(first.row));
    let y = steps.row(first.row);
    let e = each!(i in [0, 1, 2] => x * edges.a[i] + (edges.c[i] + edges.b[i] * y));
    locations.jittered(simd, edges, e, first)
}
