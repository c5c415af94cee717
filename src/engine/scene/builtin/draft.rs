//! Builder for built-in scenes: adds generated meshes and images, returns their ids, and creates a [`Scene`].
//!
//! Generated data is validated only here. All input comes from this crate, so invalid data is a bug; the tests of the
//! built-in scenes build every scene.

use std::sync::Arc;

use glam::{DMat4, Mat4, Vec3};

use crate::image::{Image, Rgba8};
use crate::scene::animation::{Animation, Attachment};
use crate::scene::{
    Camera, Instance, Library, Material, MaterialId, Mesh, MeshData, MeshId, Scene, Texture, TextureId,
};

/// Scene under construction, without its name.
pub(super) struct SceneDraft {
    library: Library,
    instances: Vec<Instance>,
    background: [u8; 3],
    home: Camera,
    /// Motion of the scene; by default, the scene is still.
    pub(super) animation: Animation,
}

impl SceneDraft {
    /// Creates an empty scene with this background (sRGB codes) and the initial view `home`.
    pub(super) fn new(background: [u8; 3], home: Camera) -> Self {
        Self { library: Library::default(), instances: Vec::new(), background, home, animation: Animation::default() }
    }

    /// Adds a generated mesh. Panics if it is invalid; see [`Mesh::new`].
    pub(super) fn mesh(&mut self, data: MeshData) -> MeshId {
        self.library.add_mesh(Mesh::new(data).expect("generated meshes are valid"))
    }

    /// Adds a generated mesh that will be deformed, and returns it with its identifier. Panics if it is invalid.
    pub(super) fn deformed_mesh(&mut self, data: MeshData) -> (MeshId, Arc<Mesh>) {
        let rest = Arc::new(Mesh::new(data).expect("generated meshes are valid"));
        (self.library.add_shared_mesh(Arc::clone(&rest)), rest)
    }

    /// Adds a generated mesh with NaN normals, which are repaired; see [`Mesh::repaired`]. Panics if it is otherwise
    /// invalid.
    pub(super) fn repaired_mesh(&mut self, data: MeshData) -> MeshId {
        self.library.add_mesh(Mesh::repaired(data).expect("generated meshes are valid but for normals"))
    }

    /// Adds a generated picture as a texture. Panics if it has no pixels.
    pub(super) fn texture(&mut self, image: Image<Rgba8>) -> TextureId {
        self.library.add_texture(Texture::new(image).expect("generated pictures have pixels"))
    }

    /// Adds a white material with a texture. The alpha of the texture determines the transparency.
    pub(super) fn textured(&mut self, name: &str, image: Image<Rgba8>) -> MaterialId {
        let texture = self.texture(image);
        self.library.add_material(Material::textured(name, texture))
    }

    /// Adds an opaque material without a texture. `diffuse` is an sRGB colour.
    pub(super) fn plain(&mut self, name: &str, diffuse: Vec3) -> MaterialId {
        self.library.add_material(Material::plain(name, diffuse))
    }

    /// Adds an opaque material whose texture file is missing. `diffuse` is an sRGB colour.
    pub(super) fn without_texture(&mut self, name: &str, diffuse: Vec3, file: &str) -> MaterialId {
        let missing_texture = Some(file.to_owned());
        self.library.add_material(Material { missing_texture, ..Material::plain(name, diffuse) })
    }

    /// Adds an untextured, blended material with an opacity in [0, 1]. `diffuse` is an sRGB colour.
    pub(super) fn translucent(&mut self, name: &str, diffuse: Vec3, opacity: f32) -> MaterialId {
        self.library.add_material(Material { opacity, ..Material::plain(name, diffuse) })
    }

    /// Adds a material with one picture for its lit side and another for its unlit side.
    pub(super) fn cel(&mut self, name: &str, [light, dark]: [Image<Rgba8>; 2]) -> MaterialId {
        let texture = self.texture(light);
        let dark_texture = Some(self.texture(dark));
        self.library.add_material(Material { dark_texture, ..Material::textured(name, texture) })
    }

    /// Adds a material whose textures have already been added.
    pub(super) fn material(&mut self, material: Material) -> MaterialId {
        self.library.add_material(material)
    }

    /// Adds an object with a white tint, and returns it for further changes.
    pub(super) fn place(
        &mut self,
        name: impl Into<String>,
        mesh: MeshId,
        material: MaterialId,
        world_from_model: Mat4,
    ) -> &mut Instance {
        let instance = Instance { name: name.into(), mesh, material, world_from_model, tint: Vec3::ONE };
        self.instances.push_mut(instance)
    }

    /// Returns the index of the object with this name. Panics if there is none.
    pub(super) fn object(&self, name: &str) -> usize {
        self.instances.iter().position(|instance| instance.name == name).expect("the object has been placed")
    }

    /// Returns the transform of an object from model space to world space.
    pub(super) fn transform(&self, instance: usize) -> DMat4 {
        self.instances[instance].world_from_model.as_dmat4()
    }

    /// Attaches an object to a node of the motion, by the transform from model space to the space of the node.
    pub(super) fn attach(&mut self, instance: usize, node: usize, node_from_model: DMat4) {
        let fallback = self.instances[instance].world_from_model;
        self.animation.attachments.push(Attachment { instance, node, node_from_model, fallback });
    }

    /// Finishes the scene and gives it a name.
    pub(super) fn finish(self, name: &str) -> Scene {
        let Self { library, instances, background, home, animation } = self;
        let scene = Scene {
            name: name.to_owned(),
            library,
            instances,
            background,
            home,
            views: Vec::new(),
            light: None,
            animation: None,
        };
        scene.animated(animation)
    }
}
