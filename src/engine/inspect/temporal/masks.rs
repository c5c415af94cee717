//! Masks of the pixels of a frame whose history was rejected, rectified or protected by a lock, and their agreement with
//! the exact disocclusion.

use rayon::prelude::*;
use serde::Serialize;

use super::steps::{FrameSteps, PixelStep};
use crate::chain::{Frame, MotionBuffers, Recipe};
use crate::image::Image;
use crate::pipeline::motion::FrameView;
use crate::pipeline::settings::{Choice, choice};
use crate::scene::Scene;

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

impl MaskScore {
    /// Returns the agreement of the rejected pixels of a frame with the exact disocclusion, of at most `most` evenly spaced
    /// pixels. `is_disoccluded` returns whether the previous frame does not show the surface of a pixel. Returns `None` if the
    /// upscaler reads no history, or if the frame has none.
    pub fn of_rejection(
        recipe: &Recipe,
        frame: &Frame,
        is_disoccluded: impl Fn((u32, u32)) -> bool + Sync,
        most: u32,
    ) -> Option<Self> {
        frame.history.as_ref()?;
        let ((width, height), drawn) = (frame.image().size(), frame.as_drawn(&frame.drawn.color));
        let steps = recipe.upscaler.upscaler().history_steps(recipe.upscaler, &drawn);
        let spacing = spacing_px((width, height), most);
        let rows: Vec<u32> = (0..height).step_by(spacing).collect();
        let of_row = |y: &u32| {
            let bits = (0..width).step_by(spacing).map(|x| {
                let is_rejected = steps((x, *y)).is_some_and(|step| step.past.is_err());
                stale_bits(is_disoccluded((x, *y))) | if is_rejected { bit(HistoryMask::Rejected) } else { 0 }
            });
            Self::of_bits(HistoryMask::Rejected, bits)
        };
        rows.par_iter().map(of_row).reduce_with(Self::and)
    }

    /// Counts the pixels with these bits.
    fn of_bits(mask: HistoryMask, bits: impl Iterator<Item = u8>) -> Self {
        let mut score = Self { mask, marked: 0, disoccluded: 0, both: 0 };
        for bits in bits {
            let (is_marked, is_stale) = (bits & bit(mask) != 0, bits & STALE != 0);
            score.marked += u32::from(is_marked);
            score.disoccluded += u32::from(is_stale);
            score.both += u32::from(is_marked && is_stale);
        }
        score
    }

    /// Returns the agreement over the pixels of both scores.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            mask: self.mask,
            marked: self.marked.saturating_add(other.marked),
            disoccluded: self.disoccluded.saturating_add(other.disoccluded),
            both: self.both.saturating_add(other.both),
        }
    }
}

/// Returns the least distance of evenly spaced pixels of which a picture has at most `most`.
fn spacing_px((width, height): (u32, u32), most: u32) -> usize {
    (1..).find(|spacing| width.div_ceil(*spacing).saturating_mul(height.div_ceil(*spacing)) <= most.max(1)).unwrap_or(1)
        as usize
}

fn fraction(part: u32, whole: u32) -> Option<f64> {
    (whole > 0).then(|| f64::from(part) / f64::from(whole))
}

fn bit(mask: HistoryMask) -> u8 {
    1 << mask as u8
}

impl HistoryMasks {
    /// Computes the masks of a frame of `scene`. Returns `None` if its upscaler reads no history, or if the frame has none.
    pub fn of(scene: &Scene, recipe: &Recipe, frame: &Frame) -> Option<Self> {
        let past = frame.history.as_ref()?;
        let (size, drawn) = (frame.image().size(), frame.as_drawn(&frame.drawn.color));
        let now = FrameView { scene, camera: &frame.camera };
        let motion = MotionBuffers::between(now, past.view(), recipe, frame.viewport)?;
        let steps = FrameSteps::new(recipe.upscaler, &drawn, size, None);
        let mut bits = Image::filled(size.0, size.1, 0);
        bits.pixels_mut().par_chunks_mut(size.0 as usize).zip(0..size.1).for_each(|(row, y)| {
            for (x, bits) in (0..).zip(row) {
                *bits = stale_bits(motion.is_disoccluded(x, y)) | steps.at((x, y)).map_or(0, |found| mask_bits(&found));
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
        MaskScore::of_bits(mask, self.bits.pixels().iter().copied())
    }

    /// Returns the agreement of all masks, in the order of [`HistoryMask::ALL`].
    pub fn scores(&self) -> Vec<MaskScore> {
        HistoryMask::ALL.iter().map(|mask| self.score(*mask)).collect()
    }
}

/// Returns [`STALE`] for a disoccluded pixel.
fn stale_bits(is_disoccluded: bool) -> u8 {
    if is_disoccluded { STALE } else { 0 }
}

fn mask_bits(found: &PixelStep) -> u8 {
    let outcomes = [
        (HistoryMask::Rejected, found.step.past.is_err()),
        (HistoryMask::Rectified, found.rectified().is_some()),
        (HistoryMask::Locked, found.is_locked()),
    ];
    outcomes.into_iter().filter(|(_, applies)| *applies).map(|(mask, _)| bit(mask)).sum()
}
