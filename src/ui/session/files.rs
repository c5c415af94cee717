//! Files: the recently opened ones, and the folder of exported ones.

use std::path::{Path, PathBuf};

use super::feature::Feature;
use super::file_command::FileCommand;
use super::preferences::MAX_RECENT;
use super::window_task::WindowTask;
use super::{Preferences, Session};
use crate::scene::MemoryLimit;

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
