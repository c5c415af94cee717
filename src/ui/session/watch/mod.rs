//! Watched pixels: a list of pixels, independent of the picked one, whose values in all buffers are updated after every
//! frame.

pub(crate) mod watcher;

use super::preferences::MAX_WATCHED;
use super::{Preferences, Session, Severity};
use crate::inspect::watch::WatchedPixel;
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::WindowTask;

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
    pub(in crate::ui) fn before(&self, row: &WatchedPixel) -> Option<&WatchedPixel> {
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
        if pixels.len() == MAX_WATCHED {
            session.report(Severity::Error, format!("Cannot watch more than {MAX_WATCHED} pixels: remove one first"));
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
        self.pixels = preferences.watched.iter().take(MAX_WATCHED).copied().collect();
    }
}

#[cfg(test)]
mod tests;
