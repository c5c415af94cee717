//! Active edge list (Wylie, Romney, Evans and Erdahl, "Half-tone perspective drawings by computer", 1967). Edges are
//! stored in a table by their first row. Edges that the current row crosses are active. The row is filled between pairs
//! of active edges; then each active edge steps to the next row by its slope.
//!
//! The algorithm is designed for polygons with any number of edges; a triangle has two active ones at a time. In
//! integers, the step from row to row is Bresenham's and exact. In floats, adding the slope accumulates rounding
//! errors, so the edge drifts.

use super::numbers::{BoundaryWalk, Numbers, RasterEdge};
use super::{PixelRange, RasterTarget, RasterTriangle, RasterizerFacts};
use crate::pipeline::choice::Label;

pub(super) const FACTS: RasterizerFacts = RasterizerFacts {
    label: Label {
        id: "active-edge",
        name: "Active edge list",
        help: "Steps edges from row to row by their slope, and fills each row between the two active edges.",
        synonyms: &[],
    },
};

/// Entry of the edge table: an edge with the rows on which it is active.
#[derive(Clone, Copy)]
struct EdgeEntry<E> {
    edge: E,
    rows: PixelRange,
}

/// Active edge: its row-by-row walk, whether it is a left edge, and its last row.
struct Active<W> {
    walk: W,
    is_left: bool,
    last: i64,
}

/// Emits the covered samples of a triangle, row by row.
pub(super) fn cover<N: Numbers>(triangle: &RasterTriangle<N>, canvas: &mut RasterTarget<'_>) {
    let sides = triangle.sides();
    let rows = sides.rows;
    let table = [
        EdgeEntry { edge: sides.long, rows },
        EdgeEntry { edge: sides.upper, rows: PixelRange { last: sides.last_upper.min(rows.last), ..rows } },
        EdgeEntry { edge: sides.lower, rows: PixelRange { first: (sides.last_upper + 1).max(rows.first), ..rows } },
    ];
    let mut active: Vec<Active<<N::Edge as RasterEdge>::Walk>> = Vec::with_capacity(2);
    let mut present = None;
    for row in canvas.rows(rows) {
        let y = canvas.pixel_row(row);
        // A grid may skip rows, but edges step through all of them.
        let from = present.map_or(y, |before: i64| before + 1);
        for passed in from..=y {
            active.retain(|edge| edge.last >= passed);
            active.iter_mut().for_each(|edge| edge.walk.step());
            let starts = |entry: &&EdgeEntry<N::Edge>| match present {
                None => entry.rows.contains(passed),
                Some(_) => entry.rows.first == passed && entry.rows.contains(passed),
            };
            for entry in table.iter().filter(starts) {
                let is_left = entry.edge.inward().right > 0;
                active.push(Active { walk: entry.edge.walk(passed), is_left, last: entry.rows.last });
            }
            present = Some(passed);
        }
        active.sort_by_key(|edge| edge.walk.boundary());
        let [left, right] = &active[..] else { continue };
        // If the first edge is not a left edge, no pixel centre of the row lies between the two edges.
        let (left, right) = match (left.is_left, left.walk.boundary(), right.walk.boundary()) {
            (true, left, right) => (left, right),
            (false, at, _) => (at, at),
        };
        let samples = canvas.columns(row, left, right);
        canvas.visit(samples.len());
        canvas.emit(row, samples);
    }
}
