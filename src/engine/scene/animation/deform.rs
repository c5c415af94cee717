//! Deformed meshes: morph targets and linear blend skinning (Khronos Group, "glTF 2.0 Specification", 2021, §3.7.2.2
//! and §3.7.3).
//!
//! A vertex is first moved by the weighted displacements of the morph targets, then by the weighted mean of the
//! transforms of its joints. Normals are transformed by the inverse transpose. All sums are in f64 and are rounded once.

use std::sync::Arc;

use glam::{DMat3, DMat4, DVec3, Vec3};

use super::rig::{RigPose, mirrored_matrix};
use crate::math::unit_or;
use crate::scene::load::MAX_COORDINATE;
use crate::scene::mesh::smooth_normals;
use crate::scene::{Mesh, MeshId};

/// Mesh that changes its shape.
#[derive(Clone, Debug)]
pub(crate) struct Deformation {
    /// Identifier of the mesh. It belongs to a single object, because others may have another pose.
    pub(crate) mesh: MeshId,
    /// Mesh before the deformation.
    pub(crate) rest: Arc<Mesh>,
    /// Index of the node that has the weights of the morph targets.
    pub(crate) node: usize,
    pub(crate) targets: Arc<[MorphTarget]>,
    pub(crate) skin: Option<Skin>,
    /// Whether the normals follow from the triangles, because the file has none.
    pub(crate) computes_normals: bool,
}

/// Displacements of all vertices by a morph target of weight 1, in model space.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MorphTarget {
    /// Displacement of each position, or empty.
    pub(crate) positions: Vec<Vec3>,
    /// Difference of each normal, or empty.
    pub(crate) normals: Vec<Vec3>,
}

/// Joint of a skin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Joint {
    /// Index of the node.
    pub(crate) node: usize,
    /// Inverse bind matrix: affine transform from model space to the space of the joint.
    pub(crate) joint_from_model: DMat4,
}

/// Influence of a joint on a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Influence {
    /// Index of the joint in the skin.
    pub(crate) joint: u32,
    /// Weight of the joint. The weights of a vertex add up to 1.
    pub(crate) weight: f64,
}

/// Skin: joints, and their influences on each vertex. A skinned mesh is deformed in world space.
#[derive(Clone, Debug)]
pub(crate) struct Skin {
    pub(crate) joints: Arc<[Joint]>,
    /// Influences of all vertices, an equal number for each vertex.
    pub(crate) influences: Arc<[Influence]>,
    /// Number of influences per vertex, at least 1.
    pub(crate) per_vertex: usize,
}

/// Position and normal of a vertex.
#[derive(Clone, Copy)]
struct Vertex {
    position: DVec3,
    normal: DVec3,
}

impl Deformation {
    /// Returns the mesh in a pose of the rig.
    pub(super) fn deformed(&self, rig: &RigPose) -> Mesh {
        let weights = &rig.weights[self.node];
        let joints = self.skin.as_ref().map(|skin| skin.matrices(rig));
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        for index in 0..self.rest.positions.len() {
            let mut vertex = self.morphed(index, weights);
            if let (Some(skin), Some(joints)) = (&self.skin, &joints) {
                vertex = vertex.moved(skin.blended(index, joints));
            }
            positions.push(usable(vertex.position));
            let rest = self.rest.normals[index];
            normals.push(if rest == Vec3::ZERO { rest } else { unit_or(vertex.normal, rest) });
        }
        if self.computes_normals {
            normals = smooth_normals(&positions, &self.rest.triangles);
        }
        self.rest.moved(positions, normals)
    }

    /// Returns a vertex moved by the morph targets.
    fn morphed(&self, index: usize, weights: &[f64]) -> Vertex {
        let [mut position, mut normal] = [self.rest.positions[index], self.rest.normals[index]].map(Vec3::as_dvec3);
        for (target, weight) in self.targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            let weighted = |deltas: &[Vec3]| deltas.get(index).map_or(DVec3::ZERO, |delta| delta.as_dvec3() * *weight);
            position += weighted(&target.positions);
            normal += weighted(&target.normals);
        }
        Vertex { position, normal }
    }

    /// Returns the deformation of the scene mirrored in z.
    pub(super) fn mirrored_z(&self) -> Self {
        let mirrored = |deltas: &[Vec3]| deltas.iter().map(|delta| Vec3 { z: -delta.z, ..*delta }).collect();
        let target = |target: &MorphTarget| MorphTarget {
            positions: mirrored(&target.positions),
            normals: mirrored(&target.normals),
        };
        Self {
            rest: Arc::new(self.rest.mirrored_z()),
            targets: self.targets.iter().map(target).collect(),
            skin: self.skin.as_ref().map(Skin::mirrored_z),
            ..self.clone()
        }
    }

    /// Returns the memory used by the mesh before the deformation, and by morph targets and influences, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let targets = self.targets.iter().map(|target| target.positions.capacity() + target.normals.capacity());
        let influences = self.skin.as_ref().map_or(0, |skin| size_of_val(&*skin.influences));
        self.rest.bytes() + targets.sum::<usize>() * size_of::<Vec3>() + influences
    }
}

impl Skin {
    /// Returns the transform of each joint from model space to world space.
    fn matrices(&self, rig: &RigPose) -> Vec<DMat4> {
        self.joints.iter().map(|joint| rig.world_from_node[joint.node] * joint.joint_from_model).collect()
    }

    /// Returns the weighted mean of the transforms of a vertex's joints.
    fn blended(&self, vertex: usize, joints: &[DMat4]) -> DMat4 {
        let influences = &self.influences[vertex * self.per_vertex..][..self.per_vertex];
        influences
            .iter()
            .filter(|influence| influence.weight != 0.0)
            .fold(DMat4::ZERO, |sum, influence| sum + joints[influence.joint as usize] * influence.weight)
    }

    fn mirrored_z(&self) -> Self {
        let joint =
            |joint: &Joint| Joint { joint_from_model: mirrored_matrix(joint.joint_from_model), node: joint.node };
        Self { joints: self.joints.iter().map(joint).collect(), ..self.clone() }
    }
}

impl Vertex {
    /// Returns the vertex in another space.
    fn moved(self, matrix: DMat4) -> Self {
        let linear = DMat3::from_mat4(matrix);
        Self { position: matrix.transform_point3(self.position), normal: cofactors(linear) * self.normal }
    }
}

/// Returns the matrix of cofactors with the sign of the determinant: a positive multiple of the inverse transpose, which
/// also exists for singular matrices.
fn cofactors(matrix: DMat3) -> DMat3 {
    let DMat3 { x_axis, y_axis, z_axis } = matrix;
    let cofactors = DMat3::from_cols(y_axis.cross(z_axis), z_axis.cross(x_axis), x_axis.cross(y_axis));
    let determinant = x_axis.dot(cofactors.x_axis);
    if determinant < 0.0 { -cofactors } else { cofactors }
}

/// Returns the position rounded to f32, or NaN if it is too large to be drawn.
fn usable(position: DVec3) -> Vec3 {
    let rounded = position.as_vec3();
    if rounded.abs().max_element() > MAX_COORDINATE { Vec3::NAN } else { rounded }
}
