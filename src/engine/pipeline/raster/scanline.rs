//! Scan conversion: splits a triangle at its middle vertex and covers the columns between its two sides on each row.
//!
//! The textbook version constructs a fourth vertex on the long edge and steps both sides from vertex to vertex. The
//! constructed vertex is rounded, so the long edge bends and cracks appear between adjacent triangles. Stepping from
//! the vertex instead of from the first row's centre shifts every row. In this version the long edge stays whole and
//! both crossings are computed for every row. There is no division by the height of a horizontal edge, because such an
//! edge bounds no row.

use super::numbers::{Numbers, RasterEdge};
use super::{RasterTarget, RasterTriangle, RasterizerFacts};
use crate::pipeline::choice::Label;

pub(super) const FACTS: RasterizerFacts = RasterizerFacts {
    label: Label {
        id: "scanline",
        name: "Scanline",
        help: "Splits the triangle at its middle vertex; computes the first and last pixel inside on each row, and \
               visits only those between.",
        synonyms: &[],
    },
};

/// Emits the covered samples of a triangle, row by row.
pub(super) fn cover<N: Numbers>(triangle: &RasterTriangle<N>, canvas: &mut RasterTarget<'_>) {
    let sides = triangle.sides();
    for row in canvas.rows(sides.rows) {
        let y = canvas.pixel_row(row);
        let (long, short) = (sides.long.boundary(y), sides.short(y).boundary(y));
        let (left, right) = if sides.long_is_left() { (long, short) } else { (short, long) };
        let samples = canvas.columns(row, left, right);
        canvas.visit(samples.len());
        canvas.emit(row, samples);
    }
}
