//! The scanline rasterizer: on each row the first and the last covered sample are computed from the edges, and only what
//! lies between is visited.
//!
//! Classic scan conversion splits a triangle at its middle vertex and steps both sides by dx/dy; the constructed fourth
//! vertex is rounded, and stepping drifts, so neighbours crack. Here each row solves the three edge inequalities for x by
//! exact integer division, with the fill rule in the bound. The set of samples is the one of the bounding box, always;
//! what changes is how many are looked at.

use super::{EdgeFunctions, Sample, Scissor, pixel_range};
use crate::pipeline::grid::SampleGrid;

/// Hands every sample of `grid` within `scissor` that belongs to the triangle to `sink`, row by row from the top, left
/// to right. Returns how many samples were visited.
pub(super) fn rasterize(
    edges: &EdgeFunctions,
    grid: SampleGrid,
    scissor: Scissor,
    mut sink: impl FnMut(Sample),
) -> u64 {
    let (top, bottom) = pixel_range(edges.y_range(), scissor.top, scissor.bottom);
    let mut visited = 0;
    for row in grid.rows(top, bottom) {
        let (_, y) = grid.position(0, row);
        let Some(span) = edges.span(y) else { continue };
        let (left, right) = pixel_range(span, scissor.left, scissor.right);
        let columns = grid.columns(row, left, right);
        visited += columns.len() as u64;
        for column in columns {
            sink(Sample { column, row, edges: edges.at(grid.position(column, row)) });
        }
    }
    visited
}
