//! Hierarchical traversal: accepts or rejects squares of pixels as a whole by testing each edge at two corners. Only
//! squares that an edge crosses are subdivided (Greene, "Hierarchical Polygon Tiling with Coverage Masks", SIGGRAPH
//! 1996).
//!
//! An edge function grows in one direction. A square is therefore outside an edge if its innermost pixel is outside,
//! and inside if its outermost pixel is inside. Squares lie on a fixed lattice and are never cut at the scissor, so the
//! coverage of a pixel does not depend on the scissor.

use super::numbers::{Numbers, RasterEdge};
use super::{PixelRange, RasterTarget, RasterTriangle, RasterizerFacts};
use crate::pipeline::choice::Label;

pub(super) const FACTS: RasterizerFacts = RasterizerFacts {
    label: Label {
        id: "tiled",
        name: "Tiled",
        help: "Accepts or rejects squares of 64 × 64 and 8 × 8 pixels as a whole; tests single pixels only in squares \
               that an edge crosses.",
        synonyms: &[],
    },
};

/// Side lengths of the squares in pixels, from coarse to fine.
const SIDES_PX: [i64; 2] = [64, 8];

/// Square of pixels, given by its top-left pixel and its side length in pixels.
#[derive(Clone, Copy)]
struct Square {
    column: i64,
    row: i64,
    side: i64,
}

/// Position of a square relative to a triangle.
#[derive(PartialEq)]
enum SquarePosition {
    Outside,
    Inside,
    Across,
}

/// Part of a triangle's bounding box that lies within the scissor rectangle, in whole pixels.
#[derive(Clone, Copy)]
struct PixelBounds {
    columns: PixelRange,
    rows: PixelRange,
}

/// Emits the covered samples of a triangle, square by square.
pub(super) fn cover<N: Numbers>(triangle: &RasterTriangle<N>, canvas: &mut RasterTarget<'_>) {
    let [columns, rows] = triangle.bounds();
    let visible = canvas.scissor();
    let within = PixelBounds { columns: columns.within(visible[0]), rows: rows.within(visible[1]) };
    for square in squares(within, SIDES_PX[0]) {
        descend(triangle, square, &SIDES_PX[1..], within, canvas);
    }
}

fn descend<N: Numbers>(
    triangle: &RasterTriangle<N>,
    square: Square,
    finer: &[i64],
    within: PixelBounds,
    canvas: &mut RasterTarget<'_>,
) {
    canvas.visit(1);
    let (columns, rows) = (square.columns().within(within.columns), square.rows().within(within.rows));
    match (place(triangle, square), finer) {
        (SquarePosition::Outside, _) => {}
        (SquarePosition::Inside, _) => {
            for row in canvas.rows(rows) {
                let samples = canvas.columns(row, columns.first, columns.last + 1);
                canvas.emit(row, samples);
            }
        }
        (SquarePosition::Across, [side, finer @ ..]) => {
            let within = PixelBounds { columns, rows };
            for part in squares(within, *side) {
                descend(triangle, part, finer, within, canvas);
            }
        }
        (SquarePosition::Across, []) => {
            for row in canvas.rows(rows) {
                let samples = canvas.columns(row, columns.first, columns.last + 1);
                canvas.visit(samples.len());
                let y = canvas.pixel_row(row);
                let inside = |column: &u32| triangle.contains(canvas.grid.pixel(*column, row).0.into(), y);
                let first = samples.clone().find(inside).unwrap_or(samples.end);
                let end = (first..samples.end).find(|column| !inside(column)).unwrap_or(samples.end);
                canvas.emit(row, first..end);
            }
        }
    }
}

/// Returns the squares of `side` × `side` px, aligned to multiples of `side`, that overlap a rectangle of pixels.
fn squares(PixelBounds { columns, rows }: PixelBounds, side: i64) -> impl Iterator<Item = Square> {
    let along =
        move |range: PixelRange| (range.first.div_euclid(side)..=range.last.div_euclid(side)).map(move |i| i * side);
    let lattice = (!columns.is_empty() && !rows.is_empty())
        .then(move || along(rows).flat_map(move |row| along(columns).map(move |column| Square { column, row, side })));
    lattice.into_iter().flatten()
}

fn place<N: Numbers>(triangle: &RasterTriangle<N>, square: Square) -> SquarePosition {
    let mut place = SquarePosition::Inside;
    for edge in triangle.edges() {
        let inward = edge.inward();
        let (innermost, outermost) =
            (square.extreme(inward.right, inward.down), square.extreme(-inward.right, -inward.down));
        if !edge.contains(innermost.0, innermost.1) {
            return SquarePosition::Outside;
        }
        if !edge.contains(outermost.0, outermost.1) {
            place = SquarePosition::Across;
        }
    }
    place
}

impl Square {
    fn columns(self) -> PixelRange {
        PixelRange { first: self.column, last: self.column + self.side - 1 }
    }

    fn rows(self) -> PixelRange {
        PixelRange { first: self.row, last: self.row + self.side - 1 }
    }

    /// Returns the column and row of the pixel of the square that lies farthest in the given direction.
    fn extreme(self, right: i8, down: i8) -> (i64, i64) {
        let pick = |range: PixelRange, direction: i8| if direction > 0 { range.last } else { range.first };
        (pick(self.columns(), right), pick(self.rows(), down))
    }
}
