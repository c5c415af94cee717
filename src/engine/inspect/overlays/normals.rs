//! Overlays of vertex and face normals, drawn as lines.

use super::edges::each_triangle;
use super::sheet::{PixelKind, Sheet, SheetLegend, Total};
use super::{Overlay, OverlayContext};
use crate::image::{Image, Rgba8};
use crate::inspect::normals::{NormalKind, Projector, normal_lines, world_length};
use crate::pipeline::wireframe::line_pixels;

/// Colour of vertex normals, in sRGB codes.
pub(crate) const VERTEX_NORMAL: Rgba8 = [64, 220, 232, 255];

/// Colour of face normals, in sRGB codes.
pub(crate) const FACE_NORMAL: Rgba8 = [255, 208, 64, 255];

const VERTEX: [PixelKind; 1] = [PixelKind { name: "vertex normal", color: VERTEX_NORMAL, striped: false }];

const FACE: [PixelKind; 1] = [PixelKind { name: "face normal", color: FACE_NORMAL, striped: false }];

/// Draws the normals of all rasterized triangles; `length` is a fraction of the diagonal of the scene's bounding box.
pub(super) fn normals(overlay: Overlay, length: f32, context: &OverlayContext<'_>) -> Sheet {
    let OverlayContext { scene, recipe, frame, .. } = context;
    let size = frame.image().size();
    let (kind, key) = match overlay {
        Overlay::FaceNormals => (NormalKind::Face, &FACE),
        _ => (NormalKind::Vertex, &VERTEX),
    };
    let mut triangles = Vec::new();
    each_triangle(scene, recipe, frame, |triangle| triangles.push(triangle.id));
    // Pieces of one triangle are consecutive.
    triangles.dedup();
    let projector = Projector::new(&frame.camera, frame.viewport);
    let found = normal_lines(scene, kind, world_length(scene, length), triangles.into_iter(), &projector);
    let mut values = Image::filled(size.0, size.1, f32::NAN);
    for [from, to] in &found.lines {
        line_pixels((*from).into(), (*to).into(), size).for_each(|(x, y)| values.set(x, y, 0.0));
    }
    let totals = vec![
        Total { name: key[0].name, number: found.lines.len() as f64, unit: "" },
        Total { name: "without a normal", number: found.without as f64, unit: "" },
    ];
    let lines = found.lines.iter().map(|ends| ends.map(|end| end.map(|c| c as f32))).collect();
    Sheet { lines, length: Some(length), ..Sheet::new(overlay, values, SheetLegend::Kinds(key), totals) }
}
