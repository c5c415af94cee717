//! Edge walking: follows the long edge from the top to the bottom vertex, and scans every row from this edge towards
//! the other two edges.
//!
//! The simple form walks the *pixels* of the long edge as a line. If the edge is nearly horizontal, the line has
//! several pixels in the same row, so this row is filled several times. The pixels of the line are rounded positions,
//! so some of them may lie outside the triangle. This version walks rows, and starts each row at the first pixel inside
//! the long edge. The end of a row is found by testing, which visits one sample beyond the triangle per row.

use super::numbers::{Numbers, RasterEdge};
use super::{RasterTarget, RasterTriangle, RasterizerFacts};
use crate::pipeline::choice::Label;

pub(super) const FACTS: RasterizerFacts = RasterizerFacts {
    label: Label {
        id: "edge-walk",
        name: "Edge walk",
        help: "Walks down the longest edge and, on each row, from that edge towards the other two until it leaves the \
               triangle.",
        synonyms: &[],
    },
};

/// Emits the covered samples of a triangle, row by row.
pub(super) fn cover<N: Numbers>(triangle: &RasterTriangle<N>, canvas: &mut RasterTarget<'_>) {
    let sides = triangle.sides();
    for row in canvas.rows(sides.rows) {
        let y = canvas.pixel_row(row);
        let start = sides.long.boundary(y);
        let inside = |canvas: &mut RasterTarget<'_>, column: u32| {
            canvas.visit(1);
            let x = canvas.grid.pixel(column, row).0.into();
            sides.upper.contains(x, y) && sides.lower.contains(x, y)
        };
        let run = if sides.long_is_left() {
            let ahead = canvas.columns(row, start, i64::MAX);
            let end = ahead.clone().find(|column| !inside(canvas, *column)).unwrap_or(ahead.end);
            ahead.start..end
        } else {
            let behind = canvas.columns(row, i64::MIN, start);
            let last_outside = behind.clone().rev().find(|column| !inside(canvas, *column));
            last_outside.map_or(behind.start, |column| column + 1)..behind.end
        };
        canvas.emit(row, run);
    }
}
