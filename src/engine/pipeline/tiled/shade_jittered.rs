//! Shading of jittered samples that belong to one triangle.
//!
//! The edge values of adjacent samples differ by varying steps, so they are computed from the positions of the samples.
//! Everything else is the same as for samples on a lattice.

use super::canvas::Canvas;
use super::edge_rows::{EdgeRows, exact_at};
use super::kernel::shade_rows;
use super::patch::Patch;
use super::record::{ShadedTriangle, TriangleSource as _};
use super::sample_positions::SamplePositions;
use super::setup::EdgeFunctions;
use crate::math::lanes::*;

/// Shades rows of jittered samples that belong to one triangle.
#[inline(never)]
pub(super) fn shade_jittered<S: Simd>(
    simd: S,
    subject: &ShadedTriangle<'_>,
    patch: &Patch,
    locations: impl SamplePositions,
    canvas: &mut Canvas<'_>,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let frame = canvas.frame;
            let Some(edges) = subject.edges.filter(|_| !frame.shader(subject.draw).on_lanes) else {
                let mut edges = PlacedRows { subject, locations, first: (patch.column, patch.first) };
                return shade_rows(simd, subject, patch, canvas, &mut edges);
            };
            let whole = frame.classic(subject.key, subject.draw, canvas.place);
            for block in patch.blocks() {
                for row in block.first..block.end {
                    let places = locations.positions(simd, block.column, [row; 2]);
                    let e = edges_of_row(edges, each!(axis in [0, 1] => places[axis].to_array()));
                    whole.shade_row(&block, row, &e, canvas.picture.row(&block, row));
                }
            }
        },
    );
}

/// Source of edge values that are computed from the positions of the samples.
struct PlacedRows<'a, L> {
    subject: &'a ShadedTriangle<'a>,
    locations: L,
    /// Column and row of the current block's first sample, within the tile.
    first: (usize, usize),
}

impl<S: Simd, L: SamplePositions> EdgeRows<S> for PlacedRows<'_, L> {
    #[inline(always)]
    fn begin(&mut self, _: S, block: &Patch) {
        self.first = (block.column, block.first);
    }

    #[inline(always)]
    fn at(&self, simd: S, rows: [usize; 2]) -> [f32x16<S>; 3] {
        let (column, first) = self.first;
        let places = self.locations.positions(simd, column, each!(row in [rows[0], rows[1]] => first + row));
        if let Some(edges) = self.subject.edges {
            return exact_at(simd, edges, places);
        }
        let e = self.subject.one.edge_values(simd, places);
        each!(i in [0, 1, 2] => e[i].to_float::<f32x16<S>>())
    }
}

/// Returns the edge values at the first eight of sixteen positions, indexed by edge and lane.
fn edges_of_row(edges: &EdgeFunctions, [x, y]: [[i32; WIDE]; 2]) -> [[f64; LANES]; 3] {
    let mut of_row = [[0.0; LANES]; 3];
    for lane in 0..LANES {
        for (values, value) in of_row.iter_mut().zip(edges.at([x[lane], y[lane]])) {
            values[lane] = value;
        }
    }
    of_row
}
