//! Frames of a clip, drawn again to find the contribution of each to a pixel.

use std::ops::Range;
use std::sync::Arc;

use serde::Serialize;

use super::chain::{Chain, PastFrames};
use super::masks::{HistoryMasks, MaskScore};
use crate::chain::{Frame, KeepDepth, Recipe, RenderInputs, Renderer};
use crate::measure::shot::Shot;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};
use crate::upscale::History;

/// Memory for frames that are followed together, in bytes.
const MEMORY_BYTES: u64 = 512 << 20;

/// Memory of a frame with its history, in bytes per pixel; an upper bound for all upscalers.
const BYTES_PER_PIXEL: u64 = 64;

/// Views of the frames that share a history.
#[derive(Clone, Debug)]
pub enum ClipView {
    /// Every frame shows the same view.
    Still {
        /// Scene of every frame.
        scene: Arc<Scene>,
        /// Camera of every frame.
        camera: Camera,
    },
    /// Scene and camera move.
    Moving(Shot),
}

impl ClipView {
    /// Returns the scene and the camera of a frame.
    pub(super) fn at(&self, number: i64) -> (Arc<Scene>, Camera) {
        match self {
            Self::Still { scene, camera } => (Arc::clone(scene), *camera),
            Self::Moving(shot) => shot.view(number),
        }
    }
}

/// Frames from frame 0, which has no history, to an inspected one.
#[derive(Clone, Debug)]
pub struct HistoryClip {
    /// View of every frame.
    pub view: ClipView,
    /// Recipe of every frame.
    pub recipe: Recipe,
    /// Size of every frame, in pixels.
    pub viewport: Viewport,
    /// Number of the inspected frame.
    pub last: u32,
}

impl HistoryClip {
    /// Returns the number of frames that are kept in memory together, at least 2.
    fn frames_together(&self) -> u32 {
        let pixels = u64::from(self.viewport.width) * u64::from(self.viewport.height);
        u32::try_from(MEMORY_BYTES / (pixels * BYTES_PER_PIXEL).max(1)).unwrap_or(u32::MAX).max(2)
    }

    /// Draws a frame, after all frames before it.
    pub(super) fn draw(&self, renderer: &mut Renderer, number: u32) -> Frame {
        let (scene, camera) = self.view.at(number.into());
        renderer.render(
            RenderInputs { scene: &scene, camera: &camera, recipe: &self.recipe, viewport: self.viewport },
            KeepDepth::No,
        )
    }
}

/// Colours of one pixel in one frame, as sRGB codes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PixelFrame {
    /// Number of the frame.
    pub frame: u32,
    /// Colour from the samples of the frame alone.
    pub samples: [u8; 3],
    /// History after rectification; `None` if it was rejected or not read.
    pub history: Option<[u8; 3]>,
    /// Share of the samples in the pixel, in [0, 1].
    pub share: f32,
    /// Blended colour, before sharpening and post filter.
    pub result: [u8; 3],
}

/// Search for the contribution of every frame of a clip to one pixel. It draws one frame per step.
#[derive(Debug)]
pub struct TemporalSearch {
    clip: HistoryClip,
    pixel: (u32, u32),
    renderer: Renderer,
    /// Number of frames that are kept in memory together.
    frames_together: u32,
    /// Frames that are followed together, once all of them are drawn.
    range: Range<u32>,
    next: u32,
    kept: Vec<Frame>,
    /// History that the frame followed last reads; `None` before the inspected frame is followed.
    stored: Option<Arc<History>>,
    chain: Chain,
    pixel_frames: Vec<PixelFrame>,
    masks: Option<HistoryMasks>,
}

/// History of a pixel of a clip.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PixelHistory {
    /// Contribution of every frame; `None` if the upscaler reads no history for the pixel.
    pub past_frames: Option<PastFrames>,
    /// Colours of the pixel in every frame from frame 0 on.
    pub pixel_frames: Vec<PixelFrame>,
    /// Precision and recall of the masks of the inspected frame.
    pub masks: Vec<MaskScore>,
}

impl TemporalSearch {
    /// Prepares the search for a pixel of the inspected frame; draws nothing yet. Returns `None` if the upscaler reads no
    /// history, or if the pixel is outside the picture.
    pub fn new(clip: HistoryClip, pixel: (u32, u32)) -> Option<Self> {
        let is_inside = pixel.0 < clip.viewport.width && pixel.1 < clip.viewport.height;
        let how = clip.recipe.upscaler;
        if !is_inside || !how.upscaler().reads().history {
            return None;
        }
        let mut search = Self {
            frames_together: clip.frames_together(),
            range: clip.last + 1..clip.last + 1,
            chain: Chain::new(how, pixel),
            clip,
            pixel,
            renderer: Renderer::default(),
            next: 0,
            kept: Vec::new(),
            stored: None,
            pixel_frames: Vec::new(),
            masks: None,
        };
        search.go_back();
        Some(search)
    }

    /// Limits the number of frames that are kept in memory together. Must be called before the first step.
    #[cfg(test)]
    pub(super) fn limit_frames_together(&mut self, frames: u32) {
        self.frames_together = frames;
        self.range.start = self.range.end.saturating_sub(frames);
    }

    /// Starts to draw the frames before those followed so far, from frame 0 on.
    fn go_back(&mut self) {
        let end = self.range.start;
        self.range = end.saturating_sub(self.frames_together)..end;
        (self.renderer, self.next) = (Renderer::default(), 0);
    }

    /// Draws the next frame. Returns `false` once the search is complete.
    pub fn step(&mut self) -> bool {
        let frame = self.clip.draw(&mut self.renderer, self.next);
        if self.pixel_frames.len() == self.next as usize {
            self.pixel_frames.push(self.pixel_frame(&frame));
        }
        if self.range.contains(&self.next) {
            self.kept.push(frame);
        } else {
            self.renderer.recycle(frame);
        }
        self.next += 1;
        self.next < self.range.end || !self.follow()
    }

    /// Follows the chain through the kept frames. Returns whether the search is complete.
    fn follow(&mut self) -> bool {
        if let Some(inspected) = self.kept.last().filter(|_| self.stored.is_none()) {
            let (scene, _) = self.clip.view.at(self.clip.last.into());
            self.masks = HistoryMasks::of(&scene, &self.clip.recipe, inspected);
        }
        for (number, frame) in self.range.clone().zip(std::mem::take(&mut self.kept)).rev() {
            if self.chain.is_complete() {
                break;
            }
            self.chain.follow(number, &frame, self.stored.as_deref());
            self.stored = frame.history;
        }
        let is_complete = self.range.start == 0 || self.chain.is_complete();
        if !is_complete {
            self.go_back();
        }
        is_complete
    }

    /// Returns the result of a complete search.
    pub fn finish(self) -> PixelHistory {
        PixelHistory {
            past_frames: self.chain.finish(self.stored.as_deref()),
            pixel_frames: self.pixel_frames,
            masks: self.masks.map(|masks| masks.scores()).unwrap_or_default(),
        }
    }

    fn pixel_frame(&self, frame: &Frame) -> PixelFrame {
        let (how, (x, y)) = (self.clip.recipe.upscaler, self.pixel);
        let step = how.upscaler().history_steps(how, &frame.as_drawn(&frame.drawn.color))(self.pixel);
        let Some(step) = step else {
            let [r, g, b, _] = frame.unfiltered().at(x, y);
            return PixelFrame { frame: self.next, samples: [r, g, b], history: None, share: 1.0, result: [r, g, b] };
        };
        PixelFrame {
            frame: self.next,
            samples: step.encoded(step.present),
            history: step.past.as_ref().ok().map(|past| step.encoded(past.rectified)),
            share: step.share,
            result: step.codes(),
        }
    }
}
