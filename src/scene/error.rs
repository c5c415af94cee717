//! What can be wrong with a file, by cause, always with its path and, for text, the line.

use std::fmt;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Why a scene or a view could not be loaded.
#[derive(Debug, Error)]
pub enum SceneError {
    /// The file cannot be read.
    #[error("{}: cannot read it: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is something else than what it should be.
    #[error("{}: {reason}", path.display())]
    Unusable {
        /// The file.
        path: PathBuf,
        /// What it is instead, and what to do.
        reason: String,
    },
    /// The load was cancelled.
    #[error("{}: loading was cancelled", path.display())]
    Cancelled {
        /// The file.
        path: PathBuf,
    },
    /// A line cannot be understood, or must not be believed.
    #[error("{}:{line}: {reason}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// Counted from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
}

/// Something left out or repaired while loading; the rest is sound.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// The file it is about.
    pub path: PathBuf,
    /// Line in it, counted from 1, where there is one.
    pub line: Option<usize>,
    /// What was found and what was done about it.
    pub text: String,
}

impl Warning {
    /// About a whole file.
    pub fn file(path: &Path, text: impl Into<String>) -> Self {
        Self { path: path.to_owned(), line: None, text: text.into() }
    }

    /// About one line.
    pub fn line(path: &Path, line: usize, text: impl Into<String>) -> Self {
        Self { path: path.to_owned(), line: Some(line), text: text.into() }
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
