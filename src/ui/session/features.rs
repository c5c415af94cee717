//! Features of the window that own state: one line each. From this list follow the state in the session, the commands,
//! the discarding of what belongs to the previous scene, and what is stored between runs.

use super::Preferences;
use super::feature::Feature;

/// Passes the list of all features to a macro: field in [`Features`], type of the state, and variant of
/// [`Command`](super::command::Command).
macro_rules! with_features {
    ($define:ident) => {
        $define! {
            /// Canvas: its size and pointer mode.
            canvas: $crate::ui::session::canvas_state::CanvasState => Canvas,
            /// Recently opened files, and the folder of exported ones.
            files: $crate::ui::session::files::Files => File,
            /// Selected stage of the pipeline, and the figures of all stages.
            stages: $crate::ui::session::stages::Stages => Stage,
            /// Picked point, and the automatic pick.
            picking: $crate::ui::session::picked_point::Picking => Pick,
            /// Playback of how the frame was drawn.
            scrub: $crate::ui::session::scrub::Scrub => Scrub,
            /// Recorded frame times and errors of each upscaler.
            timings: $crate::ui::session::timings::Timings => Timings,
            /// Long measurements.
            tasks: $crate::ui::session::long_tasks::LongTasks => Measure,
            /// Case that is shown in place of the scene, if any.
            case: Option<$crate::ui::session::open_case::OpenCase> => Case,
            /// Stability probe.
            probing: $crate::ui::session::probe::ProbeState => Probe,
            /// Vertex table.
            vertices: $crate::ui::session::vertices::VertexTable => Vertices,
            /// Mesh view, which shows the scene from a second camera.
            mesh_view: $crate::ui::session::mesh_view::MeshView => MeshView,
            /// 2D lab.
            lab: $crate::ui::session::lab::Lab => Lab,
            /// Assertions.
            checks: $crate::ui::session::checks::Checks => Checks,
            /// Trace of the arithmetic of the picked pixel.
            trace: $crate::ui::session::trace::TraceView => Trace,
            /// Ranges and colour maps of the buffers and stages.
            range: $crate::ui::session::range::RangeControl => Range,
            /// Overlays of the picture.
            overlays: $crate::ui::session::overlays::Overlays => Overlays,
            /// Fates of the frame's triangles and fragments, and the filter that selects triangles by fate.
            fates: $crate::ui::session::fates::FatesView => Fates,
            /// Bookmarks, navigation history and search.
            places: $crate::ui::session::place::Places => Place,
            /// What-if comparison, which shows the effect of the last change of settings.
            what_if: $crate::ui::session::what_if::WhatIf => WhatIf,
            /// Watched pixels and their values.
            watch: $crate::ui::session::watch::WatchList => Watch,
            /// Explanation of another renderer's picture.
            explaining: $crate::ui::session::explaining::Explaining => Explaining,
            /// Comparison of several pictures of one view.
            comparison: $crate::ui::session::compare::CompareState => Compare,
            /// Sequences of picture files, and the frame that they show.
            sequences: $crate::ui::session::sequences::Sequences => Sequence,
            /// Time of an animated scene, and its playback.
            scene_time: $crate::ui::session::scene_time::SceneTime => SceneTime,
            /// Recorded camera path.
            camera_path: $crate::ui::session::camera_path::RecordedPath => CameraPath,
            /// Errors over time of the compared upscalers.
            over_time: $crate::ui::session::over_time::OverTime => OverTime,
            /// Earlier frames of the picked pixel.
            temporal: $crate::ui::session::temporal::TemporalView => Temporal,
            /// Filmstrip of all upscaling methods below a comparison.
            filmstrip: $crate::ui::session::filmstrip::Filmstrip => Filmstrip,
            /// Start card, coach and lessons for new users.
            onboarding: $crate::ui::session::onboarding::Onboarding => Onboarding,
            /// Workspace of the other panels.
            workspaces: $crate::ui::session::workspaces::Workspaces => Workspace,
            /// Errors, notices, offers, and the log.
            messages: $crate::ui::session::Messages => Message,
            /// Theme, scale and motion of the window.
            appearance: $crate::ui::session::appearance::Appearance => Appearance,
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
