//! `texture`: samples a texture of 8-bit codes with the renderer's sampler.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::{Check, Control, Point, Real, Refusal, Unanswered, json};
use crate::image::{Image, Rgba8};
use crate::pipeline::sample::Sampler;
use crate::pipeline::settings::{AddressMode, ColorSpace, TexelFilter};

/// Input of a `texture` case: a texture and the coordinates to sample.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Texture {
    /// Texels as 8-bit codes, row by row from the top.
    #[serde(deserialize_with = "json::rows")]
    pub(crate) texels: Image<Real>,
    /// Filter for coordinates between texel centres.
    pub(crate) filter: TextureFilter,
    /// Address mode for coordinates outside [0, 1].
    pub(crate) address: TextureAddress,
    /// Texture coordinates to sample, with v pointing down.
    pub(crate) uv: Vec<Point>,
}

/// Filter for coordinates between texel centres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum TextureFilter {
    /// Value of the nearest texel.
    Point,
    /// Weighted mean of the four surrounding texels.
    Bilinear,
}

/// Address mode for coordinates outside [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum TextureAddress {
    /// Clamps coordinates to the border texels.
    Clamp,
    /// Repeats the texture.
    Wrap,
}

impl Check for Texture {}

impl Texture {
    pub(super) fn answer(&self, control: &Control<'_>) -> Result<TextureAnswer, Unanswered> {
        let texture = codes(&self.texels)?;
        let filter = match self.filter {
            TextureFilter::Point => TexelFilter::Point,
            TextureFilter::Bilinear => TexelFilter::Bilinear,
        };
        let address = match self.address {
            TextureAddress::Clamp => AddressMode::Clamp,
            TextureAddress::Wrap => AddressMode::Repeat,
        };
        let sampler = Sampler::new(filter, address, ColorSpace::Bytes);
        let read = |uv: DVec2| f64::from(sampler.sample(&texture, uv.as_vec2()).x) * f64::from(u8::MAX);
        let values = self.uv.iter().map(|uv| Some(read(uv.0)));
        Ok(TextureAnswer { values: control.collect("values", (0, self.uv.len() as u64), values)? })
    }
}

/// Converts values to a grey image. Refuses values other than whole numbers from 0 to 255, because the image has 8 bits
/// per channel.
pub(super) fn codes(values: &Image<Real>) -> Result<Image<Rgba8>, Refusal> {
    let is_code = |value: &&Real| (0.0..=255.0).contains(&value.0) && value.0.fract() == 0.0;
    match values.pixels().iter().find(|value| !is_code(value)) {
        Some(value) => {
            Err(Refusal(format!("{} is not an 8-bit code; values must be whole numbers from 0 to 255", value.0)))
        }
        None => Ok(values.map(|value| [value.0 as u8; 4])),
    }
}

/// Answer to a [`Texture`] case: the sampled values.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TextureAnswer {
    /// Sampled values, one per texture coordinate, in units of 8-bit codes from 0 to 255, not rounded.
    pub values: Vec<f64>,
}
