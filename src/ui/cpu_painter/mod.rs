//! Painter that renders egui frames to images on the CPU, without a window system or a GPU. Images are bit-identical on
//! every machine.
//!
//! Input: the texture changes of a pass and its tessellated meshes. Output: an image in physical pixels. The rules
//! match egui's own GPU painter, so that a screenshot equals the window: vertices snapped to 1/256 px, top-left fill
//! rule, clip rectangles rounded to whole pixels. All arithmetic is on gamma-encoded, premultiplied values: `src =
//! vertex colour · texel / 255`, `dst = src + dst · (1 − src.a)`. Anti-aliasing is part of the meshes, as feathered
//! edges. Paint callbacks need a GPU and are skipped.

mod texture;
mod triangle;

use std::collections::HashMap;

use eframe::egui::{
    self, Color32, Rect, TextureId, TexturesDelta,
    epaint::{ClippedPrimitive, Mesh, Primitive},
};

use self::{texture::UiTexture, triangle::PaintTriangle};
use crate::image::{Image, Rgba8};

/// CPU painter for the frames of one egui context, with the context's textures.
#[derive(Default)]
pub(crate) struct CpuPainter {
    textures: HashMap<TextureId, UiTexture>,
    /// Textures freed by the last pass. That pass may still draw them, so they are dropped when the next texture
    /// changes are applied.
    freed: Vec<TextureId>,
}

impl CpuPainter {
    /// Applies and drains the texture changes of a pass. Must be called for every pass, including those that are not
    /// painted.
    pub(crate) fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        for id in self.freed.drain(..) {
            self.textures.remove(&id);
        }
        for (id, changes) in delta.set.drain() {
            for change in changes {
                self.textures.entry(id).or_default().apply(change);
            }
        }
        self.freed.extend(delta.free.drain());
    }

    /// Paints tessellated shapes over an opaque `background`.
    ///
    /// `size_px` is (width, height) in physical pixels, and `pixels_per_point` the number of physical pixels per egui
    /// point. Skips meshes with an unknown texture and triangles with non-finite coordinates.
    pub(crate) fn paint(
        &self,
        primitives: &[ClippedPrimitive],
        size_px: (u32, u32),
        pixels_per_point: f32,
        background: Color32,
    ) -> Image<Rgba8> {
        let mut picture = Image::filled(size_px.0, size_px.1, background.to_opaque().to_array());
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            if let Primitive::Mesh(mesh) = primitive
                && let Some(texture) = self.textures.get(&mesh.texture_id)
            {
                let clip = PixelRect::rounded(*clip_rect, pixels_per_point, size_px);
                paint_mesh(mesh, texture, pixels_per_point, clip, &mut picture);
            }
        }
        picture
    }

    /// Tessellates and paints the shapes of a pass of `context`, taken from its [`egui::FullOutput`].
    pub(crate) fn paint_shapes(
        &self,
        context: &egui::Context,
        shapes: Vec<egui::epaint::ClippedShape>,
        size_px: (u32, u32),
        background: Color32,
    ) -> Image<Rgba8> {
        let pixels_per_point = context.pixels_per_point();
        self.paint(&context.tessellate(shapes, pixels_per_point), size_px, pixels_per_point, background)
    }
}

fn paint_mesh(mesh: &Mesh, texture: &UiTexture, pixels_per_point: f32, clip: PixelRect, picture: &mut Image<Rgba8>) {
    for indices in mesh.indices.as_chunks::<3>().0 {
        if let [Some(a), Some(b), Some(c)] = indices.map(|index| mesh.vertices.get(index as usize))
            && let Some(triangle) = PaintTriangle::new([*a, *b, *c], pixels_per_point, texture)
        {
            triangle.paint(clip, picture);
        }
    }
}

/// Rectangle of whole pixels, with columns `left..right` and rows `top..bottom`.
#[derive(Clone, Copy)]
struct PixelRect {
    left: i64,
    top: i64,
    right: i64,
    bottom: i64,
}

impl PixelRect {
    /// Converts `rect` from points to pixels, rounds its sides to whole pixels and clamps it to the image.
    fn rounded(rect: Rect, pixels_per_point: f32, (width, height): (u32, u32)) -> Self {
        let round = |points: f32, limit: u32| ((points * pixels_per_point).round() as i64).clamp(0, i64::from(limit));
        Self {
            left: round(rect.min.x, width),
            top: round(rect.min.y, height),
            right: round(rect.max.x, width),
            bottom: round(rect.max.y, height),
        }
    }
}

#[cfg(test)]
mod tests;
