//! Messages: a list of all, and the bar for what did not work.

use super::Session;
use crate::text;

/// Lines kept in the log.
const LOG_LINES: usize = 500;

/// One line of the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogLine {
    /// How grave.
    pub level: Level,
    /// What happened.
    pub text: String,
}

/// How grave a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Good to know.
    Info,
    /// Something was left out or repaired.
    Warning,
    /// Something did not work.
    Error,
}

impl Session {
    /// Writes a line into the log; errors also into the bar above the canvas.
    pub fn report(&mut self, level: Level, text: impl Into<String>) {
        let text = text::one_line(&text.into());
        if level == Level::Error {
            self.error = Some(text.clone());
        }
        if self.log.len() == LOG_LINES {
            self.log.pop_front();
        }
        self.log.push_back(LogLine { level, text });
    }
}
