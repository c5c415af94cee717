//! Mesh data that shading needs besides interpolated attributes: world-space positions and tangents.
//!
//! Both are recomputed from the mesh of a fragment's triangle. Neither vertices nor triangles carry them, so draws that
//! do not need them pay nothing.

use glam::{Mat4, Vec2, Vec3};

use crate::pipeline::interpolate::Fragment;
use crate::pipeline::plan::DrawPlan;
use crate::scene::{Instance, Library, Mesh, TriangleId};

/// Mesh placed in the world by the transform of its instance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedMesh<'a> {
    mesh: &'a Mesh,
    world_from_model: Mat4,
    first: TriangleId,
}

impl<'a> PlacedMesh<'a> {
    /// Returns the mesh of an instance, which `plan` draws.
    pub(crate) fn new(library: &'a Library, instance: &Instance, plan: &DrawPlan) -> Self {
        let mesh = library.mesh(instance.mesh);
        Self { mesh, world_from_model: instance.world_from_model, first: plan.first_triangle() }
    }

    /// Returns the vertex indices of a triangle in the mesh, or `None` if the mesh does not contain it.
    fn corners(&self, triangle: TriangleId) -> Option<[usize; 3]> {
        let index = triangle.0.checked_sub(self.first.0)?;
        Some(self.mesh.triangles.get(index as usize)?.map(|vertex| vertex as usize))
    }

    /// Returns the world-space corners of a triangle before clipping, or `None` if the mesh does not contain it.
    pub(crate) fn positions(&self, triangle: TriangleId) -> Option<[Vec3; 3]> {
        let corners = self.corners(triangle)?;
        Some(corners.map(|vertex| self.world_from_model.transform_point3(self.mesh.positions[vertex])))
    }

    /// Returns the world-space position of a fragment, interpolated with the weights of the unclipped triangle.
    pub(crate) fn position(&self, fragment: &Fragment) -> Option<Vec3> {
        let [a, b, c] = self.positions(fragment.triangle)?;
        Some(a + (b - a) * fragment.source_weights.y + (c - a) * fragment.source_weights.z)
    }

    /// Returns the world-space directions in which u and v increase on a triangle, not normalised. Returns `None` if
    /// the triangle has no area in texture space after scaling by `uv_scale`.
    ///
    /// Source: Lengyel, "Computing Tangent Space Basis Vectors for an Arbitrary Mesh", 2001.
    pub(crate) fn tangents(&self, triangle: TriangleId, uv_scale: Vec2) -> Option<[Vec3; 2]> {
        let [a, b, c] = self.corners(triangle)?;
        let (positions, uvs) = (&self.mesh.positions, &self.mesh.uvs);
        let [e1, e2] = [b, c].map(|to| self.world_from_model.transform_vector3(positions[to] - positions[a]));
        let (a, b, c) = (*uvs.get(a)?, *uvs.get(b)?, *uvs.get(c)?);
        let [d1, d2] = [b, c].map(|to| (to - a) * uv_scale);
        let area = d1.perp_dot(d2);
        (area.is_finite() && area != 0.0).then(|| {
            let sign = area.signum();
            [(e1 * d2.y - e2 * d1.y) * sign, (e2 * d1.x - e1 * d2.x) * sign]
        })
    }
}
