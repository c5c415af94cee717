//! Renderer side of watched pixels: replays these pixels after every new frame to find their values.

use crate::inspect::watch::{WatchedPixel, watch};
use crate::ui::engine::{RenderedView, Request};

/// Watched pixels, and the view in which their values are found.
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

    /// Sets the view on screen, in which the values of the pixels are found.
    pub(crate) fn set_view(&mut self, view: &RenderedView) {
        self.is_due |= view.fresh && !self.pixels.is_empty();
        self.view = Some(view.clone());
    }

    /// Whether the values are out of date because the view or the list of pixels has changed.
    pub(crate) fn has_work(&self) -> bool {
        self.is_due && self.view.is_some()
    }

    /// Finds the values of all watched pixels and returns them; `None` before the first view.
    pub(crate) fn step(&mut self) -> Option<Vec<WatchedPixel>> {
        self.is_due = false;
        let RenderedView { request, frame, .. } = self.view.as_ref()?;
        let Request { scene, recipe, .. } = request;
        Some(watch(scene, recipe, frame, &self.pixels))
    }
}
