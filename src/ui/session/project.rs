//! Project files: the state of the window as a [`Project`], and restoring it.

use super::file_command::FileCommand;
use super::place::OpenedProject;
use super::workspace::Workspace;
use super::{Session, Severity};
use crate::inspect::project::Project;
use crate::pipeline::settings::Choice as _;
use crate::scene::SceneSource;
use crate::scene::obj::TrMeaning;

impl Session {
    /// Returns the state of the window as a project.
    pub(crate) fn project(&self) -> Project {
        let tr = match &self.source {
            SceneSource::File(_, tr) => *tr,
            SceneSource::Builtin(_) => TrMeaning::Auto,
        };
        let mut project = Project::new(self.place(), tr, self.viewport());
        let sequences = &self.features.sequences;
        project.comparison = self.features.comparison.stored(&self.state.tiles, self.state.recipe, sequences);
        project.workspace = Some(self.workspace().id().to_owned());
        project.probe = Some(self.features.probing.probe);
        project.camera_path = self.features.camera_path.stored();
        project
    }

    /// Prepares the session for a project, which [`Session::show_scene`] restores once its scene is loaded. Returns the
    /// source of the scene.
    pub(crate) fn open_project(&mut self, opened: OpenedProject) -> SceneSource {
        let source = opened.project.source();
        self.features.places.pending = Some(opened.project.state());
        self.features.places.project = Some(opened);
        source
    }

    /// Completes a project whose scene and inspection state are restored.
    pub(crate) fn finish_project(&mut self, opened: &OpenedProject) {
        self.close_case();
        self.features.places.after_project = self.restore_tools(&opened.project);
        self.features.files.remember(&opened.path);
    }

    /// Restores workspace, comparison, probe and camera path of a project. Returns the commands that open its picture files.
    pub(crate) fn restore_tools(&mut self, project: &Project) -> Vec<FileCommand> {
        if let Some(id) = &project.workspace {
            match Workspace::ALL.iter().find(|workspace| workspace.id() == id) {
                Some(workspace) => self.show_workspace(*workspace),
                None => self.report(Severity::Warning, format!("The project names an unknown workspace: {id}")),
            }
        }
        if let Some(probe) = project.probe {
            self.features.probing.probe = probe;
        }
        if let Some(path) = &project.camera_path {
            self.features.camera_path.restore(path);
        }
        let Some(comparison) = &project.comparison else { return Vec::new() };
        self.features.sequences.restore(comparison);
        let files = self.features.comparison.restore(comparison, &mut self.state.tiles, self.state.recipe);
        files.into_iter().map(|(role, path)| FileCommand::OpenPicture(role, path)).collect()
    }
}
