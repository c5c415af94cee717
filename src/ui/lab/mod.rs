//! State and layout of the 2D lab. Each page has a file for its controls. All pages share the grid, the playback bar,
//! the description of the current step, and the comparison of methods.

mod palette;

mod grid;

mod grid_view;

mod pointer;

mod transport;

mod readout;

mod methods;

mod pages;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::{self, CentralPanel, Panel, ScrollArea, Ui, Vec2};

use super::command::Command;
use super::save_as::SaveItem;
use super::scrub;
use super::theme::{self, ROW_HEIGHT, space};
use crate::image::{Image, Rgba8, file};
use crate::lab::recording::{MethodComparison, Recording, time_of};
use crate::lab::seed_fills::Paint;
use crate::lab::{Lesson, Page};
use crate::manual::Chapter;
use crate::pipeline::settings::Choice as _;
use crate::ui::canvas_state::CanvasChange;
use crate::ui::features::Feature;
use crate::ui::files::FileCommand;
use crate::ui::session::{Session, Severity};
use crate::ui::stages::StageChange;
use crate::ui::window_task::DialogCommand;
use crate::ui::window_task::WindowTask;
use crate::ui::workspace::PanelSpec;
use crate::ui::workspace::Workspace;

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    id: "lab",
    name: "2D lab",
    help: "Step-by-step algorithms for lines, circles, polygons, fills and sampling",
    synonyms: &[],
    chapter: Chapter::Lab,
    grows: true,
    titled: false,
    controls: None,
    content: |ui, cx| self::ui(ui, &cx.session.features.lab, cx.commands),
};

/// Run time below which the algorithm is run repeatedly to measure its time.
const SHORT_RUN: Duration = Duration::from_millis(2);

/// Initial playback speed, in steps per second.
const SPEED: f32 = 12.0;

/// State of the 2D lab.
#[derive(Clone, Debug)]
pub(crate) struct Lab {
    /// Whether the lab replaces the pipeline in the window.
    pub(crate) open: bool,
    /// Page shown in the lab.
    pub(crate) page: Page,
    /// Lesson (input and settings) of each page, including the user's changes, in the order of `Page::ALL`.
    lessons: Vec<Lesson>,
    /// Recorded run of the current page.
    pub(crate) recording: Arc<Recording>,
    /// Number of recorded steps applied to the grid.
    pub(crate) step: usize,
    /// Playback direction: 1 forwards, −1 backwards, 0 paused.
    pub(crate) playing: i64,
    /// Playback speed, in steps per second.
    pub(crate) speed: f32,
    /// Elapsed fraction of the time between two steps during playback, from 0 to 1.
    due: f32,
    /// Duration of one run of the algorithm without recording.
    pub(crate) run_time: Duration,
    /// Comparison of all methods for the same task, if requested.
    pub(crate) comparison: Option<MethodComparison>,
    /// Kind of pixel that the brush paints on the seed fill page.
    pub(crate) brush: Paint,
    /// Scale in points per pixel, and grid position at the centre of the view in pixels; `None` fits the grid into the
    /// window.
    pub(crate) view: Option<(f32, Vec2)>,
}

/// Change to the state of the lab.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LabChange {
    /// Opens the lab if `true`, or returns to the pipeline.
    Open(bool),
    /// Opens the lab, or returns to the pipeline.
    Toggle,
    /// Opens a picture file in the lab. The scene stays loaded and reappears when the lab is closed.
    OpenPicture(PathBuf),
    /// Shows a page of the lab.
    Page(Page),
    /// Sets the input and settings of the current page.
    Set(Box<Lesson>),
    /// Resets the current page to its defaults.
    Reset,
    /// Shows the state after this number of steps.
    Go(usize),
    /// Moves forwards by this number of steps, or backwards if it is negative.
    StepBy(i64),
    /// Plays forwards (1) or backwards (−1), or pauses (0).
    Play(i64),
    /// Toggles playback.
    TogglePlay,
    /// Advances playback by this many seconds.
    Tick(f32),
    /// Sets the playback speed, in steps per second.
    Speed(f32),
    /// Sets the kind of pixel that the brush paints.
    Brush(Paint),
    /// Sets the scale, in points per pixel, and the centre, in pixels, of the grid; `None` fits the grid into the
    /// window.
    View(Option<(f32, Vec2)>),
    /// Runs all methods for the current task, and measures their times and errors.
    Compare,
    /// Closes the comparison of methods.
    CloseComparison,
    /// Loads an image file into the current page, or into the sampling page if the current page does not use images.
    Picture(PathBuf),
    /// Saves the drawing of the current page, in the format with this file name extension.
    Save(&'static str),
}

/// Part of a change that needs a file or the rest of the session.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LabTask {
    /// Opens the lab, or returns to the pipeline.
    Toggle,
    /// Opens a picture file in the lab.
    OpenPicture(PathBuf),
    /// Loads an image file into the current page.
    Picture(PathBuf),
    /// Saves the drawing of the current page, in the format with this file name extension.
    Save(&'static str),
}

impl Default for Lab {
    fn default() -> Self {
        let lessons: Vec<_> = Page::ALL.iter().map(|page| Lesson::new(*page)).collect();
        Self {
            open: false,
            page: Page::Lines,
            lessons,
            recording: Arc::default(),
            step: usize::MAX,
            playing: 0,
            speed: SPEED,
            due: 0.0,
            run_time: Duration::ZERO,
            comparison: None,
            brush: Paint::Wall,
            view: None,
        }
    }
}

impl Lab {
    /// Returns the lesson of the current page.
    pub(crate) fn lesson(&self) -> &Lesson {
        &self.lessons[self.place()]
    }

    fn place(&self) -> usize {
        Page::ALL.iter().position(|page| *page == self.page).unwrap_or(0)
    }

    /// Converts a command for the lab if the lab is open. A command with a counterpart in the lab, such as stepping,
    /// becomes that lab command. A command without meaning in the lab becomes `None`. Any other command is returned
    /// unchanged. Opening a model or a built-in scene also closes the lab.
    pub(crate) fn claim(&mut self, command: Command) -> Option<Command> {
        if !self.open {
            return Some(command);
        }
        let change = match command {
            Command::StepTriangle(step) | Command::NudgePick(step, 0) => LabChange::StepBy(step),
            Command::LimitTriangles(Some(0)) => LabChange::Go(0),
            Command::LimitTriangles(None) => LabChange::Go(usize::MAX),
            Command::Scrub(scrub::ScrubChange::Play(_)) => LabChange::TogglePlay,
            Command::Canvas(CanvasChange::Fit) => LabChange::View(None),
            Command::File(FileCommand::SavePicture) => LabChange::Save("png"),
            Command::File(FileCommand::SaveAs(SaveItem::Picture)) => {
                return Some(Command::File(FileCommand::SaveAs(SaveItem::LabDrawing("png"))));
            }
            Command::File(FileCommand::SaveAs(
                SaveItem::Values
                | SaveItem::Buffers
                | SaveItem::Pixel
                | SaveItem::Outline(..)
                | SaveItem::Case
                | SaveItem::Comparison,
            )) => {
                return None;
            }
            Command::Escape => LabChange::Play(0),
            Command::NudgePick(..)
            | Command::ChooseUpscaler(_)
            | Command::Stage(StageChange::Step(_))
            | Command::Scrub(_)
            | Command::StepFault(_)
            | Command::Canvas(CanvasChange::TogglePointerMode(_))
            | Command::ResetCamera
            | Command::Orbit(..)
            | Command::Dialog(DialogCommand::GoTo)
            | Command::File(FileCommand::CopyPicture)
            | Command::WhatIf(_)
            | Command::Watch(_)
            | Command::Undo
            | Command::Redo
            | Command::Compare(_)
            | Command::Overlays(_)
            | Command::Range(_)
            | Command::MeshView(_)
            | Command::Trace(_)
            | Command::File(FileCommand::SaveData)
            | Command::File(FileCommand::SaveOutline(..))
            | Command::Canvas(CanvasChange::OneToOne) => return None,
            Command::File(FileCommand::Open(path)) if file::is_named_picture(&path) => LabChange::Picture(path),
            Command::File(FileCommand::Open(_)) | Command::File(FileCommand::OpenBuiltin(_)) => {
                self.open = false;
                return Some(command);
            }
            other => return Some(other),
        };
        Some(Command::Lab(change))
    }

    /// Applies a change. Returns a task if the change needs a file or the rest of the session.
    pub(crate) fn apply(&mut self, change: LabChange) -> Option<LabTask> {
        match change {
            LabChange::Open(open) => {
                self.open = open;
                self.playing = 0;
                if open && self.recording.steps.is_empty() {
                    self.run();
                }
            }
            LabChange::Page(page) => {
                self.page = page;
                (self.step, self.playing, self.view, self.comparison) = (usize::MAX, 0, None, None);
                self.run();
            }
            LabChange::Set(lesson) => {
                let place = self.place();
                self.lessons[place] = *lesson;
                self.comparison = None;
                self.run();
            }
            LabChange::Reset => {
                let place = self.place();
                self.lessons[place] = Lesson::new(self.page);
                (self.step, self.view, self.comparison) = (usize::MAX, None, None);
                self.run();
            }
            LabChange::Go(step) => (self.step, self.playing) = (step.min(self.recording.steps.len()), 0),
            LabChange::StepBy(step) => {
                self.playing = 0;
                self.move_by(step);
            }
            LabChange::Play(direction) => self.play(direction),
            LabChange::TogglePlay => self.play(i64::from(self.playing == 0)),
            LabChange::Tick(seconds) => self.tick(seconds),
            LabChange::Speed(speed) => self.speed = speed,
            LabChange::Brush(brush) => self.brush = brush,
            LabChange::View(view) => self.view = view,
            LabChange::Compare => self.comparison = self.lesson().compare(),
            LabChange::CloseComparison => self.comparison = None,
            LabChange::Toggle => return Some(LabTask::Toggle),
            LabChange::OpenPicture(path) => return Some(LabTask::OpenPicture(path)),
            LabChange::Picture(path) => return Some(LabTask::Picture(path)),
            LabChange::Save(extension) => return Some(LabTask::Save(extension)),
        }
        None
    }

    /// Loads an image into the current page, or into the sampling page if the current page does not use images.
    pub(crate) fn show_picture(&mut self, picture: &Image<Rgba8>) {
        let place = self.place();
        if self.lessons[place].set_picture(picture) {
            (self.comparison, self.playing) = (None, 0);
            self.run();
            return;
        }
        for lesson in self.lessons.iter_mut().filter(|lesson| lesson.page() == Page::Sampling) {
            lesson.set_picture(picture);
        }
        self.apply(LabChange::Page(Page::Sampling));
    }

    /// Runs and times the algorithm of the current page. If all steps of the previous run were shown, all new steps are
    /// shown, too.
    fn run(&mut self) {
        let showed_all = self.step >= self.recording.steps.len();
        let lesson = self.lesson();
        let recording = Arc::new(lesson.record());
        let begin = Instant::now();
        let items = lesson.walk();
        let once = begin.elapsed();
        self.run_time = if once < SHORT_RUN && items > 0 { time_of(|| self.lesson().walk()) } else { once };
        self.step = if showed_all { recording.steps.len() } else { self.step.min(recording.steps.len()) };
        self.recording = recording;
    }

    fn move_by(&mut self, steps: i64) {
        let last = self.recording.steps.len() as i64;
        self.step = (self.step as i64).saturating_add(steps).clamp(0, last) as usize;
    }

    fn play(&mut self, direction: i64) {
        let end = self.recording.steps.len();
        // Playing from the end restarts from the beginning.
        match direction {
            1 if self.step >= end => self.step = 0,
            -1 if self.step == 0 => self.step = end,
            _ => {}
        }
        (self.playing, self.due) = (direction, 0.0);
    }

    fn tick(&mut self, seconds: f32) {
        self.due += seconds * self.speed;
        let steps = self.due.floor();
        self.due -= steps;
        self.move_by(self.playing * steps as i64);
        let end = if self.playing > 0 { self.recording.steps.len() } else { 0 };
        if self.step == end {
            self.playing = 0;
        }
    }
}

impl Feature for Lab {
    type Change = LabChange;

    fn apply(session: &mut Session, change: LabChange) -> Option<WindowTask> {
        match session.features.lab.apply(change)? {
            LabTask::Toggle => {
                let is_open = session.features.lab.open;
                session.show_workspace(if is_open { session.features.workspaces.base } else { Workspace::Lab });
            }
            LabTask::OpenPicture(path) => {
                session.features.messages.offered_picture = None;
                if session.open_picture(&path) {
                    session.features.lab.apply(LabChange::Open(true));
                    session.report(Severity::Info, format!("Opened {} in the 2D lab", path.display()));
                }
            }
            LabTask::Picture(path) => drop(session.open_picture(&path)),
            LabTask::Save(extension) => return Some(WindowTask::Save(SaveItem::LabDrawing(extension))),
        }
        None
    }

    fn leave_scene(&mut self) {}
}

impl Session {
    /// Loads a picture file into the canvas of the 2D lab. Returns whether it could be read.
    fn open_picture(&mut self, path: &Path) -> bool {
        match file::read(path) {
            Ok(picture) => {
                self.features.lab.show_picture(&picture);
                true
            }
            Err(error) => {
                self.report(Severity::Error, error.to_string());
                false
            }
        }
    }
}

/// Maximum initial width of each side panel, as a fraction of the window width.
const SIDE_SHARE: f32 = 0.27;

/// Height of the bars above and below the grid, in points.
const BAR_HEIGHT: f32 = ROW_HEIGHT + 12.0;

/// Draws the lab into the area below the menu.
pub(crate) fn ui(ui: &mut Ui, lab: &Lab, commands: &mut Vec<Command>) {
    let mut changes = Vec::new();
    let frame = theme::panel_frame(ui);
    // The grid keeps the largest share even in a narrow window.
    let share = |wanted: f32| wanted.min(ui.available_width() * SIDE_SHARE);
    let (left, right) = (share(264.0), share(316.0));
    if let Some(comparison) = &lab.comparison {
        Panel::bottom("lab rivals").frame(frame).resizable(true).default_size(230.0).min_size(120.0).show(ui, |ui| {
            methods::ui(ui, comparison, &mut changes);
        });
    }
    Panel::left("lab pages").frame(frame).resizable(true).default_size(left).min_size(200.0).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            page_list(ui, lab, &mut changes);
            pages::controls(ui, lab, &mut changes);
        });
    });
    Panel::right("lab readout").frame(frame).resizable(true).default_size(right).min_size(220.0).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| readout::ui(ui, lab, &mut changes, commands));
    });
    CentralPanel::default().frame(theme::canvas_frame(ui)).show(ui, |ui| {
        Panel::top("lab says").frame(frame).exact_size(BAR_HEIGHT).show(ui, |ui| readout::sentence(ui, lab));
        Panel::bottom("lab transport").frame(frame).exact_size(BAR_HEIGHT).show(ui, |ui| {
            transport::ui(ui, lab, &mut changes);
        });
        CentralPanel::no_frame().show(ui, |ui| grid::ui(ui, lab, &mut changes));
    });
    commands.extend(changes.into_iter().map(Command::Lab));
}

fn page_list(ui: &mut Ui, lab: &Lab, changes: &mut Vec<LabChange>) {
    for page in Page::ALL {
        // A growing atom after the name left-aligns it.
        let name = (page.name(), egui::Atom::grow());
        let button = egui::Button::selectable(*page == lab.page, name)
            .min_size(egui::vec2(ui.available_width(), theme::CONTROL_HEIGHT));
        if ui.add(button).on_hover_text(page.help()).clicked() {
            changes.push(LabChange::Page(*page));
        }
    }
    ui.add_space(space::XS);
    ui.separator();
}

#[cfg(test)]
mod tests;
