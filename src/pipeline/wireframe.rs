//! The edges of triangles, laid over a finished picture as one-pixel lines.
//!
//! Edges run between *snapped* corners: what the rasterizer works with. A line's colour is chosen against the picture
//! below, light on dark and dark on light, so that no picture hides it. The same pixels can be asked for one at a time
//! ([`crosses`]), which is how the inspector explains them.

use super::viewport::{ScreenTriangle, ScreenVertex};
use crate::flat2d::line::{clip_to, midpoint_line};
use crate::image::color::luma;
use crate::image::{Image, Rgba8};
use crate::math::fixed::to_pixels;
use crate::scene::TriangleId;

/// Lines over darker pixels than this luma are light.
const DARK_BELOW_LUMA: f32 = 110.0;

/// Draws the edges of all `triangles`.
pub fn overlay(triangles: &[ScreenTriangle], image: &mut Image<Rgba8>) {
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

/// The first of `triangles` whose edge is drawn over pixel (x, y) of a picture of `size`, if any is.
pub fn crosses(triangles: &[ScreenTriangle], size: (u32, u32), pixel: (u32, u32)) -> Option<TriangleId> {
    triangles.iter().find(|t| edge_pixels(t, size).any(|p| p == pixel)).map(|t| t.id)
}

/// Colour of a line over a pixel.
pub fn line_color(below: Rgba8) -> Rgba8 {
    if luma(below) < DARK_BELOW_LUMA { [232, 232, 232, 255] } else { [24, 24, 24, 255] }
}

/// The pixels of a triangle's three edges within a picture of `size`.
pub fn edge_pixels(triangle: &ScreenTriangle, size: (u32, u32)) -> impl Iterator<Item = (u32, u32)> {
    let [a, b, c] = triangle.vertices.each_ref().map(pixel_position);
    [(a, b), (b, c), (c, a)].into_iter().flat_map(move |(from, to)| line_pixels(from, to, size))
}

/// The pixels of a line between two points in px, within a picture of `size`.
pub fn line_pixels(from: (f64, f64), to: (f64, f64), (width, height): (u32, u32)) -> impl Iterator<Item = (u32, u32)> {
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
