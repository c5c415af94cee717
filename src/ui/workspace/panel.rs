//! Drawing of each dockable panel.

use crate::ui::panels::{
    PanelSpec, checks, compare, explaining, fates, filter_taps, frame_times, inspector, lab, log, mesh_view, over_time,
    picture, pipeline, probe, range, scaling, skipped_work, stability, trace, tradeoff, vertices, watch,
};
use crate::ui::session::workspace::Panel;

impl Panel {
    /// Returns the drawing of the panel.
    pub(super) fn spec(self) -> &'static PanelSpec {
        match self {
            Self::Stages => &pipeline::PANEL,
            Self::Picture => &picture::PANEL,
            Self::Pixel => &inspector::PANEL,
            Self::Calculation => &trace::PANEL,
            Self::Watch => &watch::PANEL,
            Self::FilterTaps => &filter_taps::PANEL,
            Self::Histogram => &range::PANEL,
            Self::MeshView => &mesh_view::PANEL,
            Self::Vertices => &vertices::PANEL,
            Self::TriangleFates => &fates::PANEL,
            Self::FrameTime => &frame_times::PANEL,
            Self::ErrorTime => &tradeoff::PANEL,
            Self::OverTime => &over_time::PANEL,
            Self::Scaling => &scaling::PANEL,
            Self::SkippedWork => &skipped_work::PANEL,
            Self::Stability => &stability::PANEL,
            Self::Probe => &probe::PANEL,
            Self::Assertions => &checks::PANEL,
            Self::OtherRenderer => &explaining::PANEL,
            Self::PictureFiles => &compare::files_panel::PANEL,
            Self::Log => &log::PANEL,
            Self::Lab => &lab::PANEL,
        }
    }
}
