//! Shared data: the library owns each mesh, material and texture once, and instances refer to them by identifier.

use std::sync::Arc;

use super::ids::{MaterialId, MeshId, TextureId};
use super::{Alpha, Material, Mesh, Texture, Transparency};
use crate::text;

/// Owner of all meshes, materials and textures of a scene. Only the library creates identifiers, so they never dangle.
/// Copies share every mesh and texture that does not change.
#[derive(Clone, Debug, Default)]
pub struct Library {
    meshes: Arc<Vec<Arc<Mesh>>>,
    materials: Vec<Material>,
    textures: Arc<Vec<Texture>>,
}

impl Library {
    /// Adds a mesh and returns its identifier.
    pub fn add_mesh(&mut self, mesh: Mesh) -> MeshId {
        self.add_shared_mesh(Arc::new(mesh))
    }

    /// Adds a mesh that has other owners, and returns its identifier.
    pub(super) fn add_shared_mesh(&mut self, mesh: Arc<Mesh>) -> MeshId {
        Arc::make_mut(&mut self.meshes).push(mesh);
        MeshId(self.meshes.len() as u32 - 1)
    }

    /// Replaces the mesh with the identifier `id`, which must come from this library.
    pub(super) fn replace_mesh(&mut self, id: MeshId, mesh: Mesh) {
        Arc::make_mut(&mut self.meshes)[id.index()] = Arc::new(mesh);
    }

    /// Adds a material and returns its identifier. Removes control characters from the material's names.
    pub fn add_material(&mut self, mut material: Material) -> MaterialId {
        material.name = text::clean(&material.name).into_owned();
        material.missing_texture = material.missing_texture.map(|name| text::clean(&name).into_owned());
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a texture and returns its identifier.
    pub fn add_texture(&mut self, texture: Texture) -> TextureId {
        Arc::make_mut(&mut self.textures).push(texture);
        TextureId(self.textures.len() as u32 - 1)
    }

    /// Returns the mesh with the identifier `id`, which must come from this library.
    pub fn mesh(&self, id: MeshId) -> &Mesh {
        &self.meshes[id.index()]
    }

    /// Returns the material with the identifier `id`, which must come from this library.
    pub(crate) fn material(&self, id: MaterialId) -> &Material {
        &self.materials[id.index()]
    }

    /// Returns the texture with the identifier `id`, which must come from this library.
    pub fn texture(&self, id: TextureId) -> &Texture {
        &self.textures[id.index()]
    }

    /// Returns a copy of the library with every mesh mirrored in z; identifiers stay valid.
    pub(crate) fn mirrored_z(&self) -> Self {
        self.with_meshes(Mesh::mirrored_z)
    }

    /// Returns a copy of the library with every mesh replaced by the result of `make`; identifiers stay valid.
    pub fn with_meshes(&self, mut make: impl FnMut(&Mesh) -> Mesh) -> Self {
        Self {
            meshes: Arc::new(self.meshes.iter().map(|mesh| Arc::new(make(mesh))).collect()),
            materials: self.materials.clone(),
            textures: Arc::clone(&self.textures),
        }
    }

    /// Returns a copy of the library with every material replaced by the result of `make`; identifiers stay valid.
    pub fn with_materials(&self, make: impl FnMut(&Material) -> Material) -> Self {
        Self {
            meshes: Arc::clone(&self.meshes),
            materials: self.materials.iter().map(make).collect(),
            textures: Arc::clone(&self.textures),
        }
    }

    /// Returns all meshes, in the order of their identifiers.
    pub fn meshes(&self) -> &[Arc<Mesh>] {
        &self.meshes
    }

    /// Returns all materials, in the order of their identifiers.
    #[cfg(test)]
    pub(crate) fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// Returns all textures, in the order of their identifiers.
    pub fn textures(&self) -> &[Texture] {
        &self.textures
    }

    /// Returns the memory used by meshes and textures, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.meshes.iter().map(|mesh| mesh.bytes()).sum::<usize>()
            + self.textures.iter().map(Texture::bytes).sum::<usize>()
    }
}

impl Material {
    /// Returns the transparency of this material for a shading that samples only the textures in `read`. The material's
    /// opacity and the alpha channel of each of these textures imply a transparency. The strongest one wins: blended
    /// before alpha-tested before opaque. [`Material::transparency`] replaces it where alpha may be below 1.
    pub(crate) fn transparency(&self, library: &Library, read: impl IntoIterator<Item = TextureId>) -> Transparency {
        match (self.transparency, self.implied_transparency(library, read)) {
            (Some(Transparency::AlphaTested), _) if self.alpha_cutoff > 1.0 => Transparency::AlphaTested,
            (Some(fixed), Transparency::AlphaTested | Transparency::Blended) => fixed,
            (_, implied) => implied,
        }
    }

    fn implied_transparency(&self, library: &Library, read: impl IntoIterator<Item = TextureId>) -> Transparency {
        if self.opacity < 1.0 {
            return Transparency::Blended;
        }
        let of_texture = |id| match library.texture(id).alpha() {
            Alpha::Opaque => Transparency::Opaque,
            Alpha::AllOrNothing => Transparency::AlphaTested,
            Alpha::Graded => Transparency::Blended,
        };
        read.into_iter().map(of_texture).max().unwrap_or_default()
    }
}
