//! Log of all messages, and the bar for errors.

use super::Session;
use crate::text;

/// Maximum number of lines in the log.
const LOG_LINES: usize = 500;

/// Line of the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogLine {
    /// Severity.
    pub level: Severity,
    /// Message text, one line.
    pub text: String,
}

/// Severity of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// Information.
    Info,
    /// Warning: something was skipped or repaired.
    Warning,
    /// Error: an operation failed.
    Error,
}

impl Session {
    /// Appends a line to the log; errors also appear in the bar above the canvas.
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
