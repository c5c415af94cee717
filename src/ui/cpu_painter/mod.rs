//! Paints a frame of egui by the CPU: the same bytes on every machine, with no window system and no graphics card.
//!
//! In: the texture changes of a pass and its tessellated meshes. Out: a picture of physical pixels.
//! The rules are those of the toolkit's own graphics-card painter, so that a screenshot is what the window shows:
//! vertices snapped to 1/256 px, top-left fill rule, clip rectangles rounded to whole pixels, and all arithmetic on
//! gamma-encoded, premultiplied values: `src = vertex colour · texel / 255`, `dst = src + dst · (1 − src.a)`.
//! Anti-aliasing is already in the meshes (their feathered rims). Paint callbacks belong to a graphics card: skipped.

mod texture;
mod triangle;

use std::collections::HashMap;

use eframe::egui::{
    self, Color32, Rect, TextureId, TexturesDelta,
    epaint::{ClippedPrimitive, Mesh, Primitive},
};

use self::{texture::Texture, triangle::Triangle};
use crate::image::{Image, Rgba8};

/// The textures of one egui context, and the means to paint its frames.
#[derive(Default)]
pub struct CpuPainter {
    textures: HashMap<TextureId, Texture>,
    /// A frame may still draw the textures that it frees, so they live until the next change arrives.
    freed: Vec<TextureId>,
}

impl CpuPainter {
    /// Applies and empties the texture changes of a pass. Call it for every pass, also for those that are not painted.
    pub fn handle_delta(&mut self, delta: &mut TexturesDelta) {
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
    /// `size_px` is (width, height) in physical pixels, one egui point being `pixels_per_point` of them. Meshes whose
    /// texture is unknown and triangles with coordinates that are not finite are left out.
    pub fn paint(
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

    /// Tessellates and paints what a pass of `context` put out, with the shapes of its [`egui::FullOutput`].
    pub fn paint_shapes(
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

fn paint_mesh(mesh: &Mesh, texture: &Texture, pixels_per_point: f32, clip: PixelRect, picture: &mut Image<Rgba8>) {
    for indices in mesh.indices.as_chunks::<3>().0 {
        if let [Some(a), Some(b), Some(c)] = indices.map(|index| mesh.vertices.get(index as usize))
            && let Some(triangle) = Triangle::new([*a, *b, *c], pixels_per_point, texture)
        {
            triangle.paint(clip, picture);
        }
    }
}

/// Whole pixels: columns `left..right`, rows `top..bottom`.
#[derive(Clone, Copy)]
struct PixelRect {
    left: i64,
    top: i64,
    right: i64,
    bottom: i64,
}

impl PixelRect {
    /// The nearest whole pixels to `rect` (in points), kept inside a picture.
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
