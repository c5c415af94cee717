//! Nodes: the tree of transforms, with the meshes, cameras and lights that it places.

use glam::{DMat4, DQuat, DVec3, Vec3};
use gltf_json::extensions::scene::khr_lights_punctual::{Light, Type};
use gltf_json::scene::Node;
use gltf_json::{Index, Root};

use super::{Failure, Remarks, name_or, valid};
use crate::math::unit_or;
use crate::scene::animation::{Local, Node as RigNode, Parts, Rig};

/// Mesh that a node places.
pub(super) struct PlacedMesh {
    /// Display name: of the node, or else of the mesh.
    pub(super) name: String,
    /// Index of the mesh in the file.
    pub(super) mesh: usize,
    /// Affine transform from model space to world space.
    pub(super) world_from_model: DMat4,
    /// Index of the node in the rig.
    pub(super) node: usize,
    /// Index of the skin in the file.
    pub(super) skin: Option<usize>,
    /// Whether a skin or morph targets deform the mesh.
    pub(super) is_deformed: bool,
}

impl PlacedMesh {
    /// Returns whether the transform mirrors the mesh, which turns its front faces over.
    pub(super) fn is_mirrored(&self) -> bool {
        self.world_from_model.determinant() < 0.0
    }
}

/// Camera that a node places.
pub(super) struct PlacedCamera {
    /// Display name: of the node, or else of the camera.
    pub(super) name: String,
    pub(super) camera: gltf_json::Camera,
    /// Affine transform from view space to world space.
    pub(super) world_from_view: DMat4,
}

/// Contents of the default scene in world space, in the order of the tree.
pub(super) struct Placed {
    pub(super) meshes: Vec<PlacedMesh>,
    pub(super) cameras: Vec<PlacedCamera>,
    /// World-space direction towards the first directional light, as a unit vector.
    pub(super) light: Option<Vec3>,
    /// All nodes of the scene.
    pub(super) rig: Rig,
    /// Index in the rig of each node of the file; `None` for nodes outside the scene.
    pub(super) rig_nodes: Vec<Option<usize>>,
}

/// Walks the nodes of the default scene.
///
/// # Errors
/// Returns an error that names a node if its transform is not affine or too large, or if two nodes have it as a child.
pub(super) fn place(root: &Root, remarks: &mut Remarks<'_>) -> Result<Placed, Failure> {
    let mut placed = Placed {
        meshes: Vec::new(),
        cameras: Vec::new(),
        light: None,
        rig: Rig::default(),
        rig_nodes: vec![None; root.nodes.len()],
    };
    let outer = Parent { rig_node: None, world: DMat4::IDENTITY };
    let mut pending: Vec<(Index<Node>, Parent)> = roots(root).into_iter().rev().map(|node| (node, outer)).collect();
    while let Some((index, parent)) = pending.pop() {
        let number = index.value();
        let Some(node) = root.nodes.get(number) else { continue };
        if placed.rig_nodes[number].is_some() {
            return Err(format!("nodes[{number}]: it has two parents, or contains itself").into());
        }
        let local = transform(node).map_err(|reason| format!("nodes[{number}]: {reason}"))?;
        let world = parent.world * local.matrix();
        if !world.as_mat4().is_finite() {
            return Err(format!("nodes[{number}]: its transform is too large").into());
        }
        let rig_node = placed.rig.add_node(RigNode { parent: parent.rig_node, local, weights: weights(root, node) });
        placed.rig_nodes[number] = Some(rig_node);
        let placed_node = Parent { rig_node: Some(rig_node), world };
        take(root, index, placed_node, &mut placed, remarks);
        pending.extend(node.children.iter().flatten().rev().map(|child| (*child, placed_node)));
    }
    Ok(placed)
}

/// Node whose children are placed.
#[derive(Clone, Copy)]
struct Parent {
    /// Index in the rig; `None` for the world.
    rig_node: Option<usize>,
    /// Affine transform from the space of the node to world space.
    world: DMat4,
}

/// Returns the weights of the morph targets of a node's mesh.
fn weights(root: &Root, node: &Node) -> Vec<f64> {
    let mesh = node.mesh.and_then(|mesh| root.get(mesh));
    let given = node.weights.as_ref().or(mesh.and_then(|mesh| mesh.weights.as_ref()));
    given.into_iter().flatten().map(|weight| f64::from(*weight)).collect()
}

/// Returns the root nodes of the default scene. A file without scenes shows all nodes that are not children.
fn roots(root: &Root) -> Vec<Index<Node>> {
    let scene = root.scene.and_then(|scene| root.get(scene)).or(root.scenes.first());
    if let Some(scene) = scene {
        return scene.nodes.clone();
    }
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
        if let Some(is_child) = is_child.get_mut(child.value()) {
            *is_child = true;
        }
    }
    (0..).zip(is_child).filter(|(_, is_child)| !is_child).map(|(node, _)| Index::new(node)).collect()
}

/// Takes mesh, camera and light of a node.
fn take(
    root: &Root,
    index: Index<Node>,
    Parent { rig_node, world }: Parent,
    placed: &mut Placed,
    remarks: &mut Remarks<'_>,
) {
    let Some(node) = root.get(index) else { return };
    let number = index.value();
    let named = |own: Option<&String>, kind, index| {
        if node.name.as_ref().is_some_and(|name| !name.is_empty()) {
            name_or(node.name.as_ref(), "node", number)
        } else {
            name_or(own, kind, index)
        }
    };
    if let Some((index, mesh)) = node.mesh.and_then(|mesh| Some((mesh.value(), root.get(mesh)?))) {
        let name = named(mesh.name.as_ref(), "mesh", index);
        let skin = node.skin.map(|skin| skin.value());
        // Joints place a skinned mesh, not its own node.
        let world_from_model = if skin.is_some() { DMat4::IDENTITY } else { world };
        let node = rig_node.unwrap_or_default();
        placed.meshes.push(PlacedMesh { name, mesh: index, world_from_model, node, skin, is_deformed: false });
    }
    if let Some((index, camera)) = node.camera.and_then(|camera| Some((camera.value(), root.get(camera)?))) {
        let name = named(camera.name.as_ref(), "camera", index);
        placed.cameras.push(PlacedCamera { name, camera: camera.clone(), world_from_view: world });
    }
    let light = node.extensions.as_ref().and_then(|extensions| extensions.khr_lights_punctual.as_ref());
    if let Some(light) = light.and_then(|light| root.get(light.light)) {
        take_light(light, world, placed, remarks);
    }
}

fn take_light(light: &Light, world: DMat4, placed: &mut Placed, remarks: &mut Remarks<'_>) {
    match valid(light.type_) {
        Some(Type::Directional) if placed.light.is_none() => {
            // A light shines along its −z axis.
            placed.light = Some(unit_or(world.z_axis.truncate(), Vec3::Y));
            remarks.note(
                "the directional light sets the setting light.direction; its colour and intensity are not rendered",
            );
        }
        Some(Type::Directional) => remarks.warn("further directional lights are not rendered"),
        Some(Type::Point) => remarks.warn("point lights are not rendered"),
        Some(Type::Spot) => remarks.warn("spot lights are not rendered"),
        None => {}
    }
}

/// Returns the transform of a node from its own space to that of its parent.
fn transform(node: &Node) -> Result<Local, String> {
    let local = if let Some(columns) = node.matrix {
        Local::Matrix(DMat4::from_cols_array(&columns.map(f64::from)))
    } else {
        let vector = |given: Option<[f32; 3]>, unset| given.map_or(unset, |given| DVec3::from(given.map(f64::from)));
        let rotation = node.rotation.map_or(DQuat::IDENTITY, |given| DQuat::from_array(given.0.map(f64::from)));
        if rotation.length_squared() == 0.0 {
            return Err("its rotation is zero".to_owned());
        }
        // Unit quaternions are left as they are: normalising them changes their last bits.
        let rotation = if rotation.is_normalized() { rotation } else { rotation.normalize() };
        let (scale, translation) = (vector(node.scale, DVec3::ONE), vector(node.translation, DVec3::ZERO));
        Local::Parts(Parts { translation, rotation, scale })
    };
    if local.matrix().row(3) != glam::DVec4::W {
        return Err("its matrix is not affine: the last row must be 0 0 0 1".to_owned());
    }
    Ok(local)
}
