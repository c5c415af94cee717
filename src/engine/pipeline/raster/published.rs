//! Two rasterizers as tutorials commonly publish them, kept only to demonstrate their faults.
//!
//! They compute in f64 whichever arithmetic is selected, so that visible errors are faults of the method and not of
//! rounding.

use super::{PixelRange, RasterTarget, RasterizerFacts};
use crate::pipeline::choice::Label;

/// Height in pixels below which a side counts as horizontal.
const FLAT_PX: f64 = 1e-6;

pub(super) const BOUNDING_BOX: RasterizerFacts = RasterizerFacts {
    label: Label {
        id: "bounding-box-published",
        name: "Bounding box (as published)",
        help: "Wrong on purpose: samples at pixel corners, shared edges drawn twice, clockwise triangles not drawn.",
        synonyms: &[],
    },
};

/// Rasterizes by the bounding-box test as commonly published, with three faults. Samples lie at the pixels' top-left
/// corners, which shifts the triangle by half a pixel. Samples on a shared edge are drawn by both triangles. Clockwise
/// triangles are not drawn.
pub(super) fn bounding_box(corners_px: [[f32; 2]; 3], canvas: &mut RasterTarget<'_>) {
    let [a, b, c] = corners_px.map(|corner| corner.map(f64::from));
    let range = |axis: usize| PixelRange {
        first: a[axis].min(b[axis]).min(c[axis]) as i64,
        last: a[axis].max(b[axis]).max(c[axis]) as i64,
    };
    let cross = |from: [f64; 2], to: [f64; 2], x: f64, y: f64| {
        (to[0] - from[0]) * (y - from[1]) - (to[1] - from[1]) * (x - from[0])
    };
    let (columns, rows) = (range(0), range(1));
    for row in canvas.rows(rows) {
        let y = canvas.pixel_row(row) as f64;
        let samples = canvas.columns(row, columns.first, columns.last.saturating_add(1));
        canvas.visit(samples.len());
        for column in samples {
            let x = f64::from(canvas.grid.pixel(column, row).0);
            if cross(a, b, x, y) <= 0.0 && cross(b, c, x, y) <= 0.0 && cross(c, a, x, y) <= 0.0 {
                canvas.emit(row, column..column + 1);
            }
        }
    }
}

pub(super) const SCANLINE: RasterizerFacts = RasterizerFacts {
    label: Label {
        id: "scanline-published",
        name: "Scanline (as published)",
        help: "Wrong on purpose: rounds the vertex where it splits the triangle, starts rows at a vertex instead of \
               at the row's centre, and draws both ends of a row.",
        synonyms: &[],
    },
};

/// Rasterizes by scan conversion as commonly published, with three faults. A rounded fourth vertex bends the long edge.
/// Sides start at the vertex instead of at the first row's centre, which shifts rows by up to a pixel times the slope.
/// The pixels at both ends of a row are drawn.
pub(super) fn scanline(corners_px: [[f32; 2]; 3], canvas: &mut RasterTarget<'_>) {
    let mut corners = corners_px.map(|corner| corner.map(f64::from));
    corners.sort_by(|a, b| a[1].total_cmp(&b[1]));
    let [top, middle, bottom] = corners;
    let share = if bottom[1] - top[1] > FLAT_PX { (middle[1] - top[1]) / (bottom[1] - top[1]) } else { 0.0 };
    let fourth = [(top[0] + share * (bottom[0] - top[0])).round(), middle[1]];
    half(canvas, [top, middle], [top, fourth]);
    half(canvas, [middle, bottom], [fourth, bottom]);
}

/// Fills one half of the split triangle, row by row between two sides. The upper endpoints of both sides have the same
/// y, and so do the lower endpoints.
fn half(canvas: &mut RasterTarget<'_>, one: [[f64; 2]; 2], other: [[f64; 2]; 2]) {
    let height = one[1][1] - one[0][1];
    if height <= FLAT_PX {
        return;
    }
    let slope = |side: [[f64; 2]; 2]| (side[1][0] - side[0][0]) / height;
    let (first, end) = (one[0][1].floor(), one[1][1].floor());
    for row in canvas.rows(PixelRange { first: first as i64, last: (end as i64).saturating_sub(1) }) {
        let steps = canvas.pixel_row(row) as f64 - first;
        let at = |side: [[f64; 2]; 2]| (side[0][0] + slope(side) * steps) as i64;
        let samples = canvas.columns(row, at(one).min(at(other)), at(one).max(at(other)).saturating_add(1));
        canvas.visit(samples.len());
        canvas.emit(row, samples);
    }
}
