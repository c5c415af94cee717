//! Meshes: the vertices and triangles of each primitive, as one mesh of the scene each.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{Vec2, Vec3};
use gltf_json::accessor::Type;
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Index, Root, accessor};

use super::accessors::{Accessors, Elements};
use super::deformations::{DeformedPrimitive, PrimitiveShape, Skins};
use super::materials::{self, srgb};
use super::nodes::PlacedMesh;
use super::vertices::{Vertices, matching};
use super::{Failure, Remarks, name_or, topology, valid};
use crate::math::unit_or;
use crate::scene::animation::{Deformation, Joint};
use crate::scene::load::{Load, MAX_COORDINATE, bytes_of};
use crate::scene::mesh::smooth_normals;
use crate::scene::{Library, Mesh, MeshData, MeshId};

/// Primitive of a mesh in the file.
pub(super) struct Part {
    pub(super) mesh: MeshId,
    /// Index of its material in the file, or `None` for the default material.
    pub(super) material: Option<usize>,
    /// Number among the primitives of its mesh, from 1; `None` if it is the only one.
    number: Option<usize>,
}

impl Part {
    /// Returns the display name of the part of an object.
    pub(super) fn name(&self, object: &str) -> String {
        self.number.map_or_else(|| object.to_owned(), |number| format!("{object} {number}"))
    }
}

/// Meshes of a file, each read at its first use.
pub(super) struct Meshes<'a> {
    root: &'a Root,
    accessors: Accessors<'a>,
    skins: Skins<'a>,
    known: HashMap<MeshKey, Vec<Part>>,
    /// Deformations of the meshes that were read.
    deformations: Vec<Deformation>,
}

/// Use of a mesh of the file that needs a mesh of its own in the scene.
#[derive(PartialEq, Eq, Hash)]
struct MeshKey {
    /// Index of the mesh in the file.
    mesh: usize,
    is_mirrored: bool,
    /// Index of the node in the rig, for a deformed mesh.
    node: Option<usize>,
}

impl MeshKey {
    fn of(placed: &PlacedMesh) -> Self {
        let node = placed.is_deformed.then_some(placed.node);
        Self { mesh: placed.mesh, is_mirrored: placed.is_mirrored(), node }
    }
}

/// Cause of the deformation of a mesh.
struct Deformer {
    /// Joints of its skin; `None` for a mesh with morph targets only.
    joints: Option<Arc<[Joint]>>,
}

/// Primitive with the deformation that it has.
struct ReadPrimitive {
    data: MeshData,
    shape: Option<PrimitiveShape>,
    /// Whether the normals follow from the triangles, because the file has none.
    computes_normals: bool,
}

impl<'a> Meshes<'a> {
    /// Creates an empty collection. `rig_nodes` holds the index in the rig of each node of the file, and `None` for
    /// nodes outside the scene.
    pub(super) fn new(root: &'a Root, accessors: Accessors<'a>, rig_nodes: &'a [Option<usize>]) -> Self {
        let (skins, known, deformations) = (Skins::new(root, rig_nodes), HashMap::new(), Vec::new());
        Self { root, accessors, skins, known, deformations }
    }

    /// Returns the deformations of all meshes.
    pub(super) fn into_deformations(self) -> Vec<Deformation> {
        self.deformations
    }

    /// Reads the mesh that a node places, at its first use. A mirrored mesh gets a copy whose triangles have the
    /// opposite order of corners, and a deformed mesh a copy for each node. Returns whether the mesh is new.
    pub(super) fn prepare(
        &mut self,
        placed: &PlacedMesh,
        library: &mut Library,
        load: &mut Load<'_>,
        remarks: &mut Remarks<'_>,
    ) -> Result<bool, Failure> {
        let key = MeshKey::of(placed);
        if self.known.contains_key(&key) {
            return Ok(false);
        }
        let Some(mesh) = self.root.meshes.get(placed.mesh) else { return Ok(false) };
        let deformer = self.deformer(placed, remarks)?;
        let mut parts = Vec::new();
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            let place = format!("meshes[{}].primitives[{number}]", placed.mesh);
            let named = |failure| match failure {
                Failure::Unusable(reason) => Failure::Unusable(format!("{place}: {reason}")),
                named @ Failure::Named(_) => named,
            };
            let read = self.primitive(primitive, deformer.as_ref(), load, remarks).map_err(named)?;
            let Some(ReadPrimitive { mut data, shape, computes_normals }) = read else { continue };
            let number = (mesh.primitives.len() > 1).then_some(number + 1);
            if key.is_mirrored {
                data.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
            }
            let material = primitive.material.map(|material| material.value());
            data.name = name_or(mesh.name.as_ref(), "mesh", placed.mesh);
            let rest = Arc::new(Mesh::repaired(data).map_err(|error| format!("{place}: {error}"))?);
            let mesh = library.add_shared_mesh(Arc::clone(&rest));
            parts.push(Part { mesh, material, number });
            if let Some(PrimitiveShape { targets, skin }) = shape {
                // The deformed mesh takes as much memory as the one at rest.
                load.charge(rest.bytes() as u64)?;
                let (node, targets) = (placed.node, targets.into());
                self.deformations.push(Deformation { mesh, rest, node, targets, skin, computes_normals });
            }
        }
        self.known.insert(key, parts);
        Ok(true)
    }

    /// Returns the parts of a mesh that was prepared.
    pub(super) fn parts(&self, placed: &PlacedMesh) -> &[Part] {
        self.known.get(&MeshKey::of(placed)).map_or(&[], Vec::as_slice)
    }

    /// Returns the cause of the deformation of a placed mesh, or `None` if it keeps its shape.
    fn deformer(&mut self, placed: &PlacedMesh, remarks: &mut Remarks<'_>) -> Result<Option<Deformer>, Failure> {
        if !placed.is_deformed {
            return Ok(None);
        }
        let Some(skin) = placed.skin else { return Ok(Some(Deformer { joints: None })) };
        let joints = self.skins.joints(skin, &mut self.accessors, remarks)?;
        Ok(Some(Deformer { joints }))
    }

    /// Reads a primitive. Returns `None` if it has no triangles.
    fn primitive(
        &mut self,
        primitive: &Primitive,
        deformer: Option<&Deformer>,
        load: &mut Load<'_>,
        remarks: &mut Remarks<'_>,
    ) -> Result<Option<ReadPrimitive>, Failure> {
        let mode = valid(primitive.mode).unwrap_or(Mode::Triangles);
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
        let Some(positions) = attribute(Semantic::Positions) else { return Ok(None) };
        let positions = self.accessors.get(positions, &[Type::Vec3])?;
        let indices = primitive.indices.map(|indices| self.indices(indices, positions.count())).transpose()?;
        let count = indices.as_ref().map_or(positions.count(), Elements::count);
        let index = |place: usize| indices.as_ref().map_or(place as u32, |indices| indices.integer(place));
        let Some(mut triangles) = topology::triangles(mode, count, index, load)? else {
            remarks.warn(format!("{} are not rendered", topology::name(mode)));
            return Ok(None);
        };
        if let Some(wrong) = triangles.as_flattened().iter().find(|index| **index as usize >= positions.count()) {
            return Err(format!("an index refers to vertex {wrong} of {}", positions.count()).into());
        }
        let is_list = mode == Mode::Triangles;
        // A deformation may give area to a triangle that has none.
        if deformer.is_none() {
            drop_without_area(&mut triangles, &positions, is_list, remarks);
        }
        if triangles.is_empty() {
            return Ok(None);
        }
        let material = primitive.material.map(|material| material.value());
        let placement = materials::placement(self.root, material);
        let normals = attribute(Semantic::Normals);
        let vertices = Vertices::choose(&mut triangles, positions.count(), normals.is_none(), load)?;
        let mut data = MeshData { positions: vertices.read(&positions, load, Vec3::from)?, ..MeshData::default() };
        check_positions(&data.positions, remarks)?;
        if let Some(placement) = placement
            && let Some(uvs) = attribute(Semantic::TexCoords(placement.set))
        {
            let uvs = matching(&mut self.accessors, uvs, &[Type::Vec2], positions.count())?;
            data.uvs = vertices.read(&uvs, load, |uv| placement.apply(Vec2::from(uv)))?;
            if data.uvs.iter().any(|uv| !uv.is_finite()) {
                remarks.warn("texture coordinate that is not finite; treated as 0 1");
            }
        }
        if let Some(colors) = attribute(Semantic::Colors(0)) {
            let colors = matching(&mut self.accessors, colors, &[Type::Vec3, Type::Vec4], positions.count())?;
            if colors.components() == 4 && (0..colors.count()).any(|vertex| colors.vector::<4>(vertex)[3] < 1.0) {
                remarks.warn("the alpha of vertex colours is not rendered");
            }
            data.colors = vertices.read(&colors, load, |color| {
                srgb(color.map(|channel| if channel.is_finite() { channel } else { 1.0 }))
            })?;
        }
        data.normals = match normals {
            Some(normals) => {
                let normals = matching(&mut self.accessors, normals, &[Type::Vec3], positions.count())?;
                let read = vertices.read(&normals, load, Vec3::from)?;
                unit_normals(read, &data.positions, &triangles, remarks)
            }
            // Each triangle has vertices of its own here, so that it is flat.
            None => {
                load.charge(bytes_of::<Vec3>(data.positions.len()))?;
                smooth_normals(&data.positions, &triangles)
            }
        };
        remark_attributes(primitive, placement.map(|placement| placement.set), remarks);
        data.triangles = triangles;
        let has_normals = normals.is_some();
        let deformed = DeformedPrimitive { primitive, vertices: &vertices, count: positions.count(), has_normals };
        let shape = match deformer {
            Some(deformer) => deformed.shape(&mut self.accessors, deformer.joints.clone(), load, remarks)?,
            None => None,
        };
        Ok(Some(ReadPrimitive { data, shape, computes_normals: !has_normals }))
    }

    fn indices(&mut self, index: Index<accessor::Accessor>, vertices: usize) -> Result<Elements<'a>, String> {
        let indices = self.accessors.get(index, &[Type::Scalar])?;
        if !indices.are_unsigned() {
            return Err(format!(
                "accessors[{}]: indices into {vertices} vertices must be unsigned integers",
                index.value()
            ));
        }
        Ok(indices)
    }
}

/// Removes triangles two of whose corners have the same position. Strips repeat vertices on purpose, so only lists give a
/// warning.
fn drop_without_area(
    triangles: &mut Vec<[u32; 3]>,
    positions: &Elements<'_>,
    is_list: bool,
    remarks: &mut Remarks<'_>,
) {
    let before = triangles.len();
    triangles.retain(|corners| {
        let [a, b, c] = corners.map(|corner| positions.vector::<3>(corner as usize));
        a != b && b != c && c != a
    });
    if is_list && triangles.len() < before {
        remarks.warn("triangles without area are skipped");
    }
}

fn check_positions(positions: &[Vec3], remarks: &mut Remarks<'_>) -> Result<(), String> {
    if positions.iter().any(|position| !position.is_finite()) {
        remarks.warn("position that is not finite; triangles that use it are not drawn");
    }
    let finite = positions.iter().filter(|position| position.is_finite());
    let largest = finite.fold(0.0_f32, |largest, position| largest.max(position.abs().max_element()));
    if largest > MAX_COORDINATE {
        return Err(format!("coordinates up to {largest:e} are too large: at most {MAX_COORDINATE:e}"));
    }
    Ok(())
}

/// Returns the normals with unit length. Normals of zero length are computed from the triangles; normals that are not
/// finite stay, and the mesh replaces them.
fn unit_normals(
    mut normals: Vec<Vec3>,
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    remarks: &mut Remarks<'_>,
) -> Vec<Vec3> {
    if normals.iter().any(|normal| !normal.is_finite()) {
        remarks.warn("normal that is not finite; corners that use it receive no direct light");
    }
    let mut computed: Option<Vec<Vec3>> = None;
    for (vertex, normal) in normals.iter_mut().enumerate().filter(|(_, normal)| normal.is_finite()) {
        if *normal == Vec3::ZERO {
            *normal = computed.get_or_insert_with(|| smooth_normals(positions, triangles))[vertex];
        } else {
            *normal = unit_or(normal.as_dvec3(), Vec3::Z);
        }
    }
    if computed.is_some() {
        remarks.warn("zero-length normal; computed from the triangles instead");
    }
    normals
}

/// Reports the attributes of a primitive that are not rendered. `set` is the set of texture coordinates that is.
fn remark_attributes(primitive: &Primitive, set: Option<u32>, remarks: &mut Remarks<'_>) {
    for semantic in primitive.attributes.keys() {
        let Checked::Valid(semantic) = semantic else { continue };
        let is_rendered = match semantic {
            Semantic::Positions
            | Semantic::Normals
            | Semantic::Colors(0)
            | Semantic::Joints(_)
            | Semantic::Weights(_) => true,
            Semantic::TexCoords(own) => set.is_none_or(|set| set == *own),
            Semantic::Tangents | Semantic::Colors(_) | Semantic::Extras(_) => false,
        };
        if !is_rendered {
            remarks
                .note(format!("the vertex attribute {} is not rendered", crate::text::message(&semantic.to_string())));
        }
    }
}
