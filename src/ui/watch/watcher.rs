//! The renderer's part: replays the watched pixels of every new frame.

use crate::inspect::watch::{Watched, watch};
use crate::ui::engine::{Request, View};

/// Knows which pixels are watched, and the frame to look at.
#[derive(Debug, Default)]
pub struct Watcher {
    pixels: Vec<(u32, u32)>,
    view: Option<View>,
    is_due: bool,
}

impl Watcher {
    /// Watches these pixels from now on.
    pub fn set(&mut self, pixels: Vec<(u32, u32)>) {
        self.is_due = self.is_due || pixels != self.pixels;
        self.pixels = pixels;
    }

    /// Takes in what is on screen now.
    pub fn look_at(&mut self, view: &View) {
        self.is_due |= view.fresh && !self.pixels.is_empty();
        self.view = Some(view.clone());
    }

    /// Whether there is something to replay.
    pub fn has_work(&self) -> bool {
        self.is_due && self.view.is_some()
    }

    /// Replays all watched pixels.
    pub fn step(&mut self) -> Option<Vec<Watched>> {
        self.is_due = false;
        let View { request, frame, .. } = self.view.as_ref()?;
        let Request { scene, recipe, .. } = request;
        Some(watch(scene, recipe, frame, &self.pixels))
    }
}
