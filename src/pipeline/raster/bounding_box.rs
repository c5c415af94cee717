//! The bounding-box rasterizer: every sample of the box around a triangle is tested against its three edges.
//!
//! The plainest algorithm, and the reference for all others. It visits two samples for each covered one of a large
//! triangle, and many more for slivers that lie across; the clamp to the scissor bounds it by the picture's size.

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
    let (left, right) = pixel_range(edges.x_range(), scissor.left, scissor.right);
    let (top, bottom) = pixel_range(edges.y_range(), scissor.top, scissor.bottom);
    let mut visited = 0;
    for row in grid.rows(top, bottom) {
        let columns = grid.columns(row, left, right);
        visited += columns.len() as u64;
        for column in columns {
            let values = edges.at(grid.position(column, row));
            if edges.contains(values) {
                sink(Sample { column, row, edges: values });
            }
        }
    }
    visited
}
