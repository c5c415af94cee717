//! Watching assertions from the window: on demand, or on every new frame until one is violated.
//!
//! The frame that is on screen is drawn once more, watched, on a thread of its own; that takes time from other frames, so it is
//! off until asked for, and said while it is on. The first violation stops it and picks the pixel.

pub mod panel;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use eframe::egui::Context;

use super::engine::View;
use super::session::{Level, Session};
use super::task::{Listening, Task};
use crate::chain::Frame;
use crate::inspect::assertions::{Assertion, Report, Violation, check};
use crate::pipeline::settings::Choice as _;

/// What the window knows of assertions.
#[derive(Clone, Debug, Default)]
pub struct Checks {
    /// The last findings, and the frame that they are of.
    pub found: Option<(Arc<Report>, Arc<Frame>)>,
    /// Share of the present check that is done.
    pub progress: Option<f32>,
    /// Whether each new frame is checked.
    pub every_frame: bool,
    /// Whether the frame on screen is to be checked.
    wanted: bool,
    /// Whether the check that is running is to stop.
    cancelled: bool,
}

/// A change of what is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Check the frame on screen.
    Run,
    /// Stop checking.
    Cancel,
    /// Check every new frame, or no more.
    ToggleEveryFrame,
}

impl Checks {
    /// Applies a change.
    pub fn apply(&mut self, change: Change) {
        match change {
            Change::Run => self.wanted = true,
            Change::Cancel => (self.wanted, self.every_frame, self.cancelled) = (false, false, true),
            Change::ToggleEveryFrame => self.every_frame ^= true,
        }
    }

    /// Whether this frame is to be checked now.
    fn wants(&self, frame: &Arc<Frame>) -> bool {
        let is_known = self.found.as_ref().is_some_and(|(_, known)| Arc::ptr_eq(known, frame));
        self.wanted || self.every_frame && !is_known
    }
}

/// Where in the full picture a violation is.
pub fn place(violation: &Violation, frame: &Frame) -> (u32, u32) {
    let drawn_at = (violation.x, violation.y);
    frame.sampling.grid().sample_at(violation.x, violation.y).map_or(drawn_at, |sample| frame.pixel_of(sample))
}

/// Runs the checks.
#[derive(Debug, Default)]
pub struct Runner {
    running: Option<(Task<f32, Report>, Arc<Frame>)>,
}

impl Runner {
    /// Takes what a check has found and starts the next one that is wanted; at once, and to its end, if the window `waits`.
    pub fn step(&mut self, session: &mut Session, context: &Context, waits: bool) {
        self.listen(session);
        if let Some((task, _)) = &self.running {
            if std::mem::take(&mut session.checks.cancelled) {
                task.cancel();
            }
            return;
        }
        let wanted = session.view_of_scene().filter(|view| session.checks.wants(&view.frame));
        let Some(view) = wanted.cloned() else { return };
        session.checks.wanted = false;
        if waits {
            if let Some(report) = checked(&view, &|_| {}, &AtomicBool::new(false)) {
                found(session, report, view.frame);
            }
            return;
        }
        (session.checks.progress, session.checks.cancelled) = (Some(0.0), false);
        let frame = view.frame.clone();
        self.running = Some((Task::start(context.clone(), move |tell, stop| checked(&view, tell, stop)), frame));
    }

    fn listen(&mut self, session: &mut Session) {
        let Some((task, frame)) = &self.running else { return };
        let frame = frame.clone();
        match task.listen(&mut session.checks.progress) {
            Listening::GoesOn => return,
            Listening::Ended(Some(report)) => found(session, *report, frame),
            Listening::Ended(None) => {}
            Listening::BrokeOff => {
                session.checks.every_frame = false;
                session.report(Level::Error, "Checking stopped by an error of the program");
            }
        }
        self.running = None;
    }
}

/// The findings of a view.
fn checked(view: &View, tell: &dyn Fn(f32), stop: &AtomicBool) -> Option<Report> {
    check(&view.request.scene, &view.request.recipe, &view.frame, Assertion::ALL, tell, stop)
}

/// Takes in findings; the first violation stops checking and picks its pixel.
fn found(session: &mut Session, report: Report, frame: Arc<Frame>) {
    if let Some((assertion, violation)) = report.first_violation() {
        let (x, y) = place(violation, &frame);
        session.pick = Some((x, y));
        session.checks.every_frame = false;
        let text = format!("“{}” is violated at {x}, {y} by triangle {}", assertion.name(), violation.triangle.0);
        session.report(Level::Warning, text);
    }
    session.checks.found = Some((Arc::new(report), frame));
}
