//! Files: the recently opened ones, the folder of exported ones, and the commands that read and write files.

use std::path::{Path, PathBuf};

use super::compare::files::PictureRole;
use super::features::Feature;
use super::save_as::SaveItem;
use super::session::{Preferences, Session};
use super::window_task::WindowTask;
use crate::inspect::lesson::BlackPixelLesson;
use crate::inspect::outline::OutlineKind;
use crate::scene::MemoryLimit;
use crate::scene::obj::TrMeaning;

/// Maximum number of recent files.
pub(crate) const MAX_RECENT: usize = 8;

/// Recently opened files, and where and how files are read and written.
#[derive(Debug)]
pub(crate) struct Files {
    /// Recently opened files, newest first.
    pub(crate) recent: Vec<PathBuf>,
    /// Folder for exported pictures and cases: the working directory at startup.
    pub(crate) folder: PathBuf,
    /// Maximum memory for the meshes and textures of a model.
    pub(crate) memory_limit: MemoryLimit,
}

impl Default for Files {
    fn default() -> Self {
        Self {
            recent: Vec::new(),
            folder: std::env::current_dir().unwrap_or_default(),
            memory_limit: MemoryLimit::default(),
        }
    }
}

/// Command that reads or writes files, or copies to the clipboard.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum FileCommand {
    /// Opens a model, case or picture file.
    Open(PathBuf),
    /// Opens a picture file in a comparison.
    OpenPicture(PictureRole, PathBuf),
    /// Reloads a model with another interpretation of `Tr` in its MTL files.
    Reopen(PathBuf, TrMeaning),
    /// Opens a built-in scene by id.
    OpenBuiltin(String),
    /// Opens the scene of a lesson with its settings, and picks its black spot.
    OpenLesson(&'static BlackPixelLesson),
    /// Cancels loading a model or case.
    CancelLoading,
    /// Cancels all running exports.
    CancelExport,
    /// Asks for a path, and saves this item there.
    SaveAs(SaveItem),
    /// Saves an item at this path, and replaces an existing file.
    SaveTo(SaveItem, PathBuf),
    /// Opens the folder of a saved file with the desktop's file manager.
    OpenFolder(PathBuf),
    /// Opens a web address in the browser.
    OpenAddress(String),
    /// Saves the triangle visible at the picked pixel as a minimal case.
    SaveCase,
    /// Saves the picture on the canvas as PNG.
    SavePicture,
    /// Saves the compared pictures and their errors as an HTML page.
    SaveComparison,
    /// Saves the exact values on the canvas as floats (PFM).
    SaveData,
    /// Saves the scene as a vector drawing, in the format with this file name extension.
    SaveOutline(OutlineKind, &'static str),
    /// Copies the picture to the clipboard.
    CopyPicture,
}

impl Files {
    /// Adds a path to the recently opened files.
    pub(crate) fn remember(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.recent.retain(|known| *known != path);
        self.recent.insert(0, path);
        self.recent.truncate(MAX_RECENT);
    }
}

impl Feature for Files {
    type Change = FileCommand;

    fn apply(_: &mut Session, change: FileCommand) -> Option<WindowTask> {
        Some(WindowTask::File(change))
    }

    fn leave_scene(&mut self) {}

    fn store(&self, preferences: &mut Preferences) {
        preferences.recent.clone_from(&self.recent);
    }

    fn restore(&mut self, preferences: &Preferences) {
        self.recent.clone_from(&preferences.recent);
    }
}
