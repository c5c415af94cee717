//! Specular highlight of Blinn–Phong shading: Ks·max(0, N·H)^Ns (Blinn, "Models of Light Reflection for Computer
//! Synthesized Pictures", 1977).
//!
//! H is the unit vector halfway between the directions to the light and to the eye. There is no highlight where N·L ≤
//! 0, as in OpenGL's fixed-function pipeline. The power is computed by `libm`, so it has the same bits on every
//! platform.

use glam::Vec3;

use super::surface::PlacedMesh;
use crate::math::unit_or;
use crate::pipeline::interpolate::Fragment;
use crate::pipeline::viewpoint::Viewpoint;

/// Source of the directions from the fragments of a draw towards the eye.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EyeDirections<'a> {
    pub(crate) eye: Viewpoint,
    pub(crate) mesh: PlacedMesh<'a>,
}

impl EyeDirections<'_> {
    /// Returns the world-space unit vector from a fragment towards the eye.
    pub(crate) fn at(&self, fragment: &Fragment) -> Vec3 {
        let position = self.mesh.position(fragment).unwrap_or_default();
        unit_or(self.eye.vector_from(position).as_dvec3(), Vec3::ZERO)
    }
}

/// Inputs for computing the specular highlights of a draw.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Highlight<'a> {
    /// Specular colour Ks, in the working colour space.
    pub(crate) specular: Vec3,
    /// Specular exponent Ns.
    pub(crate) shininess: f32,
    pub(crate) eye: EyeDirections<'a>,
}

impl Highlight<'_> {
    /// Returns the world-space unit vector from a fragment towards the eye.
    pub(crate) fn eye_direction(&self, fragment: &Fragment) -> Vec3 {
        self.eye.at(fragment)
    }

    /// Returns the half vector H: the unit vector halfway between the directions to the light and to the eye; zero if
    /// they are opposite.
    pub(crate) fn halfway(&self, to_light: Vec3, fragment: &Fragment) -> Vec3 {
        unit_or((to_light + self.eye_direction(fragment)).as_dvec3(), Vec3::ZERO)
    }

    /// Returns the highlight factor max(0, N·H)^Ns, or 0 if N·L ≤ 0.
    pub(crate) fn factor(&self, normal: Vec3, to_light: Vec3, fragment: &Fragment) -> f32 {
        if normal.dot(to_light) > 0.0 {
            libm::powf(normal.dot(self.halfway(to_light, fragment)).max(0.0), self.shininess)
        } else {
            0.0
        }
    }
}
