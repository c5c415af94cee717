//! Communication with the render worker: sends requests when their inputs change, and handles the answers.

use std::time::Instant;

use eframe::egui::Ui;

use super::Workbench;
use crate::inspect::find::{self, Found, Wanted};
use crate::ui::engine::Request;
use crate::ui::panels::bottom::Tab;
use crate::ui::session::{Level, Measuring};
use crate::ui::task::Task;
use crate::ui::worker::{Answer, Job, MeasureRequest};

impl Workbench {
    /// Handles all pending results of the render worker, tasks, exports, scene loader and case evaluation.
    pub(super) fn listen(&mut self) {
        while let Some(answer) = self.worker.poll() {
            self.hear(answer);
        }
        self.hear_tasks();
        self.hear_saving();
        self.hear_loading();
        self.hear_case();
    }

    pub(super) fn hear(&mut self, answer: Answer) {
        match answer {
            Answer::View(view) => {
                if view.fresh && view.request.triangle_limit.is_none() {
                    let ms = view.frame.times.total.as_secs_f64() * 1e3;
                    self.session.timings.record_recent(&view.request, ms);
                }
                self.session.view = Some(*view);
                self.asked_at = None;
            }
            Answer::Compared(compared) => self.session.compared = Some(*compared),
            Answer::Watched(rows) => self.session.watch.hear(rows),
            Answer::WhatIf(found) => self.session.what_if.found = Some(*found),
            Answer::Stages(figures) => self.session.stages = Some(*figures),
            // Discards late answers of a measurement that a newer one has replaced.
            Answer::Sample { of, .. } | Answer::Judged { of, .. } | Answer::Noise { of, .. } | Answer::Measured(of)
                if of != self.measurement => {}
            Answer::Sample { upscaling, milliseconds, progress, .. } => {
                self.session.measuring = self.session.measuring.map(|_| Measuring { progress });
                self.session.timings.record_measured(upscaling, milliseconds);
            }
            Answer::Judged { upscaling, error, progress, .. } => {
                self.session.measuring = self.session.measuring.map(|_| Measuring { progress });
                self.session.timings.record_error(upscaling, *error);
            }
            Answer::Noise { noise, .. } => self.session.timings.record_noise(noise),
            Answer::Measured(_) => self.session.measuring = None,
            Answer::Panicked(text) => {
                self.asked_at = None;
                let text = format!("Drawing stopped: internal error: {text}. The last good picture stays.");
                self.session.report(Level::Error, text);
            }
        }
    }

    /// Sends a render request if any of its inputs has changed.
    pub(super) fn ask(&mut self, ui: &Ui) {
        self.session.pick_by_itself();
        let request = self.session.request();
        let same = self.asked.as_ref().is_some_and(|asked| asked.same_view(&request));
        if !same && self.session.canvas_px != (0, 0) {
            self.asked = Some(request.clone());
            self.asked_at.get_or_insert_with(Instant::now);
            self.worker.send(Job::Show(Box::new(request)));
            if self.waits {
                self.listen();
                ui.request_repaint();
            }
        }
    }

    /// Sends a comparison request if it differs from the last one.
    pub(super) fn ask_to_compare(&mut self, ui: &Ui) {
        let request = self.session.compare_request().filter(|_| self.session.canvas_px != (0, 0));
        let same = match (&self.asked_to_compare, &request) {
            (Some(asked), Some(request)) => asked.same_as(request),
            (asked, request) => asked.is_none() && request.is_none(),
        };
        if same {
            return;
        }
        if request.is_none() {
            self.session.compared = None;
        }
        self.asked_to_compare = request.clone();
        self.worker.send(Job::Compare(request.map(Box::new)));
        if self.waits {
            self.listen();
            ui.request_repaint();
        }
    }

    /// Sends the list of watched pixels to the worker if it has changed.
    pub(super) fn ask_to_watch(&mut self, ui: &Ui) {
        if self.asked_to_watch != self.session.watch.pixels {
            self.asked_to_watch.clone_from(&self.session.watch.pixels);
            self.worker.send(Job::Watch(self.asked_to_watch.clone()));
            if self.waits {
                self.listen();
                ui.request_repaint();
            }
        }
    }

    /// Sends a what-if request if it differs from the last one.
    pub(super) fn ask_what_if(&mut self, ui: &Ui) {
        let request = self.session.what_if_request().filter(|_| self.session.canvas_px != (0, 0));
        if self.session.what_if.asks_anew(request.as_ref()) {
            self.worker.send(Job::WhatIf(request.map(Box::new)));
            if self.waits {
                self.listen();
                ui.request_repaint();
            }
        }
    }

    /// Starts timing all upscalers on the scene, view and size on screen.
    pub(crate) fn measure(&mut self) {
        let request = Request { triangle_limit: None, fragment_limit: None, ..self.session.request() };
        let request = MeasureRequest {
            number: self.measurement + 1,
            of: request,
            reference: self.session.comparison.reference,
            turn: self.session.timings.turn,
        };
        self.session.timings.begin_measurement(request.clone());
        self.session.measuring = Some(Measuring { progress: 0.0 });
        if self.tab != Tab::ErrorTime {
            self.tab = Tab::FrameTime;
        }
        self.measurement = request.number;
        self.worker.send(Job::Measure(Box::new(request)));
    }

    /// Searches the frame on screen for `wanted`, in a background thread unless the window is synchronous.
    pub(super) fn find(&mut self, ui: &Ui, wanted: Wanted) {
        let Some(view) = self.session.view_of_scene().cloned() else { return };
        let look = move || {
            let found = find::find(&view.request.scene, &view.request.recipe, &view.frame, &wanted);
            (wanted, found)
        };
        if self.waits {
            self.found(&look());
        } else {
            self.finding = Some(Task::start(ui.ctx().clone(), move |_, _| Some(look())));
        }
    }

    pub(super) fn found(&mut self, (wanted, found): &(Wanted, Found)) {
        if let Some(pixel) = self.session.take_found(wanted, found) {
            self.canvas.bring_into_view(pixel, self.session.canvas_px);
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
        session.timings.turn = Turn::STILL;
        let mut bench = Workbench::new(session, Worker::inline());
        bench.measure();
        bench.measure();
        bench.listen();
        let series = bench.session().timings.series();
        assert!(!series.is_empty() && series.iter().all(|(_, times)| times.len() == MEASURE_ROUNDS));
        assert_eq!(bench.session().measuring, None);
    }
}
