//! Starts long measurements in background threads and handles their results.

use std::sync::Arc;

use eframe::egui::Ui;

use super::Workbench;
use crate::chain::RenderInputs;
use crate::measure::scaling::{self, ScalingQuantity};
use crate::measure::skipped_work::savings;
use crate::report::stability::sweep::{self, StabilityPlan, StabilityProgress, SweepStage};
use crate::ui::engine::Request;
use crate::ui::session::features::Features;
use crate::ui::session::long_tasks::LongTasks;
use crate::ui::session::workspace::Panel;
use crate::ui::session::{Severity, probe};
use crate::ui::task::{BackgroundTask, TaskStatus};

impl Workbench {
    /// Starts computing the stability report in a background thread.
    pub(super) fn measure_stability(&mut self, ui: &Ui) {
        self.show_panel(Panel::Stability);
        self.session.features.tasks.stability.progress =
            Some(StabilityProgress { stage: SweepStage::Judging, done: 0, of: 1 });
        let plan = StabilityPlan::default();
        self.session.features.tasks.stability.task =
            Some(BackgroundTask::start(ui.ctx().clone(), move |report_progress, stop| {
                sweep::run(&plan, report_progress, stop).filter(|report| !report.partial)
            }));
    }

    /// Starts measuring how much frame time the current view saves because its draws skip unneeded parts of the
    /// pipeline.
    pub(super) fn measure_plan(&mut self, ui: &Ui) {
        /// Number of measured rounds.
        const ROUNDS: usize = 21;
        let request = self.session.request();
        self.session.features.tasks.savings.progress = Some(0.0);
        self.session.features.tasks.savings.task =
            Some(BackgroundTask::start(ui.ctx().clone(), move |report_progress, stop| {
                let Request { scene, camera, recipe, viewport, .. } = &request;
                let inputs = RenderInputs { scene, camera, recipe, viewport: *viewport };
                let found = savings(inputs, ROUNDS, report_progress, stop)?;
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
        self.session.features.tasks.scaling.progress = Some((ScalingQuantity::Triangles, 0.0));
        self.session.features.tasks.scaling.task =
            Some(BackgroundTask::start(ui.ctx().clone(), move |report_progress, stop| {
                let plan = scaling::ScalingPlan::new(recipe, MAX_SCALING.0, threads, MAX_SCALING.1);
                let found = scaling::measure(&plan, &|quantity, share| report_progress((quantity, share)), stop).ok();
                let found = found.filter(|found| !found.partial)?;
                Some((found, recipe))
            }));
    }

    /// Handles the progress and the results of long measurements.
    pub(super) fn poll_tasks(&mut self) {
        probe::listen(&mut self.session);
        let Features { tasks, places, .. } = &mut self.session.features;
        let LongTasks { stability, savings, scaling, .. } = tasks;
        let mut broke_off = poll_task(&mut stability.task, &mut stability.progress, |report| {
            stability.report = Some(Arc::from(report));
        });
        broke_off |= poll_task(&mut savings.task, &mut savings.progress, |found| {
            let (measured, of) = *found;
            savings.found = Some((Arc::new(measured), of));
        });
        broke_off |= poll_task(&mut scaling.task, &mut scaling.progress, |found| {
            let (measured, recipe) = *found;
            scaling.found = Some((Arc::new(measured), recipe));
        });
        let mut found = None;
        broke_off |= poll_task(&mut places.searching, &mut None, |what| found = Some(what));
        if broke_off {
            self.session.report(Severity::Error, "Measurement stopped: internal error");
        }
        if let Some(found) = found {
            let (wanted, found) = *found;
            self.handle_search_result(&wanted, &found);
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
