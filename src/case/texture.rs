//! `texture`: what a texture of codes reads as, by the sampler that draws.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::{Check, Control, Point, Real, Refusal, Unanswered, json};
use crate::image::{Image, Rgba8};
use crate::pipeline::sample::Sampler;
use crate::pipeline::settings::{Address, ColorSpace, Filter};

/// The case.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Texture {
    /// Codes, row by row from the top.
    #[serde(deserialize_with = "json::rows")]
    pub texels: Image<Real>,
    /// How it is read between texel centres.
    pub filter: TextureFilter,
    /// What lies outside of [0, 1].
    pub address: TextureAddress,
    /// Texture coordinates, v down.
    pub uv: Vec<Point>,
}

/// How a texture is read between texel centres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TextureFilter {
    /// The nearest texel.
    Point,
    /// The four texels around.
    Bilinear,
}

/// What lies outside of [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TextureAddress {
    /// The border texel.
    Clamp,
    /// The texture again.
    Wrap,
}

impl Check for Texture {}

impl Texture {
    pub(super) fn answer(&self, control: &Control<'_>) -> Result<TextureAnswer, Unanswered> {
        let texture = codes(&self.texels)?;
        let filter = match self.filter {
            TextureFilter::Point => Filter::Point,
            TextureFilter::Bilinear => Filter::Bilinear,
        };
        let address = match self.address {
            TextureAddress::Clamp => Address::Clamp,
            TextureAddress::Wrap => Address::Repeat,
        };
        let sampler = Sampler::new(filter, address, ColorSpace::Bytes);
        let read = |uv: DVec2| f64::from(sampler.sample(&texture, uv.as_vec2()).x) * f64::from(u8::MAX);
        let values = self.uv.iter().map(|uv| Some(read(uv.0)));
        Ok(TextureAnswer { values: control.collect("values", (0, self.uv.len() as u64), values)? })
    }
}

/// A grey picture of codes, which must be whole numbers from 0 to 255: pictures in this program hold no others.
pub(super) fn codes(values: &Image<Real>) -> Result<Image<Rgba8>, Refusal> {
    let is_code = |value: &&Real| (0.0..=255.0).contains(&value.0) && value.0.fract() == 0.0;
    match values.pixels().iter().find(|value| !is_code(value)) {
        Some(value) => Err(Refusal(format!("{} is no 8-bit code, and pictures here hold nothing else", value.0))),
        None => Ok(values.map(|value| [value.0 as u8; 4])),
    }
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TextureAnswer {
    /// What was read, in codes but not rounded, one for each texture coordinate.
    pub values: Vec<f64>,
}
