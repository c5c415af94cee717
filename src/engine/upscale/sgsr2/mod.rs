//! Snapdragon Game Super Resolution 2 (SGSR 2), two-pass variant: temporal upscaling for mobile processors, with a
//! short Lanczos-like kernel, a bilinear history, and a depth clip instead of locks.
//!
//! ```text
//! convert, per sample:  distances of 4 × 4 samples ─┬─► nearest of 3 × 3: motion vector
//!                                                   └─► depth clip: share of depth edges
//! upscale, per pixel:   3 × 3 samples ─┬─► kernel ─► present colour, weight ───────────┐
//!                                      └─► box of colours ─► rectified history ────────┴─► blend ─► picture, history
//! ```
//!
//! Steps and constants follow the published shaders (Qualcomm, “Snapdragon Game Super Resolution 2”, 2024, folder
//! `sgsr/v2` of the repository `SnapdragonStudios/snapdragon-gsr`, two-pass variants). Differences:
//!
//! - Disocclusion and still views are known exactly. SGSR 2 relies on the depth clip, which weakens the history beside
//!   every depth edge.
//! - The history stores the accumulated weight of each pixel. SGSR 2 assumes the maximum, so that a disoccluded pixel
//!   accepts new samples slowly and a still view never stops changing.
//! - The depth clip compares distances along the view axis. In a perspective view with a distant far plane, the ratio of
//!   two distances equals the published ratio of depths. The field of view counts as 90°.
//! - The vector of a pixel is that of the sample nearest to it. SGSR 2 interpolates vectors, also across edges.
//! - The samples follow the low-discrepancy pattern of the other methods, not Halton's sequence.
//! - Weights of the box are interpolated between those of a still and a fast pixel, instead of their exponents.

mod convert;
mod frame;
mod kernel;
mod past;
#[cfg(test)]
mod tests;

use self::frame::{RowBuffers, Sgsr2Frame};
use super::quads::Quad;
use super::row_parts::OutputRow;
use super::spares::Spares;
use super::{
    Accumulated, Anchor, FilterSpace, HistorySteps, Jitter, Offers, Reads, Sampling, Scale, Tap, UpscaleInputs,
    Upscaled, Upscaler, Upscaling, bands,
};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;

/// SGSR 2-class temporal upscaling.
pub(crate) static SGSR2: Sgsr2 = Sgsr2;

/// [`Upscaler`] implementation of [`SGSR2`].
pub(crate) struct Sgsr2;

/// Returns the jitter: eight positions for each pixel of the area of a sample.
fn jitter_of(scale: Scale) -> Jitter {
    Jitter::low_discrepancy(Jitter::eight_per_pixel(scale))
}

impl Upscaler for Sgsr2 {
    fn id(&self) -> &'static str {
        "sgsr2"
    }

    fn name(&self) -> &'static str {
        "SGSR 2"
    }

    fn help(&self) -> &'static str {
        "Jitters the samples and blends them with the history, which motion vectors reproject and a box of the 3×3 \
         samples rectifies. Depth edges weaken the history. Still views regain fine detail; in motion the picture \
         softens, because the history is read bilinearly, thin objects fade, and the surroundings of moving edges \
         shimmer. Source: Qualcomm Snapdragon Game Super Resolution 2, two passes (2024)."
    }

    fn artefacts(&self) -> &'static str {
        "softens in motion, thin objects fade, surroundings of moving edges shimmer"
    }

    fn offers(&self) -> Offers {
        Offers {
            scales: &[Scale::ONE_AND_A_HALF, Scale::TWO, Scale::THREE],
            anchors: &[Anchor::Centre],
            lights: &[FilterSpace::Linear, FilterSpace::Bytes],
            deringing: false,
            sharpening: false,
            history: false,
        }
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
        let frame = Sgsr2Frame::new(how, drawn, size);
        frame.pixel(at, &mut frame.surface_rows()).codes
    }

    /// Returns the samples of this frame only; history contributes no taps.
    fn taps(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Vec<Tap> {
        Sgsr2Frame::new(how, drawn, size).taps(at)
    }

    fn history_steps<'a>(&'a self, how: Upscaling, drawn: &'a UpscaleInputs<'a>) -> HistorySteps<'a> {
        let frame = drawn.frame.map(|seen| Sgsr2Frame::new(how, drawn, seen.size));
        let spare = Spares::default();
        Box::new(move |at| {
            let frame = frame.as_ref()?;
            Some(spare.with(|| frame.surface_rows(), |surfaces| frame.pixel(at, surfaces).step))
        })
    }
}

/// Computes the full image, and in `memory` the history for the next frame.
fn fill(lanes: Lanes, how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>, memory: &mut Image<Quad>) {
    let width = full.width() as usize;
    let frame = Sgsr2Frame::new(how, drawn, full.size());
    bands::fill_both(full, memory, |first, full, memory| {
        let mut buffers = RowBuffers::new(&frame);
        for row in OutputRow::split_band(first, width, full, memory) {
            on_lanes!(lanes, simd => frame.row(simd, &mut buffers, row));
        }
    });
}
