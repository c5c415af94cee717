//! Table of the keys of the window.

use eframe::egui::{Key, Modifiers};

use super::{KeyBinding, Topic};
use crate::inspect::range::RangeFit;
use crate::inspect::scrub::Unit;
use crate::inspect::trace::StepDirection;
use crate::ui::session::PointerMode;
use crate::ui::session::canvas_state::CanvasChange;
use crate::ui::session::command::Command;
use crate::ui::session::compare::{CompareChange, Mode};
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::lab::LabChange;
use crate::ui::session::mesh_view::MeshViewChange;
use crate::ui::session::overlays::OverlayChange;
use crate::ui::session::place::PlaceChange;
use crate::ui::session::range::RangeChange;
use crate::ui::session::save_item::SaveItem;
use crate::ui::session::scene_time::SceneTimeChange;
use crate::ui::session::scrub::ScrubChange;
use crate::ui::session::stages::StageChange;
use crate::ui::session::trace::TraceChange;
use crate::ui::session::watch::WatchChange;
use crate::ui::session::what_if::WhatIfChange;
use crate::ui::session::window_task::DialogCommand;
use crate::ui::session::workspace::{Workspace, WorkspaceChange};

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
