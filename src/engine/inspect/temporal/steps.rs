//! Blending of the pixels of one frame with their history, including locks.

use std::borrow::Cow;

use super::filter::BlendColor;
use crate::chain::Frame;
use crate::image::{Image, Rgba8};
use crate::upscale::{History, HistoryStep, HistorySteps, PastColor, Reprojected, UpscaleInputs, Upscaling};

/// Locks of a frame: two numbers per pixel, the first of which is the remaining lifetime.
type Locks = Image<[f32; 2]>;

/// Blending of a pixel with its history, and its lock.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelStep {
    pub(super) step: HistoryStep,
    /// Remaining lifetime of the lock that protects the history from rectification, in (0, 1]; 0 without one.
    pub(super) lock_lifetime: f32,
}

impl PixelStep {
    /// Returns the history if rectification changed it.
    pub(super) fn rectified(&self) -> Option<&PastColor> {
        self.step.past.as_ref().ok().filter(|past| past.rectified != past.read)
    }

    /// Whether a lock protects the history from rectification.
    pub(super) fn is_locked(&self) -> bool {
        self.lock_lifetime > 0.0
    }
}

/// Access to the blending of all pixels of one frame.
pub(super) struct FrameSteps<'a> {
    size: (u32, u32),
    /// Whether camera and scene are unchanged since the previous frame.
    pub(super) is_still: bool,
    steps: HistorySteps<'a>,
    /// Locks of the previous frame and of this one; `None` if the upscaler has none.
    locks: Option<(&'a Locks, Cow<'a, Locks>)>,
}

impl<'a> FrameSteps<'a> {
    /// Prepares the steps of a frame with inputs `drawn`. `stored` is the history that the upscaler stored for the next
    /// frame, if it is known.
    pub(super) fn new(
        how: Upscaling,
        drawn: &'a UpscaleInputs<'a>,
        size: (u32, u32),
        stored: Option<&'a History>,
    ) -> Self {
        let before = drawn.frame.and_then(|frame| frame.history?.accumulated.as_ref()?.locks.as_ref());
        let after = || match stored {
            Some(stored) => stored.accumulated.as_ref()?.locks.as_ref().map(Cow::Borrowed),
            None => {
                let mut picture = Image::filled(size.0, size.1, [0; 4]);
                let upscaled = how.upscaler().upscale_with_history(how, drawn, &mut picture, None);
                upscaled.history?.locks.map(Cow::Owned)
            }
        };
        Self {
            size,
            is_still: drawn.frame.is_some_and(|frame| frame.motion.is_none()),
            steps: how.upscaler().history_steps(how, drawn),
            locks: before.and_then(|before| Some((before, after()?))),
        }
    }

    /// Returns how a pixel is blended with its history; `None` if the upscaler reads no history for it.
    pub(super) fn at(&self, at: (u32, u32)) -> Option<PixelStep> {
        let step = (self.steps)(at)?;
        let lock_lifetime = step.past.as_ref().map_or(0.0, |past| self.lock_lifetime(at, past));
        Some(PixelStep { step, lock_lifetime })
    }

    /// Returns the lifetime of the lock that the history has at a position. The lock counts only if it still exists after
    /// this frame. A still view needs none, because nothing is rectified.
    fn lock_lifetime(&self, at: (u32, u32), past: &PastColor) -> f32 {
        let Some((before, after)) = self.locks.as_ref().filter(|_| !self.is_still) else { return 0.0 };
        if after.at(at.0, at.1)[0] <= 0.0 {
            return 0.0;
        }
        let place = Reprojected { place: past.position_px, is_still: false };
        place.read(self.size, |x, y| before.at(x, y))[0]
    }
}

/// Returns the numbers of sRGB codes, without alpha.
fn numbers([r, g, b, _]: Rgba8) -> BlendColor {
    [r, g, b].map(f32::from)
}

impl History {
    /// Returns the colour of a pixel that the next frame reads, in the space in which the upscaler blends.
    pub(super) fn color(&self, (x, y): (u32, u32)) -> BlendColor {
        match (&self.accumulated, &self.picture) {
            (Some(accumulated), _) => {
                let [a, b, c, _] = accumulated.color.at(x, y);
                [a, b, c]
            }
            (None, Some(picture)) => numbers(picture.at(x, y)),
            (None, None) => [0.0; 3],
        }
    }

    /// Returns a filtered colour as the next frame uses it: a history of sRGB codes is rounded to codes.
    pub(super) fn rounded(&self, color: BlendColor) -> BlendColor {
        if self.accumulated.is_some() { color } else { color.map(|code| f32::from((code + 0.5) as u8)) }
    }
}

impl Frame {
    /// Returns the colour of a pixel before the post filter, as sRGB codes.
    pub(super) fn blended_codes(&self, (x, y): (u32, u32)) -> BlendColor {
        numbers(self.unfiltered().at(x, y))
    }
}
