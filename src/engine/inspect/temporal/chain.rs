//! Chain of blending steps that leads from a pixel back to earlier frames.

use std::collections::BTreeMap;

use serde::Serialize;

use super::filter::{BlendColor, PastFilter};
use super::steps::{FrameSteps, PixelStep};
use crate::chain::Frame;
use crate::pipeline::settings::Choice as _;
use crate::upscale::{BlendSpace, History, PastColor, Rejection, Upscaling};

/// Share of the history at which following it ends.
const LEAST_REST: f64 = 1.0 / 512.0;

/// Share of the inspected pixel below which a pixel of an earlier frame is not followed. Far below one sRGB code.
const LEAST_WEIGHT: f64 = 1.0 / 16384.0;

/// Contribution of earlier frames to a pixel. Shares are those before rectification.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PastFrames {
    /// Space of the colours.
    pub space: BlendSpace,
    /// Colour of the pixel before sharpening, post filter and encoding: the sum of the samples, the changes and the rest.
    pub color: BlendColor,
    /// Frames from the inspected one backwards.
    pub frames: Vec<FrameShare>,
    /// Share of older frames, and of pixels whose share is too small to follow.
    pub rest: f64,
    /// Contribution of the rest to the colour.
    pub rest_color: [f64; 3],
    /// Whether recomputing every followed step gave the bits that the upscaler stored.
    pub is_reproduced: bool,
}

/// Contribution of one frame to a pixel of a later frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameShare {
    /// Number of the frame, counted from the start of the history.
    pub frame: u32,
    /// Share of the samples of this frame in the inspected pixel.
    pub share: f64,
    /// Contribution of the samples of this frame to the colour.
    pub samples: [f64; 3],
    /// Change of the colour by this frame's rectification of the history, and by limits and rounding of the filter.
    pub rectification: [f64; 3],
    /// Mean position of the contributing pixels of this frame, in pixels.
    pub position_px: [f64; 2],
    /// Number of contributing pixels of this frame.
    pub pixels: u32,
    /// Share of history that this frame rectified.
    pub rectified: f64,
    /// Share of history that locks protected from rectification in this frame.
    pub locked: f64,
    /// Shares of pixels of this frame whose history was rejected, so that only samples of this frame remain.
    pub rejected: Vec<RejectedShare>,
}

/// Share of a pixel whose history was rejected for one reason.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RejectedShare {
    /// Reason of the rejection.
    pub reason: Rejection,
    /// Share of the inspected pixel.
    pub share: f64,
}

impl FrameShare {
    fn new(frame: u32) -> Self {
        Self {
            frame,
            share: 0.0,
            samples: [0.0; 3],
            rectification: [0.0; 3],
            position_px: [0.0; 2],
            pixels: 0,
            rectified: 0.0,
            locked: 0.0,
            rejected: Vec::new(),
        }
    }

    fn add_samples(&mut self, share: f64, color: BlendColor) {
        self.share += share;
        add(&mut self.samples, share, color);
    }

    /// Notes what became of the history of a pixel that has this share of the inspected pixel.
    fn add_outcome(&mut self, found: &PixelStep, share: f64) {
        let passed = share * (1.0 - f64::from(found.step.share));
        self.rectified += if found.rectified().is_some() { passed } else { 0.0 };
        self.locked += if found.is_locked() { passed } else { 0.0 };
        let Err(reason) = found.step.past else { return };
        match self.rejected.iter_mut().find(|rejected| rejected.reason == reason) {
            Some(rejected) => rejected.share += share,
            None => self.rejected.push(RejectedShare { reason, share }),
        }
    }

    /// Computes the mean position from pixels with their weights.
    fn set_position(&mut self, weights: &PixelWeights) {
        let total: f64 = weights.values().map(|weight| weight.abs()).sum();
        for (&(y, x), weight) in weights {
            let share = weight.abs() / total;
            self.position_px[0] += (f64::from(x) + 0.5) * share;
            self.position_px[1] += (f64::from(y) + 0.5) * share;
        }
        self.pixels = weights.len() as u32;
    }
}

/// Weights of pixels in the inspected pixel, by row and column.
type PixelWeights = BTreeMap<(u32, u32), f64>;

fn add(sum: &mut [f64; 3], weight: f64, color: BlendColor) {
    for (sum, number) in sum.iter_mut().zip(color) {
        *sum += weight * f64::from(number);
    }
}

/// Chain of steps from a pixel backwards, frame by frame.
#[derive(Debug)]
pub(super) struct Chain {
    how: Upscaling,
    /// Contributing pixels of the frame to be followed next.
    weights: PixelWeights,
    found: Option<PastFrames>,
}

impl Chain {
    pub(super) fn new(how: Upscaling, (x, y): (u32, u32)) -> Self {
        Self { how, weights: BTreeMap::from([((y, x), 1.0)]), found: None }
    }

    /// Whether no frame before the followed ones has a share worth following.
    pub(super) fn is_complete(&self) -> bool {
        self.weights.values().map(|weight| weight.abs()).sum::<f64>() < LEAST_REST
    }

    /// Follows the chain through frame `number`. Frames must be followed in descending order. `stored` is the history that
    /// the upscaler stored after this frame; it may be missing for the first followed frame.
    pub(super) fn follow(&mut self, number: u32, frame: &Frame, stored: Option<&History>) {
        let size = (frame.viewport.width, frame.viewport.height);
        let drawn = frame.as_drawn(&frame.drawn.color);
        let steps = FrameSteps::new(self.how, &drawn, size, stored);
        let weights = std::mem::take(&mut self.weights);
        let mut of_frame = FrameShare::new(number);
        of_frame.set_position(&weights);
        for ((y, x), weight) in weights {
            let at = (x, y);
            let Some(found) = steps.at(at) else {
                of_frame.add_samples(weight, frame.blended_codes(at));
                continue;
            };
            let is_reproduced = self.is_reproduced(&found, frame, stored, at);
            let past_frames = self.found.get_or_insert_with(|| PastFrames {
                space: found.step.space,
                color: found.step.blended(),
                frames: Vec::new(),
                rest: 0.0,
                rest_color: [0.0; 3],
                is_reproduced: true,
            });
            past_frames.is_reproduced &= is_reproduced;
            of_frame.add_samples(weight * f64::from(found.step.share), found.step.present);
            of_frame.add_outcome(&found, weight);
            if let (Ok(past), Some(history)) = (&found.step.past, frame.history.as_deref()) {
                let passed = weight * (1.0 - f64::from(found.step.share));
                let filter = PastFilter::new(self.how, past, size, steps.is_still);
                add(&mut of_frame.rectification, passed, past.rectified);
                for (tap @ (x, y), tap_weight) in filter.taps() {
                    add(&mut of_frame.rectification, -passed * tap_weight, history.color(tap));
                    *self.weights.entry((y, x)).or_default() += passed * tap_weight;
                }
                if let Some(past_frames) = &mut self.found {
                    past_frames.is_reproduced &= is_read(history, &filter, past);
                }
            }
        }
        if let Some(past_frames) = &mut self.found {
            past_frames.frames.push(of_frame);
        }
        self.drop_small(frame.history.as_deref());
    }

    /// Moves pixels with a small weight to the rest.
    fn drop_small(&mut self, history: Option<&History>) {
        let (Some(found), Some(history)) = (&mut self.found, history) else { return };
        self.weights.retain(|(y, x), weight| {
            let is_followed = weight.abs() >= LEAST_WEIGHT;
            if !is_followed {
                found.rest += *weight;
                add(&mut found.rest_color, *weight, history.color((*x, *y)));
            }
            is_followed
        });
    }

    /// Whether a step gives the bits of its pixel: those that the upscaler stored, or the codes of the picture.
    fn is_reproduced(&self, found: &PixelStep, frame: &Frame, stored: Option<&History>, at: (u32, u32)) -> bool {
        let codes = || found.step.codes().map(f32::from) == frame.blended_codes(at);
        match stored {
            Some(stored) if stored.accumulated.is_some() => found.step.blended() == stored.color(at),
            Some(_) => codes(),
            None => self.how.sharpening() > 0 || codes(),
        }
    }

    /// Ends the chain. `history` is the history that the last followed frame read. Returns `None` if the upscaler reads no
    /// history for the pixel.
    pub(super) fn finish(self, history: Option<&History>) -> Option<PastFrames> {
        let mut found = self.found?;
        for ((y, x), weight) in self.weights {
            found.rest += weight;
            add(&mut found.rest_color, weight, history.map_or([0.0; 3], |history| history.color((x, y))));
        }
        for frame in &mut found.frames {
            frame.rejected.sort_by(|a, b| b.share.total_cmp(&a.share).then_with(|| a.reason.id().cmp(b.reason.id())));
        }
        Some(found)
    }
}

/// Whether filtering the history again gives the bits that the upscaler read.
fn is_read(history: &History, filter: &PastFilter, past: &PastColor) -> bool {
    history.rounded(filter.read(|at| history.color(at))) == past.read
}
