//! Earlier frames of the picked pixel: how each contributes to it, and its colour in every frame.
//!
//! The frames are drawn again in the background, from frame 0 on, and do not depend on the frames that the window has
//! shown before.

pub(crate) mod searcher;

use std::sync::Arc;

use super::Session;
use super::feature::Feature;
use super::window_task::WindowTask;
use crate::chain::Recipe;
use crate::inspect::temporal::{ClipView, HistoryClip, PixelHistory};
use crate::measure::shot::Shot;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};

/// Number of frames up to which the history of a pixel is searched for. More would take minutes.
const MAX_FRAMES: u32 = 600;

/// Pixel whose history is searched for, and the frame that shows it.
#[derive(Clone, Debug)]
pub(crate) struct TemporalRequest {
    scene: Arc<Scene>,
    camera: Camera,
    recipe: Recipe,
    viewport: Viewport,
    pixel: (u32, u32),
    /// Frame of a scene or a camera in motion; `None` for a still view.
    moving: Option<MovingFrame>,
}

/// Frame of a scene or a camera in motion.
#[derive(Clone, Debug)]
struct MovingFrame {
    shot: Shot,
    number: u32,
}

impl MovingFrame {
    fn is_same(&self, other: &Self) -> bool {
        self.number == other.number && self.shot.is_same(&other.shot)
    }
}

impl TemporalRequest {
    /// Replaces the last request by a new one. Returns whether their results differ.
    pub(crate) fn replace(last: &mut Option<Self>, new: Option<&Self>) -> bool {
        let is_same = match (&*last, new) {
            (Some(last), Some(new)) => last.is_same(new),
            (last, new) => last.is_none() && new.is_none(),
        };
        if !is_same {
            *last = new.cloned();
        }
        !is_same
    }

    /// Whether both requests have the same result.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene)
            && self.camera == other.camera
            && self.recipe == other.recipe
            && self.viewport == other.viewport
            && self.pixel == other.pixel
            && match (&self.moving, &other.moving) {
                (Some(frame), Some(other)) => frame.is_same(other),
                (frame, other) => frame.is_none() && other.is_none(),
            }
    }

    /// Returns the frames that share the history of the pixel.
    fn clip(&self) -> HistoryClip {
        let (recipe, viewport, how) = (self.recipe, self.viewport, self.recipe.upscaler);
        let (view, last) = match &self.moving {
            Some(MovingFrame { shot, number }) => (ClipView::Moving(shot.clone()), *number),
            None => {
                let view = ClipView::Still { scene: Arc::clone(&self.scene), camera: self.camera };
                (view, how.upscaler().converges_after(how).saturating_sub(1))
            }
        };
        HistoryClip { view, recipe, viewport, last }
    }
}

/// History of the picked pixel.
#[derive(Debug, Default)]
pub(crate) struct TemporalView {
    /// Whether the section shows only its title, so that no history is searched for.
    pub(in crate::ui) is_hidden: bool,
    /// Whether the history is being searched for.
    pub(in crate::ui) is_searching: bool,
    /// Newest result; `None` if nothing is picked or if the search is not complete.
    pub(crate) history: Option<PixelHistory>,
}

impl TemporalView {
    /// Notes that a request was sent.
    pub(crate) fn expect(&mut self, request: Option<&TemporalRequest>) {
        (self.is_searching, self.history) = (request.is_some(), None);
    }

    /// Stores the result of the newest request.
    pub(crate) fn store_history(&mut self, history: PixelHistory) {
        (self.is_searching, self.history) = (false, Some(history));
    }
}

/// Change of the section “Earlier frames”.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TemporalChange {
    /// Shows the section if it is hidden, and hides it otherwise. A hidden section draws no frames.
    Toggle,
}

impl Feature for TemporalView {
    type Change = TemporalChange;

    fn apply(session: &mut Session, change: TemporalChange) -> Option<WindowTask> {
        match change {
            TemporalChange::Toggle => session.features.temporal.is_hidden ^= true,
        }
        None
    }

    fn leave_scene(&mut self) {
        *self = Self { is_hidden: self.is_hidden, ..Self::default() };
    }
}

impl Session {
    /// Whether the upscaler reads history, so that earlier frames contribute to pixels.
    pub(in crate::ui) fn has_earlier_frames(&self) -> bool {
        self.state.recipe.upscaler.upscaler().reads().history
    }

    /// Returns the request for the history of the picked pixel. Returns `None` without a pick or a method with history,
    /// while the scene plays, for frames after [`MAX_FRAMES`], and if the section is hidden.
    pub(in crate::ui) fn temporal_request(&self) -> Option<TemporalRequest> {
        let pixel = self.pick?;
        let (recipe, time) = (self.state.recipe, &self.features.scene_time);
        let is_paused = !time.is_playing && self.features.scrub.triangle_limit.is_none();
        if !is_paused || !self.has_earlier_frames() || self.features.temporal.is_hidden {
            return None;
        }
        let request = self.request();
        let moving = match (request.replayed_frame(), request.sequence) {
            (Some(number), Some(frame)) if number <= MAX_FRAMES => Some(MovingFrame { shot: frame.shot, number }),
            (Some(_), _) => return None,
            (None, _) => None,
        };
        let (scene, camera, viewport) = (Arc::clone(&self.scene), self.state.camera, self.viewport());
        Some(TemporalRequest { scene, camera, recipe, viewport, pixel, moving })
    }
}
