//! Assemble and transform: a shared mesh at one instance's place becomes vertices in clip space.
//!
//! Each mesh vertex is transformed once, however many triangles share it. The matrices of a draw are multiplied in f64
//! and rounded once, so a model far from the origin costs no precision in the product. What the plan leaves out is
//! neither transformed nor stored.

use glam::{DMat4, Mat3, Mat4, Vec2, Vec3, Vec4};

use super::plan::{Containment, DrawPlan, Part};
use super::settings::{Settings, Shading};
use super::shade::{lambert, to_working_space};
use crate::math::{Aabb, unit_or};
use crate::scene::{Camera, Instance, Mesh};

/// What is interpolated over a triangle besides position. Parts that the plan leaves out are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Varyings {
    /// World-space normal; of unit length at vertices only.
    pub normal: Vec3,
    /// Texture coordinates, v down.
    pub uv: Vec2,
    /// Vertex colour, in the numbers that light is computed in; white where the mesh has none.
    pub color: Vec3,
    /// Light at the vertex (Gouraud only).
    pub light: f32,
    /// Weights of the three vertices of the unclipped triangle.
    pub source_weights: Vec3,
}

impl Varyings {
    /// From `self` at t = 0 to `other` at t = 1; a value that is the same at both ends stays exactly the same.
    pub fn lerp(&self, other: &Self, t: f32) -> Self {
        Self {
            normal: self.normal + (other.normal - self.normal) * t,
            uv: self.uv + (other.uv - self.uv) * t,
            color: self.color + (other.color - self.color) * t,
            light: self.light + (other.light - self.light) * t,
            source_weights: self.source_weights + (other.source_weights - self.source_weights) * t,
        }
    }
}

/// A vertex in clip space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipVertex {
    /// Homogeneous position: inside is 0 ≤ z ≤ w, |x| ≤ w, |y| ≤ w.
    pub position: Vec4,
    /// What comes along.
    pub varyings: Varyings,
}

/// The matrices of one draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawMatrices {
    /// Clip space from model space.
    pub clip_from_model: Mat4,
    /// World-space normals from model-space normals: inverse transpose.
    pub world_from_model_normal: Mat3,
}

impl DrawMatrices {
    /// For one instance seen by a camera. `aspect` is width over height.
    pub fn new(instance: &Instance, camera: &Camera, aspect: f32, reversed: bool) -> Self {
        let product: DMat4 = camera.clip_from_view(aspect, reversed).as_dmat4()
            * camera.view_from_world().as_dmat4()
            * instance.world_from_model.as_dmat4();
        let linear = glam::DMat3::from_mat4(instance.world_from_model.as_dmat4());
        let normal = if linear.determinant() == 0.0 { linear } else { linear.inverse().transpose() };
        Self { clip_from_model: product.as_mat4(), world_from_model_normal: normal.as_mat3() }
    }
}

/// Where a model-space box lies with respect to the frustum.
///
/// Convex against convex by planes only: a box reported as `Crossing` may still be outside, never the other way round.
pub fn containment(bounds: Aabb, clip_from_model: Mat4) -> Containment {
    if bounds.is_empty() {
        return Containment::Outside;
    }
    let corners = bounds.corners().map(|c| clip_from_model * c.extend(1.0));
    let mut inside_all = true;
    for plane in super::clip::Plane::ALL {
        let beyond =
            corners.iter().filter(|c| plane.distance(**c, 1.0).is_nan() || plane.distance(**c, 1.0) < 0.0).count();
        if beyond == corners.len() && corners.iter().all(|c| c.is_finite()) {
            return Containment::Outside;
        }
        inside_all &= beyond == 0;
    }
    if inside_all { Containment::Inside } else { Containment::Crossing }
}

/// Transforms all vertices of a mesh. `source_weights` is left zero: it belongs to triangles, not to vertices.
pub fn transform(mesh: &Mesh, matrices: &DrawMatrices, settings: &Settings, plan: &DrawPlan) -> Vec<ClipVertex> {
    let reads = |part| plan.runs(part);
    let (normals, uvs, colors) = (reads(Part::Normals), reads(Part::TextureCoordinates), reads(Part::VertexColors));
    let light_direction = unit_or(settings.light.direction.as_dvec3(), Vec3::Y);
    (0..mesh.positions.len())
        .map(|i| {
            let mut varyings = Varyings { color: Vec3::ONE, ..Varyings::default() };
            if normals {
                let normal = matrices.world_from_model_normal * mesh.normals[i];
                varyings.normal = unit_or(normal.as_dvec3(), Vec3::Y);
                if settings.shading == Shading::Gouraud {
                    varyings.light = lambert(varyings.normal, light_direction, settings.light.ambient);
                }
            }
            if uvs {
                varyings.uv = mesh.uvs[i];
            }
            if colors {
                varyings.color = to_working_space(mesh.colors[i], settings.color_space);
            }
            ClipVertex { position: matrices.clip_from_model * mesh.positions[i].extend(1.0), varyings }
        })
        .collect()
}
