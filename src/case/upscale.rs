//! `upscale`: an enlarged picture of codes, by the upscalers that frames are enlarged with.

use serde::{Deserialize, Serialize};

use super::texture::codes;
use super::{Check, Real, Refusal, check_picture, json};
use crate::image::{Image, Rgba8};
use crate::upscale::{Anchor, Drawn, Scale, Upscaling};

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

/// Kernels in cases, and the method of this program that has it.
const METHOD_OF_KERNEL: [(&str, &str); 8] = [
    ("nearest_floor", "nearest"),
    ("nearest", "nearest"),
    ("bilinear", "bilinear"),
    ("lagrange", "bicubic"),
    ("catmull_rom", "catmull-rom"),
    ("mitchell", "mitchell"),
    ("lanczos2", "lanczos2"),
    ("lanczos3", "lanczos3"),
];

/// Phases in cases, and what this program calls them.
const ANCHOR_OF_PHASE: [(&str, Anchor); 2] = [("corner", Anchor::Corner), ("center", Anchor::Centre)];

impl Check for Upscale {}

impl Upscale {
    pub(super) fn answer(&self) -> Result<UpscaleAnswer, Refusal> {
        let how = self.choice()?;
        let drawn = codes(&self.image)?;
        let [width, height] = [drawn.width(), drawn.height()].map(|side| side.saturating_mul(self.scale));
        check_picture(width, height).map_err(Refusal)?;
        let full = how.upscale(&Drawn::from(&drawn), width, height);
        let codes = |y: u32| full.row(y).iter().map(|pixel| pixel[0]).collect();
        let values = |y: u32| (0..width).map(|x| weighted(how, &drawn, full.size(), (x, y))).collect();
        Ok(UpscaleAnswer {
            quantized: false,
            values: (0..height).map(values).collect(),
            codes: (0..height).map(codes).collect(),
        })
    }

    fn choice(&self) -> Result<Upscaling, Refusal> {
        let Self { kernel, phase, scale, .. } = self;
        let id = METHOD_OF_KERNEL.iter().find(|(known, _)| known == kernel).map(|(_, id)| *id);
        let how = id.and_then(|id| Upscaling::new(id, *scale));
        let how = how.ok_or_else(|| Refusal(format!("no upscaler has the kernel `{kernel}`")))?;
        let anchor = ANCHOR_OF_PHASE.iter().find(|(known, _)| known == phase).map(|(_, anchor)| *anchor);
        let anchor = anchor.ok_or_else(|| Refusal(format!("no upscaler works in the phase `{phase}`")))?;
        if how.scale().whole() != Some(*scale) {
            let scales: Vec<_> = how.upscaler().offers().scales.iter().map(Scale::to_string).collect();
            let scales = scales.join(", ");
            return Err(Refusal(format!(
                "the upscaler `{}` does not enlarge by {scale}, only by {scales}",
                how.method()
            )));
        }
        if kernel == "nearest_floor" && anchor != Anchor::Corner {
            return Err(Refusal("the sample before a place is copied in the phase `corner` only".to_owned()));
        }
        Ok(how.with_anchor(anchor))
    }
}

/// What a pixel is before it is rounded to a code, not clamped.
fn weighted(how: Upscaling, drawn: &Image<Rgba8>, size: (u32, u32), at: (u32, u32)) -> f64 {
    let grid = how.grid();
    let taps = how.upscaler().taps(how, &Drawn::from(drawn), size, at);
    let samples = taps.iter().filter_map(|tap| Some((tap.weight, grid.sample_at(tap.x, tap.y)?)));
    samples.map(|(weight, (column, row))| f64::from(weight) * f64::from(drawn.at(column, row)[0])).sum()
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UpscaleAnswer {
    /// Whether `values` are rounded to codes.
    pub quantized: bool,
    /// Weighted sums of codes, row by row.
    pub values: Vec<Vec<f64>>,
    /// The codes that are drawn, row by row.
    pub codes: Vec<Vec<u8>>,
}
