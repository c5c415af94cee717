//! Wireframe overlay: the edges of triangles as one-pixel lines over a finished picture.
//!
//! Edges run between *snapped* corners, the positions that the rasterizer uses. A line's colour contrasts with the
//! picture below, light on dark and dark on light, so that lines stay visible on any picture. [`crosses`] finds the
//! edge over a single pixel, which lets the inspector explain that pixel.

use super::screen_triangle::ScreenTriangle;
use super::screen_vertex::ScreenVertex;
use crate::flat2d::line::{clip_to, midpoint_line};
use crate::image::color::luma;
use crate::image::{Image, Rgba8};
use crate::math::fixed::to_pixels;
use crate::scene::TriangleId;

/// Luma, 0 to 255, below which a pixel counts as dark and gets a light line.
const DARK_BELOW_LUMA: f32 = 110.0;

/// Draws the edges of all `triangles` over a picture.
pub(crate) fn overlay(triangles: &[ScreenTriangle], image: &mut Image<Rgba8>) {
    let mut on_line = Image::filled(image.width(), image.height(), false);
    for triangle in triangles {
        for (x, y) in edge_pixels(triangle, image.size()) {
            on_line.set(x, y, true);
        }
    }
    for (pixel, covered) in image.pixels_mut().iter_mut().zip(on_line.pixels()) {
        if *covered {
            *pixel = line_color(*pixel);
        }
    }
}

/// Returns the identifier of the first triangle that has an edge drawn over `pixel`, or `None` if there is none. `size`
/// is the size of the picture in pixels.
pub(crate) fn crosses(triangles: &[ScreenTriangle], size: (u32, u32), pixel: (u32, u32)) -> Option<TriangleId> {
    triangles.iter().find(|t| edge_pixels(t, size).any(|p| p == pixel)).map(|t| t.id)
}

/// Returns the line colour, light or dark, that contrasts with the pixel below.
pub(crate) fn line_color(below: Rgba8) -> Rgba8 {
    if luma(below) < DARK_BELOW_LUMA { [232, 232, 232, 255] } else { [24, 24, 24, 255] }
}

/// Returns the pixels on which a triangle's three edges are drawn, within a picture of `size` px.
pub(crate) fn edge_pixels(triangle: &ScreenTriangle, size: (u32, u32)) -> impl Iterator<Item = (u32, u32)> {
    let [a, b, c] = triangle.vertices.each_ref().map(pixel_position);
    [(a, b), (b, c), (c, a)].into_iter().flat_map(move |(from, to)| line_pixels(from, to, size))
}

/// Returns the pixels of a line between two points, given in pixels, within a picture of `size` px.
pub(crate) fn line_pixels(
    from: (f64, f64),
    to: (f64, f64),
    (width, height): (u32, u32),
) -> impl Iterator<Item = (u32, u32)> {
    clip_to(from, to, width, height)
        .map(|(from, to)| {
            let cell = |(x, y): (f64, f64)| (x.floor() as i64, y.floor() as i64);
            midpoint_line(cell(from), cell(to))
        })
        .into_iter()
        .flatten()
        .filter_map(move |(x, y)| {
            let (x, y) = (u32::try_from(x).ok()?, u32::try_from(y).ok()?);
            (x < width && y < height).then_some((x, y))
        })
}

fn pixel_position(vertex: &ScreenVertex) -> (f64, f64) {
    (f64::from(to_pixels(vertex.x.into())), f64::from(to_pixels(vertex.y.into())))
}
