//! Scenes: validated data for rendering. Every [`Scene`] can be rendered.

pub(crate) mod animation;

pub mod builtin;

pub(crate) mod camera;

pub mod camera_file;

pub(crate) mod camera_path;

pub(crate) mod clusters;

pub(crate) mod depth_mapping;

pub(crate) mod error;

mod file_names;

pub(crate) mod first_view;

pub(crate) mod format;

mod ids;

pub(crate) mod library;

pub(crate) mod load;

pub(crate) mod material;

pub(crate) mod mesh;

mod mips;

pub mod seams;

pub(crate) mod source;

pub(crate) mod texture;

mod warnings;

pub use animation::SceneMotion;
pub use camera::Camera;
pub use camera::Projection;
pub use camera::SubView;
pub(crate) use camera_path::key_views;
pub use camera_path::{CameraPath, KeyView};
pub use depth_mapping::{DepthCurve, DepthMapping};
pub use error::SceneError;
pub use error::Warning;
pub use first_view::UpAxis;
pub use format::SceneFormat;
pub use format::{gltf, obj};
pub(crate) use ids::{MaterialId, MeshId, TextureId};
pub use library::Library;
pub use load::LoadControl;
pub use load::Loaded;
pub use load::MemoryLimit;
pub use material::Material;
pub use material::Transparency;
pub use mesh::Mesh;
pub use mesh::MeshData;
pub(crate) use mips::MipOffsets;
pub use source::SceneSource;
pub(crate) use texture::Alpha;
pub use texture::Texture;

use glam::{Mat4, Vec3};

use crate::math::Aabb;
use crate::text;

/// One object of a scene: mesh, material and transform. The record is small, because meshes and materials are shared.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Display name of the object.
    pub name: String,
    /// Identifier of the object's mesh, which other objects may share.
    pub mesh: MeshId,
    /// Identifier of the object's material, which other objects may share.
    pub material: MaterialId,
    /// Affine transform from model space to world space.
    pub world_from_model: Mat4,
    /// Colour that multiplies the material's colour, as sRGB values in [0, 1].
    pub tint: Vec3,
}

/// Identifier of a triangle in a scene, numbered in draw order over all instances.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[serde(transparent)]
pub struct TriangleId(pub u32);

impl TriangleId {
    /// Value that represents "no triangle" in buffers of identifiers.
    pub const NONE: Self = Self(u32::MAX);
}

/// Scene to render: objects, the data that they share, background, and initial view.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Display name of the scene.
    pub name: String,
    /// Shared meshes, materials and textures.
    pub library: Library,
    /// Objects, in draw order.
    pub instances: Vec<Instance>,
    /// Background colour, as sRGB codes.
    pub background: [u8; 3],
    /// Initial view, to which a view reset returns.
    pub home: Camera,
    /// Views that the file of the scene defines by its cameras, in file order.
    pub views: Vec<SceneView>,
    /// World-space direction towards the light that the file of the scene defines, as a unit vector; `None` if it
    /// defines none. It replaces the light direction of the settings when the scene is opened.
    pub light: Option<Vec3>,
    /// Motion of the scene; `None` for a still scene. An edit of the triangles must remove or replace it.
    pub animation: Option<SceneMotion>,
}

/// View of a scene with a name, from a camera in the scene's file.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneView {
    /// Display name of the view.
    pub name: String,
    /// Camera of the view.
    pub camera: Camera,
}

impl Scene {
    /// Returns the bounding box of all instances, in world space.
    pub fn bounds(&self) -> Aabb {
        self.instances
            .iter()
            .fold(Aabb::EMPTY, |all, i| all.union(self.library.mesh(i.mesh).bounds().transformed(i.world_from_model)))
    }

    /// Returns the scene and its initial view mirrored in z, for models made for a coordinate system of the opposite
    /// handedness.
    pub fn mirrored_z(&self) -> Self {
        let mirror = Mat4::from_scale(Vec3::new(1.0, 1.0, -1.0));
        let mut scene = Self {
            library: self.library.mirrored_z(),
            home: self.home.mirrored_z(),
            light: self.light.map(|direction| direction * Vec3::new(1.0, 1.0, -1.0)),
            animation: self.mirrored_animation(),
            ..self.clone()
        };
        for view in &mut scene.views {
            view.camera = view.camera.mirrored_z();
        }
        for instance in &mut scene.instances {
            instance.world_from_model = mirror * instance.world_from_model * mirror;
        }
        scene
    }

    /// Removes control characters from the names of the scene, its instances and its views, which may come from files.
    fn clean_names(&mut self) {
        let instances = self.instances.iter_mut().map(|instance| &mut instance.name);
        let names = instances.chain(self.views.iter_mut().map(|view| &mut view.name)).chain([&mut self.name]);
        for name in names {
            *name = text::clean(name).into_owned();
        }
    }

    /// Returns a view of the whole scene with the up axis `up`, from the preferred direction unless another one shows
    /// clearly more front-facing area.
    pub fn first_view(&self, up: UpAxis) -> Camera {
        first_view::first_view(self, up)
    }

    /// Returns the time of the pose, in seconds; 0 for a still scene.
    pub fn time_s(&self) -> f64 {
        self.animation.as_ref().map_or(0.0, SceneMotion::time_s)
    }

    /// Returns the number of triangles over all instances.
    pub fn triangle_count(&self) -> usize {
        self.instances.iter().map(|i| self.library.mesh(i.mesh).triangles.len()).sum()
    }

    /// Returns the identifier of the first triangle of each instance, in draw order.
    pub fn first_triangles(&self) -> Vec<TriangleId> {
        self.instances
            .iter()
            .scan(0, |next, i| {
                let first = *next;
                *next += self.library.mesh(i.mesh).triangles.len() as u32;
                Some(TriangleId(first))
            })
            .collect()
    }

    /// Returns the ids of the triangles with a normal or texture coordinate that was not finite, in ascending order.
    pub(crate) fn broken_triangles(&self) -> impl Iterator<Item = TriangleId> {
        let meshes = self.instances.iter().map(|instance| self.library.mesh(instance.mesh));
        meshes.zip(self.first_triangles()).flat_map(|(mesh, TriangleId(first))| {
            mesh.broken_triangles().iter().map(move |triangle| TriangleId(first + triangle))
        })
    }

    /// Returns the memory used by the scene, in bytes.
    pub fn memory(&self) -> SceneMemory {
        SceneMemory {
            shared_bytes: self.library.bytes() + self.animation_bytes(),
            mesh_bytes: self.library.meshes().iter().map(|mesh| mesh.bytes()).sum(),
            instance_bytes: self.instances.iter().map(|i| size_of::<Instance>() + i.name.capacity()).sum(),
            unshared_bytes: self.instances.iter().map(|i| self.library.mesh(i.mesh).bytes()).sum(),
        }
    }
}

/// Memory used by a scene, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneMemory {
    /// Memory used by meshes, textures and motion, in bytes. Each mesh and each texture is counted once.
    pub shared_bytes: usize,
    /// Memory used by the meshes, in bytes. `shared_bytes` includes it.
    pub mesh_bytes: usize,
    /// Memory used by the instance records and their names, in bytes.
    pub instance_bytes: usize,
    /// Memory that the meshes would take if every instance had its own copy of its mesh, in bytes.
    pub unshared_bytes: usize,
}
