//! Background task that determines the fate of every triangle and fragment of the frame on screen. It runs while the
//! panel “Triangle fates” is shown or triangles are selected.

use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::Ui;

use crate::inspect::fates::Fates;
use crate::ui::engine::{RenderedView, Request};
use crate::ui::session::{Session, Severity};
use crate::ui::task::{BackgroundTask, TaskStatus};

/// Time for which a frame must stay unchanged before its fates are counted, so that counting does not slow down a
/// moving view.
const SETTLED: Duration = Duration::from_millis(150);

/// Runner of the background task that counts the fates of the frame on screen.
#[derive(Debug, Default)]
pub(crate) struct Finder {
    task: Option<BackgroundTask<(), Fates>>,
    last_request: Option<Request>,
    /// Request of the frame on screen, and the time at which this frame was first seen.
    unchanged_since: Option<(Request, Instant)>,
}

/// Handles the result of the task that counts fates. Starts a new task if the frame has changed and its fates are
/// needed: because the panel “Triangle fates” is open (`wanted`), a filter is active or triangles are selected. If
/// `waits` is `true`, the fates are counted synchronously.
pub(crate) fn update(ui: &Ui, session: &mut Session, wanted: bool, waits: bool) {
    let mut finder = std::mem::take(&mut session.features.fates.finder);
    finder.update(ui, session, wanted, waits);
    session.features.fates.finder = finder;
}

impl Finder {
    fn update(&mut self, ui: &Ui, session: &mut Session, wanted: bool, waits: bool) {
        self.listen(session);
        let wanted = wanted || session.features.fates.is_filtering() || !session.selection.is_empty();
        let Some(view) = session.view_of_scene().filter(|_| wanted && self.task.is_none()) else { return };
        if self.last_request.as_ref().is_some_and(|asked| asked.same_complete_frame(&view.request)) {
            return;
        }
        let view = view.clone();
        if !waits && !self.has_settled(&view.request) {
            ui.request_repaint_after(SETTLED);
            return;
        }
        self.last_request = Some(view.request.clone());
        if waits {
            found(session, find(&view));
            ui.request_repaint();
        } else {
            self.task = Some(BackgroundTask::start(ui.ctx().clone(), move |_, _| Some(find(&view))));
        }
    }

    fn has_settled(&mut self, request: &Request) -> bool {
        self.unchanged_since.take_if(|(known, _)| !known.same_complete_frame(request));
        self.unchanged_since.get_or_insert_with(|| (request.clone(), Instant::now())).1.elapsed() >= SETTLED
    }

    fn listen(&mut self, session: &mut Session) {
        let Some(task) = &self.task else { return };
        match task.poll(&mut None) {
            TaskStatus::Running => return,
            TaskStatus::Ended(fates) => {
                if let Some(fates) = fates {
                    found(session, *fates);
                }
            }
            TaskStatus::Lost => session.report(Severity::Error, "Counting fates stopped: internal error"),
        }
        self.task = None;
    }
}

fn find(RenderedView { request, frame, .. }: &RenderedView) -> Fates {
    Fates::of(&request.scene, &request.recipe, frame)
}

fn found(session: &mut Session, fates: Fates) {
    for complaint in fates.account.complaints() {
        session.report(Severity::Error, format!("Fate counts do not add up (internal error): {complaint}"));
    }
    session.features.fates.set_fates(Arc::new(fates), &mut session.selection);
}
