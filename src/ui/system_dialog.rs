//! The system's file dialog, run in a background thread because it blocks until it is closed.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use eframe::egui::Ui;

/// If the system's file dialog ends without a file within this time, the program assumes that the system could not show
/// it. No user closes a dialog this fast.
const FASTEST_PERSON: Duration = Duration::from_millis(400);

/// Open file dialog of the system.
pub(crate) struct SystemDialog {
    answer: Receiver<Option<PathBuf>>,
    since: Instant,
}

/// Outcome of a file dialog.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// The user chose this path.
    Chosen(PathBuf),
    /// The user closed the dialog without choosing a file.
    Cancelled,
    /// The system could not show a dialog.
    Unavailable,
}

impl SystemDialog {
    /// Runs `dialog`, which blocks, in a background thread, and repaints the window when it ends.
    pub(crate) fn open(ui: &Ui, dialog: impl FnOnce() -> Option<PathBuf> + Send + 'static) -> Self {
        let (sender, answer) = channel();
        let context = ui.ctx().clone();
        std::thread::spawn(move || {
            // Sending fails if the window is already closed.
            drop(sender.send(dialog()));
            context.request_repaint();
        });
        Self { answer, since: Instant::now() }
    }

    /// Returns the outcome; `None` while the dialog is open.
    pub(crate) fn poll(&self) -> Option<Answer> {
        let chosen = self.answer.try_recv().ok()?;
        Some(match chosen {
            Some(path) => Answer::Chosen(path),
            None if self.since.elapsed() < FASTEST_PERSON => Answer::Unavailable,
            None => Answer::Cancelled,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(dialog: impl Fn() -> Option<PathBuf> + Clone + Send + 'static) -> Answer {
        let mut open = None;
        let context = eframe::egui::Context::default();
        context
            .run_ui(eframe::egui::RawInput::default(), |ui| open = Some(SystemDialog::open(ui, dialog.clone())))
            .textures_delta
            .clear();
        let open = open.unwrap();
        loop {
            if let Some(answer) = open.poll() {
                return answer;
            }
            std::thread::yield_now();
        }
    }

    #[test]
    fn a_dialog_that_ends_at_once_without_a_file_was_not_shown() {
        assert_eq!(answer(|| None), Answer::Unavailable);
        assert_eq!(answer(|| Some("a.png".into())), Answer::Chosen("a.png".into()));
        let slow = || {
            std::thread::sleep(2 * FASTEST_PERSON);
            None
        };
        assert_eq!(answer(slow), Answer::Cancelled);
    }
}
