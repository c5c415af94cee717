//! Progress display for long commands.

use std::io::{IsTerminal as _, Write as _, stderr};
use std::sync::atomic::{AtomicUsize, Ordering};

/// One line on standard error that shows the latest progress. It is written only to a terminal, and cleared when
/// dropped.
#[derive(Debug)]
pub(crate) struct ProgressLine {
    is_terminal: bool,
    /// Length of the visible text, in characters.
    shown: AtomicUsize,
}

impl ProgressLine {
    /// Creates an empty line.
    pub(crate) fn new() -> Self {
        Self { is_terminal: stderr().is_terminal(), shown: AtomicUsize::new(0) }
    }

    /// Replaces the text of the line.
    pub(crate) fn show(&self, text: &str) {
        if self.is_terminal {
            let before = self.shown.swap(text.chars().count(), Ordering::Relaxed);
            // A failed write is ignored, because the command works without progress output.
            let _ = write!(stderr(), "\r{text:before$}");
        }
    }

    /// Shows the completed fraction of `work` in percent. `share` is in [0, 1].
    pub(crate) fn show_share(&self, work: &str, share: f32) {
        self.show(&format!("{work}: {:3.0} %", share * 100.0));
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        if self.shown.load(Ordering::Relaxed) > 0 {
            self.show("");
            let _ = write!(stderr(), "\r");
        }
    }
}
