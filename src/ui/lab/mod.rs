//! The 2D lab in the window: what it knows, and its layout. Each page has a file for its controls; the frame around them is
//! one for all: the grid, the transport, what the step says, and how the rivals compare.

mod palette;

mod grid;

mod pointer;

mod transport;

mod readout;

mod rivals;

mod pages;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::{self, CentralPanel, Panel, ScrollArea, Ui, Vec2};

use super::command::Command;
use super::scrub;
use super::theme::{self, ROW_HEIGHT, space};
use crate::image::{Image, Rgba8, file};
use crate::lab::recording::{Comparison, Recording, time_of};
use crate::lab::seed_fills::Paint;
use crate::lab::{Lesson, Page};
use crate::pipeline::settings::Choice as _;

/// A run shorter than this is timed by repeating it.
const SHORT_RUN: Duration = Duration::from_millis(2);

/// Steps per second when playing begins.
const SPEED: f32 = 12.0;

/// What the lab knows.
#[derive(Clone, Debug)]
pub struct Lab {
    /// Whether it is shown instead of the pipeline.
    pub open: bool,
    /// The page shown.
    pub page: Page,
    /// Each page as it was left.
    lessons: Vec<Lesson>,
    /// The run of the present page.
    pub recording: Arc<Recording>,
    /// Steps shown.
    pub step: usize,
    /// Steps forwards or backwards per tick: −1, 0 or 1.
    pub playing: i64,
    /// Steps per second.
    pub speed: f32,
    /// Part of a step that playing has gained.
    due: f32,
    /// Time of one run without recording.
    pub run_time: Duration,
    /// How the ways to do the same compare, once asked for.
    pub comparison: Option<Comparison>,
    /// What the mouse paints on the page of seed fill.
    pub brush: Paint,
    /// Points per pixel of the grid, and the place in the middle; fitted if none.
    pub view: Option<(f32, Vec2)>,
}

/// What can be asked of it.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// Show it, or the pipeline.
    Open(bool),
    /// Show this page.
    Page(Page),
    /// Change input or settings of the present page.
    Set(Box<Lesson>),
    /// Start the present page anew.
    Reset,
    /// Show so many steps.
    Go(usize),
    /// Show more or fewer steps.
    StepBy(i64),
    /// Play forwards (1), backwards (−1), or stop (0).
    Play(i64),
    /// Play or stop.
    TogglePlay,
    /// Seconds have passed while playing.
    Tick(f32),
    /// Play at so many steps per second.
    Speed(f32),
    /// Paint with this.
    Brush(Paint),
    /// Enlarge and move the grid so; fit it if none.
    View(Option<(f32, Vec2)>),
    /// Run and time all ways to do the same.
    Compare,
    /// Close the comparison.
    CloseComparison,
    /// Make the picture of this file the canvas of the page, or of the one that samples pictures.
    Picture(PathBuf),
    /// Save the drawing in the format of this end of a file name.
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
    /// The present page as it stands.
    pub fn lesson(&self) -> &Lesson {
        &self.lessons[self.place()]
    }

    fn place(&self) -> usize {
        Page::ALL.iter().position(|page| *page == self.page).unwrap_or(0)
    }

    /// While it is open, keys that step and zoom mean the lab, and those of the pipeline mean nothing. `None` for a command
    /// that has no meaning then.
    pub fn claim(&mut self, command: Command) -> Option<Command> {
        if !self.open {
            return Some(command);
        }
        let change = match command {
            Command::StepTriangle(step) | Command::NudgePick(step, 0) => Change::StepBy(step),
            Command::LimitTriangles(Some(0)) => Change::Go(0),
            Command::LimitTriangles(None) => Change::Go(usize::MAX),
            Command::Scrub(scrub::Change::Play(_)) => Change::TogglePlay,
            Command::ZoomFit => Change::View(None),
            Command::SavePicture => Change::Save("png"),
            Command::Escape => Change::Play(0),
            Command::NudgePick(..)
            | Command::ChooseUpscaler(_)
            | Command::StepStage(_)
            | Command::Scrub(_)
            | Command::StepFault(_)
            | Command::TogglePointerMode
            | Command::ResetCamera
            | Command::AskForPixel
            | Command::CopyPicture
            | Command::WhatIf(_)
            | Command::Watch(_)
            | Command::Undo
            | Command::Redo
            | Command::Compare(_)
            | Command::Overlays(_)
            | Command::Range(_)
            | Command::MeshView(_)
            | Command::Trace(_)
            | Command::SaveData
            | Command::SaveOutline(..)
            | Command::ZoomOne => return None,
            Command::Open(path) if file::is_named_picture(&path) => Change::Picture(path),
            Command::Open(_) | Command::OpenBuiltin(_) => {
                self.open = false;
                return Some(command);
            }
            other => return Some(other),
        };
        Some(Command::Lab(change))
    }

    /// Makes a change. Returns it if it concerns the disk.
    pub fn apply(&mut self, change: Change) -> Option<Change> {
        match change {
            Change::Open(open) => {
                self.open = open;
                self.playing = 0;
                if open && self.recording.steps.is_empty() {
                    self.run();
                }
            }
            Change::Page(page) => {
                self.page = page;
                (self.step, self.playing, self.view, self.comparison) = (usize::MAX, 0, None, None);
                self.run();
            }
            Change::Set(lesson) => {
                let place = self.place();
                self.lessons[place] = *lesson;
                self.comparison = None;
                self.run();
            }
            Change::Reset => {
                let place = self.place();
                self.lessons[place] = Lesson::new(self.page);
                (self.step, self.view, self.comparison) = (usize::MAX, None, None);
                self.run();
            }
            Change::Go(step) => (self.step, self.playing) = (step.min(self.recording.steps.len()), 0),
            Change::StepBy(step) => {
                self.playing = 0;
                self.move_by(step);
            }
            Change::Play(direction) => self.play(direction),
            Change::TogglePlay => self.play(i64::from(self.playing == 0)),
            Change::Tick(seconds) => self.tick(seconds),
            Change::Speed(speed) => self.speed = speed,
            Change::Brush(brush) => self.brush = brush,
            Change::View(view) => self.view = view,
            Change::Compare => self.comparison = self.lesson().compare(),
            Change::CloseComparison => self.comparison = None,
            disk @ (Change::Save(_) | Change::Picture(_)) => return Some(disk),
        }
        None
    }

    /// Makes a picture the canvas of the present page; if it has none, of the page that samples pictures.
    pub fn show_picture(&mut self, picture: &Image<Rgba8>) {
        let place = self.place();
        if self.lessons[place].set_picture(picture) {
            (self.comparison, self.playing) = (None, 0);
            self.run();
            return;
        }
        for lesson in self.lessons.iter_mut().filter(|lesson| lesson.page() == Page::Sampling) {
            lesson.set_picture(picture);
        }
        self.apply(Change::Page(Page::Sampling));
    }

    /// Runs the present page. All steps are shown if all were, otherwise as many as before.
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
        // From the end it begins again.
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

/// Most of the window's width that each panel beside the grid takes at first.
const SIDE_SHARE: f32 = 0.27;

/// Height of the bar with the transport, points.
const BAR_HEIGHT: f32 = ROW_HEIGHT + 12.0;

/// Draws the lab into what the menu leaves of the window.
pub fn ui(ui: &mut Ui, lab: &Lab, commands: &mut Vec<Command>) {
    let mut changes = Vec::new();
    let frame = theme::panel_frame(ui);
    // In a narrow window the grid still has the largest share.
    let share = |wanted: f32| wanted.min(ui.available_width() * SIDE_SHARE);
    let (left, right) = (share(264.0), share(316.0));
    if let Some(comparison) = &lab.comparison {
        Panel::bottom("lab rivals").frame(frame).resizable(true).default_size(230.0).min_size(120.0).show(ui, |ui| {
            rivals::ui(ui, comparison, &mut changes);
        });
    }
    Panel::left("lab pages").frame(frame).resizable(true).default_size(left).min_size(200.0).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            page_list(ui, lab, &mut changes);
            pages::controls(ui, lab, &mut changes);
        });
    });
    Panel::right("lab readout").frame(frame).resizable(true).default_size(right).min_size(220.0).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| readout::ui(ui, lab, &mut changes));
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

fn page_list(ui: &mut Ui, lab: &Lab, changes: &mut Vec<Change>) {
    for page in Page::ALL {
        // What grows behind the name pushes it to the left.
        let name = (page.name(), egui::Atom::grow());
        let button = egui::Button::selectable(*page == lab.page, name)
            .min_size(egui::vec2(ui.available_width(), theme::CONTROL_HEIGHT));
        if ui.add(button).on_hover_text(page.help()).clicked() {
            changes.push(Change::Page(*page));
        }
    }
    ui.add_space(space::XS);
    ui.separator();
}

#[cfg(test)]
mod tests;
