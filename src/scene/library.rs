//! Shared buffers: each mesh, material and texture is owned once, and instances refer to it by number.

use super::{Material, Mesh, Texture};
use crate::text;

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub struct $name(u32);

        impl $name {
            /// Position in the library.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(
    /// A mesh of one [`Library`].
    MeshId
);
id!(
    /// A material of one [`Library`].
    MaterialId
);
id!(
    /// A texture of one [`Library`].
    TextureId
);

/// Owner of all meshes, materials and textures of a scene. Identifiers are only made here, so they never dangle.
#[derive(Clone, Debug, Default)]
pub struct Library {
    meshes: Vec<Mesh>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
}

impl Library {
    /// Takes a mesh.
    pub fn add_mesh(&mut self, mesh: Mesh) -> MeshId {
        self.meshes.push(mesh);
        MeshId(self.meshes.len() as u32 - 1)
    }

    /// Takes a material; its names are cleaned.
    pub fn add_material(&mut self, mut material: Material) -> MaterialId {
        material.name = text::clean(&material.name).into_owned();
        material.missing_texture = material.missing_texture.map(|name| text::clean(&name).into_owned());
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Takes a texture.
    pub fn add_texture(&mut self, texture: Texture) -> TextureId {
        self.textures.push(texture);
        TextureId(self.textures.len() as u32 - 1)
    }

    /// The mesh behind an identifier of this library.
    pub fn mesh(&self, id: MeshId) -> &Mesh {
        &self.meshes[id.index()]
    }

    /// The material behind an identifier of this library.
    pub fn material(&self, id: MaterialId) -> &Material {
        &self.materials[id.index()]
    }

    /// The texture behind an identifier of this library.
    pub fn texture(&self, id: TextureId) -> &Texture {
        &self.textures[id.index()]
    }

    /// The same library with every mesh mirrored in z; identifiers stay valid.
    pub fn mirrored_z(&self) -> Self {
        self.with_meshes(Mesh::mirrored_z)
    }

    /// The same library with every mesh made anew by `make`; identifiers stay valid.
    pub fn with_meshes(&self, make: impl FnMut(&Mesh) -> Mesh) -> Self {
        Self {
            meshes: self.meshes.iter().map(make).collect(),
            materials: self.materials.clone(),
            textures: self.textures.clone(),
        }
    }

    /// All meshes.
    pub fn meshes(&self) -> &[Mesh] {
        &self.meshes
    }

    /// All materials.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// All textures.
    pub fn textures(&self) -> &[Texture] {
        &self.textures
    }

    /// Bytes held by meshes and textures.
    pub fn bytes(&self) -> usize {
        self.meshes.iter().map(Mesh::bytes).sum::<usize>() + self.textures.iter().map(Texture::bytes).sum::<usize>()
    }
}
