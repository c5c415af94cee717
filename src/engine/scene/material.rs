//! Materials: surface properties and transparency.

use glam::{Vec2, Vec3};
use serde::Serialize;

use super::ids::TextureId;

/// Transparency of a surface: opaque, alpha-tested or blended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transparency {
    /// The surface hides everything behind it.
    #[default]
    Opaque,
    /// The surface is alpha-tested: opaque where the texture's alpha passes the test, and not drawn elsewhere.
    AlphaTested,
    /// The surface is blended with the surfaces behind it.
    Blended,
}

/// Default of [`Material::alpha_cutoff`].
pub(crate) const ALPHA_TEST_THRESHOLD: f32 = 0.5;

/// Surface properties used for shading.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Display name of the material, from the file or assigned.
    pub name: String,
    /// Diffuse colour (`Kd`) as sRGB values in [0, 1], multiplied by the texture.
    pub diffuse: Vec3,
    /// Opacity (`d`, or 1 − `Tr`) from 0 (invisible) to 1 (opaque), multiplied by the alpha of the texture.
    pub opacity: f32,
    /// Colour texture (`map_Kd`).
    pub texture: Option<TextureId>,
    /// File name of a colour texture that could not be read. The diffuse colour is used instead of the texture.
    pub missing_texture: Option<String>,
    /// Texture of the unlit side, used only by cel shading.
    pub dark_texture: Option<TextureId>,
    /// Emitted colour (`Ke`) as sRGB values in [0, 1], added after lighting; black for none.
    pub emission: Vec3,
    /// Texture (`map_Ke`) that multiplies the emitted colour.
    pub emission_texture: Option<TextureId>,
    /// Specular colour (`Ks`) of Blinn–Phong shading, as sRGB values in [0, 1].
    pub specular: Vec3,
    /// Specular exponent (`Ns`) of Blinn–Phong shading, at least 0.
    pub shininess: f32,
    /// Texture (`map_d`) whose alpha channel multiplies the opacity.
    pub alpha_texture: Option<TextureId>,
    /// Tangent-space normal map (`norm`, `map_Bump`): x right, y up the picture (OpenGL), z out of the surface.
    pub normal_texture: Option<TextureId>,
    /// Scale factor for the x and y components of the normal map (`-bm`).
    pub normal_scale: f32,
    /// Scale factor for the texture coordinates (`-s`), applied per vertex, before the offset.
    pub uv_scale: Vec2,
    /// Offset of the texture coordinates (`-o`), with v pointing down.
    pub uv_offset: Vec2,
    /// Whether texture coordinates are clamped, regardless of the address mode in the settings.
    pub clamp: bool,
    /// Whether back faces are drawn like front faces, regardless of the culling in the settings.
    pub double_sided: bool,
    /// Transparency where an alpha below 1 may occur; `None` if the values of alpha determine it.
    pub transparency: Option<Transparency>,
    /// Threshold of the alpha test, at least 0: fragments with a lower filtered alpha are discarded. A threshold above 1
    /// discards all fragments.
    pub alpha_cutoff: f32,
}

impl Material {
    /// Creates an opaque, untextured material. `diffuse` is an sRGB colour.
    pub fn plain(name: impl Into<String>, diffuse: Vec3) -> Self {
        Self {
            name: name.into(),
            diffuse,
            opacity: 1.0,
            texture: None,
            missing_texture: None,
            dark_texture: None,
            emission: Vec3::ZERO,
            emission_texture: None,
            specular: Vec3::ZERO,
            shininess: 32.0,
            alpha_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            uv_scale: Vec2::ONE,
            uv_offset: Vec2::ZERO,
            clamp: false,
            double_sided: false,
            transparency: None,
            alpha_cutoff: ALPHA_TEST_THRESHOLD,
        }
    }

    /// Creates a white material with a texture and full opacity.
    pub(crate) fn textured(name: impl Into<String>, texture: TextureId) -> Self {
        Self { texture: Some(texture), ..Self::plain(name, Vec3::ONE) }
    }
}

impl Default for Material {
    fn default() -> Self {
        Self::plain("default", Vec3::splat(0.8))
    }
}
