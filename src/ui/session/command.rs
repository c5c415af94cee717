//! Commands: everything that the user can do in the window.
//!
//! Widgets and keys push [`Command`]s; nothing changes while a frame of the window is being laid out.

use super::feature::Feature;
use super::features::with_features;
use super::place::PlaceChange;
use super::scrub::ScrubChange;
use super::window_task::{DialogCommand, WindowTask};
use super::{PictureSize, Session};
use crate::chain::Recipe;
use crate::inspect::Remedy;
use crate::inspect::find::SearchTarget;
use crate::inspect::scrub::Unit;
use crate::inspect::selection::TriangleSelection;
use crate::scene::Camera;
use crate::ui::engine::Shown;

/// Declares [`Command`]: a variant for each feature, and the commands that change the document and the window.
macro_rules! define_command {
    ($($(#[$doc:meta])* $field:ident: $state:ty => $variant:ident,)+) => {
        /// User action, applied after the window is laid out.
        #[derive(Clone, Debug, PartialEq)]
        pub(crate) enum Command {
            $($(#[$doc])* $variant(<$state as Feature>::Change),)+
            /// Opens a dialog or the manual.
            Dialog(DialogCommand),
            /// Mirrors the scene along the z axis.
            MirrorZ,
            /// Replaces the recipe.
            SetRecipe(Recipe),
            /// Applies a remedy for the picked pixel to the settings or to the camera.
            ApplyRemedy(Remedy),
            /// Selects the upscaler at this index of the registry.
            ChooseUpscaler(usize),
            /// Starts failed upscaler processes again, and draws all pictures again.
            RestartUpscalers,
            /// Resets the recipe to the default.
            ResetRecipe,
            /// Replaces the camera.
            SetCamera(Camera),
            /// Orbits the camera so that the scene turns by this many steps right and down.
            Orbit(i8, i8),
            /// Resets the camera to the scene's home view.
            ResetCamera,
            /// Moves the camera until the whole scene is visible.
            FitCamera,
            /// Changes the picture size.
            SetSize(PictureSize),
            /// Moves the pick by this many pixels right and down.
            NudgePick(i64, i64),
            /// Shows this buffer, pipeline stage or intermediate value on the canvas.
            Show(Shown),
            /// Picks the next (positive) or previous (negative) crack or double hit, and zooms in on its pixel.
            StepFault(i64),
            /// Draws only this many triangles; all if `None`.
            LimitTriangles(Option<usize>),
            /// Draws one more triangle (positive) or one fewer (negative).
            StepTriangle(i64),
            /// Replaces the selection of triangles.
            Select(TriangleSelection),
            /// Undoes the last change of settings, view or size.
            Undo,
            /// Redoes the last undone change.
            Redo,
            /// Performs the first applicable action: closes the manual, closes the introduction, closes the case, clears
            /// the selection, clears the pick, hides the probe's heat map, ends the comparison, or shows the colour buffer
            /// of the complete frame.
            Escape,
        }

        impl Command {
            /// Returns the command that navigates to a search target.
            pub(crate) fn go_to(wanted: SearchTarget) -> Self {
                match wanted {
                    SearchTarget::Pixel(x, y) => Self::Pick(Some((x, y))),
                    wanted => Self::Place(PlaceChange::Find(wanted)),
                }
            }

            /// Applies the command to the session. Returns a task if the window must complete it.
            pub(super) fn apply(self, session: &mut Session) -> Option<WindowTask> {
                match self {
                    $(Self::$variant(change) => return <$state as Feature>::apply(session, change),)+
                    Self::Dialog(command) => return Some(WindowTask::Dialog(command)),
                    Self::MirrorZ => session.mirror_z(),
                    Self::SetRecipe(recipe) => session.set_recipe(recipe),
                    Self::ApplyRemedy(remedy) => remedy.apply(&mut session.state.recipe, &mut session.state.camera),
                    Self::ChooseUpscaler(place) => session.choose_upscaler(place),
                    Self::RestartUpscalers => session.restart_upscalers(),
                    Self::ResetRecipe => session.state.recipe = Recipe::default(),
                    Self::SetCamera(camera) => session.state.camera = camera,
                    Self::Orbit(right, down) => session.orbit(right, down),
                    Self::ResetCamera => session.state.camera = session.scene.home,
                    Self::FitCamera => session.fit_camera(),
                    Self::SetSize(size) => session.state.size = size,
                    Self::NudgePick(dx, dy) => return session.nudge(dx, dy).map(WindowTask::KeepInView),
                    Self::Show(shown) => session.show(shown),
                    Self::StepFault(step) => return session.step_fault(step > 0).map(WindowTask::BringIntoView),
                    Self::LimitTriangles(limit) => session.limit_triangles(limit),
                    Self::StepTriangle(step) => session.scrub(ScrubChange::Step(Unit::Triangle, step > 0)),
                    Self::Select(selection) => session.features.fates.adopt_selection(selection, &mut session.selection),
                    Self::Undo => session.travel(true),
                    Self::Redo => session.travel(false),
                    Self::Escape => return Some(WindowTask::Escape),
                }
                None
            }
        }
    };
}
with_features!(define_command);
