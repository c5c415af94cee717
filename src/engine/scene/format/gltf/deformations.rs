//! Deformations: skins and morph targets of the meshes that nodes place.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DMat4, DVec4, Vec3};
use gltf_json::Root;
use gltf_json::accessor::Type;
use gltf_json::mesh::{Primitive, Semantic};
use gltf_json::validation::Checked;

use super::accessors::Accessors;
use super::nodes::Placed;
use super::vertices::{Vertices, matching};
use super::{Failure, Remarks};
use crate::scene::animation::{Influence, Joint, MorphTarget, Skin};
use crate::scene::load::{Load, bytes_of};

/// Joints of the skins of a file, each read at its first use.
pub(super) struct Skins<'a> {
    root: &'a Root,
    /// Index in the rig of each node of the file; `None` for nodes outside the scene.
    rig_nodes: &'a [Option<usize>],
    known: HashMap<usize, Option<Arc<[Joint]>>>,
}

/// Deformation of a primitive, before its mesh exists.
pub(super) struct PrimitiveShape {
    pub(super) targets: Vec<MorphTarget>,
    pub(super) skin: Option<Skin>,
}

/// Marks the placed meshes that a skin deforms, or morph targets whose weights change or are not zero.
pub(super) fn mark(root: &Root, placed: &mut Placed) {
    let weighted = placed.rig.weighted();
    for placed_mesh in &mut placed.meshes {
        let primitives = root.meshes.get(placed_mesh.mesh).map_or(&[][..], |mesh| &mesh.primitives);
        let has_targets = primitives.iter().any(|primitive| !targets(primitive).is_empty());
        placed_mesh.is_deformed = placed_mesh.skin.is_some() || (has_targets && weighted[placed_mesh.node]);
    }
}

fn targets(primitive: &Primitive) -> &[gltf_json::mesh::MorphTarget] {
    primitive.targets.as_deref().unwrap_or_default()
}

impl<'a> Skins<'a> {
    /// Creates an empty collection.
    pub(super) fn new(root: &'a Root, rig_nodes: &'a [Option<usize>]) -> Self {
        Self { root, rig_nodes, known: HashMap::new() }
    }

    /// Returns the joints of a skin; `None` if a joint is not part of the scene, with a warning.
    pub(super) fn joints(
        &mut self,
        skin: usize,
        accessors: &mut Accessors<'_>,
        remarks: &mut Remarks<'_>,
    ) -> Result<Option<Arc<[Joint]>>, Failure> {
        if let Some(known) = self.known.get(&skin) {
            return Ok(known.clone());
        }
        let named = |reason: String| format!("skins[{skin}]: {reason}");
        let joints = self.read_joints(skin, accessors).map_err(named)?;
        if joints.is_none() {
            remarks
                .warn(format!("skins[{skin}]: a joint is not part of the scene; the mesh is shown in its bind pose"));
        }
        self.known.insert(skin, joints.clone());
        Ok(joints)
    }

    fn read_joints(&self, index: usize, accessors: &mut Accessors<'_>) -> Result<Option<Arc<[Joint]>>, String> {
        let Some(skin) = self.root.skins.get(index) else { return Ok(None) };
        let inverse_binds =
            skin.inverse_bind_matrices.map(|matrices| accessors.get(matrices, &[Type::Mat4])).transpose()?;
        if let Some(matrices) = &inverse_binds
            && matrices.count() < skin.joints.len()
        {
            return Err(format!("it has {} inverse bind matrices for {} joints", matrices.count(), skin.joints.len()));
        }
        let mut joints = Vec::with_capacity(skin.joints.len());
        for (number, joint) in skin.joints.iter().enumerate() {
            let Some(node) = self.rig_nodes.get(joint.value()).copied().flatten() else { return Ok(None) };
            let matrix = inverse_binds
                .as_ref()
                .map_or(DMat4::IDENTITY, |matrices| affine(matrices.vector::<16>(number).map(f64::from)));
            if !matrix.is_finite() {
                return Err(format!("its inverse bind matrix {number} is not finite"));
            }
            joints.push(Joint { node, joint_from_model: matrix });
        }
        if joints.is_empty() { Err("it has no joints".to_owned()) } else { Ok(Some(joints.into())) }
    }
}

/// Returns the matrix of these columns, with the last row that an affine matrix has.
fn affine(columns: [f64; 16]) -> DMat4 {
    let DMat4 { x_axis, y_axis, z_axis, w_axis } = DMat4::from_cols_array(&columns);
    let vector = |axis: DVec4| DVec4 { w: 0.0, ..axis };
    DMat4::from_cols(vector(x_axis), vector(y_axis), vector(z_axis), DVec4 { w: 1.0, ..w_axis })
}

/// Primitive that is deformed, with the choice and number of its vertices.
#[derive(Clone, Copy)]
pub(super) struct DeformedPrimitive<'p> {
    pub(super) primitive: &'p Primitive,
    pub(super) vertices: &'p Vertices,
    /// Number of vertices in the file.
    pub(super) count: usize,
    /// Whether the file has normals, so that morph targets change them.
    pub(super) has_normals: bool,
}

impl DeformedPrimitive<'_> {
    /// Reads the morph targets and, if the mesh has a skin, the influences of its joints. Returns `None` if there is
    /// neither.
    pub(super) fn shape(
        self,
        accessors: &mut Accessors<'_>,
        joints: Option<Arc<[Joint]>>,
        load: &mut Load<'_>,
        remarks: &mut Remarks<'_>,
    ) -> Result<Option<PrimitiveShape>, Failure> {
        let mut read = Vec::new();
        for target in targets(self.primitive) {
            read.push(self.target(target, accessors, load)?);
        }
        let skin = match joints {
            Some(joints) => self.skin(joints, accessors, load, remarks)?,
            None => None,
        };
        Ok((skin.is_some() || !read.is_empty()).then_some(PrimitiveShape { targets: read, skin }))
    }

    fn target(
        self,
        target: &gltf_json::mesh::MorphTarget,
        accessors: &mut Accessors<'_>,
        load: &mut Load<'_>,
    ) -> Result<MorphTarget, Failure> {
        let mut displacements = |index: Option<_>| -> Result<Vec<Vec3>, Failure> {
            let Some(index) = index else { return Ok(Vec::new()) };
            let elements = matching(accessors, index, &[Type::Vec3], self.count)?;
            let read = self.vertices.read(&elements, load, Vec3::from)?;
            match read.iter().position(|displacement| !displacement.is_finite()) {
                Some(vertex) => Err(format!("the displacement {vertex} of a morph target is not finite").into()),
                None => Ok(read),
            }
        };
        let positions = displacements(target.positions)?;
        let normals = displacements(target.normals.filter(|_| self.has_normals))?;
        Ok(MorphTarget { positions, normals })
    }

    /// Reads all sets of joints and weights. Returns `None` if the primitive has none.
    fn skin(
        self,
        joints: Arc<[Joint]>,
        accessors: &mut Accessors<'_>,
        load: &mut Load<'_>,
        remarks: &mut Remarks<'_>,
    ) -> Result<Option<Skin>, Failure> {
        let attribute = |semantic| self.primitive.attributes.get(&Checked::Valid(semantic)).copied();
        let mut sets: Vec<Vec<[Influence; 4]>> = Vec::new();
        for set in 0.. {
            let (indices, weights) = (attribute(Semantic::Joints(set)), attribute(Semantic::Weights(set)));
            let Some((indices, weights)) = indices.zip(weights) else { break };
            let indices = matching(accessors, indices, &[Type::Vec4], self.count)?;
            let weights = matching(accessors, weights, &[Type::Vec4], self.count)?;
            let indices = self.vertices.read(&indices, load, |indices: [f32; 4]| indices)?;
            let weights = self.vertices.read(&weights, load, |weights: [f32; 4]| weights)?;
            load.charge(bytes_of::<[Influence; 4]>(2 * indices.len()))?;
            sets.push(indices.iter().zip(&weights).map(|(indices, weights)| four(*indices, *weights)).collect());
        }
        let Some(vertices) = sets.first().map(Vec::len) else {
            remarks.warn("a skinned mesh has no joints and weights; it is shown in its bind pose");
            return Ok(None);
        };
        let influences = (0..vertices).flat_map(|vertex| sets.iter().flat_map(move |set| set[vertex]));
        let mut influences: Vec<Influence> = influences.collect();
        let per_vertex = 4 * sets.len();
        if let Some(wrong) = influences.iter().find(|influence| influence.joint as usize >= joints.len()) {
            return Err(format!("a vertex refers to joint {} of {}", wrong.joint, joints.len()).into());
        }
        normalize(&mut influences, per_vertex, remarks);
        Ok(Some(Skin { joints, influences: influences.into(), per_vertex }))
    }
}

/// Returns four influences. A weight of zero needs no joint, so that its index may be anything.
fn four(joints: [f32; 4], weights: [f32; 4]) -> [Influence; 4] {
    std::array::from_fn(|place| {
        let weight = f64::from(weights[place]);
        Influence { joint: if weight == 0.0 { 0 } else { joints[place] as u32 }, weight }
    })
}

/// Scales the weights of each vertex so that they add up to 1. Vertices without weights follow the first joint.
fn normalize(influences: &mut [Influence], per_vertex: usize, remarks: &mut Remarks<'_>) {
    for influence in
        influences.iter_mut().filter(|influence| !(influence.weight >= 0.0 && influence.weight.is_finite()))
    {
        remarks.warn("weight of a joint that is negative or not finite; treated as 0");
        influence.weight = 0.0;
    }
    for vertex in influences.chunks_exact_mut(per_vertex) {
        let sum: f64 = vertex.iter().map(|influence| influence.weight).sum();
        if sum > 0.0 {
            vertex.iter_mut().for_each(|influence| influence.weight /= sum);
        } else {
            remarks.warn("vertex without weights of joints; it follows the first joint");
            vertex[0].weight = 1.0;
        }
    }
}
