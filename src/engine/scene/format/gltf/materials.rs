//! Materials: base colour, alpha modes, normal maps and emission, with the placement of their textures.
//!
//! Factors in the file are linear; colours of a [`Material`] are sRGB values, so they are encoded here. Texels are sRGB
//! codes in both.

use std::collections::HashMap;
use std::path::Path;

use glam::{Mat2, Vec2, Vec3};
use gltf_json::extensions::texture::TextureTransform;
use gltf_json::material::{AlphaMode, NormalTexture};
use gltf_json::texture::{Info, MagFilter, WrappingMode};
use gltf_json::{Index, Root, texture};

use super::buffers::Buffers;
use super::document::transform_of_normals;
use super::textures::{TextureUse, Textures};
use super::{Remarks, name_or, valid};
use crate::image::color::encode;
use crate::scene::load::Load;
use crate::scene::{Library, Material, MaterialId, Transparency};
use crate::text;

/// Placement of the textures of a material: the set of texture coordinates, and their transform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placement {
    /// Number of the set, as in `TEXCOORD_0`.
    pub(super) set: u32,
    scale: Vec2,
    /// Rotation in radians, counter-clockwise with v down.
    rotation: f32,
    offset: Vec2,
}

impl Placement {
    /// Returns the placement of a texture in the set `set`, unless its transform selects another one.
    fn new(set: u32, transform: Option<&TextureTransform>) -> Self {
        let unplaced = Self { set, scale: Vec2::ONE, rotation: 0.0, offset: Vec2::ZERO };
        transform.map_or(unplaced, |transform| Self {
            set: transform.tex_coord.unwrap_or(set),
            scale: transform.scale.0.into(),
            rotation: transform.rotation.0,
            offset: transform.offset.0.into(),
        })
    }

    fn of(info: &Info) -> Self {
        let transform = info.extensions.as_ref().and_then(|extensions| extensions.texture_transform.as_ref());
        Self::new(info.tex_coord, transform)
    }

    fn of_normals(info: &NormalTexture) -> Self {
        Self::new(info.tex_coord, transform_of_normals(info).and_then(Result::ok).as_ref())
    }

    /// Returns the texture coordinates after scaling, rotating and moving them.
    pub(super) fn apply(&self, uv: Vec2) -> Vec2 {
        if self.rotation == 0.0 {
            return self.scale * uv + self.offset;
        }
        let (sin, cos) = (libm::sinf(self.rotation), libm::cosf(self.rotation));
        Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos)) * (self.scale * uv) + self.offset
    }
}

/// Materials of a file, each created at its first use.
pub(super) struct Materials<'a> {
    root: &'a Root,
    textures: Textures<'a>,
    /// Identifier of each material by its index; the default material has the index `None`.
    known: HashMap<Option<usize>, MaterialId>,
}

/// Returns the placement of the textures of a material: that of its base colour texture, or else of the first other
/// one. Returns `None` if the material has no texture that is rendered.
pub(super) fn placement(root: &Root, material: Option<usize>) -> Option<Placement> {
    let material = root.materials.get(material?)?;
    let base = material.pbr_metallic_roughness.base_color_texture.as_ref();
    base.map(Placement::of)
        .or(material.normal_texture.as_ref().map(Placement::of_normals))
        .or(material.emissive_texture.as_ref().map(Placement::of))
}

impl<'a> Materials<'a> {
    /// Creates an empty collection for the file at `path`.
    pub(super) fn new(path: &'a Path, root: &'a Root, buffers: &'a Buffers<'a>) -> Self {
        Self { root, textures: Textures::new(path, root, buffers), known: HashMap::new() }
    }

    /// Returns the identifier of a material, creating it at its first use. `None` is the default material.
    pub(super) fn id(
        &mut self,
        index: Option<usize>,
        library: &mut Library,
        load: &mut Load<'_>,
        remarks: &mut Remarks<'_>,
    ) -> MaterialId {
        if let Some(id) = self.known.get(&index) {
            return *id;
        }
        let material = index.and_then(|index| self.material(index, library, load, remarks));
        let id = library.add_material(material.unwrap_or_else(|| Material::plain("default", Vec3::ONE)));
        self.known.insert(index, id);
        id
    }

    /// Returns a material of the file; `None` if there is none with this index.
    fn material(
        &mut self,
        index: usize,
        library: &mut Library,
        load: &mut Load<'_>,
        remarks: &mut Remarks<'_>,
    ) -> Option<Material> {
        let described = self.root.materials.get(index)?;
        let surface = &described.pbr_metallic_roughness;
        let [red, green, blue, opacity] = surface.base_color_factor.0;
        let mode = valid(described.alpha_mode).unwrap_or(AlphaMode::Opaque);
        let base = surface.base_color_texture.as_ref();
        let emissive = described.emissive_texture.as_ref();
        let normals = described.normal_texture.as_ref();
        let mut read = |index: Index<texture::Texture>, keeps_alpha, remarks: &mut Remarks<'_>| {
            self.textures.get(TextureUse { index, keeps_alpha }, library, load, remarks)
        };
        let texture = base.and_then(|base| read(base.index, mode != AlphaMode::Opaque, remarks));
        let emission_texture = emissive.and_then(|emissive| read(emissive.index, false, remarks));
        let normal_texture = normals.and_then(|normals| read(normals.index, false, remarks));
        remark_unrendered(described, remarks);
        let first = placement(self.root, Some(index));
        let name = name_or(described.name.as_ref(), "material", index);
        let kept = if base.is_some() { "base colour" } else { "normal map" };
        let others = [("normal map", normals.map(Placement::of_normals)), ("emission", emissive.map(Placement::of))];
        for (other, placement) in others {
            if placement.is_some() && placement != first {
                let name = text::one_line(&name);
                remarks.warn(format!(
                    "material {name}: the texture coordinates of its {other} differ from those of its {kept}, which are used"
                ));
            }
        }
        let used = [base.map(|base| base.index), emissive.map(|info| info.index), normals.map(|info| info.index)];
        let clamp = used.into_iter().flatten().map(|texture| self.clamps(texture, remarks)).next().unwrap_or(false);

        let plain = Material::plain(name, srgb([red, green, blue]));
        let missing = base.filter(|_| texture.is_none()).map(|base| format!("texture {}", base.index.value()));
        let shown = Material {
            texture,
            missing_texture: missing,
            emission: srgb(described.emissive_factor.0),
            emission_texture,
            normal_texture,
            normal_scale: normals.map_or(1.0, |normals| normals.scale),
            clamp,
            double_sided: described.double_sided,
            ..plain
        };
        Some(match mode {
            AlphaMode::Opaque => shown,
            AlphaMode::Blend => {
                let opacity = opacity.clamp(0.0, 1.0);
                Material { opacity, transparency: Some(Transparency::Blended), ..shown }
            }
            AlphaMode::Mask => {
                // opacity · alpha < cutoff is tested as alpha < cutoff / opacity.
                let cutoff = described.alpha_cutoff.unwrap_or_default().0;
                let alpha_cutoff = if cutoff <= 0.0 { 0.0 } else { cutoff / opacity.clamp(0.0, 1.0) };
                Material { alpha_cutoff, transparency: Some(Transparency::AlphaTested), ..shown }
            }
        })
    }

    /// Returns whether a texture clamps its coordinates in both directions. Other ways of addressing are settings.
    fn clamps(&self, index: Index<texture::Texture>, remarks: &mut Remarks<'_>) -> bool {
        let sampler = self.root.get(index).and_then(|texture| self.root.get(texture.sampler?));
        let Some(sampler) = sampler else { return false };
        if sampler.mag_filter.and_then(valid) == Some(MagFilter::Nearest) {
            remarks.note("nearest filtering of textures is not taken from the file; use the setting filter=point");
        }
        let ways = [valid(sampler.wrap_s), valid(sampler.wrap_t)].map(|way| way.unwrap_or(WrappingMode::Repeat));
        match ways {
            [WrappingMode::ClampToEdge, WrappingMode::ClampToEdge] => true,
            [WrappingMode::Repeat, WrappingMode::Repeat] => false,
            _ => {
                remarks.warn("textures that are mirrored, or clamped in one direction only, repeat instead");
                false
            }
        }
    }
}

/// Warns about properties of a material that are not rendered.
fn remark_unrendered(described: &gltf_json::Material, remarks: &mut Remarks<'_>) {
    let surface = &described.pbr_metallic_roughness;
    if described.occlusion_texture.is_some() {
        remarks.warn("occlusion maps are not rendered");
    }
    if surface.metallic_roughness_texture.is_some() || surface.metallic_factor.0 > 0.0 {
        remarks.note("metalness and roughness are not rendered: all surfaces are diffuse");
    }
}

/// Encodes a linear colour as sRGB values in [0, 1]. Channels outside of this range are clamped.
pub(super) fn srgb(linear: [f32; 3]) -> Vec3 {
    // The rounded formula misses 1 by one unit in the last place; a white material must not change its texture.
    Vec3::from(linear.map(|channel| if channel < 1.0 { encode(channel.max(0.0)) } else { 1.0 }))
}
