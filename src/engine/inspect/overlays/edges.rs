//! Triangle edges as lines, and their ownership under the fill rule.

use super::sheet::{Sheet, SheetLegend, Total};
use super::watch::corners_px;
use super::{Overlay, OverlayContext};
use crate::chain::{Frame, Recipe};
use crate::image::Image;
use crate::pipeline::prepare;
use crate::pipeline::raster::AnyTriangle;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::wireframe::line_pixels;
use crate::scene::Scene;
use crate::upscale::Sampling;

/// Draws the edges of all rasterized triangles, between unsnapped or snapped corners depending on `overlay`.
pub(super) fn wireframe(overlay: Overlay, context: &OverlayContext<'_>) -> Sheet {
    let OverlayContext { scene, recipe, frame, .. } = context;
    let size = frame.image().size();
    let mut values = Image::filled(size.0, size.1, f32::NAN);
    let mut lines = Vec::new();
    each_triangle(scene, recipe, frame, |triangle| {
        let [a, b, c] = match overlay {
            Overlay::SnappedWireframe => corners_px(triangle, recipe.pipeline.arithmetic),
            _ => triangle.corners_px(),
        };
        for [from, to] in [[a, b], [b, c], [c, a]] {
            lines.push([from, to]);
            let wide = |[x, y]: [f32; 2]| (f64::from(x), f64::from(y));
            line_pixels(wide(from), wide(to), size).for_each(|(x, y)| values.set(x, y, 1.0));
        }
    });
    let on_lines = values.pixels().iter().filter(|value| !value.is_nan()).count();
    let totals = vec![
        Total { name: "triangles", number: (lines.len() / 3) as f64, unit: "" },
        Total { name: "pixels on lines", number: on_lines as f64, unit: "px" },
    ];
    Sheet { lines, ..Sheet::new(overlay, values, SheetLegend::Lines, totals) }
}

/// Calls `sink` with every rasterized triangle, projected to the full picture.
pub(super) fn each_triangle(scene: &Scene, recipe: &Recipe, frame: &Frame, sink: impl FnMut(&ScreenTriangle)) {
    match frame.sampling {
        Sampling::Grid(_) => frame.geometry().triangles.iter().for_each(sink),
        Sampling::Lattice(_) => {
            let geometry = prepare(scene, &frame.camera, &recipe.pipeline, frame.viewport, &mut ());
            geometry.triangles.iter().for_each(sink);
        }
    }
}

/// An edge of a triangle, with its inner side and ownership.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeMarks {
    /// Endpoints in px, at the corners that the rasterizer uses.
    pub ends_px: [[f32; 2]; 2],
    /// Unit vector from the edge into the triangle, y down.
    pub inward: [f32; 2],
    /// Whether samples exactly on the edge belong to the triangle.
    pub owned: bool,
}

/// Returns the edges of rasterized triangles whose bounding boxes overlap a rectangle (left, top, right, bottom in px
/// of the picture). Stops after the triangle that brings the number of edges to `most` or more. Returns no edges for
/// lattice sampling, which does not rasterize at the full resolution.
pub fn edge_marks(frame: &Frame, recipe: &Recipe, [left, top, right, bottom]: [f32; 4], most: usize) -> Vec<EdgeMarks> {
    if matches!(frame.sampling, Sampling::Lattice(_)) {
        return Vec::new();
    }
    let settings = &recipe.pipeline;
    let meets = |corners: &[[f32; 2]; 3]| {
        let least = |axis: usize| corners.iter().map(|c| c[axis]).fold(f32::INFINITY, f32::min);
        let most = |axis: usize| corners.iter().map(|c| c[axis]).fold(f32::NEG_INFINITY, f32::max);
        most(0) >= left && least(0) <= right && most(1) >= top && least(1) <= bottom
    };
    let mut marks = Vec::new();
    for triangle in &frame.geometry().triangles {
        let corners = corners_px(triangle, settings.arithmetic);
        if !meets(&corners) {
            continue;
        }
        let Some(edges) = AnyTriangle::new(settings.arithmetic, triangle.corners_px(), settings.fill_rule) else {
            continue;
        };
        let owned = edges.owned();
        for (opposite, owned) in owned.into_iter().enumerate() {
            let (from, to) = (corners[(opposite + 1) % 3], corners[(opposite + 2) % 3]);
            marks.push(EdgeMarks { ends_px: [from, to], inward: inward(from, to, corners[opposite]), owned });
        }
        if marks.len() >= most {
            break;
        }
    }
    marks
}

/// Returns the unit normal of a line, directed to the side on which the point `inside` lies; zero for a line of zero
/// length.
fn inward(from: [f32; 2], to: [f32; 2], inside: [f32; 2]) -> [f32; 2] {
    let (along, down) = (to[0] - from[0], to[1] - from[1]);
    let length = along.hypot(down);
    if length == 0.0 {
        return [0.0; 2];
    }
    let side = -down * (inside[0] - from[0]) + along * (inside[1] - from[1]);
    [-down / length * side.signum(), along / length * side.signum()]
}
