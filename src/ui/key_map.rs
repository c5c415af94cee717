//! Key map: the keys, mouse gestures and names of commands. Shortcuts, tooltips, key sheet and palette read these tables.

use eframe::egui::{Key, KeyboardShortcut, Modifiers};

use super::appearance::AppearanceChange;
use super::camera_path::CameraPathChange;
use super::canvas_state::CanvasChange;
use super::command::Command;
use super::compare::{CompareChange, Mode};
use super::files::FileCommand;
use super::filmstrip::FilmstripChange;
use super::lab::LabChange;
use super::long_tasks::MeasureCommand;
use super::mesh_view::MeshViewChange;
use super::onboarding::OnboardingChange;
use super::over_time::OverTimeChange;
use super::overlays::OverlayChange;
use super::place::PlaceChange;
use super::range::RangeChange;
use super::save_as::SaveItem;
use super::scene_time::SceneTimeChange;
use super::scrub::ScrubChange;
use super::session::{PictureSize, PointerMode};
use super::stages::StageChange;
use super::temporal::TemporalChange;
use super::timings::TimingsChange;
use super::trace::TraceChange;
use super::watch::WatchChange;
use super::what_if::WhatIfChange;
use super::window_task::DialogCommand;
use super::workspace::{Workspace, WorkspaceChange};
use crate::inspect::range::RangeFit;
use crate::inspect::scrub::Unit;
use crate::inspect::trace::StepDirection;

/// Topic under which keys and mouse gestures are listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Topic {
    /// Mouse.
    Mouse,
    /// Picture on the canvas.
    Picture,
    /// Picked pixel.
    Pixel,
    /// Stages.
    Stages,
    /// Frame playback.
    Making,
    /// Value range and overlays.
    Showing,
    /// Calculation of the picked pixel.
    Arithmetic,
    /// Search and bookmarks.
    Places,
    /// Scene and view.
    Scene,
    /// Settings.
    Settings,
    /// Comparing.
    Comparing,
    /// Everything else.
    General,
}

impl Topic {
    /// All topics with their display names, in the order of the key sheet.
    pub(crate) const ALL: [(Self, &'static str); 12] = [
        (Self::Mouse, "Mouse"),
        (Self::Picture, "Picture on the canvas"),
        (Self::Pixel, "Picked pixel"),
        (Self::Stages, "Stages"),
        (Self::Making, "Frame playback"),
        (Self::Showing, "Value range and overlays"),
        (Self::Arithmetic, "Calculation of the picked pixel"),
        (Self::Places, "Search and bookmarks"),
        (Self::Scene, "Scene and view"),
        (Self::Settings, "Settings"),
        (Self::Comparing, "Comparing"),
        (Self::General, "Other"),
    ];
}

/// Key binding with its description.
pub(crate) struct KeyBinding {
    /// Topic under which the key sheet lists the binding.
    pub(crate) topic: Topic,
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

const fn bind(
    topic: Topic,
    modifiers: Modifiers,
    key: Key,
    command: fn() -> Command,
    what: &'static str,
) -> KeyBinding {
    KeyBinding { topic, key, modifiers, command, description: what, synonyms: &[] }
}

/// Modifier keys Ctrl + Shift.
const CONTROL_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// Returns a key binding for jumping to a bookmark.
const fn jump(key: Key, command: fn() -> Command) -> KeyBinding {
    bind(Topic::Places, Modifiers::ALT, key, command, "Go to a bookmark")
}

/// Returns a key binding for showing a workspace.
const fn show(key: Key, command: fn() -> Command) -> KeyBinding {
    bind(Topic::General, Modifiers::COMMAND, key, command, "Show a workspace")
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
    bind(Topic::Scene, Modifiers::COMMAND, Key::O, || Command::Dialog(DialogCommand::Open), "Open a model or a case")
        .also(&["import", "load"]),
    bind(
        Topic::Picture,
        Modifiers::COMMAND.plus(Modifiers::ALT),
        Key::S,
        || Command::File(FileCommand::SaveData),
        "Save the exact values of the shown buffer as floats (PFM)",
    ),
    bind(
        Topic::Picture,
        CONTROL_SHIFT,
        Key::S,
        || Command::File(FileCommand::SaveAs(SaveItem::Picture)),
        "Save the picture as PNG under a chosen name",
    )
    .also(&["export", "save as"]),
    bind(
        Topic::Picture,
        Modifiers::COMMAND,
        Key::S,
        || Command::File(FileCommand::SavePicture),
        "Save the picture as PNG",
    )
    .also(&["screenshot", "capture"]),
    bind(Topic::Places, CONTROL_SHIFT, Key::C, || Command::Place(PlaceChange::Copy), "Copy the view as a command"),
    bind(Topic::Picture, Modifiers::COMMAND, Key::C, || Command::File(FileCommand::CopyPicture), "Copy the picture"),
    bind(
        Topic::Settings,
        Modifiers::COMMAND.plus(Modifiers::SHIFT),
        Key::Z,
        || Command::Redo,
        "Redo the last undone change",
    ),
    bind(Topic::Settings, Modifiers::COMMAND, Key::Z, || Command::Undo, "Undo the last change")
        .also(&["undo", "revert"]),
    bind(
        Topic::Places,
        Modifiers::COMMAND,
        Key::G,
        || Command::Dialog(DialogCommand::GoTo),
        "Go to a pixel, triangle, vertex or object",
    ),
    bind(Topic::Places, CONTROL_SHIFT, Key::P, || Command::Dialog(DialogCommand::Palette), "Find anything"),
    bind(
        Topic::Places,
        Modifiers::COMMAND,
        Key::B,
        || Command::Place(PlaceChange::Bookmark),
        "Bookmark the current view",
    ),
    show(Key::Num1, || Command::Workspace(WorkspaceChange::Show(Workspace::Inspect))),
    show(Key::Num2, || Command::Workspace(WorkspaceChange::Show(Workspace::Geometry))),
    show(Key::Num3, || Command::Workspace(WorkspaceChange::Show(Workspace::Compare))),
    show(Key::Num4, || Command::Workspace(WorkspaceChange::Show(Workspace::Measure))),
    show(Key::Num5, || Command::Workspace(WorkspaceChange::Show(Workspace::Robustness))),
    show(Key::Num6, || Command::Workspace(WorkspaceChange::Show(Workspace::Lab))),
    bind(
        Topic::General,
        Modifiers::NONE,
        Key::F6,
        || Command::Workspace(WorkspaceChange::NextPanel),
        "Move the keyboard focus to the next panel",
    ),
    bind(
        Topic::General,
        Modifiers::NONE,
        Key::F9,
        || Command::Workspace(WorkspaceChange::TogglePanels),
        "Hide or show the panels around the picture",
    ),
    jump(Key::Num1, || Command::Place(PlaceChange::Jump(0))),
    jump(Key::Num2, || Command::Place(PlaceChange::Jump(1))),
    jump(Key::Num3, || Command::Place(PlaceChange::Jump(2))),
    jump(Key::Num4, || Command::Place(PlaceChange::Jump(3))),
    jump(Key::Num5, || Command::Place(PlaceChange::Jump(4))),
    jump(Key::Num6, || Command::Place(PlaceChange::Jump(5))),
    jump(Key::Num7, || Command::Place(PlaceChange::Jump(6))),
    jump(Key::Num8, || Command::Place(PlaceChange::Jump(7))),
    jump(Key::Num9, || Command::Place(PlaceChange::Jump(8))),
    bind(
        Topic::Places,
        Modifiers::ALT,
        Key::ArrowLeft,
        || Command::Place(PlaceChange::Back),
        "Go back to the previous view",
    ),
    bind(
        Topic::Places,
        Modifiers::ALT,
        Key::ArrowRight,
        || Command::Place(PlaceChange::Forward),
        "Go forward to the next view",
    ),
    bind(
        Topic::Picture,
        Modifiers::NONE,
        Key::F,
        || Command::Canvas(CanvasChange::Fit),
        "Fit the picture into the canvas",
    )
    .also(&["zoom", "zoom to fit"]),
    bind(
        Topic::Picture,
        Modifiers::NONE,
        Key::Num0,
        || Command::Canvas(CanvasChange::OneToOne),
        "Show one picture pixel per screen pixel",
    ),
    bind(
        Topic::Stages,
        Modifiers::NONE,
        Key::OpenBracket,
        || Command::Stage(StageChange::Step(-1)),
        "Select the previous stage",
    ),
    bind(
        Topic::Stages,
        Modifiers::NONE,
        Key::CloseBracket,
        || Command::Stage(StageChange::Step(1)),
        "Select the next stage",
    ),
    bind(
        Topic::Making,
        Modifiers::COMMAND,
        Key::Comma,
        || Command::Scrub(ScrubChange::Step(Unit::Draw, false)),
        "Draw one fewer object",
    ),
    bind(
        Topic::Making,
        Modifiers::COMMAND,
        Key::Period,
        || Command::Scrub(ScrubChange::Step(Unit::Draw, true)),
        "Draw one more object",
    ),
    bind(
        Topic::Making,
        Modifiers::SHIFT,
        Key::Comma,
        || Command::Scrub(ScrubChange::Step(Unit::Fragment, false)),
        "Draw one fewer fragment",
    ),
    bind(
        Topic::Making,
        Modifiers::SHIFT,
        Key::Period,
        || Command::Scrub(ScrubChange::Step(Unit::Fragment, true)),
        "Draw one more fragment",
    ),
    bind(
        Topic::Making,
        Modifiers::SHIFT,
        Key::Space,
        || Command::Scrub(ScrubChange::Play(false)),
        "Play backwards, or pause",
    ),
    bind(
        Topic::Making,
        Modifiers::NONE,
        Key::Space,
        || Command::Scrub(ScrubChange::Play(true)),
        "Play back how the frame was drawn, or pause",
    ),
    bind(
        Topic::Making,
        Modifiers::NONE,
        Key::Y,
        || Command::Scrub(ScrubChange::Touching(None)),
        "Step only through triangles and fragments at the picked pixel, or through all of them",
    ),
    bind(
        Topic::Scene,
        Modifiers::COMMAND,
        Key::Space,
        || Command::SceneTime(SceneTimeChange::TogglePlay),
        "Play the animated scene, or pause",
    )
    .also(&["animation", "time", "motion"]),
    bind(
        Topic::Scene,
        Modifiers::ALT,
        Key::Comma,
        || Command::SceneTime(SceneTimeChange::Step(-1)),
        "Show the previous frame of the animated scene",
    ),
    bind(
        Topic::Scene,
        Modifiers::ALT,
        Key::Period,
        || Command::SceneTime(SceneTimeChange::Step(1)),
        "Show the next frame of the animated scene",
    ),
    bind(Topic::Making, Modifiers::NONE, Key::Comma, || Command::StepTriangle(-1), "Draw one fewer triangle"),
    bind(Topic::Making, Modifiers::NONE, Key::Period, || Command::StepTriangle(1), "Draw one more triangle"),
    bind(Topic::Pixel, Modifiers::SHIFT, Key::J, || Command::StepFault(-1), "Go to the previous faulty pixel"),
    bind(Topic::Pixel, Modifiers::NONE, Key::J, || Command::StepFault(1), "Go to the next faulty pixel"),
    bind(
        Topic::Showing,
        Modifiers::NONE,
        Key::O,
        || Command::Overlays(OverlayChange::ToggleOpen),
        "Show or hide the list of overlays",
    ),
    bind(
        Topic::Showing,
        Modifiers::SHIFT,
        Key::N,
        || Command::Range(RangeChange::FitVisible),
        "Fit the value range to the visible part of the picture",
    ),
    bind(
        Topic::Showing,
        Modifiers::NONE,
        Key::N,
        || Command::Range(RangeChange::Fit(RangeFit::All)),
        "Fit the value range to all values of the picture",
    ),
    bind(
        Topic::Showing,
        Modifiers::SHIFT,
        Key::R,
        || Command::Range(RangeChange::DrawRegion(true)),
        "Draw a rectangle, to show the statistics of its pixels",
    )
    .also(&["crop", "region", "selection", "average"]),
    bind(
        Topic::Making,
        Modifiers::NONE,
        Key::Home,
        || Command::LimitTriangles(Some(0)),
        "Go to the start, before the first triangle",
    ),
    bind(
        Topic::Making,
        Modifiers::NONE,
        Key::End,
        || Command::LimitTriangles(None),
        "Go to the end, after the last triangle",
    ),
    bind(
        Topic::Scene,
        Modifiers::COMMAND,
        Key::ArrowLeft,
        || Command::Orbit(-1, 0),
        "Orbit the camera by 5°: the scene turns left",
    ),
    bind(
        Topic::Scene,
        Modifiers::COMMAND,
        Key::ArrowRight,
        || Command::Orbit(1, 0),
        "Orbit the camera by 5°: the scene turns right",
    ),
    bind(
        Topic::Scene,
        Modifiers::COMMAND,
        Key::ArrowUp,
        || Command::Orbit(0, -1),
        "Orbit the camera by 5°: the scene turns up",
    ),
    bind(
        Topic::Scene,
        Modifiers::COMMAND,
        Key::ArrowDown,
        || Command::Orbit(0, 1),
        "Orbit the camera by 5°: the scene turns down",
    ),
    bind(
        Topic::Pixel,
        Modifiers::SHIFT,
        Key::ArrowLeft,
        || Command::NudgePick(-10, 0),
        "Pick the pixel 10 px to the left",
    ),
    bind(
        Topic::Pixel,
        Modifiers::SHIFT,
        Key::ArrowRight,
        || Command::NudgePick(10, 0),
        "Pick the pixel 10 px to the right",
    ),
    bind(Topic::Pixel, Modifiers::SHIFT, Key::ArrowUp, || Command::NudgePick(0, -10), "Pick the pixel 10 px above"),
    bind(Topic::Pixel, Modifiers::SHIFT, Key::ArrowDown, || Command::NudgePick(0, 10), "Pick the pixel 10 px below"),
    bind(
        Topic::Pixel,
        Modifiers::NONE,
        Key::ArrowLeft,
        || Command::NudgePick(-1, 0),
        "Pick the pixel 1 px to the left",
    ),
    bind(
        Topic::Pixel,
        Modifiers::NONE,
        Key::ArrowRight,
        || Command::NudgePick(1, 0),
        "Pick the pixel 1 px to the right",
    ),
    bind(Topic::Pixel, Modifiers::NONE, Key::ArrowUp, || Command::NudgePick(0, -1), "Pick the pixel 1 px above"),
    bind(Topic::Pixel, Modifiers::NONE, Key::ArrowDown, || Command::NudgePick(0, 1), "Pick the pixel 1 px below"),
    bind(Topic::Settings, Modifiers::NONE, Key::Num1, || Command::ChooseUpscaler(0), "Choose an upscaler"),
    bind(Topic::Settings, Modifiers::NONE, Key::Num2, || Command::ChooseUpscaler(1), "Choose an upscaler"),
    bind(Topic::Settings, Modifiers::NONE, Key::Num3, || Command::ChooseUpscaler(2), "Choose an upscaler"),
    bind(Topic::Settings, Modifiers::NONE, Key::Num4, || Command::ChooseUpscaler(3), "Choose an upscaler"),
    bind(Topic::Settings, Modifiers::NONE, Key::Num5, || Command::ChooseUpscaler(4), "Choose an upscaler"),
    bind(Topic::Settings, Modifiers::NONE, Key::Num6, || Command::ChooseUpscaler(5), "Choose an upscaler"),
    bind(Topic::Settings, Modifiers::NONE, Key::Num7, || Command::ChooseUpscaler(6), "Choose an upscaler"),
    bind(Topic::Settings, Modifiers::NONE, Key::Num8, || Command::ChooseUpscaler(7), "Choose an upscaler"),
    bind(Topic::Settings, Modifiers::NONE, Key::Num9, || Command::ChooseUpscaler(8), "Choose an upscaler"),
    bind(
        Topic::Comparing,
        Modifiers::NONE,
        Key::T,
        || Command::Compare(CompareChange::Toggle(Mode::Tiles)),
        "Compare pictures in tiles, or stop comparing",
    ),
    bind(
        Topic::Comparing,
        Modifiers::NONE,
        Key::W,
        || Command::Compare(CompareChange::Toggle(Mode::Wipe)),
        "Wipe between pictures A and B, or stop comparing",
    ),
    bind(
        Topic::Comparing,
        Modifiers::NONE,
        Key::B,
        || Command::Compare(CompareChange::Toggle(Mode::Flip)),
        "Flip between pictures A and B, or stop comparing",
    ),
    bind(
        Topic::Comparing,
        Modifiers::NONE,
        Key::D,
        || Command::Compare(CompareChange::Toggle(Mode::Difference)),
        "Show the difference between pictures A and B, or stop comparing",
    ),
    bind(
        Topic::Comparing,
        Modifiers::NONE,
        Key::X,
        || Command::WhatIf(WhatIfChange::Toggle),
        "Show the effect of the last change of a setting, or stop comparing",
    ),
    bind(Topic::Comparing, Modifiers::NONE, Key::S, || Command::Compare(CompareChange::Swap), "Swap pictures A and B"),
    bind(
        Topic::Comparing,
        Modifiers::NONE,
        Key::R,
        || Command::Compare(CompareChange::ToggleRegion),
        "Reset the value range; while comparing, draw a rectangle to measure",
    ),
    bind(
        Topic::General,
        Modifiers::NONE,
        Key::L,
        || Command::Lab(LabChange::Toggle),
        "Switch between the 2D lab and the pipeline",
    ),
    bind(
        Topic::General,
        Modifiers::NONE,
        Key::K,
        || Command::Lab(LabChange::TogglePlay),
        "Play the steps of the 2D lab, or stop",
    ),
    bind(
        Topic::Arithmetic,
        Modifiers::SHIFT,
        Key::F10,
        || Command::Trace(TraceChange::Step(-1)),
        "Go to the previous line of the calculation",
    ),
    bind(
        Topic::Arithmetic,
        Modifiers::NONE,
        Key::F10,
        || Command::Trace(TraceChange::Step(1)),
        "Go to the next line of the calculation",
    ),
    bind(
        Topic::Arithmetic,
        Modifiers::SHIFT,
        Key::F5,
        || Command::Trace(TraceChange::Run(None, StepDirection::Back)),
        "Go to the previous flagged line of the calculation",
    ),
    bind(
        Topic::Arithmetic,
        Modifiers::NONE,
        Key::F5,
        || Command::Trace(TraceChange::Run(None, StepDirection::Forward)),
        "Go to the next flagged line of the calculation",
    ),
    bind(
        Topic::Arithmetic,
        Modifiers::SHIFT,
        Key::F11,
        || Command::Trace(TraceChange::Stage(StepDirection::Back)),
        "Go to the previous stage of the calculation",
    ),
    bind(
        Topic::Arithmetic,
        Modifiers::NONE,
        Key::F11,
        || Command::Trace(TraceChange::Stage(StepDirection::Forward)),
        "Go to the next stage of the calculation",
    ),
    bind(
        Topic::Scene,
        Modifiers::NONE,
        Key::M,
        || Command::MeshView(MeshViewChange::Toggle),
        "Show or hide the mesh view",
    ),
    bind(
        Topic::Scene,
        Modifiers::NONE,
        Key::C,
        || Command::Canvas(CanvasChange::TogglePointerMode(PointerMode::Camera)),
        "Turn camera mode on or off: dragging orbits, the wheel dollies, W A S D Q E fly",
    )
    .also(&["fly", "wasd", "first person"]),
    bind(
        Topic::Scene,
        Modifiers::NONE,
        Key::P,
        || Command::Canvas(CanvasChange::TogglePointerMode(PointerMode::Pan)),
        "Turn pan mode on or off: dragging pans the picture",
    )
    .also(&["pan", "hand tool", "scroll"]),
    bind(Topic::Scene, Modifiers::NONE, Key::H, || Command::ResetCamera, "Return to the scene's home view")
        .also(&["home", "reset camera"]),
    bind(Topic::Pixel, Modifiers::NONE, Key::Enter, || Command::Watch(WatchChange::AddPick), "Watch the picked pixel"),
    bind(
        Topic::Pixel,
        Modifiers::NONE,
        Key::Escape,
        || Command::Escape,
        "Clear the selection; without one, stop comparing; otherwise show the finished picture",
    ),
    bind(
        Topic::General,
        Modifiers::SHIFT,
        Key::Slash,
        || Command::Dialog(DialogCommand::Keys),
        "Show all keys and mouse gestures",
    )
    .also(&["shortcuts", "hotkeys", "controls"]),
    bind(
        Topic::General,
        Modifiers::NONE,
        Key::Questionmark,
        || Command::Dialog(DialogCommand::Keys),
        "Show all keys and mouse gestures",
    ),
    bind(
        Topic::General,
        Modifiers::NONE,
        Key::F1,
        || Command::Dialog(DialogCommand::Manual(None)),
        "Open and search the manual",
    )
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

/// Command that has no key, but a name by which the palette finds it.
pub(crate) struct KeylessCommand {
    /// Title in the palette.
    pub(crate) title: &'static str,
    /// Constructor of the command.
    pub(crate) command: fn() -> Command,
    /// Other words for the command, in lower case, by which the palette finds it.
    pub(crate) synonyms: &'static [&'static str],
}

const fn keyless(title: &'static str, command: fn() -> Command) -> KeylessCommand {
    KeylessCommand { title, command, synonyms: &[] }
}

impl KeylessCommand {
    /// Returns the command with other words for it, in lower case, by which the palette finds it.
    const fn also(self, synonyms: &'static [&'static str]) -> Self {
        Self { synonyms, ..self }
    }
}

/// Commands that have no key, in the order of the palette. Commands on items of a list, such as scenes, follow from the
/// list and are not included.
pub(crate) const KEYLESS: &[KeylessCommand] = &[
    keyless("Fit the scene into the view", || Command::FitCamera).also(&["frame all"]),
    keyless("Mirror the scene along z", || Command::MirrorZ).also(&["handedness", "flip z"]),
    keyless("Reset all settings", || Command::ResetRecipe).also(&["reset", "defaults"]),
    keyless("Save the picked triangle as a case file", || Command::File(FileCommand::SaveCase)),
    keyless("Restart upscaler processes", || Command::RestartUpscalers).also(&["external", "retry"]),
    keyless("Switch between dark and light theme", || Command::Appearance(AppearanceChange::ToggleTheme))
        .also(&["dark mode", "light mode"]),
    keyless("Reduce motion", || Command::Appearance(AppearanceChange::ToggleMotion)).also(&[
        "animation",
        "accessibility",
        "blinking",
        "smooth scrolling",
    ]),
    keyless("Add key view to the camera path", || Command::CameraPath(CameraPathChange::Add)).also(&[
        "record",
        "keyframe",
        "animation",
    ]),
    keyless("Remove key view of the camera path", || Command::CameraPath(CameraPathChange::Remove)),
    keyless("Remove the camera path", || Command::CameraPath(CameraPathChange::Clear)),
    keyless("Measure errors over time", || Command::OverTime(OverTimeChange::Measure)).also(&["flicker", "motion"]),
    keyless("Manage bookmarks", || Command::Dialog(DialogCommand::Bookmarks)),
    keyless("Compare all upscalers in tiles", || Command::Compare(CompareChange::Every(None))),
    keyless("Earlier frames of the picked pixel", || Command::Temporal(TemporalChange::Toggle)).also(&[
        "history",
        "ghosting",
        "contribution",
    ]),
    keyless("Filmstrip of all upscaling methods", || Command::Filmstrip(FilmstripChange::Toggle)).also(&["thumbnails"]),
    keyless("Pin the current settings as A and compare later changes with them", || {
        Command::WhatIf(WhatIfChange::PinNow)
    }),
    keyless("Restore the settings from before the last change", || Command::WhatIf(WhatIfChange::Revert)),
    keyless("Save the compared pictures and their errors as an HTML page", || {
        Command::File(FileCommand::SaveComparison)
    }),
    keyless("Stop comparing", || Command::Compare(CompareChange::Mode(Mode::Off))),
    keyless("Add an upscaler process…", || Command::Dialog(DialogCommand::AddUpscaler))
        .also(&["external", "python", "plugin", "custom"]),
    keyless("Measure all upscalers", || Command::Measure(MeasureCommand::MeasureUpscalers)).also(&["profile"]),
    keyless("Measure the savings of skipped work", || Command::Measure(MeasureCommand::MeasurePlan)),
    keyless("Measure scaling", || Command::Measure(MeasureCommand::MeasureScaling)),
    keyless("Run the stability report", || Command::Measure(MeasureCommand::RunStability)),
    keyless("Save all frame times as CSV", || Command::Timings(TimingsChange::Export)).also(&["csv"]),
    keyless("Match the picture size to the window", || Command::SetSize(PictureSize::MatchWindow))
        .also(&["resolution"]),
    keyless("Show the start card", || Command::Onboarding(OnboardingChange::OpenCard)).also(&["welcome", "examples"]),
    keyless("Start the introduction in four steps", || Command::Onboarding(OnboardingChange::StartCoach))
        .also(&["tutorial", "tour", "coach"]),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_binding_is_hidden_by_an_earlier_one() {
        for (place, binding) in BINDINGS.iter().enumerate() {
            // The toolkit reports Ctrl as both `ctrl` and `command`.
            let pressed = Modifiers { ctrl: binding.modifiers.command, ..binding.modifiers };
            let hides =
                |earlier: &&KeyBinding| earlier.key == binding.key && pressed.matches_logically(earlier.modifiers);
            let hiding = BINDINGS[..place].iter().find(hides).map(|earlier| earlier.description);
            assert_eq!(hiding, None, "{}", binding.description);
        }
    }
}
