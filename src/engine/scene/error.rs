//! Errors and warnings about scene and view files, with the path and, for text files, the line.

use std::fmt;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Reason why a scene or a view could not be loaded.
#[derive(Debug, Error)]
pub enum SceneError {
    /// The file is not readable.
    #[error("{}: cannot read it: {source}", path.display())]
    Unreadable {
        /// Path of the file.
        path: PathBuf,
        /// I/O error of the operating system.
        source: std::io::Error,
    },
    /// The file has the wrong format or unusable content.
    #[error("{}: {reason}", path.display())]
    Unusable {
        /// Path of the file.
        path: PathBuf,
        /// Description of the problem, with a remedy if there is one.
        reason: String,
    },
    /// The load was cancelled.
    #[error("{}: loading was cancelled", path.display())]
    Cancelled {
        /// Path of the file.
        path: PathBuf,
    },
    /// A line is malformed or has implausible values.
    #[error("{}:{line}: {reason}", path.display())]
    Line {
        /// Path of the file.
        path: PathBuf,
        /// Line number, counted from 1.
        line: usize,
        /// Description of the error in this line.
        reason: String,
    },
}

/// Warning about content that was skipped or repaired while loading. The rest of the file is valid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// File that the warning refers to.
    pub(crate) path: PathBuf,
    /// Line number, counted from 1; `None` if the warning concerns the whole file.
    pub(crate) line: Option<usize>,
    /// Description of the problem and of how it was handled.
    pub text: String,
}

impl Warning {
    /// Creates a warning about a whole file.
    pub fn file(path: &Path, text: impl Into<String>) -> Self {
        Self { path: path.to_owned(), line: None, text: text.into() }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}: {}", self.path.display(), self.text),
            None => write!(f, "{}: {}", self.path.display(), self.text),
        }
    }
}
