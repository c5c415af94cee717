//! Temporal anti-aliasing (TAA) and temporal upsampling: jittered samples are blended with the history, which is
//! reprojected by motion vectors and rectified by the samples around the pixel.
//!
//! ```text
//! samples ─► 3 × 3 around the pixel ─┬─► present colour, confidence ──────────────┐
//!                                    └─► range or variance ─┐                     ├─► blend ─► picture, history
//! motion vector of the nearest surface around ──► history ──┴─► rectified history ┘
//! ```
//!
//! The vector is that of the nearest surface around the pixel, so that an anti-aliased edge moves with its object (Karis,
//! 2014). At ×1, the surfaces are those of 3 × 3 pixels. Above, they are those of the 2 × 2 samples around the pixel. All
//! colours are in YCoCg, where chroma and luminance are separate. The history stores Y, Co, Cg and the accumulated weight
//! of a pixel. A new sample has weight 1 / (n + 1), where n is the accumulated weight. In motion, n is limited to
//! [`MOVING_WEIGHT`], so that old samples decay exponentially. In a still view, every jitter position is drawn once,
//! nothing is rectified, and then the picture no longer changes.

mod rows;
#[cfg(test)]
mod tests;

use self::rows::{TaaFrame, catmull_rom};
use super::quads::Quad;
use super::row_parts::OutputRow;
use super::spares::Spares;
use super::{
    Accumulated, Anchor, FilterSpace, HistoryFilter, HistorySteps, HistoryTaps, Jitter, Offers, Reads, Sampling, Scale,
    Tap, UpscaleInputs, Upscaled, Upscaler, Upscaling, bands,
};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;

/// Temporal anti-aliasing.
pub(crate) static TAA: Taa = Taa;

/// [`Upscaler`] implementation of [`TAA`].
pub(crate) struct Taa;

/// Limit of the accumulated weight of the history in motion. A new sample inside a pixel then has a share of 1/10,
/// which Karis (2014) recommends.
const MOVING_WEIGHT: f32 = 9.0;

/// Returns the jitter: 16 positions without upscaling, otherwise eight for each pixel of the area of a sample.
fn jitter_of(scale: Scale) -> Jitter {
    Jitter::low_discrepancy(if scale == Scale::ONE { 16 } else { Jitter::eight_per_pixel(scale) })
}

impl Upscaler for Taa {
    fn id(&self) -> &'static str {
        "taa"
    }

    fn name(&self) -> &'static str {
        "TAA"
    }

    fn help(&self) -> &'static str {
        "Jitters the samples and blends them with the history, which motion vectors reproject and the 3×3 samples around \
         the pixel rectify. Edges and fine detail become smooth in motion, also on moving objects. Thin objects fade \
         while they move, because the samples around them reject their history; the picture softens slightly. Temporal \
         anti-aliasing after B. Karis, “High Quality Temporal Supersampling”, 2014; above ×1 as temporal upsampling."
    }

    fn artefacts(&self) -> &'static str {
        "thin objects fade while they move, the picture softens slightly"
    }

    fn offers(&self) -> Offers {
        Offers {
            scales: &[Scale::ONE, Scale::ONE_AND_A_HALF, Scale::TWO],
            anchors: &[Anchor::Centre],
            lights: &[FilterSpace::Linear, FilterSpace::Bytes],
            deringing: false,
            sharpening: false,
            history: true,
        }
    }

    fn default_scale(&self) -> Scale {
        Scale::ONE
    }

    fn reads(&self) -> Reads {
        Reads { gbuffer: true, history: true }
    }

    fn jitter(&self, how: Upscaling) -> Option<Jitter> {
        Some(jitter_of(how.scale()))
    }

    fn sampling(&self, how: Upscaling) -> Sampling {
        Sampling::Lattice(how.lattice())
    }

    fn upscale(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>) {
        self.upscale_with_history(how, drawn, full, None);
    }

    fn upscale_with_history(
        &self,
        how: Upscaling,
        drawn: &UpscaleInputs<'_>,
        full: &mut Image<Rgba8>,
        memory: Option<Accumulated>,
    ) -> Upscaled {
        let mut memory = Accumulated::reusing(memory, full.size());
        fill(Lanes::best(), how, drawn, full, &mut memory.color);
        Upscaled { history: Some(memory), ..Upscaled::default() }
    }

    fn pixel(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Rgba8 {
        let frame = TaaFrame::new(how, drawn, size);
        frame.pixel(at, &mut frame.scratch()).codes
    }

    /// Returns the samples of this frame only; history contributes no taps.
    fn taps(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Vec<Tap> {
        TaaFrame::new(how, drawn, size).taps(at)
    }

    fn history_steps<'a>(&'a self, how: Upscaling, drawn: &'a UpscaleInputs<'a>) -> HistorySteps<'a> {
        let frame = drawn.frame.map(|seen| TaaFrame::new(how, drawn, seen.size));
        let spare = Spares::default();
        Box::new(move |at| {
            let frame = frame.as_ref()?;
            Some(spare.with(|| frame.scratch(), |scratch| frame.pixel(at, scratch).step))
        })
    }

    fn history_taps(&self, how: Upscaling, t: f32) -> HistoryTaps {
        match how.history().filter {
            HistoryFilter::Bilinear => HistoryTaps::Linear(t),
            HistoryFilter::CatmullRom => {
                let weights = catmull_rom(f32x16::splat(baseline(), t));
                HistoryTaps::Four(weights.map(|weights| weights.to_array()[0]))
            }
        }
    }
}

/// Computes the full image, and in `memory` the history for the next frame.
fn fill(lanes: Lanes, how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>, memory: &mut Image<Quad>) {
    let width = full.width() as usize;
    let frame = TaaFrame::new(how, drawn, full.size());
    bands::fill_both(full, memory, |first, full, memory| {
        let mut scratch = frame.scratch();
        for row in OutputRow::split_band(first, width, full, memory) {
            on_lanes!(lanes, simd => frame.row(simd, &mut scratch, row));
        }
    });
}
