//! Projection to the screen: divide by w, scale to the picture, snap to the 1/256 px grid.

use glam::Vec3;

use super::clip::ClippedTriangle;
use super::clip_space::ClipVertex;
use super::depth::DepthScale;
use super::screen_vertex::ScreenVertex;
use super::viewport::Viewport;

impl Viewport {
    /// Projects the corners of a clipped triangle; `scale` determines their depths.
    pub(crate) fn project(self, triangle: &ClippedTriangle, scale: &DepthScale) -> [ScreenVertex; 3] {
        let [a, b, c] = &triangle.vertices;
        // Projected one by one: mapping an array of items this large copies each of them four times.
        [self.project_vertex(a, scale), self.project_vertex(b, scale), self.project_vertex(c, scale)]
    }

    /// Projects one corner, whose w must be positive.
    #[inline]
    pub(crate) fn project_vertex(self, vertex: &ClipVertex, scale: &DepthScale) -> ScreenVertex {
        let (inv_w, ndc) = divided(vertex);
        let position_px = self.pixels_from_ndc(ndc);
        ScreenVertex::at(position_px.into(), scale.of_vertex(vertex), inv_w, vertex.varyings)
    }
}

/// Returns 1/w of a vertex, and its position divided by w: normalised device coordinates, y up.
#[inline]
pub(crate) fn divided(vertex: &ClipVertex) -> (f32, Vec3) {
    let inv_w = 1.0 / vertex.position.w;
    (inv_w, vertex.position.truncate() * inv_w)
}
