use std::sync::Arc;

use super::*;
use eframe::egui::{
    ColorImage, Pos2, TextureOptions,
    epaint::{ImageDelta, Vertex},
    pos2,
};

const TEXTURE: TextureId = TextureId::Managed(7);

fn painter_with(size: [usize; 2], texels: &[Color32], options: TextureOptions) -> CpuPainter {
    let mut painter = CpuPainter::default();
    apply(&mut painter, ImageDelta::full(Arc::new(ColorImage::new(size, texels.to_vec())), options));
    painter
}

fn apply(painter: &mut CpuPainter, change: ImageDelta) {
    let mut delta = TexturesDelta::default();
    delta.push(TEXTURE, change);
    painter.handle_delta(&mut delta);
}

fn solid_painter() -> CpuPainter {
    painter_with([1, 1], &[Color32::WHITE], TextureOptions::LINEAR)
}

/// Returns a rectangle as a mesh of two triangles that share a diagonal. The whole texture is mapped onto it.
fn quad(rect: Rect, color: Color32) -> Mesh {
    let corner = |x: f32, y: f32| Vertex {
        pos: pos2(rect.left() + x * rect.width(), rect.top() + y * rect.height()),
        uv: pos2(x, y),
        color,
    };
    Mesh {
        indices: vec![0, 1, 2, 2, 1, 3],
        vertices: vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0), corner(1.0, 1.0)],
        texture_id: TEXTURE,
    }
}

fn rect(left: f32, top: f32, right: f32, bottom: f32) -> Rect {
    Rect::from_min_max(pos2(left, top), pos2(right, bottom))
}

fn paint(painter: &CpuPainter, mesh: Mesh, clip_rect: Rect, size: (u32, u32), scale: f32) -> Image<Rgba8> {
    let primitive = ClippedPrimitive { clip_rect, primitive: Primitive::Mesh(mesh) };
    painter.paint(&[primitive], size, scale, Color32::BLACK)
}

fn reds(picture: &Image<Rgba8>, row: u32) -> Vec<u8> {
    picture.row(row).iter().map(|pixel| pixel[0]).collect()
}

#[test]
fn a_solid_rectangle_covers_the_pixels_whose_centres_it_contains() {
    let color = Color32::from_rgb(10, 200, 30);
    let picture = paint(&solid_painter(), quad(rect(1.5, 0.0, 3.5, 1.0), color), Rect::EVERYTHING, (5, 2), 1.0);
    let [ground, green] = [[0, 0, 0, 255], [10, 200, 30, 255]];
    assert_eq!(
        picture.row(0),
        [ground, green, green, ground, ground],
        "centres on the left edge are in, on the right out"
    );
    assert_eq!(picture.row(1), [ground; 5]);
}

#[test]
fn nearest_filtering_shows_whole_texels() {
    let painter = painter_with([2, 1], &[Color32::from_gray(40), Color32::from_gray(200)], TextureOptions::NEAREST);
    let picture = paint(&painter, quad(rect(0.0, 0.0, 4.0, 1.0), Color32::WHITE), Rect::EVERYTHING, (4, 1), 1.0);
    assert_eq!(reds(&picture, 0), [40, 40, 200, 200]);
}

#[test]
fn linear_filtering_interpolates_between_texel_centres() {
    let painter = painter_with([2, 1], &[Color32::from_gray(40), Color32::from_gray(200)], TextureOptions::LINEAR);
    let picture = paint(&painter, quad(rect(0.0, 0.0, 4.0, 1.0), Color32::WHITE), Rect::EVERYTHING, (4, 1), 1.0);
    // The texel centres are at u = 0.5 and 1.5. The four pixels sample u = 0.25, 0.75, 1.25 and 1.75, so the weights of
    // the second texel are 0, 1/4, 3/4 and 1.
    assert_eq!(reds(&picture, 0), [40, 80, 160, 200]);
}

#[test]
fn vertex_colours_multiply_texels() {
    let painter = painter_with([1, 1], &[Color32::from_rgb(100, 200, 50)], TextureOptions::NEAREST);
    let mesh = quad(rect(0.0, 0.0, 1.0, 1.0), Color32::from_rgb(51, 255, 102));
    assert_eq!(paint(&painter, mesh, Rect::EVERYTHING, (1, 1), 1.0).at(0, 0), [20, 200, 20, 255]);
}

#[test]
fn translucent_over_opaque_blends_gamma_encoded_values() {
    let painter = solid_painter();
    let mut mesh = quad(rect(0.0, 0.0, 1.0, 1.0), Color32::from_gray(100));
    mesh.append(quad(rect(0.0, 0.0, 1.0, 1.0), Color32::from_rgba_premultiplied(51, 0, 0, 51)));
    // The factor of the lower layer is 1 − 51/255 = 0.8. Red: 51 + 100 · 0.8 = 131. Green and blue: 100 · 0.8 = 80.
    assert_eq!(paint(&painter, mesh, Rect::EVERYTHING, (1, 1), 1.0).at(0, 0), [131, 80, 80, 255]);
}

#[test]
fn additive_colours_saturate() {
    let mut mesh = quad(rect(0.0, 0.0, 1.0, 1.0), Color32::from_gray(200));
    mesh.append(quad(rect(0.0, 0.0, 1.0, 1.0), Color32::from_rgba_premultiplied(100, 20, 0, 0)));
    assert_eq!(paint(&solid_painter(), mesh, Rect::EVERYTHING, (1, 1), 1.0).at(0, 0), [255, 220, 200, 255]);
}

#[test]
fn triangles_that_share_edges_cover_each_pixel_once() {
    // A fan around a pixel centre, with spokes along rows, columns, diagonals and other slopes.
    let color = Color32::from_rgba_premultiplied(128, 128, 128, 128);
    let rim: [Pos2; 8] = [
        pos2(-3.0, -3.0),
        pos2(8.5, -3.0),
        pos2(20.0, -3.0),
        pos2(20.0, 8.5),
        pos2(20.0, 20.0),
        pos2(7.3, 20.0),
        pos2(-3.0, 20.0),
        pos2(-3.0, 9.1),
    ];
    let mut mesh = Mesh::with_texture(TEXTURE);
    mesh.vertices =
        std::iter::once(pos2(8.5, 8.5)).chain(rim).map(|pos| Vertex { pos, uv: Pos2::ZERO, color }).collect();
    for spoke in 0..8 {
        // The winding alternates, because egui does not guarantee a winding order.
        let [first, second] = [1 + spoke, 1 + (spoke + 1) % 8];
        mesh.indices.extend(if spoke % 2 == 0 { [0, first, second] } else { [0, second, first] });
    }
    let picture = paint(&solid_painter(), mesh, Rect::EVERYTHING, (17, 17), 1.0);
    assert!(picture.pixels().iter().all(|pixel| *pixel == [128, 128, 128, 255]));
}

#[test]
fn clip_rectangles_are_rounded_to_whole_pixels() {
    let mesh = quad(rect(0.0, 0.0, 10.0, 10.0), Color32::WHITE);
    let picture = paint(&solid_painter(), mesh, rect(0.8, 0.0, 1.9, 0.6), (6, 3), 2.0);
    // Clip rectangle in pixels: x in 1.6 … 3.8, y in 0 … 1.2.
    assert_eq!(reds(&picture, 0), [0, 0, 255, 255, 0, 0]);
    assert_eq!(reds(&picture, 1), [0; 6]);
}

#[test]
fn a_partial_update_replaces_its_rectangle_only() {
    let mut painter = painter_with([3, 2], &[Color32::from_gray(10); 6], TextureOptions::NEAREST);
    let patch = Arc::new(ColorImage::filled([2, 1], Color32::from_gray(90)));
    apply(&mut painter, ImageDelta::partial([1, 1], patch, TextureOptions::NEAREST));
    let picture = paint(&painter, quad(rect(0.0, 0.0, 3.0, 2.0), Color32::WHITE), Rect::EVERYTHING, (3, 2), 1.0);
    assert_eq!(reds(&picture, 0), [10, 10, 10]);
    assert_eq!(reds(&picture, 1), [10, 90, 90]);
}

#[test]
fn a_freed_texture_is_still_drawn_in_the_frame_that_frees_it() {
    let mut painter = solid_painter();
    let mut delta = TexturesDelta::default();
    delta.free(TEXTURE);
    painter.handle_delta(&mut delta);
    let draw = |painter: &CpuPainter| {
        paint(painter, quad(rect(0.0, 0.0, 1.0, 1.0), Color32::WHITE), Rect::EVERYTHING, (1, 1), 1.0).at(0, 0)[0]
    };
    assert_eq!(draw(&painter), 255);
    painter.handle_delta(&mut TexturesDelta::default());
    assert_eq!(draw(&painter), 0);
}

#[test]
fn invalid_triangles_are_skipped() {
    let painter = solid_painter();
    let mut mesh = quad(rect(0.0, 0.0, 1.0, 1.0), Color32::WHITE);
    mesh.vertices[0].pos.x = f32::NAN;
    mesh.vertices[3].pos.y = f32::INFINITY;
    mesh.indices.extend([0, 1, 99]);
    assert_eq!(paint(&painter, mesh, Rect::EVERYTHING, (1, 1), 1.0).at(0, 0), [0, 0, 0, 255]);
    let far = quad(rect(-1e30, -1e30, 1e30, 1e30), Color32::WHITE);
    assert_eq!(reds(&paint(&painter, far, Rect::EVERYTHING, (2, 1), 1.0), 0), [255, 255]);
}
