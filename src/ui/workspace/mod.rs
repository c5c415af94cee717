//! Workspaces: the tasks that the window is divided into, each with its own layout of dockable panels.
//!
//! The current workspace follows from the state of the session: the 2D lab, a comparison and the mesh view each have a
//! workspace, and the others are chosen by the user.

mod defaults;

mod dock;

mod layout;

mod panel;

pub(crate) use dock::{Docks, framed, scrolling};
pub(crate) use layout::StoredLayouts;
pub(crate) use panel::{Panel, PanelContext, PanelSpec, PanelWidgets};

use super::compare::{CompareChange, Mode};
use super::features::Feature;
use super::lab::LabChange;
use super::session::Session;
use super::window_task::WindowTask;
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Task of the user, with its own layout of panels.
    #[derive(PartialOrd, Ord)]
    pub(crate) Workspace {
        Inspect = "inspect", "Inspect", "Step through the stages, and explain any pixel of the picture.";
        Geometry = "geometry", "Geometry",
            "See the scene from outside, the vertices at every stage, and the fate of every triangle.";
        Compare = "compare", "Compare", "Compare pictures of several upscalers or settings, by eye and by number.";
        Measure = "measure", "Measure", "Measure frame times, errors, scaling and skipped work.";
        Robustness = "robustness", "Robustness",
            "Find ill-conditioned cases: stability report, probe and assertions.";
        Lab = "lab", "2D lab", "Step through algorithms for lines, circles, polygons, fills and sampling.";
    }
}

/// Change of the workspace or of its layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WorkspaceChange {
    /// Switches to a workspace.
    Show(Workspace),
    /// Shows a panel, in the current workspace if it has the panel, otherwise in the first workspace that has it.
    Panel(Panel),
    /// Maximizes a panel, or restores the layout if the panel is already maximized.
    Maximize(Panel),
    /// Hides or shows all panels around the picture, or restores the layout if a panel is maximized.
    TogglePanels,
    /// Moves the keyboard focus to the next panel.
    NextPanel,
    /// Restores the default layout of the current workspace.
    ResetLayout,
}

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
