//! Communication with the render worker: sends requests when their inputs change, and handles the responses.

use std::time::Instant;

use eframe::egui::Ui;

use super::Workbench;
use crate::inspect::find::{self, SearchResult, SearchTarget};
use crate::measure::stages::StageTimes;
use crate::pipeline::settings::Execution;
use crate::ui::engine::{RenderedView, Request};
use crate::ui::session::Severity;
use crate::ui::session::compare::compute::CompareRequest;
use crate::ui::session::long_tasks::Measuring;
use crate::ui::session::temporal::TemporalRequest;
use crate::ui::session::timings::request::MeasureRequest;
use crate::ui::session::workspace::Panel;
use crate::ui::task::BackgroundTask;
use crate::ui::worker::{WorkerRequest, WorkerResponse};
use crate::upscale::process;

/// Requests that the worker has received last.
#[derive(Default)]
pub(super) struct SentRequests {
    view: Option<Request>,
    comparison: Option<CompareRequest>,
    filmstrip: Option<CompareRequest>,
    temporal: Option<TemporalRequest>,
    watched: Vec<(u32, u32)>,
}

impl Workbench {
    /// Handles all pending results of the render worker, background tasks, exports, scene loader and case evaluation.
    pub(super) fn receive_answers(&mut self) {
        while let Some(answer) = self.worker.poll() {
            self.handle(answer);
        }
        self.report_process_failures();
        self.poll_tasks();
        self.poll_saving();
        self.poll_opener();
        self.poll_loading();
        self.poll_case();
        self.poll_pictures();
    }

    /// Reports the failures of upscaler processes that were not reported yet.
    fn report_process_failures(&mut self) {
        let failures = process::failures_after(self.process_failures);
        self.process_failures += failures.len();
        for failure in failures {
            let text = format!("{failure}. Choose the upscaler again, or run “Restart upscaler processes”, to retry.");
            self.session.report(Severity::Error, text);
        }
    }

    pub(super) fn handle(&mut self, answer: WorkerResponse) {
        match answer {
            WorkerResponse::View(view) => {
                if view.fresh && view.request.triangle_limit.is_none() {
                    let ms = view.frame.times.total.as_secs_f64() * 1e3;
                    self.session.features.timings.record_recent(&view.request, ms);
                    self.record_stages(&view);
                }
                if !view.needs_replay {
                    self.session.features.scene_time.replay = None;
                }
                self.session.view = Some(*view);
                self.widgets.requested_at = None;
            }
            WorkerResponse::Compared(compared) => self.session.features.comparison.compared = Some(*compared),
            WorkerResponse::Replaying(progress) => self.session.features.scene_time.replay = Some(progress),
            WorkerResponse::Filmstrip(drawn) => self.session.features.filmstrip.drawn = Some(*drawn),
            WorkerResponse::Temporal { request, history } => {
                // Discards a late answer to an earlier request.
                if self.sent.temporal.as_ref().is_some_and(|sent| sent.is_same(&request)) {
                    self.session.features.temporal.store_history(*history);
                }
            }
            WorkerResponse::Watched(rows) => self.session.features.watch.store_values(rows),
            WorkerResponse::WhatIf(found) => self.session.features.what_if.found = Some(*found),
            WorkerResponse::Stages(figures) => self.session.features.stages.store_figures(*figures),
            // Discards late answers of a measurement that a newer one has replaced.
            WorkerResponse::Sample { of, .. }
            | WorkerResponse::MethodError { of, .. }
            | WorkerResponse::Noise { of, .. }
            | WorkerResponse::Measured(of)
                if of != self.measuring.number => {}
            WorkerResponse::Sample { upscaling, milliseconds, progress, .. } => {
                self.session.features.tasks.measuring =
                    self.session.features.tasks.measuring.map(|_| Measuring { progress });
                self.session.features.timings.record_measured(upscaling, milliseconds);
            }
            WorkerResponse::MethodError { upscaling, error, milliseconds, progress, .. } => {
                self.session.features.tasks.measuring =
                    self.session.features.tasks.measuring.map(|_| Measuring { progress });
                self.session.features.timings.record_error(upscaling, *error, milliseconds);
            }
            WorkerResponse::Noise { noise, .. } => self.session.features.timings.record_noise(noise),
            WorkerResponse::Measured(_) => self.session.features.tasks.measuring = None,
            WorkerResponse::Panicked(text) => {
                self.widgets.requested_at = None;
                let text = format!("Drawing stopped: internal error: {text}. The last complete picture is kept.");
                self.session.report(Severity::Error, text);
            }
        }
    }

    /// Records the stage times of a new frame if the scene plays: the worker times the stages of a frame only if the frame
    /// stays on screen. In classic execution, frames record no times of single stages.
    fn record_stages(&mut self, view: &RenderedView) {
        if self.session.features.scene_time.is_playing && view.frame.execution == Execution::Tiled {
            let times = StageTimes::recorded(&view.request.recipe, &view.frame);
            self.session.features.stages.record_played(times, Instant::now());
        }
    }

    /// Sends a request to the worker. A synchronous worker has answered when this returns.
    fn send(&mut self, ui: &Ui, request: WorkerRequest) {
        self.worker.send(request);
        if self.widgets.is_synchronous {
            self.receive_answers();
            ui.request_repaint();
        }
    }

    /// Sends a render request if any of its inputs has changed.
    pub(super) fn send_request(&mut self, ui: &Ui) {
        self.session.pick_by_itself();
        self.session.follow_picked_point();
        let request = self.session.request();
        let same = self.sent.view.as_ref().is_some_and(|asked| asked.same_view(&request));
        if !same && self.session.has_size() {
            self.sent.view = Some(request.clone());
            self.widgets.requested_at.get_or_insert_with(Instant::now);
            self.send(ui, WorkerRequest::Show(Box::new(request)));
        }
    }

    /// Sends a comparison request if it differs from the last one.
    pub(super) fn send_compare_request(&mut self, ui: &Ui) {
        let request = self.session.compare_request().filter(|_| self.session.has_size());
        if CompareRequest::replace(&mut self.sent.comparison, request.as_ref()) {
            if request.is_none() {
                self.session.features.comparison.compared = None;
            }
            self.send(ui, WorkerRequest::Compare(request.map(Box::new)));
        }
    }

    /// Sends a request for the pictures of the filmstrip if it differs from the last one.
    pub(super) fn send_filmstrip_request(&mut self, ui: &Ui) {
        let request = self.session.filmstrip_request().filter(|_| self.session.has_size());
        if CompareRequest::replace(&mut self.sent.filmstrip, request.as_ref()) {
            self.send(ui, WorkerRequest::Filmstrip(request.map(Box::new)));
        }
    }

    /// Sends a request for the history of the picked pixel if it differs from the last one.
    pub(super) fn send_temporal_request(&mut self, ui: &Ui) {
        let request = self.session.temporal_request().filter(|_| self.session.has_size());
        if TemporalRequest::replace(&mut self.sent.temporal, request.as_ref()) {
            self.session.features.temporal.expect(request.as_ref());
            self.send(ui, WorkerRequest::Temporal(request.map(Box::new)));
        }
    }

    /// Sends the list of watched pixels to the worker if it has changed.
    pub(super) fn send_watch_request(&mut self, ui: &Ui) {
        if self.sent.watched != self.session.features.watch.pixels {
            self.sent.watched.clone_from(&self.session.features.watch.pixels);
            self.send(ui, WorkerRequest::Watch(self.sent.watched.clone()));
        }
    }

    /// Sends a what-if request if it differs from the last one.
    pub(super) fn send_what_if_request(&mut self, ui: &Ui) {
        let request = self.session.what_if_request().filter(|_| self.session.has_size());
        if self.session.features.what_if.update_request(request.as_ref()) {
            self.send(ui, WorkerRequest::WhatIf(request.map(Box::new)));
        }
    }

    /// Starts measuring the time and error of all upscalers with the current scene, camera and picture size.
    pub(crate) fn measure(&mut self) {
        let request = Request { triangle_limit: None, fragment_limit: None, ..self.session.request() };
        let request = MeasureRequest {
            number: self.measuring.number + 1,
            of: request,
            reference: self.session.features.comparison.reference,
            turn: self.session.features.timings.turn,
            metric: self.session.features.timings.metric,
        };
        self.session.features.timings.begin_measurement(request.clone());
        self.session.features.tasks.measuring = Some(Measuring { progress: 0.0 });
        if !self.docks.shows(Panel::ErrorTime) {
            self.show_panel(Panel::FrameTime);
        }
        self.measuring.number = request.number;
        self.worker.send(WorkerRequest::Measure(Box::new(request)));
    }

    /// Searches the frame on screen for `wanted`, in a background thread unless the window is synchronous.
    pub(super) fn search(&mut self, ui: &Ui, wanted: SearchTarget) {
        let Some(view) = self.session.view_of_scene().cloned() else { return };
        let look = move || {
            let found = find::find(&view.request.scene, &view.request.recipe, &view.frame, &wanted);
            (wanted, found)
        };
        if self.widgets.is_synchronous {
            let (wanted, found) = look();
            self.handle_search_result(&wanted, &found);
        } else {
            self.session.features.places.searching =
                Some(BackgroundTask::start(ui.ctx().clone(), move |_, _| Some(look())));
        }
    }

    pub(super) fn handle_search_result(&mut self, wanted: &SearchTarget, found: &SearchResult) {
        if let Some(pixel) = self.session.apply_search_result(wanted, found) {
            self.widgets.canvas.bring_into_view(pixel, self.widgets.visible_px);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::Recipe;
    use crate::measure::motion::Turn;
    use crate::scene::SceneSource;
    use crate::ui::session::{PictureSize, Session};
    use crate::ui::worker::{MEASURE_ROUNDS, Worker};

    #[test]
    fn late_answers_of_one_measurement_are_not_taken_for_those_of_the_next() {
        let source = SceneSource::named("triangle".into());
        let scene = source.load().unwrap().scene;
        let home = scene.home;
        let mut session = Session::new(Arc::new(scene), source, Recipe::default(), home);
        session.state.size = PictureSize::Fixed(16, 12);
        session.features.timings.turn = Turn::STILL;
        let mut bench = Workbench::new(session, Worker::inline());
        bench.measure();
        bench.measure();
        bench.receive_answers();
        let series = bench.session().features.timings.series();
        assert!(!series.is_empty() && series.iter().all(|(_, times)| times.len() == MEASURE_ROUNDS));
        assert_eq!(bench.session().features.tasks.measuring, None);
    }
}
