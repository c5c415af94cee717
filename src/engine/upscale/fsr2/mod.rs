//! FidelityFX Super Resolution 2 (FSR 2): temporal upscaling with a Lanczos kernel, a history that is rectified by the
//! colours around the pixel, and locks that protect thin features from rectification.
//!
//! ```text
//! samples ─► 3 × 3 around the pixel ─┬─► Lanczos 2 ─► present colour, weight ────────────┐
//!                                    ├─► box of colours ────────┐                        ├─► blend ─► RCAS ─► picture
//!                                    └─► thin feature ─► locks ─┤                        │     └─► history, locks
//! motion vector of the nearest surface around ──► history ──────┴─► rectified history ───┘
//! ```
//!
//! The steps follow AMD's documentation of the technique (“FidelityFX Super Resolution 2.2”, 2023; T. Arcila and C.
//! Riley, GDC 2022). The constants are those of the published version 2.2. Differences:
//!
//! - Disocclusion and still views are known exactly. FSR 2 estimates them from depths and from a luminance history.
//! - The history stores the accumulated weight of each pixel, in units of the Lanczos kernel. FSR 2.2 assumes the maximum.
//!   In motion, the weight is limited to that of ten average frames, not to ten times that of the frame: a sample far
//!   from the pixel then has little influence.
//! - A lock compares the median luminance of the 3 × 3 samples with that of its creation. FSR 2 compares luminance at a
//!   thirty-second of the resolution, for which a single pixel would depend on a large part of the picture.
//! - The reactive mask is derived from the materials of the visible surfaces, for which the G-buffer treats alpha-tested
//!   and transparent surfaces as opaque. FSR 2 reads it from the application.
//! - There is no exposure, because colours are in [0, 1].

mod frame;
mod kernel;
mod locks;
mod reactive;
mod rows;
mod surroundings;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use self::frame::Fsr2Frame;
use self::kernel::history_weights;
use super::row_parts::OutputRow;
use super::spares::Spares;
use super::{
    Accumulated, Anchor, FilterSpace, HistorySteps, HistoryTaps, Jitter, Offers, Reads, Sampling, Scale, Tap,
    UpscaleInputs, Upscaled, Upscaler, Upscaling, bands, fsr,
};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;

/// FSR 2-class temporal upscaling.
pub(crate) static FSR2: Fsr2 = Fsr2;

/// [`Upscaler`] implementation of [`FSR2`].
pub(crate) struct Fsr2;

/// Returns the jitter: points of Halton's sequence, eight for each pixel of the area of a sample.
fn jitter_of(scale: Scale) -> Jitter {
    Jitter::halton(Jitter::eight_per_pixel(scale))
}

impl Upscaler for Fsr2 {
    fn id(&self) -> &'static str {
        "fsr2"
    }

    fn name(&self) -> &'static str {
        "FSR 2"
    }

    fn help(&self) -> &'static str {
        "Jitters the samples and blends them, filtered by a Lanczos kernel, with the history, which motion vectors \
         reproject and a box of the 3×3 samples rectifies. Locks protect thin features from rectification. Still views \
         regain fine detail; in motion, edges stay smooth and thin lines whole, but transparency and moving light lag. \
         Optional sharpening. Source: AMD FidelityFX Super Resolution 2.2 (2023)."
    }

    fn artefacts(&self) -> &'static str {
        "transparency and moving light lag, locked thin lines may leave a trace"
    }

    fn offers(&self) -> Offers {
        Offers {
            scales: &[Scale::ONE_AND_A_HALF, Scale::TWO, Scale::THREE],
            anchors: &[Anchor::Centre],
            lights: &[FilterSpace::Linear, FilterSpace::Bytes],
            deringing: false,
            sharpening: true,
            history: false,
        }
    }

    fn reads(&self) -> Reads {
        Reads { gbuffer: true, history: true }
    }

    fn reads_reactive_mask(&self) -> bool {
        true
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
        let mut memory = Accumulated::with_locks_reusing(memory, full.size());
        fill(Lanes::best(), how, drawn, full, &mut memory);
        fsr::sharpen(how, full);
        Upscaled { history: Some(memory), ..Upscaled::default() }
    }

    fn pixel(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Rgba8 {
        let frame = Fsr2Frame::new(how, drawn, size);
        fsr::sharpened_pixel(how, size, at, |at| frame.pixel(at, &mut frame.scratch()).codes)
    }

    /// Returns the samples of this frame only; history contributes no taps.
    fn taps(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Vec<Tap> {
        let frame = Fsr2Frame::new(how, drawn, size);
        let mut sums: BTreeMap<(u32, u32), f32> = BTreeMap::new();
        for (at, share) in fsr::sharpening_shares(how, size, at, |at| frame.pixel(at, &mut frame.scratch()).codes) {
            for ((x, y), weight) in frame.sample_weights(at) {
                *sums.entry((y, x)).or_default() += share * weight;
            }
        }
        sums.into_iter().map(|((y, x), weight)| Tap { x, y, weight }).collect()
    }

    /// Returns the blending before sharpening.
    fn history_steps<'a>(&'a self, how: Upscaling, drawn: &'a UpscaleInputs<'a>) -> HistorySteps<'a> {
        let frame = drawn.frame.map(|seen| Fsr2Frame::new(how, drawn, seen.size));
        let spare = Spares::default();
        Box::new(move |at| {
            let frame = frame.as_ref()?;
            Some(spare.with(|| frame.scratch(), |scratch| frame.pixel(at, scratch).step))
        })
    }

    fn history_taps(&self, _how: Upscaling, t: f32) -> HistoryTaps {
        let weights = history_weights(f32x16::splat(baseline(), t));
        HistoryTaps::FourClamped(weights.map(|weights| weights.to_array()[0]))
    }
}

/// Computes the full image without sharpening, and in `memory` the history for the next frame.
fn fill(
    lanes: Lanes,
    how: Upscaling,
    drawn: &UpscaleInputs<'_>,
    full: &mut Image<Rgba8>,
    Accumulated { color, locks }: &mut Accumulated,
) {
    let size = full.size();
    let width = size.0 as usize;
    let locks = locks.get_or_insert_with(|| Image::filled(size.0, size.1, [0.0; 2]));
    let frame = Fsr2Frame::new(how, drawn, size);
    bands::fill_three(full, color, locks, |first, full, color, locks| {
        let mut scratch = frame.scratch();
        let rows = OutputRow::split_band(first, width, full, color).zip(locks.chunks_exact_mut(width));
        for (row, locks) in rows {
            on_lanes!(lanes, simd => frame.row(simd, &mut scratch, row, locks));
        }
    });
}
