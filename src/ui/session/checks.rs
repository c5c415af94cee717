//! Assertion checks: run on demand, or on every new frame until an assertion is violated.
//!
//! A background thread redraws the frame on screen with an observer. This slows other frames down, so checking is off
//! by default, and the window indicates when it is on. The first violation stops checking and picks its pixel.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use eframe::egui::Context;

use super::{Session, Severity};
use crate::chain::Frame;
use crate::inspect::assertions::{Assertion, AssertionReport, Violation, check};
use crate::inspect::control::TaskControl;
use crate::pipeline::settings::Choice as _;
use crate::ui::engine::RenderedView;
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::WindowTask;
use crate::ui::task::{BackgroundTask, TaskStatus};

/// State of the assertion checks.
#[derive(Debug, Default)]
pub(crate) struct Checks {
    /// Latest report, and the frame that it describes.
    pub(crate) found: Option<(Arc<AssertionReport>, Arc<Frame>)>,
    /// Completed fraction of the running check, from 0 to 1.
    pub(crate) progress: Option<f32>,
    /// Whether each new frame is checked.
    pub(crate) every_frame: bool,
    /// Whether a check of the frame on screen was requested.
    wanted: bool,
    /// Whether cancellation of the running check was requested.
    cancelled: bool,
    runner: Runner,
}

/// Change to the assertion checks, requested by the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChecksChange {
    /// Checks the frame on screen.
    Run,
    /// Stops checking.
    Cancel,
    /// Toggles whether every new frame is checked.
    ToggleEveryFrame,
}

impl Checks {
    /// Applies a change.
    pub(crate) fn apply(&mut self, change: ChecksChange) {
        match change {
            ChecksChange::Run => self.wanted = true,
            ChecksChange::Cancel => (self.wanted, self.every_frame, self.cancelled) = (false, false, true),
            ChecksChange::ToggleEveryFrame => self.every_frame ^= true,
        }
    }

    /// Whether `frame` must be checked now.
    fn wants(&self, frame: &Arc<Frame>) -> bool {
        let is_known = self.found.as_ref().is_some_and(|(_, known)| Arc::ptr_eq(known, frame));
        self.wanted || self.every_frame && !is_known
    }
}

/// Returns the column and row of a violation in the full-resolution picture.
pub(crate) fn place(violation: &Violation, frame: &Frame) -> (u32, u32) {
    let drawn_at = (violation.x, violation.y);
    frame.sampling.grid().sample_at(violation.x, violation.y).map_or(drawn_at, |sample| frame.pixel_of(sample))
}

impl Feature for Checks {
    type Change = ChecksChange;

    fn apply(session: &mut Session, change: ChecksChange) -> Option<WindowTask> {
        session.features.checks.apply(change);
        None
    }

    fn leave_scene(&mut self) {
        // The result of the running check would change the pick in the new scene.
        (self.runner, self.progress) = (Runner::default(), None);
    }
}

/// Handles the result of the running check and starts the next requested check. If `waits` is `true`, runs the check
/// synchronously instead of in a background thread.
pub(crate) fn step(session: &mut Session, context: &Context, waits: bool) {
    let mut runner = std::mem::take(&mut session.features.checks.runner);
    runner.step(session, context, waits);
    session.features.checks.runner = runner;
}

/// Runner of assertion checks in a background thread.
#[derive(Debug, Default)]
struct Runner {
    running: Option<(BackgroundTask<f32, AssertionReport>, Arc<Frame>)>,
}

impl Runner {
    fn step(&mut self, session: &mut Session, context: &Context, waits: bool) {
        self.listen(session);
        if let Some((task, _)) = &self.running {
            if std::mem::take(&mut session.features.checks.cancelled) {
                task.cancel();
            }
            return;
        }
        let wanted = session.view_of_scene().filter(|view| session.features.checks.wants(&view.frame));
        let Some(view) = wanted.cloned() else { return };
        session.features.checks.wanted = false;
        if waits {
            if let Some(report) = checked(&view, TaskControl::quiet()) {
                found(session, report, view.frame);
            }
            return;
        }
        (session.features.checks.progress, session.features.checks.cancelled) = (Some(0.0), false);
        let frame = view.frame.clone();
        let work = move |progress: &(dyn Fn(f32) + Sync), cancel: &AtomicBool| {
            checked(&view, TaskControl { progress, cancel })
        };
        self.running = Some((BackgroundTask::start(context.clone(), work), frame));
    }

    fn listen(&mut self, session: &mut Session) {
        let Some((task, frame)) = &self.running else { return };
        let frame = frame.clone();
        match task.poll(&mut session.features.checks.progress) {
            TaskStatus::Running => return,
            TaskStatus::Ended(Some(report)) => found(session, *report, frame),
            TaskStatus::Ended(None) => {}
            TaskStatus::Lost => {
                session.features.checks.every_frame = false;
                session.report(Severity::Error, "Checking stopped: internal error");
            }
        }
        self.running = None;
    }
}

/// Checks all assertions on the frame of `view`. Returns `None` if cancelled.
fn checked(view: &RenderedView, control: TaskControl<'_>) -> Option<AssertionReport> {
    check(&view.request.scene, &view.request.recipe, &view.frame, Assertion::ALL, control)
}

/// Stores a report. If it contains a violation, stops checking and picks the pixel of the first violation.
fn found(session: &mut Session, report: AssertionReport, frame: Arc<Frame>) {
    if let Some((assertion, violation)) = report.first_violation() {
        let (x, y) = place(violation, &frame);
        session.pick = Some((x, y));
        session.features.checks.every_frame = false;
        let text = format!("“{}” is violated at pixel {x}, {y} by triangle {}", assertion.name(), violation.triangle.0);
        session.report(Severity::Warning, text);
    }
    session.features.checks.found = Some((Arc::new(report), frame));
}
