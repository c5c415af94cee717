//! Transform between the grid of the 2D lab and the screen.

use eframe::egui::{Pos2, vec2};
use glam::DVec2;

/// Radius of a draggable handle, in points.
pub(super) const HANDLE: f32 = 6.0;

/// Transform between positions on the grid and positions on the screen.
#[derive(Clone, Copy, Debug)]
pub(super) struct GridView {
    /// Scale of the grid, in points per pixel.
    pub(super) scale: f32,
    /// Screen position of the upper left corner of pixel (0, 0), in points.
    pub(super) origin: Pos2,
}

impl GridView {
    /// Maps a position from the grid, in pixels, to the screen, in points.
    pub(super) fn screen(self, place: DVec2) -> Pos2 {
        self.origin + vec2(place.x as f32, place.y as f32) * self.scale
    }

    /// Maps a position from the screen, in points, to the grid, in pixels.
    pub(super) fn place(self, at: Pos2) -> DVec2 {
        let place = (at - self.origin) / self.scale;
        DVec2::new(place.x.into(), place.y.into())
    }
}
