//! Shared buffers: the library owns each mesh, material and texture once, and instances refer to it by identifier.

use super::{Material, Mesh, Texture};
use crate::text;

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub struct $name(u32);

        impl $name {
            /// Returns the index in the library.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(
    /// Identifier of a mesh of one [`Library`].
    MeshId
);
id!(
    /// Identifier of a material of one [`Library`].
    MaterialId
);
id!(
    /// Identifier of a texture of one [`Library`].
    TextureId
);

/// Owner of all meshes, materials and textures of a scene. Only the library creates identifiers, so they never dangle.
#[derive(Clone, Debug, Default)]
pub struct Library {
    meshes: Vec<Mesh>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
}

impl Library {
    /// Adds a mesh.
    pub fn add_mesh(&mut self, mesh: Mesh) -> MeshId {
        self.meshes.push(mesh);
        MeshId(self.meshes.len() as u32 - 1)
    }

    /// Adds a material and removes control characters from its names.
    pub fn add_material(&mut self, mut material: Material) -> MaterialId {
        material.name = text::clean(&material.name).into_owned();
        material.missing_texture = material.missing_texture.map(|name| text::clean(&name).into_owned());
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a texture.
    pub fn add_texture(&mut self, texture: Texture) -> TextureId {
        self.textures.push(texture);
        TextureId(self.textures.len() as u32 - 1)
    }

    /// Returns the mesh of an identifier from this library.
    pub fn mesh(&self, id: MeshId) -> &Mesh {
        &self.meshes[id.index()]
    }

    /// Returns the material of an identifier from this library.
    pub fn material(&self, id: MaterialId) -> &Material {
        &self.materials[id.index()]
    }

    /// Returns the texture of an identifier from this library.
    pub fn texture(&self, id: TextureId) -> &Texture {
        &self.textures[id.index()]
    }

    /// Returns a copy of the library with every mesh mirrored in z; identifiers stay valid.
    pub(crate) fn mirrored_z(&self) -> Self {
        self.with_meshes(Mesh::mirrored_z)
    }

    /// Returns a copy of the library with every mesh replaced by the result of `make`; identifiers stay valid.
    pub(crate) fn with_meshes(&self, make: impl FnMut(&Mesh) -> Mesh) -> Self {
        Self {
            meshes: self.meshes.iter().map(make).collect(),
            materials: self.materials.clone(),
            textures: self.textures.clone(),
        }
    }

    /// Returns all meshes, in the order of their identifiers.
    pub fn meshes(&self) -> &[Mesh] {
        &self.meshes
    }

    /// Returns all materials, in the order of their identifiers.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// Returns all textures, in the order of their identifiers.
    pub fn textures(&self) -> &[Texture] {
        &self.textures
    }

    /// Returns the memory of meshes and textures, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.meshes.iter().map(Mesh::bytes).sum::<usize>() + self.textures.iter().map(Texture::bytes).sum::<usize>()
    }
}
