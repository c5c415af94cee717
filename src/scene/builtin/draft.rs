//! A scene in the making: takes shapes and pictures, hands out identifiers, and ends as a [`Scene`].
//!
//! The one place where generated data is checked. What arrives here was computed by this crate, so a fault in it is a
//! fault of the code; the tests of the built-in scenes build every one of them.

use glam::{Mat4, Vec3};

use crate::image::{Image, Rgba8};
use crate::scene::{
    Camera, Instance, Library, Material, MaterialId, Mesh, MeshData, MeshId, Scene, Texture, TextureId,
};

/// A scene without its name.
pub(super) struct Draft {
    library: Library,
    instances: Vec<Instance>,
    background: [u8; 3],
    home: Camera,
}

impl Draft {
    /// An empty scene before `background` (sRGB codes), first seen from `home`.
    pub(super) fn new(background: [u8; 3], home: Camera) -> Self {
        Self { library: Library::default(), instances: Vec::new(), background, home }
    }

    /// Takes a generated mesh. Panics if the generator broke the rules of [`Mesh::new`].
    pub(super) fn mesh(&mut self, data: MeshData) -> MeshId {
        self.library.add_mesh(Mesh::new(data).expect("generated meshes are valid"))
    }

    /// The same of a mesh some of whose normals are no numbers.
    pub(super) fn repaired_mesh(&mut self, data: MeshData) -> MeshId {
        self.library.add_mesh(Mesh::repaired(data).expect("generated meshes are valid but for normals"))
    }

    /// Takes a generated picture. Panics if the generator made an empty one.
    pub(super) fn texture(&mut self, name: &str, image: Image<Rgba8>) -> TextureId {
        self.library.add_texture(Texture::new(name, image).expect("generated pictures have pixels"))
    }

    /// A white material under a texture of its own, opaque where that is.
    pub(super) fn textured(&mut self, name: &str, image: Image<Rgba8>) -> MaterialId {
        let texture = self.texture(name, image);
        self.library.add_material(Material::textured(name, texture))
    }

    /// An opaque material without a texture. `diffuse` in sRGB values.
    pub(super) fn plain(&mut self, name: &str, diffuse: Vec3) -> MaterialId {
        self.library.add_material(Material::plain(name, diffuse))
    }

    /// An opaque material whose texture could not be read. `diffuse` in sRGB values.
    pub(super) fn without_texture(&mut self, name: &str, diffuse: Vec3, file: &str) -> MaterialId {
        let missing_texture = Some(file.to_owned());
        self.library.add_material(Material { missing_texture, ..Material::plain(name, diffuse) })
    }

    /// An untextured material that shows what lies behind. `diffuse` in sRGB values.
    pub(super) fn translucent(&mut self, name: &str, diffuse: Vec3, opacity: f32) -> MaterialId {
        self.library.add_material(Material { opacity, ..Material::plain(name, diffuse) })
    }

    /// A material that has one picture for its lit and one for its unlit side.
    pub(super) fn cel(&mut self, name: &str, [light, dark]: [Image<Rgba8>; 2]) -> MaterialId {
        let texture = self.texture(name, light);
        let dark_texture = Some(self.texture(&format!("{name}, dark"), dark));
        self.library.add_material(Material { dark_texture, ..Material::textured(name, texture) })
    }

    /// Adds a material whose textures were added before.
    pub(super) fn material(&mut self, material: Material) -> MaterialId {
        self.library.add_material(material)
    }

    /// Adds an object. Returns it, white, to be tinted.
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

    /// The scene, named.
    pub(super) fn finish(self, name: &str) -> Scene {
        let Self { library, instances, background, home } = self;
        Scene { name: name.to_owned(), library, instances, background, home }
    }
}
