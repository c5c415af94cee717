//! Starts long measurements in background threads and handles their results.

use std::sync::Arc;

use eframe::egui::Ui;

use super::Workbench;
use crate::measure::scaling::{self, ScalingQuantity};
use crate::measure::skipped_work::savings;
use crate::report::stability::sweep::{self, StabilityPlan, StabilityProgress, SweepStage};
use crate::ui::engine::Request;
use crate::ui::probe;
use crate::ui::save_as::Destination;
use crate::ui::session::Severity;
use crate::ui::task::{BackgroundTask, TaskStatus};
use crate::ui::workspace::Panel;

impl Workbench {
    /// Starts computing the stability report in a background thread.
    pub(super) fn measure_stability(&mut self, ui: &Ui) {
        self.show_panel(Panel::Stability);
        self.session.tasks.stability.progress = Some(StabilityProgress { stage: SweepStage::Judging, done: 0, of: 1 });
        let plan = StabilityPlan::default();
        self.measuring_stability = Some(BackgroundTask::start(ui.ctx().clone(), move |report_progress, stop| {
            sweep::run(&plan, report_progress, stop).filter(|report| !report.partial)
        }));
    }

    /// Starts measuring how much frame time the current view saves because its draws skip unneeded parts of the
    /// pipeline.
    pub(super) fn measure_plan(&mut self, ui: &Ui) {
        /// Number of measured rounds.
        const ROUNDS: usize = 21;
        let request = self.session.request();
        self.session.tasks.savings.progress = Some(0.0);
        self.measuring_savings = Some(BackgroundTask::start(ui.ctx().clone(), move |report_progress, stop| {
            let Request { scene, camera, recipe, viewport, .. } = &request;
            let found = savings(scene, camera, recipe, *viewport, ROUNDS, report_progress, stop)?;
            Some((found, request))
        }));
    }

    /// Starts measuring how the frame time scales with triangles, pixels, overlapping layers and threads under the
    /// current recipe.
    pub(super) fn measure_scaling(&mut self, ui: &Ui) {
        /// Maximum number of triangles, and number of measured rounds. Both are small enough that the measurement takes
        /// seconds, not minutes.
        const MAX_SCALING: (usize, usize) = (1_000_000, 7);
        let recipe = self.session.state.recipe;
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        self.session.tasks.scaling.progress = Some((ScalingQuantity::Triangles, 0.0));
        self.measuring_scaling = Some(BackgroundTask::start(ui.ctx().clone(), move |report_progress, stop| {
            let plan = scaling::ScalingPlan::new(recipe, MAX_SCALING.0, threads, MAX_SCALING.1);
            let found = scaling::measure(&plan, &|quantity, share| report_progress((quantity, share)), stop).ok();
            let found = found.filter(|found| !found.partial)?;
            Some((found, recipe))
        }));
    }

    /// Handles the progress and the results of long measurements.
    pub(super) fn poll_tasks(&mut self) {
        probe::listen(&mut self.session);
        let session = &mut self.session;
        let broke_off = poll_task(&mut self.measuring_stability, &mut session.tasks.stability.progress, |report| {
            session.tasks.stability.report = Some(Arc::from(report));
        });
        let broke_off = broke_off
            | poll_task(&mut self.measuring_savings, &mut session.tasks.savings.progress, |found| {
                let (savings, of) = *found;
                session.tasks.savings.found = Some((Arc::new(savings), of));
            })
            | poll_task(&mut self.measuring_scaling, &mut session.tasks.scaling.progress, |found| {
                let (scaling, recipe) = *found;
                session.tasks.scaling.found = Some((Arc::new(scaling), recipe));
            });
        let mut found = None;
        let broke_off = broke_off | poll_task(&mut self.searching, &mut None, |what| found = Some(what));
        if broke_off {
            session.report(Severity::Error, "Measurement stopped: internal error");
        }
        if let Some(what) = found {
            self.handle_search_result(&what);
        }
    }

    /// Applies a change to the stability probe.
    pub(super) fn probe(&mut self, ui: &Ui, change: probe::ProbeChange) {
        match probe::apply(&mut self.session, ui.ctx(), change) {
            probe::WindowAction::Nothing => {}
            probe::WindowAction::BringIntoView(pixel) => {
                self.widgets.canvas.bring_into_view(pixel, self.widgets.visible_px);
            }
            probe::WindowAction::Write(case) => self.write_case(ui, &case, Destination::Automatic),
        }
    }
}

/// Updates the progress of a task and handles its result. Returns `true` if the task's thread ended without reporting a
/// result, for example because it panicked.
fn poll_task<P: Send + 'static, T: Send + 'static>(
    task: &mut Option<BackgroundTask<P, T>>,
    progress: &mut Option<P>,
    done: impl FnOnce(Box<T>),
) -> bool {
    let Some(running) = task else { return false };
    let listening = running.poll(progress);
    if !matches!(listening, TaskStatus::Running) {
        *task = None;
    }
    match listening {
        TaskStatus::Running => false,
        TaskStatus::Ended(result) => {
            if let Some(result) = result {
                done(result);
            }
            false
        }
        TaskStatus::Lost => true,
    }
}
