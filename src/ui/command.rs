//! What a person can ask the window to do, and the keys that ask it.
//!
//! Widgets and keys push [`Command`]s; nothing is changed while a frame of the window is being laid out. The key map is
//! one table: shortcuts, tooltips and the key sheet read it.

use std::path::PathBuf;

use eframe::egui::{Key, KeyboardShortcut, Modifiers};

use super::checks;
use super::compare::{Change, Mode};
use super::engine::Shown;
use super::fates;
use super::judging::StabilityView;
use super::lab;
use super::mesh_view;
use super::overlays;
use super::panels::bottom::Tab;
use super::place;
use super::probe;
use super::range;
use super::scrub;
use super::session::{PictureSize, PointerMode};
use super::timings::TimingsView;
use super::trace;
use super::vertices;
use super::watch;
use super::what_if;
use crate::chain::Recipe;
use crate::inspect::outline::OutlineKind;
use crate::inspect::range::Fit;
use crate::inspect::scrub::Unit;
use crate::inspect::selection::TriangleSelection;
use crate::inspect::trace::Direction;
use crate::measure::motion::Turn;
use crate::report::stability::column::Column;
use crate::scene::Camera;
use crate::scene::obj::TrMeaning;

/// An intent.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Ask for a model to open.
    AskForFile,
    /// Open a model.
    Open(PathBuf),
    /// Load a model again with another meaning of `Tr`.
    Reopen(PathBuf, TrMeaning),
    /// Show a built-in scene, by id.
    OpenBuiltin(String),
    /// Show the mirror image in z.
    MirrorZ,
    /// Close the case that is open.
    CloseCase,
    /// Show this part of the open case.
    ShowPart(usize),
    /// Open the worst case of a configuration, as JSON, with that configuration chosen.
    OpenWorst(Column, String),
    /// Save the triangle that the picked pixel shows as a case of its own.
    SaveCase,
    /// Judge the engine on all classes of hard cases.
    RunStability,
    /// Stop judging.
    CancelStability,
    /// Show the report this way.
    ShowStability(StabilityView),
    /// Measure what the plan of the present view saves.
    MeasurePlan,
    /// Stop measuring that.
    CancelPlan,
    /// Change what is known of how firmly the picture stands.
    Probe(probe::Change),
    /// Change what of the vertices is shown.
    Vertices(vertices::Change),
    /// Change how the scene is seen from outside.
    MeshView(mesh_view::Change),
    /// Measure how cost grows with triangles, pixels, layers and threads.
    MeasureGrowth,
    /// Stop measuring that.
    CancelGrowth,
    /// Stop waiting for a model.
    CancelLoading,
    /// Cancel the export of drawings.
    CancelExport,
    /// Draw by this recipe.
    SetRecipe(Recipe),
    /// Draw with the upscaler that stands at this place of the list.
    ChooseUpscaler(usize),
    /// Change what is compared.
    Compare(Change),
    /// Draw by the default recipe.
    ResetRecipe,
    /// Look from here.
    SetCamera(Camera),
    /// Look from where the scene starts.
    ResetCamera,
    /// Move so that everything is seen.
    FitCamera,
    /// Make the picture this large.
    SetSize(PictureSize),
    /// Question this pixel, or none.
    Pick(Option<(u32, u32)>),
    /// Question the pixel so far to the right and down.
    NudgePick(i64, i64),
    /// Show this on the canvas.
    Show(Shown),
    /// Show a later or an earlier stage.
    StepStage(i64),
    /// Question a later or an earlier crack or double hit, and show it enlarged.
    StepFault(i64),
    /// Draw only the first triangles.
    LimitTriangles(Option<usize>),
    /// Draw more or fewer triangles.
    StepTriangle(i64),
    /// Change what the pointer does.
    SetPointerMode(PointerMode),
    /// Change to the other pointer mode.
    TogglePointerMode,
    /// Enlarge the picture to fit the canvas.
    ZoomFit,
    /// One picture pixel per screen pixel.
    ZoomOne,
    /// Time every upscaler.
    Measure,
    /// Stop timing.
    CancelMeasure,
    /// Judge and time upscalers over this motion of the camera.
    MeasureOver(Turn),
    /// Plot frame times this way.
    ShowTimings(TimingsView),
    /// Take in no more recent frame times, or do so again.
    PauseTimings,
    /// Write all frame times into a file.
    ExportTimings,
    /// Forget all frame times.
    ClearTimings,
    /// Save the picture that the canvas shows.
    SavePicture,
    /// Save the exact values of what the canvas shows as floats.
    SaveData,
    /// Save the scene as drawing commands, in the format of this end of a file name.
    SaveOutline(OutlineKind, &'static str),
    /// Put the picture on the clipboard.
    CopyPicture,
    /// Take back the last change of a setting.
    Undo,
    /// Make it again.
    Redo,
    /// Open the picture of a file in the 2D lab.
    OpenInLab(PathBuf),
    /// Close the offer to open a picture in the 2D lab.
    CloseOffer,
    /// Close the error bar.
    CloseError,
    /// Close the first hint.
    CloseHint,
    /// Switch between dark and light.
    ToggleTheme,
    /// Make the whole interface larger or smaller.
    SetScale(f32),
    /// Show or hide the key sheet.
    ToggleKeys,
    /// Ask for a pixel to go to.
    AskForPixel,
    /// Drop what is selected, innermost first.
    Escape,
    /// Change what is laid over the picture.
    Overlays(overlays::Change),
    /// Change the range or the colours of what is shown.
    Range(range::Change),
    /// Show the lab, or the pipeline again.
    ToggleLab,
    /// Change something in the lab.
    Lab(lab::Change),
    /// Change what is checked.
    Checks(checks::Change),
    /// Step through the arithmetic of the picked pixel.
    Trace(trace::Change),
    /// Go through the making of the frame.
    Scrub(scrub::Change),
    /// Ask for triangles by how they ended.
    Fates(fates::Change),
    /// Select these triangles in the picture, or none.
    Select(TriangleSelection),
    /// Open a tab along the bottom.
    OpenTab(Tab),
    /// Show the switches of all stages, or of none.
    OpenStages(bool),
    /// Open the palette, where everything is found by a few letters.
    OpenPalette,
    /// Ask what the last change of the settings did.
    WhatIf(what_if::Change),
    /// Change which pixels are watched.
    Watch(watch::Change),
    /// Keep a place, or go to one.
    Place(place::Change),
}

/// A key, what it does, and the words for it.
pub struct Binding {
    /// The key.
    pub key: Key,
    /// With these held.
    pub modifiers: Modifiers,
    /// Makes the command.
    pub command: fn() -> Command,
    /// What it does.
    pub what: &'static str,
}

const fn bind(modifiers: Modifiers, key: Key, command: fn() -> Command, what: &'static str) -> Binding {
    Binding { key, modifiers, command, what }
}

/// Control and shift.
const CONTROL_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// A key that goes to a bookmark.
const fn jump(key: Key, command: fn() -> Command) -> Binding {
    bind(Modifiers::COMMAND, key, command, "Go to a bookmark")
}

impl Binding {
    /// As the toolkit writes it.
    pub fn shortcut(&self) -> KeyboardShortcut {
        KeyboardShortcut::new(self.modifiers, self.key)
    }
}

/// The key map. Later entries of one key have fewer modifiers, so the first match is the right one.
pub const BINDINGS: &[Binding] = &[
    bind(Modifiers::COMMAND, Key::O, || Command::AskForFile, "Open a model or a case"),
    bind(
        Modifiers::COMMAND.plus(Modifiers::SHIFT),
        Key::S,
        || Command::SaveData,
        "Save the exact values as floats (PFM)",
    ),
    bind(Modifiers::COMMAND, Key::S, || Command::SavePicture, "Save the picture as PNG"),
    bind(CONTROL_SHIFT, Key::C, || Command::Place(place::Change::Copy), "Copy as command: all of this in one line"),
    bind(Modifiers::COMMAND, Key::C, || Command::CopyPicture, "Copy the picture"),
    bind(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z, || Command::Redo, "Redo"),
    bind(Modifiers::COMMAND, Key::Z, || Command::Undo, "Undo the last setting"),
    bind(Modifiers::COMMAND, Key::G, || Command::AskForPixel, "Go to a pixel, triangle, vertex or object"),
    bind(CONTROL_SHIFT, Key::P, || Command::OpenPalette, "Find anything"),
    bind(Modifiers::COMMAND, Key::B, || Command::Place(place::Change::Bookmark), "Bookmark this place"),
    jump(Key::Num1, || Command::Place(place::Change::Jump(0))),
    jump(Key::Num2, || Command::Place(place::Change::Jump(1))),
    jump(Key::Num3, || Command::Place(place::Change::Jump(2))),
    jump(Key::Num4, || Command::Place(place::Change::Jump(3))),
    jump(Key::Num5, || Command::Place(place::Change::Jump(4))),
    jump(Key::Num6, || Command::Place(place::Change::Jump(5))),
    jump(Key::Num7, || Command::Place(place::Change::Jump(6))),
    jump(Key::Num8, || Command::Place(place::Change::Jump(7))),
    jump(Key::Num9, || Command::Place(place::Change::Jump(8))),
    bind(Modifiers::ALT, Key::ArrowLeft, || Command::Place(place::Change::Back), "Back to what was looked at before"),
    bind(Modifiers::ALT, Key::ArrowRight, || Command::Place(place::Change::Forward), "Forward again"),
    bind(Modifiers::NONE, Key::F, || Command::ZoomFit, "Fit the picture into the canvas"),
    bind(Modifiers::NONE, Key::Num0, || Command::ZoomOne, "One picture pixel per screen pixel"),
    bind(Modifiers::NONE, Key::OpenBracket, || Command::StepStage(-1), "Show the stage before"),
    bind(Modifiers::NONE, Key::CloseBracket, || Command::StepStage(1), "Show the stage after"),
    bind(Modifiers::COMMAND, Key::Comma, || Command::Scrub(scrub::Change::Step(Unit::Draw, false)), "One object fewer"),
    bind(Modifiers::COMMAND, Key::Period, || Command::Scrub(scrub::Change::Step(Unit::Draw, true)), "One object more"),
    bind(
        Modifiers::SHIFT,
        Key::Comma,
        || Command::Scrub(scrub::Change::Step(Unit::Fragment, false)),
        "One fragment fewer",
    ),
    bind(
        Modifiers::SHIFT,
        Key::Period,
        || Command::Scrub(scrub::Change::Step(Unit::Fragment, true)),
        "One fragment more",
    ),
    bind(Modifiers::SHIFT, Key::Space, || Command::Scrub(scrub::Change::Play(false)), "Play backwards, or pause"),
    bind(
        Modifiers::NONE,
        Key::Space,
        || Command::Scrub(scrub::Change::Play(true)),
        "Play how the frame comes about, or pause",
    ),
    bind(
        Modifiers::NONE,
        Key::Y,
        || Command::Scrub(scrub::Change::Touching(None)),
        "Step only to what touches the picked pixel, or to all",
    ),
    bind(Modifiers::NONE, Key::Comma, || Command::StepTriangle(-1), "One triangle fewer"),
    bind(Modifiers::NONE, Key::Period, || Command::StepTriangle(1), "One triangle more"),
    bind(Modifiers::SHIFT, Key::J, || Command::StepFault(-1), "Previous faulty pixel of what is shown"),
    bind(Modifiers::NONE, Key::J, || Command::StepFault(1), "Next faulty pixel of what is shown"),
    bind(
        Modifiers::NONE,
        Key::O,
        || Command::Overlays(overlays::Change::ToggleOpen),
        "Show or hide the list of overlays",
    ),
    bind(Modifiers::SHIFT, Key::N, || Command::Range(range::Change::FitVisible), "Fit the range to what is on screen"),
    bind(Modifiers::NONE, Key::N, || Command::Range(range::Change::Fit(Fit::All)), "Fit the range to all values"),
    bind(Modifiers::NONE, Key::Home, || Command::LimitTriangles(Some(0)), "Before the first triangle"),
    bind(Modifiers::NONE, Key::End, || Command::LimitTriangles(None), "After the last triangle"),
    bind(Modifiers::SHIFT, Key::ArrowLeft, || Command::NudgePick(-10, 0), "Picked pixel 10 to the left"),
    bind(Modifiers::SHIFT, Key::ArrowRight, || Command::NudgePick(10, 0), "Picked pixel 10 to the right"),
    bind(Modifiers::SHIFT, Key::ArrowUp, || Command::NudgePick(0, -10), "Picked pixel 10 up"),
    bind(Modifiers::SHIFT, Key::ArrowDown, || Command::NudgePick(0, 10), "Picked pixel 10 down"),
    bind(Modifiers::NONE, Key::ArrowLeft, || Command::NudgePick(-1, 0), "Picked pixel to the left"),
    bind(Modifiers::NONE, Key::ArrowRight, || Command::NudgePick(1, 0), "Picked pixel to the right"),
    bind(Modifiers::NONE, Key::ArrowUp, || Command::NudgePick(0, -1), "Picked pixel up"),
    bind(Modifiers::NONE, Key::ArrowDown, || Command::NudgePick(0, 1), "Picked pixel down"),
    bind(Modifiers::NONE, Key::Num1, || Command::ChooseUpscaler(0), "Choose the upscaler"),
    bind(Modifiers::NONE, Key::Num2, || Command::ChooseUpscaler(1), "Choose the upscaler"),
    bind(Modifiers::NONE, Key::Num3, || Command::ChooseUpscaler(2), "Choose the upscaler"),
    bind(Modifiers::NONE, Key::Num4, || Command::ChooseUpscaler(3), "Choose the upscaler"),
    bind(Modifiers::NONE, Key::Num5, || Command::ChooseUpscaler(4), "Choose the upscaler"),
    bind(Modifiers::NONE, Key::Num6, || Command::ChooseUpscaler(5), "Choose the upscaler"),
    bind(Modifiers::NONE, Key::Num7, || Command::ChooseUpscaler(6), "Choose the upscaler"),
    bind(Modifiers::NONE, Key::Num8, || Command::ChooseUpscaler(7), "Choose the upscaler"),
    bind(Modifiers::NONE, Key::Num9, || Command::ChooseUpscaler(8), "Choose the upscaler"),
    bind(Modifiers::NONE, Key::T, || Command::Compare(Change::Toggle(Mode::Tiles)), "Compare in tiles, and back"),
    bind(Modifiers::NONE, Key::W, || Command::Compare(Change::Toggle(Mode::Wipe)), "Wipe A over B, and back"),
    bind(Modifiers::NONE, Key::B, || Command::Compare(Change::Toggle(Mode::Flip)), "Flip between A and B, and back"),
    bind(Modifiers::NONE, Key::D, || Command::Compare(Change::Toggle(Mode::Difference)), "Difference, and back"),
    bind(Modifiers::NONE, Key::X, || Command::WhatIf(what_if::Change::Toggle), "What did the last change do? And back"),
    bind(Modifiers::NONE, Key::S, || Command::Compare(Change::Swap), "Swap A and B"),
    bind(
        Modifiers::NONE,
        Key::R,
        || Command::Compare(Change::ToggleRegion),
        "Reset the range; comparing: drag a rectangle to measure",
    ),
    bind(Modifiers::NONE, Key::L, || Command::ToggleLab, "The 2D lab, and back to the pipeline"),
    bind(Modifiers::NONE, Key::K, || Command::Lab(lab::Change::TogglePlay), "Play the steps of the lab, or stop"),
    bind(Modifiers::SHIFT, Key::F10, || Command::Trace(trace::Change::Step(-1)), "Arithmetic: one line back"),
    bind(Modifiers::NONE, Key::F10, || Command::Trace(trace::Change::Step(1)), "Arithmetic: one line forward"),
    bind(
        Modifiers::SHIFT,
        Key::F5,
        || Command::Trace(trace::Change::Run(None, Direction::Back)),
        "Arithmetic: back to the last notable line",
    ),
    bind(
        Modifiers::NONE,
        Key::F5,
        || Command::Trace(trace::Change::Run(None, Direction::Forward)),
        "Arithmetic: on to the next notable line",
    ),
    bind(
        Modifiers::SHIFT,
        Key::F11,
        || Command::Trace(trace::Change::Stage(Direction::Back)),
        "Arithmetic: the stage before",
    ),
    bind(
        Modifiers::NONE,
        Key::F11,
        || Command::Trace(trace::Change::Stage(Direction::Forward)),
        "Arithmetic: the next stage",
    ),
    bind(Modifiers::NONE, Key::M, || Command::MeshView(mesh_view::Change::Toggle), "The scene from outside, and back"),
    bind(Modifiers::NONE, Key::C, || Command::TogglePointerMode, "Camera mode and back"),
    bind(Modifiers::NONE, Key::H, || Command::ResetCamera, "Back to the scene's own view"),
    bind(Modifiers::NONE, Key::Enter, || Command::Watch(watch::Change::AddPick), "Watch the picked pixel"),
    bind(Modifiers::NONE, Key::Escape, || Command::Escape, "Drop the pick, then the stage or buffer shown"),
    bind(Modifiers::SHIFT, Key::Slash, || Command::ToggleKeys, "Show the keys"),
    bind(Modifiers::NONE, Key::Questionmark, || Command::ToggleKeys, "Show the keys"),
    bind(Modifiers::NONE, Key::F1, || Command::ToggleKeys, "Show the keys"),
];

/// What the mouse does, for the key sheet.
pub const MOUSE: &[(&str, &str)] = &[
    ("Click", "Question the pixel; it stays picked"),
    ("Right-drag", "Question pixels along the way"),
    ("Wheel", "Enlarge the picture at the pointer"),
    ("Drag", "Move the picture"),
    ("Middle-drag", "Turn the scene around its target"),
    ("Shift + middle-drag", "Shift the view"),
    ("Ctrl + wheel", "Come closer, go away"),
    ("Hold Alt", "Numbers in pixels as bits"),
    ("Shift + drag", "Figures of a box of the picture"),
    ("Comparing: hold Shift", "See the other picture"),
    ("What changed: hold Shift", "See what was drawn before"),
    ("Comparing: R, then drag", "Measure a rectangle"),
    ("C, then drag, wheel, W A S D Q E", "Camera mode: turn, come closer, fly"),
];
