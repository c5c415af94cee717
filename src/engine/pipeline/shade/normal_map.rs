//! Tangent-space normal maps.
//!
//! A texel (r, g, b) encodes the vector 2·(r, g, b) − 1 in the frame of tangent, bitangent and normal. x points along
//! increasing u. y points up in the texture (OpenGL convention), which is along decreasing v, because v points down
//! here. z points along the interpolated normal. The tangent of the fragment's triangle is orthogonalised against that
//! normal (Gram–Schmidt). The bitangent is the cross product of normal and tangent; its sign follows the orientation of
//! the texture coordinates, so mirrored coordinates work. Texels are data, not light, so codes are filtered without
//! decoding.

use glam::{Vec2, Vec3};

use super::Readable;
use super::surface::PlacedMesh;
use crate::pipeline::interpolate::Fragment;
use crate::pipeline::sample::Sampler;

/// Tangent-space normal map of a draw, with the mesh that provides tangents.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NormalMap<'a> {
    pub(super) texture: Readable<'a>,
    pub(super) sampler: Sampler,
    /// Factor by which the x and y components of the map's vectors are multiplied.
    pub(super) scale: f32,
    pub(super) uv_scale: Vec2,
    pub(super) mesh: PlacedMesh<'a>,
}

impl<'a> NormalMap<'a> {
    /// Returns the texture of the map, and its sampler.
    pub(crate) fn texture(&self) -> (Readable<'a>, Sampler) {
        (self.texture, self.sampler)
    }

    /// Returns the tangent-space vector that the map holds at a fragment, with x and y scaled; not normalised.
    pub(crate) fn vector(&self, fragment: &Fragment) -> Vec3 {
        let [x, y, z] = (self.texture.color(self.sampler, fragment) * 2.0 - 1.0).to_array();
        Vec3::new(x * self.scale, y * self.scale, z)
    }

    /// Returns the tangent and the bitangent of a fragment: unit vectors perpendicular to its unit `normal`. Returns
    /// `None` if its triangle has no tangent.
    pub(crate) fn frame(&self, normal: Vec3, fragment: &Fragment) -> Option<[Vec3; 2]> {
        let [along_u, along_v] = self.mesh.tangents(fragment.triangle, self.uv_scale)?;
        let tangent = (along_u - normal * normal.dot(along_u)).try_normalize()?;
        let bitangent = normal.cross(tangent);
        let up = if bitangent.dot(along_v) > 0.0 { -1.0 } else { 1.0 };
        Some([tangent, bitangent * up])
    }

    /// Returns the interpolated unit `normal` of a fragment, perturbed by the map and normalised. Returns `normal`
    /// itself if the fragment's triangle has no tangent.
    pub(crate) fn apply(&self, normal: Vec3, fragment: &Fragment) -> Vec3 {
        let Some([tangent, bitangent]) = self.frame(normal, fragment) else { return normal };
        let vector = self.vector(fragment);
        (tangent * vector.x + bitangent * vector.y + normal * vector.z).try_normalize().unwrap_or(normal)
    }
}
