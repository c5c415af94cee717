//! Scenes: objects in world space with one texture each, a camera and a light.

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::mesh::Mesh;
use super::view::Camera;
use super::{Fault, Picture};

/// Directional light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Light {
    /// Direction towards the light in world space, of any length.
    pub(crate) direction: DVec3,
    /// Share of light that reaches every surface, 0…1.
    pub(crate) ambient: f64,
}

impl Default for Light {
    /// Returns the light of the program's default settings.
    fn default() -> Self {
        Self { direction: DVec3::new(0.4, 0.7, 0.6), ambient: 0.2 }
    }
}

/// Surface of an object.
#[derive(Clone, Debug)]
pub(crate) struct Material {
    /// Name of the material and of its texture file.
    pub(crate) name: &'static str,
    pub(crate) texture: Picture,
    /// Opacity, 0…1; below 1, the object is blended.
    pub(crate) opacity: f64,
}

/// Vertex in world space. All values are representable as `f32`, as in a file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vertex {
    pub(crate) position: DVec3,
    /// Texture coordinates, v upwards.
    pub(crate) uv: DVec2,
    /// Unit normal in world space.
    pub(crate) normal: DVec3,
    /// Unit normal in the space of the object.
    pub(crate) object_normal: DVec3,
}

/// Object in world space.
#[derive(Clone, Debug)]
pub(crate) struct Object {
    pub(crate) material: Material,
    /// Triangles, counter-clockwise from their front.
    pub(crate) triangles: Vec<[Vertex; 3]>,
    /// Linear part of the transformation from the space of the object to world space.
    pub(crate) model: DMat3,
}

impl Object {
    /// Returns a mesh transformed to world space by an invertible transformation that keeps its winding.
    pub(crate) fn new(mesh: &Mesh, model: DAffine3, material: Material) -> Self {
        let normals = model.matrix3.inverse().transpose();
        let stored = |value: DVec3| value.as_vec3().as_dvec3();
        let triangles = mesh.triangles.iter().map(|corners| {
            corners.map(|corner| Vertex {
                position: stored(model.transform_point3(corner.position)),
                uv: corner.uv.as_vec2().as_dvec2(),
                normal: stored((normals * corner.normal).normalize()),
                object_normal: corner.normal,
            })
        });
        Self { material, triangles: triangles.collect(), model: model.matrix3 }
    }
}

/// Scene with its view and the faults to draw it with.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    /// Objects in the order in which they are drawn.
    pub(crate) objects: Vec<Object>,
    pub(crate) camera: Camera,
    pub(crate) light: Light,
    /// Background in sRGB codes.
    pub(crate) background: [u8; 3],
    /// Faults that do not change the picture, or hardly so.
    pub(crate) invisible: &'static [Fault],
    /// Pairs of faults that are both visible together.
    pub(crate) pairs: &'static [[Fault; 2]],
}

impl Scene {
    /// Returns the faults that change the picture.
    pub(crate) fn faults(&self) -> impl Iterator<Item = Fault> {
        Fault::ALL.iter().copied().filter(|fault| !self.invisible.contains(fault))
    }
}
