//! How a command ends when it cannot do what it was asked for: one sentence and an exit code.

use std::path::PathBuf;
use std::process::ExitCode;

use super::interrupt::INTERRUPTED;
use rasterscope::case::CaseError;
use rasterscope::chain::SetError;
use rasterscope::drawing::file::DrawingFileError;
use rasterscope::image::file::ImageFileError;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::SceneError;
use thiserror::Error;

/// Exit code for input that cannot be used and output that cannot be written.
const BAD_INPUT: u8 = 2;

/// Exit code where a window was asked for and there can be none.
const NO_WINDOW: u8 = 3;

/// Exit code where what should hold does not.
const VIOLATED: u8 = 1;

/// Why a command gave up.
#[derive(Debug, Error)]
pub(crate) enum Failure {
    /// The command line itself is wrong.
    #[error("{0}")]
    Usage(String),
    /// A model or a view cannot be loaded.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Neither an id nor a file.
    #[error("{}: there is no such file, and no such built-in scene ({known})", name.display())]
    UnknownScene { name: PathBuf, known: String },
    /// A `--set` that changes nothing.
    #[error("--set {0}")]
    Setting(#[from] SetError),
    /// `--at` names no pixel.
    #[error(
        "--at {x},{y}: the scene's picture is {} × {} px, so columns are 0 to {} and rows 0 to {}",
        picture.width, picture.height, picture.width - 1, picture.height - 1
    )]
    OutsidePicture { x: u32, y: u32, picture: Viewport },
    /// `--fragment` names none that is there.
    #[error("--fragment {number}: {there_are} fragments touched the pixel")]
    NoSuchFragment { number: u32, there_are: usize },
    /// A picture cannot be written.
    #[error(transparent)]
    Picture(#[from] ImageFileError),
    /// A drawing cannot be written.
    #[error(transparent)]
    Drawing(#[from] DrawingFileError),
    /// A case cannot be read.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// A result or report cannot be written into its file.
    #[error("{}: cannot write it: {source}", path.display())]
    ResultFile { path: PathBuf, source: std::io::Error },
    /// Results cannot be written.
    #[error("standard output: {0}")]
    Output(std::io::Error),
    /// The threads asked for cannot be had.
    #[error("--threads: {0}")]
    Threads(String),
    /// What `check` was asked to check does not hold.
    #[error("{violated} of {of} assertions are violated")]
    Violated { violated: usize, of: usize },
    /// What should be the same bits is not.
    #[error("{differing} of {of} ways to draw it tile by tile differ from triangle after triangle")]
    Unequal { differing: usize, of: usize },
    /// A measurement was interrupted.
    #[error("interrupted: {0}")]
    Interrupted(&'static str),
    /// There can be no window.
    #[error("{0}")]
    NoWindow(String),
}

impl Failure {
    /// What the process ends with.
    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::NoWindow(_) => NO_WINDOW,
            Self::Interrupted(_) => INTERRUPTED,
            Self::Violated { .. } | Self::Unequal { .. } => VIOLATED,
            _ => BAD_INPUT,
        })
    }
}
