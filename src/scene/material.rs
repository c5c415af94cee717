//! Surface properties.

use glam::Vec3;

use super::TextureId;

/// What a surface looks like, as far as this pipeline shades it.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name in the file, or a given one.
    pub name: String,
    /// Colour (`Kd`), multiplied with the texture; sRGB values in [0, 1].
    pub diffuse: Vec3,
    /// 1 is opaque (`d`, or 1 − `Tr`).
    pub opacity: f32,
    /// Colour texture (`map_Kd`).
    pub texture: Option<TextureId>,
    /// Texture for the side away from the light, read by cel shading only.
    pub dark_texture: Option<TextureId>,
}

impl Material {
    /// An opaque, untextured material. `diffuse` in sRGB values.
    pub fn plain(name: impl Into<String>, diffuse: Vec3) -> Self {
        Self { name: name.into(), diffuse, opacity: 1.0, texture: None, dark_texture: None }
    }

    /// An opaque white material under a texture.
    pub fn textured(name: impl Into<String>, texture: TextureId) -> Self {
        Self { texture: Some(texture), ..Self::plain(name, Vec3::ONE) }
    }
}

impl Default for Material {
    fn default() -> Self {
        Self::plain("default", Vec3::splat(0.8))
    }
}
