//! Vertex assembly and transform: turns the mesh of one instance into vertices in clip space.
//!
//! Each mesh vertex is transformed once, however many triangles share it. The matrices of a draw are multiplied in f64
//! and rounded once, so the product loses no precision for a model far from the origin. Attributes that the plan skips
//! are not transformed and keep their default values.

use glam::{DMat4, Mat3, Mat4, Vec2, Vec3, Vec4};

use super::clip_space::{ClipPlane, ClipVertex, Varyings};
use super::plan::{Containment, DrawPlan, PipelinePart};
use super::settings::Settings;
use super::shade::to_working_space;
use super::shading::{Input, lambert};
use crate::math::{Aabb, unit_or};
use crate::scene::{Instance, Mesh};

/// Transform matrices of one draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DrawMatrices {
    /// Transform from model space to clip space.
    pub(crate) clip_from_model: Mat4,
    /// Transform of normals from model space to world space: the inverse transpose.
    pub(crate) world_from_model_normal: Mat3,
}

impl DrawMatrices {
    /// Returns the matrices of one instance. `clip_from_world` is [`crate::scene::Camera::clip_from_world_f64`], the
    /// same for all instances.
    pub(crate) fn new(instance: &Instance, clip_from_world: DMat4) -> Self {
        let product = Self::product(instance, clip_from_world);
        let linear = glam::DMat3::from_mat4(instance.world_from_model.as_dmat4());
        let normal = if linear.determinant() == 0.0 { linear } else { linear.inverse().transpose() };
        Self { clip_from_model: product.as_mat4(), world_from_model_normal: normal.as_mat3() }
    }

    /// Returns the transform from model space to clip space before it is rounded to f32.
    pub(crate) fn product(instance: &Instance, clip_from_world: DMat4) -> DMat4 {
        clip_from_world * instance.world_from_model.as_dmat4()
    }

    /// Returns the clip-space position of a model-space position.
    #[inline]
    pub(crate) fn clip_position(&self, model: Vec3) -> Vec4 {
        self.clip_from_model * model.extend(1.0)
    }
}

/// Bound on the rounding error of a transformed vertex, relative to the sum of the magnitudes of its terms. A component
/// of the vertex is the sum of four products, so its error relative to that sum is less than 4 times [`f32::EPSILON`].
/// This is doubled because a plane distance combines two components, and doubled again for safety.
pub(super) const ROUNDING: f64 = 16.0 * f32::EPSILON as f64;

/// Absolute bound on the rounding error of subnormal products. Each product is off by at most half the smallest
/// subnormal number, and a plane distance contains six such products.
pub(super) const UNDERFLOW: f64 = f32::MIN_POSITIVE as f64;

/// Classifies a model-space box against the frustum.
///
/// The test is conservative, because it considers each plane on its own: a box reported as `Crossing` may in fact be
/// outside. `Inside` and `Outside` hold for every vertex in the box *after rounding*, so boxes that touch a plane are
/// `Crossing`.
pub(crate) fn containment(bounds: Aabb, clip_from_model: Mat4) -> Containment {
    if bounds.is_empty() {
        return Containment::Outside;
    }
    let magnitudes = DMat4::from_cols_array(&clip_from_model.as_dmat4().to_cols_array().map(f64::abs));
    let farthest = bounds.min.abs().max(bounds.max.abs()).as_dvec3();
    let magnitudes = magnitudes * farthest.extend(1.0);
    let corners = bounds.corners().map(|c| clip_from_model * c.extend(1.0));
    // Above this magnitude, a vertex inside the box may overflow even if no corner of the box does.
    let mut inside_all = magnitudes.max_element() < f64::from(f32::MAX);
    for plane in ClipPlane::ALL {
        let slack = ROUNDING * plane.magnitude(magnitudes) + UNDERFLOW;
        let distances = corners.map(|c| plane.distance(c, 1.0));
        if distances.iter().all(|d| *d < -slack) {
            return Containment::Outside;
        }
        inside_all &= distances.iter().all(|d| *d > slack);
    }
    if inside_all { Containment::Inside } else { Containment::Crossing }
}

/// Transforms all vertices of a mesh. `source_weights` stays zero, because it belongs to triangles, not to vertices.
pub(crate) fn transform(mesh: &Mesh, matrices: &DrawMatrices, settings: &Settings, plan: &DrawPlan) -> Vec<ClipVertex> {
    let transformer = Transformer::new(mesh, matrices, settings, plan);
    (0..mesh.positions.len()).map(|i| transformer.vertex(i)).collect()
}

/// Vertex transform of one draw.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transformer<'a> {
    mesh: &'a Mesh,
    matrices: &'a DrawMatrices,
    settings: &'a Settings,
    normals: bool,
    uvs: bool,
    colors: bool,
    /// Whether light is computed at the vertices.
    light: bool,
    uv_transform: Option<[Vec2; 2]>,
    light_direction: Vec3,
}

impl<'a> Transformer<'a> {
    /// Returns the vertex transform of a mesh, for the parts that the plan runs.
    pub(crate) fn new(mesh: &'a Mesh, matrices: &'a DrawMatrices, settings: &'a Settings, plan: &DrawPlan) -> Self {
        let reads = |part| plan.runs(part);
        Self {
            mesh,
            matrices,
            settings,
            normals: reads(PipelinePart::Normals),
            uvs: reads(PipelinePart::TextureCoordinates),
            colors: reads(PipelinePart::VertexColors),
            light: settings.shading.reads(Input::VertexLight),
            uv_transform: plan.uv_transform(),
            light_direction: unit_or(settings.light.direction.as_dvec3(), Vec3::Y),
        }
    }

    /// Transforms one vertex of the mesh.
    #[inline]
    pub(crate) fn vertex(&self, i: usize) -> ClipVertex {
        let Self { mesh, matrices, settings, .. } = *self;
        let mut varyings = Varyings { color: Vec3::ONE, ..Varyings::default() };
        if self.normals {
            varyings.normal = unit_or(self.world_normal(i).as_dvec3(), Vec3::ZERO);
            if self.light {
                let [normal, light] = [varyings.normal, self.light_direction].map(|vector| vector.to_array());
                varyings.light = lambert(&normal, &light, settings.light.ambient);
            }
        }
        if self.uvs {
            varyings.uv = self.uv(i);
        }
        if self.colors {
            varyings.color = to_working_space(mesh.colors[i], settings.color_space);
        }
        let position = matrices.clip_position(mesh.positions[i]);
        ClipVertex { position, cut_at: None, varyings }
    }

    /// Returns the texture coordinates of a vertex with the material's scale and offset applied.
    #[inline]
    fn uv(&self, i: usize) -> Vec2 {
        let uv = self.mesh.uvs[i];
        self.uv_transform.map_or(uv, |[scale, offset]| uv * scale + offset)
    }

    /// Returns the world-space normal of a vertex, not normalised.
    #[inline]
    pub(crate) fn world_normal(&self, i: usize) -> Vec3 {
        self.matrices.world_from_model_normal * self.mesh.normals[i]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_is_inside_only_if_rounding_cannot_change_that() {
        let cube = |half: f32| containment(Aabb { min: Vec3::splat(-half), max: Vec3::splat(half) }, flat());
        assert_eq!(cube(0.9), Containment::Inside);
        assert_eq!(cube(1.0), Containment::Crossing, "touches the sides");
        assert_eq!(cube(1.1), Containment::Crossing);
        let beside =
            |x: f32| containment(Aabb { min: Vec3::new(x, 0.0, 0.0), max: Vec3::new(x + 1.0, 0.5, 0.5) }, flat());
        assert_eq!(beside(1.0), Containment::Crossing, "touches the right side from outside");
        assert_eq!(beside(1.01), Containment::Outside);
    }

    #[test]
    fn a_box_that_may_overflow_is_neither_inside_nor_outside() {
        let huge = Aabb { min: Vec3::splat(-f32::MAX), max: Vec3::splat(f32::MAX) };
        assert_eq!(containment(huge, flat()), Containment::Crossing);
        assert_eq!(containment(Aabb::EMPTY, flat()), Containment::Outside);
    }

    /// Returns an orthographic matrix whose frustum is bounded by |x|, |y| ≤ 1; −1 < z < 1 lies well inside.
    fn flat() -> Mat4 {
        Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::Z * 0.25, Vec4::new(0.0, 0.0, 0.5, 1.0))
    }
}
