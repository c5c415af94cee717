//! Tangent-space normal maps.
//!
//! A texel (r, g, b) is the vector 2·(r, g, b) − 1 in the frame of tangent, bitangent and normal: x along growing u, y up the
//! picture (OpenGL; along falling v, which runs down here), z along the interpolated normal. The tangent of the fragment's
//! triangle is orthogonalised against that normal (Gram–Schmidt), and the bitangent is their cross product with the sign of
//! the texture coordinates, so that mirrored ones work. Texels are data, not light: codes are filtered as they are.

use glam::{Vec2, Vec3};

use super::Readable;
use super::surface::PlacedMesh;
use crate::pipeline::interpolate::Fragment;
use crate::pipeline::sample::Sampler;

/// The normal map of a draw.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NormalMap<'a> {
    pub(super) texture: Readable<'a>,
    pub(super) sampler: Sampler,
    /// Factor of x and y.
    pub(super) scale: f32,
    pub(super) uv_scale: Vec2,
    pub(super) mesh: PlacedMesh<'a>,
}

impl<'a> NormalMap<'a> {
    /// Returns the texture, and how it is sampled.
    pub(crate) fn texture(&self) -> (Readable<'a>, Sampler) {
        (self.texture, self.sampler)
    }

    /// Returns the vector that the map holds at a fragment, scaled, in tangent space.
    pub(crate) fn vector(&self, fragment: &Fragment) -> Vec3 {
        let [x, y, z] = (self.texture.color(self.sampler, fragment) * 2.0 - 1.0).to_array();
        Vec3::new(x * self.scale, y * self.scale, z)
    }

    /// Returns tangent and bitangent of a fragment: unit vectors perpendicular to its unit `normal`. `None` where its
    /// triangle has no tangent.
    pub(crate) fn frame(&self, normal: Vec3, fragment: &Fragment) -> Option<[Vec3; 2]> {
        let [along_u, along_v] = self.mesh.tangents(fragment.triangle, self.uv_scale)?;
        let tangent = (along_u - normal * normal.dot(along_u)).try_normalize()?;
        let bitangent = normal.cross(tangent);
        let up = if bitangent.dot(along_v) > 0.0 { -1.0 } else { 1.0 };
        Some([tangent, bitangent * up])
    }

    /// Returns the unit normal that replaces the interpolated unit `normal`; that normal itself where there is no tangent.
    pub(crate) fn apply(&self, normal: Vec3, fragment: &Fragment) -> Vec3 {
        let Some([tangent, bitangent]) = self.frame(normal, fragment) else { return normal };
        let vector = self.vector(fragment);
        (tangent * vector.x + bitangent * vector.y + normal * vector.z).try_normalize().unwrap_or(normal)
    }
}
