//! Masks of the pixels of a frame whose history was rejected, rectified or protected by a lock, and their agreement with
//! the exact disocclusion.

use rayon::prelude::*;
use serde::Serialize;

use super::steps::{FrameSteps, PixelStep};
use crate::chain::{Frame, Recipe};
use crate::image::Image;
use crate::pipeline::settings::{Choice, choice};
use crate::upscale::FrameInputs;

choice! {
    /// Set of pixels whose history an upscaler rejected, changed or protected.
    pub HistoryMask {
        Rejected = "rejected-history", "Rejected history", "Pixels whose history was rejected, so that only samples of this frame remain.";
        Rectified = "clamped-history", "Clamped history", "Pixels whose history was changed to agree with the samples around them.";
        Locked = "locked-history", "Locked history", "Pixels whose history a lock protects from clamping, because they show a thin feature.";
    }
}

/// Bit of [`HistoryMasks`] for disoccluded pixels; those below are the masks.
const STALE: u8 = 1 << HistoryMask::ALL.len();

/// Masks of a frame at full resolution.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryMasks {
    bits: Image<u8>,
}

/// Agreement of a mask with the exact disocclusion: the pixels whose surface the previous frame does not show.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MaskScore {
    /// Mask that is compared with the disocclusion.
    pub mask: HistoryMask,
    /// Number of pixels in the mask.
    pub marked: u32,
    /// Number of pixels that are disoccluded.
    pub disoccluded: u32,
    /// Number of pixels in the mask that are disoccluded.
    pub both: u32,
}

impl MaskScore {
    /// Returns the fraction of the mask that is disoccluded, in [0, 1]; `None` for an empty mask.
    pub fn precision(&self) -> Option<f64> {
        fraction(self.both, self.marked)
    }

    /// Returns the fraction of the disoccluded pixels that is in the mask, in [0, 1]; `None` without disocclusion.
    pub fn recall(&self) -> Option<f64> {
        fraction(self.both, self.disoccluded)
    }
}

fn fraction(part: u32, whole: u32) -> Option<f64> {
    (whole > 0).then(|| f64::from(part) / f64::from(whole))
}

fn bit(mask: HistoryMask) -> u8 {
    1 << mask as u8
}

impl HistoryMasks {
    /// Computes the masks of a frame. Returns `None` if its upscaler reads no history, or if the frame has none.
    pub fn of(recipe: &Recipe, frame: &Frame) -> Option<Self> {
        frame.history.as_ref()?;
        let (size, drawn) = (frame.image().size(), frame.as_drawn(&frame.drawn.color));
        let inputs = drawn.frame?;
        let steps = FrameSteps::new(recipe.upscaler, &drawn, size, None);
        let mut bits = Image::filled(size.0, size.1, 0);
        bits.pixels_mut().par_chunks_mut(size.0 as usize).zip(0..size.1).for_each(|(row, y)| {
            for (x, bits) in (0..).zip(row) {
                *bits = stale_bits(&inputs, (x, y)) | steps.at((x, y)).map_or(0, |found| mask_bits(&found));
            }
        });
        Some(Self { bits })
    }

    /// Whether a pixel is in a mask.
    pub fn contains(&self, mask: HistoryMask, (x, y): (u32, u32)) -> bool {
        self.bits.at(x, y) & bit(mask) != 0
    }

    /// Whether the previous frame does not show the surface of a pixel: it was hidden, outside the picture or behind the eye.
    pub fn is_disoccluded(&self, (x, y): (u32, u32)) -> bool {
        self.bits.at(x, y) & STALE != 0
    }

    /// Returns the agreement of a mask with the exact disocclusion.
    pub fn score(&self, mask: HistoryMask) -> MaskScore {
        let count = |wanted: u8| self.bits.pixels().iter().filter(|bits| **bits & wanted == wanted).count() as u32;
        MaskScore { mask, marked: count(bit(mask)), disoccluded: count(STALE), both: count(bit(mask) | STALE) }
    }

    /// Returns the agreement of all masks, in the order of [`HistoryMask::ALL`].
    pub fn scores(&self) -> Vec<MaskScore> {
        HistoryMask::ALL.iter().map(|mask| self.score(*mask)).collect()
    }
}

/// Returns [`STALE`] if the previous frame does not show the surface of a pixel.
fn stale_bits(inputs: &FrameInputs<'_>, at: (u32, u32)) -> u8 {
    if inputs.reproject(at).is_err() { STALE } else { 0 }
}

fn mask_bits(found: &PixelStep) -> u8 {
    let outcomes = [
        (HistoryMask::Rejected, found.step.past.is_err()),
        (HistoryMask::Rectified, found.rectified().is_some()),
        (HistoryMask::Locked, found.is_locked()),
    ];
    outcomes.into_iter().filter(|(_, applies)| *applies).map(|(mask, _)| bit(mask)).sum()
}
