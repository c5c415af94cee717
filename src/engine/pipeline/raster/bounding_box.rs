//! Bounding-box rasterizer: tests every sample of a triangle's bounding box against the three edges.
//!
//! It is the simplest algorithm, and the reference for all others. For a large triangle it visits two samples per
//! covered one, and many more for diagonal slivers. Clamping to the scissor bounds the work by the picture's size.

use super::numbers::Numbers;
use super::{RasterTarget, RasterTriangle, RasterizerFacts};
use crate::pipeline::choice::Label;

pub(super) const FACTS: RasterizerFacts = RasterizerFacts {
    label: Label {
        id: "bounding-box",
        name: "Bounding box",
        help: "Tests every pixel in the bounding box of a triangle against the three edges: the simplest algorithm.",
        synonyms: &[],
    },
};

/// Emits the covered samples of a triangle, row by row.
pub(super) fn cover<N: Numbers>(triangle: &RasterTriangle<N>, canvas: &mut RasterTarget<'_>) {
    let [columns, rows] = triangle.bounds();
    for row in canvas.rows(rows) {
        let samples = canvas.columns(row, columns.first, columns.last + 1);
        canvas.visit(samples.len());
        let mut run = samples.start..samples.start;
        for column in samples {
            let (x, y) = canvas.grid.pixel(column, row);
            if triangle.contains(x.into(), y.into()) {
                run = if run.end == column { run.start..column + 1 } else { column..column + 1 };
            } else if !run.is_empty() {
                // Covered samples of a row are contiguous.
                break;
            }
        }
        canvas.emit(row, run);
    }
}
