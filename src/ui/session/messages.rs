//! Messages for the user: errors, notices and offers in the message line, and the log.

use std::collections::VecDeque;
use std::path::PathBuf;

use super::Session;
use crate::text;
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::WindowTask;

/// Maximum number of lines in the log.
const LOG_LINES: usize = 500;

/// Messages for the user.
#[derive(Debug, Default)]
pub(crate) struct Messages {
    /// Error shown in the message line until it is closed.
    pub(crate) error: Option<String>,
    /// Picture file that was opened as a scene. The message line offers to open it in the 2D lab.
    pub(crate) offered_picture: Option<PathBuf>,
    /// Notice shown in the message line until it is closed.
    pub(crate) notice: Option<Notice>,
    /// All messages, up to the length limit of the log.
    pub(crate) log: VecDeque<LogLine>,
}

/// Outcome that the message line shows until it is closed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Notice {
    /// A file was saved.
    Saved(PathBuf),
    /// A model was opened with this number of warnings, which the log lists.
    Warnings(usize),
}

/// Message in the log, shown as one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct LogLine {
    /// Severity of the message.
    pub(crate) level: Severity,
    /// Text of the message, without line breaks.
    pub(crate) text: String,
}

/// Severity of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Severity {
    /// Information about a completed operation.
    Info,
    /// Warning: something was skipped or repaired.
    Warning,
    /// Error: an operation failed.
    Error,
}

/// Message that the user dismisses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dismissal {
    /// Offer to open a picture in the 2D lab.
    Offer,
    /// Notice about a saved file or warnings.
    Notice,
    /// Message of the last error.
    Error,
}

impl Feature for Messages {
    type Change = Dismissal;

    fn apply(session: &mut Session, change: Dismissal) -> Option<WindowTask> {
        let messages = &mut session.features.messages;
        match change {
            Dismissal::Offer => messages.offered_picture = None,
            Dismissal::Notice => messages.notice = None,
            Dismissal::Error => messages.error = None,
        }
        None
    }

    fn leave_scene(&mut self) {
        (self.offered_picture, self.notice, self.error) = (None, None, None);
    }
}

impl Session {
    /// Appends a message to the log. Errors also appear in the message line above the canvas.
    pub(crate) fn report(&mut self, level: Severity, text: impl Into<String>) {
        let text = text::one_line(&text.into());
        if level == Severity::Error {
            self.features.messages.error = Some(text.clone());
        }
        if self.features.messages.log.len() == LOG_LINES {
            self.features.messages.log.pop_front();
        }
        self.features.messages.log.push_back(LogLine { level, text });
    }
}
