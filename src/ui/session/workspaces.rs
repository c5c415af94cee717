//! Choice of the workspace that is shown.

use super::Session;
use super::feature::Feature;
use super::workspace::{Workspace, WorkspaceChange};
use crate::ui::session::compare::{CompareChange, Mode};
use crate::ui::session::lab::LabChange;
use crate::ui::session::window_task::WindowTask;

/// Workspace that the user has chosen.
#[derive(Debug)]
pub(crate) struct Workspaces {
    /// Workspace that is shown unless the 2D lab, a comparison or the mesh view is open.
    pub(in crate::ui) base: Workspace,
}

impl Default for Workspaces {
    fn default() -> Self {
        Self { base: Workspace::Inspect }
    }
}

impl Feature for Workspaces {
    type Change = WorkspaceChange;

    /// Leaves the change to the window, which owns the layouts.
    fn apply(_session: &mut Session, change: WorkspaceChange) -> Option<WindowTask> {
        Some(WindowTask::Workspace(change))
    }

    fn leave_scene(&mut self) {}
}

impl Session {
    /// Returns the workspace that is shown.
    pub(crate) fn workspace(&self) -> Workspace {
        if self.features.lab.open {
            Workspace::Lab
        } else if self.features.comparison.is_on() && self.features.case.is_none() {
            Workspace::Compare
        } else if self.features.mesh_view.open {
            Workspace::Geometry
        } else if self.features.case.is_some() && self.features.workspaces.base == Workspace::Measure {
            // A case is shown in place of the picture.
            Workspace::Inspect
        } else {
            self.features.workspaces.base
        }
    }

    /// Shows a workspace. Leaving the workspace of a comparison ends the comparison, and its tiles are kept.
    pub(crate) fn show_workspace(&mut self, workspace: Workspace) {
        if workspace == self.workspace() {
            return;
        }
        if matches!(workspace, Workspace::Compare | Workspace::Measure) {
            self.close_case();
        }
        self.features.lab.apply(LabChange::Open(workspace == Workspace::Lab));
        self.features.mesh_view.open = workspace == Workspace::Geometry;
        let mode = match workspace {
            Workspace::Compare => self.features.comparison.last_mode,
            _ => Mode::Off,
        };
        self.compare(CompareChange::Mode(mode));
        match workspace {
            Workspace::Inspect | Workspace::Measure | Workspace::Robustness => {
                self.features.workspaces.base = workspace;
            }
            Workspace::Geometry | Workspace::Compare | Workspace::Lab => {}
        }
    }
}
