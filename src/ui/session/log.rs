//! Log of all messages. The last error also appears above the canvas.

use super::Session;
use crate::text;

/// Maximum number of lines in the log.
const LOG_LINES: usize = 500;

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

impl Session {
    /// Appends a message to the log. Errors also appear in the message line above the canvas.
    pub(crate) fn report(&mut self, level: Severity, text: impl Into<String>) {
        let text = text::one_line(&text.into());
        if level == Severity::Error {
            self.error = Some(text.clone());
        }
        if self.log.len() == LOG_LINES {
            self.log.pop_front();
        }
        self.log.push_back(LogLine { level, text });
    }
}
