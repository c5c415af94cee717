//! Failures of commands: a message of one sentence, and an exit code.

use std::path::PathBuf;
use std::process::ExitCode;

use crate::case::CaseError;
use crate::chain::SetError;
use crate::drawing::file::DrawingFileError;
use crate::image::file::ImageFileError;
use crate::measure::part::PartError;
use crate::pipeline::viewport::Viewport;
use crate::scene::SceneError;
use crate::upscale::process::ProcessFailure;
use thiserror::Error;

/// Exit code for unusable input, unwritable output and failed upscaler processes.
const BAD_INPUT: u8 = 2;

/// Exit code if the requested window cannot be opened.
const NO_WINDOW: u8 = 3;

/// Exit code of an interrupted process.
pub(super) const INTERRUPTED: u8 = 130;

/// Exit code for violated assertions, unequal pictures, and errors beyond a bound.
const VIOLATED: u8 = 1;

/// Reason for the failure of a command.
#[derive(Debug, Error)]
pub(crate) enum Failure {
    /// The command line is invalid.
    #[error("{0}")]
    Usage(String),
    /// A model or a view cannot be loaded.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The scene is neither a built-in id nor a file.
    #[error("{}: no such file or built-in scene; the built-in scenes are {known}", name.display())]
    UnknownScene { name: PathBuf, known: String },
    /// The key or the value of `--set` is invalid.
    #[error("--set {0}")]
    Setting(#[from] SetError),
    /// `--at` is outside the picture.
    #[error(
        "--at {x},{y}: the scene's picture is {} × {} px, so columns are 0 to {} and rows 0 to {}",
        picture.width, picture.height, picture.width - 1, picture.height - 1
    )]
    OutsidePicture { x: u32, y: u32, picture: Viewport },
    /// `--fragment` exceeds the number of fragments.
    #[error("--fragment {number}: the pixel has fragments 1 to {there_are} only")]
    NoSuchFragment { number: u32, there_are: usize },
    /// A picture cannot be read or written.
    #[error(transparent)]
    Picture(#[from] ImageFileError),
    /// A drawing cannot be written.
    #[error(transparent)]
    Drawing(#[from] DrawingFileError),
    /// A case cannot be read.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// Parts of an experiment cannot be merged.
    #[error(transparent)]
    Part(#[from] PartError),
    /// A result file or report cannot be written.
    #[error("{}: cannot write it: {source}", path.display())]
    ResultFile { path: PathBuf, source: std::io::Error },
    /// Standard output cannot be written.
    #[error("standard output: {0}")]
    Output(std::io::Error),
    /// The requested threads cannot be created.
    #[error("--threads: {0}")]
    Threads(String),
    /// At least one assertion of `check` is violated.
    #[error("{violated} of {of} assertions are violated")]
    Violated { violated: usize, of: usize },
    /// Pictures that must be bit-identical differ.
    #[error("{differing} of {of} variants of tiled execution differ from classic execution")]
    Unequal { differing: usize, of: usize },
    /// The error of a picture is beyond a bound of `compare`.
    #[error("{0}")]
    OutOfBounds(String),
    /// An upscaler process failed; the results contain pictures of nearest neighbours in its place.
    #[error(transparent)]
    UpscalerProcess(ProcessFailure),
    /// A command was interrupted.
    #[error("interrupted: {0}")]
    Interrupted(&'static str),
    /// No window can be opened.
    #[error("{0}")]
    NoWindow(String),
}

impl Failure {
    /// Returns the exit code of the process.
    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::NoWindow(_) => NO_WINDOW,
            Self::Interrupted(_) => INTERRUPTED,
            Self::Violated { .. } | Self::Unequal { .. } | Self::OutOfBounds(_) => VIOLATED,
            _ => BAD_INPUT,
        })
    }
}
