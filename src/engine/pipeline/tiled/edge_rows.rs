//! Edge values at the samples of a patch, for eight samples in each of two rows at a time.

use super::lattice::TileLattice;
use super::patch::Patch;
use super::record::Record;
use super::setup::EdgeFunctions;
use crate::math::lanes::*;

/// Source of the edge values at the samples of a patch.
pub(super) trait EdgeRows<S: Simd> {
    /// Moves to one of the blocks of the patch.
    fn begin(&mut self, simd: S, block: &Patch);

    /// Returns the edge values of eight samples in each of two rows of the block. Rows are counted from the first row
    /// of the patch.
    fn at(&self, simd: S, rows: [usize; 2]) -> [f32x16<S>; 3];
}

/// Edge values of up to eight rows in 32-bit integers, for triangles whose edge values fit. Sums may wrap around, but
/// are correct at samples that the triangle covers.
pub(super) struct IntegerRows<'a, S: Simd> {
    lattice: &'a TileLattice,
    /// Change of the first two edge values per 1/256 px to the right.
    a: [i32; 2],
    /// Differences between the edge values of the eight samples in a row of the block and the edge values at the start
    /// of the row. They are repeated for the second row.
    along: [i32x16<S>; 2],
    /// Edge values at the start of each row.
    down: [[i32; LANES]; 2],
    doubled_area: i32,
}

impl<'a, S: Simd> IntegerRows<'a, S> {
    #[inline(always)]
    pub(super) fn new(simd: S, lattice: &'a TileLattice, record: &Record, patch: &Patch) -> Self {
        let [y, shift] = lattice.rows_i32(simd, patch.first);
        let ([a0, b0, c0], [a1, b1, c1], doubled_area) = record.integer_edges();
        let down = each!((a, b, c) in [(a0, b0, c0), (a1, b1, c1)] => (y * b + shift * a + c).to_array());
        Self { lattice, a: [a0, a1], along: [i32x16::splat(simd, 0); 2], down, doubled_area }
    }
}

impl<S: Simd> EdgeRows<S> for IntegerRows<'_, S> {
    #[inline(always)]
    fn begin(&mut self, simd: S, block: &Patch) {
        let columns = self.lattice.columns_i32(simd, block.column);
        self.along = each!(edge in [0, 1] => {
            let along = columns * self.a[edge];
            along.combine(along)
        });
    }

    #[inline(always)]
    fn at(&self, simd: S, [upper, lower]: [usize; 2]) -> [f32x16<S>; 3] {
        let [first, second] = each!(edge in [0, 1] => {
            let down = i32x8::splat(simd, self.down[edge][upper]).combine(i32x8::splat(simd, self.down[edge][lower]));
            self.along[edge] + down
        });
        let third = i32x16::splat(simd, self.doubled_area) - first - second;
        each!(e in [first, second, third] => e.to_float::<f32x16<S>>())
    }
}

/// Edge values of up to eight rows in doubles, for any triangle.
pub(super) struct ExactRows<'a, S: Simd> {
    lattice: &'a TileLattice,
    /// Change of the edge values per 1/256 px to the right.
    a: [f64; 3],
    /// Differences between the edge values of the eight samples in a row of the block and the edge values at the start
    /// of the row.
    along: [F64<S>; 3],
    /// Edge values at the start of each row.
    down: [[f64; LANES]; 3],
}

impl<'a, S: Simd> ExactRows<'a, S> {
    #[inline(always)]
    pub(super) fn new(simd: S, lattice: &'a TileLattice, edges: &EdgeFunctions, patch: &Patch) -> Self {
        let EdgeFunctions { a, b, c } = *edges;
        let steps = &lattice.doubles;
        let y = F64::load_array_ref(simd, &steps.rows) + steps.row(patch.first);
        let shift = F64::load_array_ref(simd, steps.shifts(patch.first));
        let down = each!(i in [0, 1, 2] => (y * b[i] + shift * a[i] + c[i]).to_array());
        Self { lattice, a, along: [F64::splat(simd, 0.0); 3], down }
    }
}

impl<S: Simd> ExactRows<'_, S> {
    /// Returns the edge values of eight samples in a row of the block, indexed by edge and lane.
    #[inline(always)]
    pub(super) fn of_row(&self, row: usize) -> [[f64; LANES]; 3] {
        each!(edge in [0, 1, 2] => (self.along[edge] + self.down[edge][row]).to_array())
    }
}

impl<S: Simd> EdgeRows<S> for ExactRows<'_, S> {
    #[inline(always)]
    fn begin(&mut self, simd: S, block: &Patch) {
        let steps = &self.lattice.doubles;
        let columns = F64::load_array_ref(simd, &steps.lanes) + steps.column(block.column);
        self.along = each!(edge in [0, 1, 2] => columns * self.a[edge]);
    }

    #[inline(always)]
    fn at(&self, simd: S, [upper, lower]: [usize; 2]) -> [f32x16<S>; 3] {
        each!(edge in [0, 1, 2] => {
            let [upper, lower] = each!(row in [upper, lower] => narrow(simd, self.along[edge] + self.down[edge][row]));
            upper.combine(lower)
        })
    }
}

/// Returns edge values that are computed in f64, and so are valid for any triangle. Positions are relative to the
/// centre of the tile's first pixel, to the right and down, in steps of 1/256 px.
#[inline(always)]
pub(super) fn exact_at<S: Simd>(simd: S, edges: &EdgeFunctions, places: [i32x16<S>; 2]) -> [f32x16<S>; 3] {
    // Offsets are small enough for floats to hold them exactly.
    let [(x0, x1), (y0, y1)] = each!(axis in [0, 1] => places[axis].to_float::<f32x16<S>>().split());
    let [first, last] = each!((x, y) in [(x0, y0), (x1, y1)] => {
        let (x, y) = (widen(simd, x), widen(simd, y));
        each!(i in [0, 1, 2] => narrow(simd, x * edges.a[i] + y * edges.b[i] + edges.c[i]))
    });
    each!(i in [0, 1, 2] => first[i].combine(last[i]))
}
