//! `upscale`: an enlarged picture of codes, by the upscalers that frames are enlarged with.

use serde::{Deserialize, Serialize};

use super::texture::codes;
use super::{Check, Real, Refusal, check_picture, json};
use crate::image::Image;
use crate::upscale::{self, Upscaler};

/// The case.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Upscale {
    /// Codes, row by row from the top.
    #[serde(deserialize_with = "json::rows")]
    pub image: Image<Real>,
    /// Enlargement per axis.
    pub scale: u32,
    /// How samples are weighted.
    pub kernel: String,
    /// `corner` if output pixel scale · k is sample k, `center` if the pictures have their middle in common.
    pub phase: String,
}

/// Kernels in cases, and the method of this program that has it. All of them work in the corner phase.
const METHOD_OF_KERNEL: [(&str, &str); 3] =
    [("nearest_floor", "nearest"), ("bilinear", "bilinear"), ("lagrange", "bicubic")];

impl Check for Upscale {}

impl Upscale {
    pub(super) fn answer(&self) -> Result<UpscaleAnswer, Refusal> {
        let upscaler = self.method()?;
        let drawn = codes(&self.image)?;
        let [width, height] = [drawn.width(), drawn.height()].map(|side| side.saturating_mul(self.scale));
        check_picture(width, height).map_err(Refusal)?;
        let full = upscaler.upscale(&drawn, self.scale, width, height);
        let codes_of_row = |y: u32| full.row(y).iter().map(|pixel| pixel[0]).collect();
        Ok(UpscaleAnswer { quantized: true, values: (0..height).map(codes_of_row).collect() })
    }

    fn method(&self) -> Result<&'static dyn Upscaler, Refusal> {
        let Self { kernel, phase, scale, .. } = self;
        let id = METHOD_OF_KERNEL.iter().find(|(known, _)| known == kernel).map(|(_, id)| *id);
        let upscaler = upscale::ALL.iter().find(|upscaler| Some(upscaler.id()) == id);
        let upscaler = upscaler.ok_or_else(|| Refusal(format!("no upscaler has the kernel `{kernel}`")))?;
        if phase != "corner" {
            return Err(Refusal(format!("no upscaler works in the phase `{phase}`, all of them in `corner`")));
        }
        if !upscaler.scales().contains(scale) {
            let scales: Vec<_> = upscaler.scales().iter().map(u32::to_string).collect();
            let scales = scales.join(" and ");
            return Err(Refusal(format!(
                "the upscaler `{}` does not enlarge by {scale}, only by {scales}",
                upscaler.id()
            )));
        }
        Ok(*upscaler)
    }
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UpscaleAnswer {
    /// That values are rounded to codes.
    pub quantized: bool,
    /// Codes, row by row.
    pub values: Vec<Vec<u8>>,
}
