//! Watched pixels: a list of pixels, independent of the picked one, whose values in all buffers are updated after every
//! frame.

pub(crate) mod panel;

pub(crate) mod watcher;

use eframe::egui::{Align2, FontId, Painter, Stroke, StrokeKind, Vec2, vec2};

use super::session::{Preferences, Session, Severity};
use super::theme::{MARK_EDGE, Tokens, font_size};
use super::zoom::Placement;
use crate::inspect::watch::WatchedPixel;
use crate::ui::features::Feature;
use crate::ui::window_task::WindowTask;

/// Maximum number of watched pixels. After every frame, each watched pixel is replayed to find its values.
pub(crate) const MAX_PIXELS: usize = 24;

/// Watched pixels and their values.
#[derive(Clone, Debug, Default)]
pub(crate) struct WatchList {
    /// Column and row of each pixel, in the order in which they were added.
    pub(crate) pixels: Vec<(u32, u32)>,
    /// Values of the watched pixels in the newest frame.
    pub(crate) rows: Vec<WatchedPixel>,
    /// Values of the watched pixels before they last changed.
    pub(crate) before: Vec<WatchedPixel>,
}

/// Change to the list of watched pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WatchChange {
    /// Watches the picked pixel.
    AddPick,
    /// Watches the pixel at this column and row.
    Add(u32, u32),
    /// Stops watching the pixel at this column and row.
    Remove(u32, u32),
    /// Stops watching all pixels.
    Clear,
}

impl WatchList {
    /// Stores the values of a frame. Adding or removing a pixel does not count as a change of the other pixels.
    pub(crate) fn store_values(&mut self, rows: Vec<WatchedPixel>) {
        let differs =
            |known: &WatchedPixel| rows.iter().any(|row| (row.x, row.y) == (known.x, known.y) && row != known);
        if self.rows.iter().any(differs) {
            self.before = std::mem::take(&mut self.rows);
        }
        self.rows = rows;
    }

    /// Returns the values of a pixel before the last change, if it was watched then.
    fn before(&self, row: &WatchedPixel) -> Option<&WatchedPixel> {
        self.before.iter().find(|before| (before.x, before.y) == (row.x, row.y))
    }
}

impl Feature for WatchList {
    type Change = WatchChange;

    fn apply(session: &mut Session, change: WatchChange) -> Option<WindowTask> {
        let pixels = &mut session.features.watch.pixels;
        let pixel = match change {
            WatchChange::AddPick => session.pick,
            WatchChange::Add(x, y) => Some((x, y)),
            WatchChange::Remove(x, y) => {
                pixels.retain(|pixel| *pixel != (x, y));
                None
            }
            WatchChange::Clear => {
                pixels.clear();
                None
            }
        };
        let pixel = pixel.filter(|pixel| !pixels.contains(pixel))?;
        if pixels.len() == MAX_PIXELS {
            session.report(Severity::Error, format!("Cannot watch more than {MAX_PIXELS} pixels: remove one first"));
        } else {
            pixels.push(pixel);
        }
        None
    }

    fn leave_scene(&mut self) {}

    fn store(&self, preferences: &mut Preferences) {
        preferences.watched.clone_from(&self.pixels);
    }

    fn restore(&mut self, preferences: &Preferences) {
        self.pixels = preferences.watched.iter().take(MAX_PIXELS).copied().collect();
    }
}

/// Draws numbered frames around all watched pixels inside the picture.
pub(super) fn markers(
    painter: &Painter,
    placement: Placement,
    session: &Session,
    (width, height): (u32, u32),
    tokens: &Tokens,
) {
    /// Minimum side length of a frame, in points, so that it is visible around small pixels.
    const MIN_POINTS: f32 = 5.0;
    for (number, (x, y)) in session.features.watch.pixels.iter().copied().enumerate() {
        if x >= width || y >= height {
            continue;
        }
        let pixel = placement.rect_of(x, y);
        let frame = eframe::egui::Rect::from_center_size(pixel.center(), pixel.size().max(Vec2::splat(MIN_POINTS)));
        painter.rect_stroke(frame.expand(1.0), 0.0, Stroke::new(3.0, MARK_EDGE), StrokeKind::Outside);
        painter.rect_stroke(frame.expand(2.0), 0.0, Stroke::new(1.0, tokens.warning), StrokeKind::Outside);
        let text = (number + 1).to_string();
        let galley = painter.layout_no_wrap(text, FontId::monospace(font_size::SMALL), tokens.warning);
        let place = Align2::LEFT_BOTTOM.anchor_size(frame.right_top() + vec2(3.0, -1.0), galley.size());
        painter.rect_filled(place.expand(1.0), 2.0, MARK_EDGE);
        painter.galley(place.min, galley, tokens.warning);
    }
}

#[cfg(test)]
mod tests;
