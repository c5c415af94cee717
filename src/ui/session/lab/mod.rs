//! State of the 2D lab: the lesson of each page, the recorded run, and its playback.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::Vec2;

use super::save_item::SaveItem;
use crate::image::{Image, Rgba8, file};
use crate::lab::recording::{MethodComparison, Recording, time_of};
use crate::lab::seed_fills::Paint;
use crate::lab::{Lesson, Page};
use crate::pipeline::settings::Choice as _;
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::WindowTask;
use crate::ui::session::workspace::Workspace;
use crate::ui::session::{Session, Severity};

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

#[cfg(test)]
mod tests;
