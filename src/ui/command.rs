//! Commands: everything that the user can do in the window, and the keys bound to it.
//!
//! Widgets and keys push [`Command`]s; nothing changes while a frame of the window is being laid out. The key map is
//! one table, shared by shortcuts, tooltips and the key sheet.

use eframe::egui::{Key, KeyboardShortcut, Modifiers};

use super::canvas_state::CanvasChange;
use super::compare::{CompareChange, Mode};
use super::engine::Shown;
use super::features::{Feature, with_features};
use super::files::FileCommand;
use super::lab::LabChange;
use super::mesh_view;
use super::overlays;
use super::place;
use super::range;
use super::save_as::SaveItem;
use super::scene_time::SceneTimeChange;
use super::scrub::{self, ScrubChange};
use super::session::{PictureSize, PointerMode, Session};
use super::stages::StageChange;
use super::trace;
use super::watch;
use super::what_if;
use super::window_task::{DialogCommand, WindowTask};
use super::workspace::{Workspace, WorkspaceChange};
use crate::chain::Recipe;
use crate::inspect::Remedy;
use crate::inspect::range::RangeFit;
use crate::inspect::scrub::Unit;
use crate::inspect::selection::TriangleSelection;
use crate::inspect::trace::StepDirection;
use crate::scene::Camera;

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

/// Key binding with its description.
pub(crate) struct KeyBinding {
    /// Key that triggers the command.
    pub(crate) key: Key,
    /// Modifiers that must be held.
    pub(crate) modifiers: Modifiers,
    /// Constructor of the command.
    pub(crate) command: fn() -> Command,
    /// Description for tooltips and the key sheet.
    pub(crate) description: &'static str,
    /// Other words for the command, in lower case, by which the palette finds it.
    pub(crate) synonyms: &'static [&'static str],
}

const fn bind(modifiers: Modifiers, key: Key, command: fn() -> Command, what: &'static str) -> KeyBinding {
    KeyBinding { key, modifiers, command, description: what, synonyms: &[] }
}

/// Modifier keys Ctrl + Shift.
const CONTROL_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// Returns a key binding for jumping to a bookmark.
const fn jump(key: Key, command: fn() -> Command) -> KeyBinding {
    bind(Modifiers::ALT, key, command, "Go to a bookmark")
}

/// Returns a key binding for showing a workspace.
const fn show(key: Key, command: fn() -> Command) -> KeyBinding {
    bind(Modifiers::COMMAND, key, command, "Show a workspace")
}

impl KeyBinding {
    /// Returns the binding with other words for its command, in lower case, by which the palette finds it.
    const fn also(self, synonyms: &'static [&'static str]) -> Self {
        Self { synonyms, ..self }
    }

    /// Whether the key works while a widget other than a text field has the keyboard focus: function keys, and keys with
    /// Ctrl or Alt.
    pub(crate) fn works_beside_focus(&self) -> bool {
        let is_function_key = matches!(
            self.key,
            Key::F1
                | Key::F2
                | Key::F3
                | Key::F4
                | Key::F5
                | Key::F6
                | Key::F7
                | Key::F8
                | Key::F9
                | Key::F10
                | Key::F11
        );
        is_function_key || self.modifiers.command || self.modifiers.alt
    }

    /// Returns the binding as an egui shortcut.
    pub(crate) fn shortcut(&self) -> KeyboardShortcut {
        KeyboardShortcut::new(self.modifiers, self.key)
    }
}

/// Key map of the window. Among the bindings of one key, those with more modifiers come first, so that the first match
/// is the most specific.
pub(crate) const BINDINGS: &[KeyBinding] = &[
    bind(Modifiers::COMMAND, Key::O, || Command::Dialog(DialogCommand::Open), "Open a model or a case")
        .also(&["import", "load"]),
    bind(
        Modifiers::COMMAND.plus(Modifiers::ALT),
        Key::S,
        || Command::File(FileCommand::SaveData),
        "Save the exact values of the shown buffer as floats (PFM)",
    ),
    bind(
        CONTROL_SHIFT,
        Key::S,
        || Command::File(FileCommand::SaveAs(SaveItem::Picture)),
        "Save the picture as PNG under a chosen name",
    )
    .also(&["export", "save as"]),
    bind(Modifiers::COMMAND, Key::S, || Command::File(FileCommand::SavePicture), "Save the picture as PNG")
        .also(&["screenshot", "capture"]),
    bind(CONTROL_SHIFT, Key::C, || Command::Place(place::PlaceChange::Copy), "Copy the view as a command"),
    bind(Modifiers::COMMAND, Key::C, || Command::File(FileCommand::CopyPicture), "Copy the picture"),
    bind(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z, || Command::Redo, "Redo the last undone change"),
    bind(Modifiers::COMMAND, Key::Z, || Command::Undo, "Undo the last change").also(&["undo", "revert"]),
    bind(
        Modifiers::COMMAND,
        Key::G,
        || Command::Dialog(DialogCommand::GoTo),
        "Go to a pixel, triangle, vertex or object",
    ),
    bind(CONTROL_SHIFT, Key::P, || Command::Dialog(DialogCommand::Palette), "Find anything"),
    bind(Modifiers::COMMAND, Key::B, || Command::Place(place::PlaceChange::Bookmark), "Bookmark the current view"),
    show(Key::Num1, || Command::Workspace(WorkspaceChange::Show(Workspace::Inspect))),
    show(Key::Num2, || Command::Workspace(WorkspaceChange::Show(Workspace::Geometry))),
    show(Key::Num3, || Command::Workspace(WorkspaceChange::Show(Workspace::Compare))),
    show(Key::Num4, || Command::Workspace(WorkspaceChange::Show(Workspace::Measure))),
    show(Key::Num5, || Command::Workspace(WorkspaceChange::Show(Workspace::Robustness))),
    show(Key::Num6, || Command::Workspace(WorkspaceChange::Show(Workspace::Lab))),
    bind(
        Modifiers::NONE,
        Key::F6,
        || Command::Workspace(WorkspaceChange::NextPanel),
        "Move the keyboard focus to the next panel",
    ),
    bind(
        Modifiers::NONE,
        Key::F9,
        || Command::Workspace(WorkspaceChange::TogglePanels),
        "Hide or show the panels around the picture",
    ),
    jump(Key::Num1, || Command::Place(place::PlaceChange::Jump(0))),
    jump(Key::Num2, || Command::Place(place::PlaceChange::Jump(1))),
    jump(Key::Num3, || Command::Place(place::PlaceChange::Jump(2))),
    jump(Key::Num4, || Command::Place(place::PlaceChange::Jump(3))),
    jump(Key::Num5, || Command::Place(place::PlaceChange::Jump(4))),
    jump(Key::Num6, || Command::Place(place::PlaceChange::Jump(5))),
    jump(Key::Num7, || Command::Place(place::PlaceChange::Jump(6))),
    jump(Key::Num8, || Command::Place(place::PlaceChange::Jump(7))),
    jump(Key::Num9, || Command::Place(place::PlaceChange::Jump(8))),
    bind(Modifiers::ALT, Key::ArrowLeft, || Command::Place(place::PlaceChange::Back), "Go back to the previous view"),
    bind(
        Modifiers::ALT,
        Key::ArrowRight,
        || Command::Place(place::PlaceChange::Forward),
        "Go forward to the next view",
    ),
    bind(Modifiers::NONE, Key::F, || Command::Canvas(CanvasChange::Fit), "Fit the picture into the canvas")
        .also(&["zoom", "zoom to fit"]),
    bind(
        Modifiers::NONE,
        Key::Num0,
        || Command::Canvas(CanvasChange::OneToOne),
        "Show one picture pixel per screen pixel",
    ),
    bind(Modifiers::NONE, Key::OpenBracket, || Command::Stage(StageChange::Step(-1)), "Select the previous stage"),
    bind(Modifiers::NONE, Key::CloseBracket, || Command::Stage(StageChange::Step(1)), "Select the next stage"),
    bind(
        Modifiers::COMMAND,
        Key::Comma,
        || Command::Scrub(scrub::ScrubChange::Step(Unit::Draw, false)),
        "Draw one fewer object",
    ),
    bind(
        Modifiers::COMMAND,
        Key::Period,
        || Command::Scrub(scrub::ScrubChange::Step(Unit::Draw, true)),
        "Draw one more object",
    ),
    bind(
        Modifiers::SHIFT,
        Key::Comma,
        || Command::Scrub(scrub::ScrubChange::Step(Unit::Fragment, false)),
        "Draw one fewer fragment",
    ),
    bind(
        Modifiers::SHIFT,
        Key::Period,
        || Command::Scrub(scrub::ScrubChange::Step(Unit::Fragment, true)),
        "Draw one more fragment",
    ),
    bind(Modifiers::SHIFT, Key::Space, || Command::Scrub(scrub::ScrubChange::Play(false)), "Play backwards, or pause"),
    bind(
        Modifiers::NONE,
        Key::Space,
        || Command::Scrub(scrub::ScrubChange::Play(true)),
        "Play back how the frame was drawn, or pause",
    ),
    bind(
        Modifiers::NONE,
        Key::Y,
        || Command::Scrub(scrub::ScrubChange::Touching(None)),
        "Step only through triangles and fragments at the picked pixel, or through all of them",
    ),
    bind(
        Modifiers::COMMAND,
        Key::Space,
        || Command::SceneTime(SceneTimeChange::TogglePlay),
        "Play the animated scene, or pause",
    )
    .also(&["animation", "time", "motion"]),
    bind(
        Modifiers::ALT,
        Key::Comma,
        || Command::SceneTime(SceneTimeChange::Step(-1)),
        "Show the previous frame of the animated scene",
    ),
    bind(
        Modifiers::ALT,
        Key::Period,
        || Command::SceneTime(SceneTimeChange::Step(1)),
        "Show the next frame of the animated scene",
    ),
    bind(Modifiers::NONE, Key::Comma, || Command::StepTriangle(-1), "Draw one fewer triangle"),
    bind(Modifiers::NONE, Key::Period, || Command::StepTriangle(1), "Draw one more triangle"),
    bind(Modifiers::SHIFT, Key::J, || Command::StepFault(-1), "Go to the previous faulty pixel"),
    bind(Modifiers::NONE, Key::J, || Command::StepFault(1), "Go to the next faulty pixel"),
    bind(
        Modifiers::NONE,
        Key::O,
        || Command::Overlays(overlays::OverlayChange::ToggleOpen),
        "Show or hide the list of overlays",
    ),
    bind(
        Modifiers::SHIFT,
        Key::N,
        || Command::Range(range::RangeChange::FitVisible),
        "Fit the value range to the visible part of the picture",
    ),
    bind(
        Modifiers::NONE,
        Key::N,
        || Command::Range(range::RangeChange::Fit(RangeFit::All)),
        "Fit the value range to all values of the picture",
    ),
    bind(
        Modifiers::SHIFT,
        Key::R,
        || Command::Range(range::RangeChange::DrawRegion(true)),
        "Draw a rectangle, to show the statistics of its pixels",
    )
    .also(&["crop", "region", "selection", "average"]),
    bind(Modifiers::NONE, Key::Home, || Command::LimitTriangles(Some(0)), "Go to the start, before the first triangle"),
    bind(Modifiers::NONE, Key::End, || Command::LimitTriangles(None), "Go to the end, after the last triangle"),
    bind(Modifiers::COMMAND, Key::ArrowLeft, || Command::Orbit(-1, 0), "Orbit the camera by 5°: the scene turns left"),
    bind(Modifiers::COMMAND, Key::ArrowRight, || Command::Orbit(1, 0), "Orbit the camera by 5°: the scene turns right"),
    bind(Modifiers::COMMAND, Key::ArrowUp, || Command::Orbit(0, -1), "Orbit the camera by 5°: the scene turns up"),
    bind(Modifiers::COMMAND, Key::ArrowDown, || Command::Orbit(0, 1), "Orbit the camera by 5°: the scene turns down"),
    bind(Modifiers::SHIFT, Key::ArrowLeft, || Command::NudgePick(-10, 0), "Pick the pixel 10 px to the left"),
    bind(Modifiers::SHIFT, Key::ArrowRight, || Command::NudgePick(10, 0), "Pick the pixel 10 px to the right"),
    bind(Modifiers::SHIFT, Key::ArrowUp, || Command::NudgePick(0, -10), "Pick the pixel 10 px above"),
    bind(Modifiers::SHIFT, Key::ArrowDown, || Command::NudgePick(0, 10), "Pick the pixel 10 px below"),
    bind(Modifiers::NONE, Key::ArrowLeft, || Command::NudgePick(-1, 0), "Pick the pixel 1 px to the left"),
    bind(Modifiers::NONE, Key::ArrowRight, || Command::NudgePick(1, 0), "Pick the pixel 1 px to the right"),
    bind(Modifiers::NONE, Key::ArrowUp, || Command::NudgePick(0, -1), "Pick the pixel 1 px above"),
    bind(Modifiers::NONE, Key::ArrowDown, || Command::NudgePick(0, 1), "Pick the pixel 1 px below"),
    bind(Modifiers::NONE, Key::Num1, || Command::ChooseUpscaler(0), "Choose an upscaler"),
    bind(Modifiers::NONE, Key::Num2, || Command::ChooseUpscaler(1), "Choose an upscaler"),
    bind(Modifiers::NONE, Key::Num3, || Command::ChooseUpscaler(2), "Choose an upscaler"),
    bind(Modifiers::NONE, Key::Num4, || Command::ChooseUpscaler(3), "Choose an upscaler"),
    bind(Modifiers::NONE, Key::Num5, || Command::ChooseUpscaler(4), "Choose an upscaler"),
    bind(Modifiers::NONE, Key::Num6, || Command::ChooseUpscaler(5), "Choose an upscaler"),
    bind(Modifiers::NONE, Key::Num7, || Command::ChooseUpscaler(6), "Choose an upscaler"),
    bind(Modifiers::NONE, Key::Num8, || Command::ChooseUpscaler(7), "Choose an upscaler"),
    bind(Modifiers::NONE, Key::Num9, || Command::ChooseUpscaler(8), "Choose an upscaler"),
    bind(
        Modifiers::NONE,
        Key::T,
        || Command::Compare(CompareChange::Toggle(Mode::Tiles)),
        "Compare pictures in tiles, or stop comparing",
    ),
    bind(
        Modifiers::NONE,
        Key::W,
        || Command::Compare(CompareChange::Toggle(Mode::Wipe)),
        "Wipe between pictures A and B, or stop comparing",
    ),
    bind(
        Modifiers::NONE,
        Key::B,
        || Command::Compare(CompareChange::Toggle(Mode::Flip)),
        "Flip between pictures A and B, or stop comparing",
    ),
    bind(
        Modifiers::NONE,
        Key::D,
        || Command::Compare(CompareChange::Toggle(Mode::Difference)),
        "Show the difference between pictures A and B, or stop comparing",
    ),
    bind(
        Modifiers::NONE,
        Key::X,
        || Command::WhatIf(what_if::WhatIfChange::Toggle),
        "Show the effect of the last change of a setting, or stop comparing",
    ),
    bind(Modifiers::NONE, Key::S, || Command::Compare(CompareChange::Swap), "Swap pictures A and B"),
    bind(
        Modifiers::NONE,
        Key::R,
        || Command::Compare(CompareChange::ToggleRegion),
        "Reset the value range; while comparing, draw a rectangle to measure",
    ),
    bind(Modifiers::NONE, Key::L, || Command::Lab(LabChange::Toggle), "Switch between the 2D lab and the pipeline"),
    bind(Modifiers::NONE, Key::K, || Command::Lab(LabChange::TogglePlay), "Play the steps of the 2D lab, or stop"),
    bind(
        Modifiers::SHIFT,
        Key::F10,
        || Command::Trace(trace::TraceChange::Step(-1)),
        "Go to the previous line of the calculation",
    ),
    bind(
        Modifiers::NONE,
        Key::F10,
        || Command::Trace(trace::TraceChange::Step(1)),
        "Go to the next line of the calculation",
    ),
    bind(
        Modifiers::SHIFT,
        Key::F5,
        || Command::Trace(trace::TraceChange::Run(None, StepDirection::Back)),
        "Go to the previous flagged line of the calculation",
    ),
    bind(
        Modifiers::NONE,
        Key::F5,
        || Command::Trace(trace::TraceChange::Run(None, StepDirection::Forward)),
        "Go to the next flagged line of the calculation",
    ),
    bind(
        Modifiers::SHIFT,
        Key::F11,
        || Command::Trace(trace::TraceChange::Stage(StepDirection::Back)),
        "Go to the previous stage of the calculation",
    ),
    bind(
        Modifiers::NONE,
        Key::F11,
        || Command::Trace(trace::TraceChange::Stage(StepDirection::Forward)),
        "Go to the next stage of the calculation",
    ),
    bind(
        Modifiers::NONE,
        Key::M,
        || Command::MeshView(mesh_view::MeshViewChange::Toggle),
        "Show or hide the mesh view",
    ),
    bind(
        Modifiers::NONE,
        Key::C,
        || Command::Canvas(CanvasChange::TogglePointerMode(PointerMode::Camera)),
        "Turn camera mode on or off: dragging orbits, the wheel dollies, W A S D Q E fly",
    )
    .also(&["fly", "wasd", "first person"]),
    bind(
        Modifiers::NONE,
        Key::P,
        || Command::Canvas(CanvasChange::TogglePointerMode(PointerMode::Pan)),
        "Turn pan mode on or off: dragging pans the picture",
    )
    .also(&["pan", "hand tool", "scroll"]),
    bind(Modifiers::NONE, Key::H, || Command::ResetCamera, "Return to the scene's home view")
        .also(&["home", "reset camera"]),
    bind(Modifiers::NONE, Key::Enter, || Command::Watch(watch::WatchChange::AddPick), "Watch the picked pixel"),
    bind(
        Modifiers::NONE,
        Key::Escape,
        || Command::Escape,
        "Clear the selection; without one, stop comparing; otherwise show the finished picture",
    ),
    bind(Modifiers::SHIFT, Key::Slash, || Command::Dialog(DialogCommand::Keys), "Show all keys and mouse gestures")
        .also(&["shortcuts", "hotkeys", "controls"]),
    bind(
        Modifiers::NONE,
        Key::Questionmark,
        || Command::Dialog(DialogCommand::Keys),
        "Show all keys and mouse gestures",
    ),
    bind(Modifiers::NONE, Key::F1, || Command::Dialog(DialogCommand::Manual(None)), "Open and search the manual")
        .also(&["help", "docs"]),
];

/// Mouse gestures and their effects, for the key sheet.
pub(crate) const MOUSE: &[(&str, &str)] = &[
    ("Click", "Pick a pixel and explain it"),
    ("Right-drag", "Inspect pixels while dragging"),
    ("Drag", "Orbit the camera around its target"),
    ("Wheel", "Zoom at the pointer"),
    ("Middle-drag; P, then drag", "Pan the picture"),
    ("Shift + middle-drag", "Pan the camera"),
    ("Ctrl + wheel", "Dolly the camera"),
    ("Tab over the picture", "Hide or show the panels"),
    ("Hold Alt", "Show pixel values as raw bits in hexadecimal"),
    ("Shift + drag; Shift + R, then drag", "Show statistics of a rectangle of the picture"),
    ("Hold Shift while comparing", "Show the other picture"),
    ("What changed: hold Shift", "Show the picture before the change"),
    ("Comparing: R, then drag", "Measure the errors in a rectangle"),
    ("C, then drag, wheel, W A S D Q E", "Camera mode: orbit, dolly, fly"),
];
