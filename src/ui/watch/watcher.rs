//! Renderer side of watched pixels: replays them in every new frame.

use crate::inspect::watch::{WatchedPixel, watch};
use crate::ui::engine::{RenderedView, Request};

/// Watched pixels, and the view in which they are replayed.
#[derive(Debug, Default)]
pub(crate) struct PixelWatcher {
    pixels: Vec<(u32, u32)>,
    view: Option<RenderedView>,
    is_due: bool,
}

impl PixelWatcher {
    /// Sets the watched pixels.
    pub(crate) fn set(&mut self, pixels: Vec<(u32, u32)>) {
        self.is_due = self.is_due || pixels != self.pixels;
        self.pixels = pixels;
    }

    /// Sets the view to replay, which is the one on screen.
    pub(crate) fn set_view(&mut self, view: &RenderedView) {
        self.is_due |= view.fresh && !self.pixels.is_empty();
        self.view = Some(view.clone());
    }

    /// Whether the pixels must be replayed: the view or the list of pixels is new.
    pub(crate) fn has_work(&self) -> bool {
        self.is_due && self.view.is_some()
    }

    /// Replays all watched pixels and returns their values; `None` before the first view.
    pub(crate) fn step(&mut self) -> Option<Vec<WatchedPixel>> {
        self.is_due = false;
        let RenderedView { request, frame, .. } = self.view.as_ref()?;
        let Request { scene, recipe, .. } = request;
        Some(watch(scene, recipe, frame, &self.pixels))
    }
}
