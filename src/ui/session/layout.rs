//! Layouts of panels, which are stored with the preferences.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::workspace::{Panel, Workspace};

/// Arrangement of panels in a workspace: a tree of rows, columns and tabs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Layout {
    /// One panel without a title.
    Panel(Panel),
    /// Panels that share one area, one of which is visible.
    Tabs {
        /// Panels in the order of their tabs.
        panels: Vec<Panel>,
        /// Index of the visible panel.
        active: usize,
    },
    /// Parts from left to right.
    Row(Vec<Part>),
    /// Parts from top to bottom.
    Column(Vec<Part>),
}

/// Part of a row or a column.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Part {
    /// Content of the part.
    pub(crate) layout: Layout,
    /// Width in a row or height in a column, in points.
    pub(crate) points: f32,
}

/// State of a workspace's layout between runs of the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StoredLayout {
    pub(in crate::ui) layout: Layout,
    /// Whether the panels around the picture are hidden.
    pub(in crate::ui) hides_panels: bool,
}

/// Layouts of the workspaces whose layout is not the default.
pub(crate) type StoredLayouts = BTreeMap<Workspace, StoredLayout>;

impl Layout {
    /// Returns all panels, in layout order.
    pub(in crate::ui) fn panels(&self) -> Vec<Panel> {
        match self {
            Self::Panel(panel) => vec![*panel],
            Self::Tabs { panels, .. } => panels.clone(),
            Self::Row(parts) | Self::Column(parts) => parts.iter().flat_map(|part| part.layout.panels()).collect(),
        }
    }

    /// Whether the layout has the same panels as `other`, each once, and valid sizes.
    pub(in crate::ui) fn is_rearrangement_of(&self, other: &Self) -> bool {
        let sorted = |layout: &Self| {
            let mut panels = layout.panels();
            panels.sort();
            panels
        };
        sorted(self) == sorted(other) && self.has_valid_sizes()
    }

    fn has_valid_sizes(&self) -> bool {
        match self {
            Self::Panel(_) => true,
            Self::Tabs { panels, .. } => !panels.is_empty(),
            Self::Row(parts) | Self::Column(parts) => {
                !parts.is_empty()
                    && parts.iter().all(|part| {
                        part.points.is_finite() && (0.0..1e6).contains(&part.points) && part.layout.has_valid_sizes()
                    })
            }
        }
    }
}
