//! Features of the window that own state: one line each. From this list follow the state in the session, the commands,
//! the discarding of what belongs to the previous scene, and what is stored between runs.

use std::fmt::Debug;

use super::session::{Preferences, Session};
use super::window_task::WindowTask;

/// Part of the window that owns its state.
pub(crate) trait Feature {
    /// Change that a command makes to the feature.
    type Change: Clone + Debug + PartialEq;

    /// Applies a change to the feature and to the rest of the session. Returns a task if the window must complete it.
    fn apply(session: &mut Session, change: Self::Change) -> Option<WindowTask>;

    /// Discards everything that belongs to the previous scene, after another one was opened.
    fn leave_scene(&mut self);

    /// Copies what the feature stores between runs into the preferences.
    fn store(&self, _preferences: &mut Preferences) {}

    /// Restores what [`Self::store`] has stored.
    fn restore(&mut self, _preferences: &Preferences) {}
}

/// Passes the list of all features to a macro: field in [`Features`], type of the state, and variant of
/// [`Command`](super::command::Command).
macro_rules! with_features {
    ($define:ident) => {
        $define! {
            /// Canvas: its size and pointer mode.
            canvas: $crate::ui::canvas_state::CanvasState => Canvas,
            /// Recently opened files, and the folder of exported ones.
            files: $crate::ui::files::Files => File,
            /// Selected stage of the pipeline, and the figures of all stages.
            stages: $crate::ui::stages::Stages => Stage,
            /// Picked point, and the automatic pick.
            picking: $crate::ui::picked_point::Picking => Pick,
            /// Playback of how the frame was drawn.
            scrub: $crate::ui::scrub::Scrub => Scrub,
            /// Recorded frame times and errors of each upscaler.
            timings: $crate::ui::timings::Timings => Timings,
            /// Long measurements.
            tasks: $crate::ui::long_tasks::LongTasks => Measure,
            /// Case that is shown in place of the scene, if any.
            case: Option<$crate::ui::open_case::OpenCase> => Case,
            /// Stability probe.
            probing: $crate::ui::probe::ProbeState => Probe,
            /// Vertex table.
            vertices: $crate::ui::vertices::VertexTable => Vertices,
            /// Mesh view, which shows the scene from a second camera.
            mesh_view: $crate::ui::mesh_view::MeshView => MeshView,
            /// 2D lab.
            lab: $crate::ui::lab::Lab => Lab,
            /// Assertions.
            checks: $crate::ui::checks::Checks => Checks,
            /// Trace of the arithmetic of the picked pixel.
            trace: $crate::ui::trace::TraceView => Trace,
            /// Ranges and colour maps of the buffers and stages.
            range: $crate::ui::range::RangeControl => Range,
            /// Overlays of the picture.
            overlays: $crate::ui::overlays::Overlays => Overlays,
            /// Fates of the frame's triangles and fragments, and the filter that selects triangles by fate.
            fates: $crate::ui::fates::FatesView => Fates,
            /// Bookmarks, navigation history and search.
            places: $crate::ui::place::Places => Place,
            /// What-if comparison, which shows the effect of the last change of settings.
            what_if: $crate::ui::what_if::WhatIf => WhatIf,
            /// Watched pixels and their values.
            watch: $crate::ui::watch::WatchList => Watch,
            /// Explanation of another renderer's picture.
            explaining: $crate::ui::explaining::Explaining => Explaining,
            /// Comparison of several pictures of one view.
            comparison: $crate::ui::compare::CompareState => Compare,
            /// Sequences of picture files, and the frame that they show.
            sequences: $crate::ui::sequences::Sequences => Sequence,
            /// Time of an animated scene, and its playback.
            scene_time: $crate::ui::scene_time::SceneTime => SceneTime,
            /// Recorded camera path.
            camera_path: $crate::ui::camera_path::RecordedPath => CameraPath,
            /// Errors over time of the compared upscalers.
            over_time: $crate::ui::over_time::OverTime => OverTime,
            /// Earlier frames of the picked pixel.
            temporal: $crate::ui::temporal::TemporalView => Temporal,
            /// Filmstrip of all upscaling methods below a comparison.
            filmstrip: $crate::ui::filmstrip::Filmstrip => Filmstrip,
            /// Start card, coach and lessons for new users.
            onboarding: $crate::ui::onboarding::Onboarding => Onboarding,
            /// Workspace of the other panels.
            workspaces: $crate::ui::workspace::Workspaces => Workspace,
            /// Errors, notices, offers, and the log.
            messages: $crate::ui::session::Messages => Message,
            /// Theme, scale and motion of the window.
            appearance: $crate::ui::appearance::Appearance => Appearance,
        }
    };
}
pub(in crate::ui) use with_features;

/// Declares [`Features`].
macro_rules! define_features {
    ($($(#[$doc:meta])* $field:ident: $state:ty => $variant:ident,)+) => {
        /// State of all features.
        #[derive(Debug, Default)]
        pub(crate) struct Features {
            $($(#[$doc])* pub(crate) $field: $state,)+
        }

        impl Features {
            /// Discards everything that belongs to the previous scene.
            pub(crate) fn leave_scene(&mut self) {
                $(Feature::leave_scene(&mut self.$field);)+
            }

            /// Copies everything that is stored between runs into the preferences.
            pub(crate) fn store(&self, preferences: &mut Preferences) {
                $(Feature::store(&self.$field, preferences);)+
            }

            /// Restores what [`Self::store`] has stored.
            pub(crate) fn restore(&mut self, preferences: &Preferences) {
                $(Feature::restore(&mut self.$field, preferences);)+
            }
        }
    };
}
with_features!(define_features);
