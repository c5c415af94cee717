//! Long measurements in background threads: starting them and handling their results.

use std::sync::Arc;

use eframe::egui::Ui;

use super::Workbench;
use crate::measure::leaving_out::savings;
use crate::measure::scaling::{self, Quantity};
use crate::report::stability::sweep::{self, Plan, Progress, Stage};
use crate::ui::engine::Request;
use crate::ui::panels::bottom::Tab;
use crate::ui::probe;
use crate::ui::session::Level;
use crate::ui::task::{Listening, Task};

impl Workbench {
    /// Starts computing the stability report in a background thread.
    pub(super) fn judge(&mut self, ui: &Ui) {
        self.tab = Tab::Stability;
        self.session.stability.progress = Some(Progress { stage: Stage::Judging, done: 0, of: 1 });
        let plan = Plan::default();
        self.judging = Some(Task::start(ui.ctx().clone(), move |tell, stop| {
            sweep::run(&plan, tell, stop).filter(|report| !report.partial)
        }));
    }

    /// Starts measuring the time that the plan of the present view saves.
    pub(super) fn measure_plan(&mut self, ui: &Ui) {
        /// Number of measured rounds.
        const ROUNDS: usize = 21;
        let request = self.session.request();
        self.session.savings.progress = Some(0.0);
        self.measuring_savings = Some(Task::start(ui.ctx().clone(), move |tell, stop| {
            let Request { scene, camera, recipe, viewport, .. } = &request;
            let found = savings(scene, camera, recipe, *viewport, ROUNDS, tell, stop)?;
            Some((found, request))
        }));
    }

    /// Starts measuring how cost scales under the present recipe.
    pub(super) fn measure_growth(&mut self, ui: &Ui) {
        /// Maximum triangle count and number of measured rounds, chosen so that the measurement takes seconds, not
        /// minutes.
        const MOST: (usize, usize) = (1_000_000, 7);
        let recipe = self.session.state.recipe;
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        self.session.growth.progress = Some((Quantity::Triangles, 0.0));
        self.measuring_growth = Some(Task::start(ui.ctx().clone(), move |tell, stop| {
            let plan = scaling::Plan::new(recipe, MOST.0, threads, MOST.1);
            let found = scaling::measure(&plan, &|quantity, share| tell((quantity, share)), stop).ok();
            let found = found.filter(|found| !found.partial)?;
            Some((found, recipe))
        }));
    }

    /// Handles the progress and the results of long measurements.
    pub(super) fn hear_tasks(&mut self) {
        probe::listen(&mut self.session);
        let session = &mut self.session;
        let broke_off = hear(&mut self.judging, &mut session.stability.progress, |report| {
            session.stability.report = Some(Arc::from(report));
        });
        let broke_off = broke_off
            | hear(&mut self.measuring_savings, &mut session.savings.progress, |found| {
                let (savings, of) = *found;
                session.savings.found = Some((Arc::new(savings), of));
            })
            | hear(&mut self.measuring_growth, &mut session.growth.progress, |found| {
                let (scaling, recipe) = *found;
                session.growth.found = Some((Arc::new(scaling), recipe));
            });
        let mut found = None;
        let broke_off = broke_off | hear(&mut self.finding, &mut None, |what| found = Some(what));
        if broke_off {
            session.report(Level::Error, "A measurement stopped: internal error");
        }
        if let Some(what) = found {
            self.found(&what);
        }
    }

    /// Applies a change to the stability probe.
    pub(super) fn probe(&mut self, ui: &Ui, change: probe::Change) {
        match probe::apply(&mut self.session, ui.ctx(), change) {
            probe::Rest::Nothing => {}
            probe::Rest::BringIntoView(pixel) => self.canvas.bring_into_view(pixel, self.session.canvas_px),
            probe::Rest::Write(case) => self.write_case(ui, &case),
        }
    }
}

/// Handles the progress and the result of a task. Returns whether the task ended without reporting, as after a panic.
fn hear<P: Send + 'static, T: Send + 'static>(
    task: &mut Option<Task<P, T>>,
    progress: &mut Option<P>,
    done: impl FnOnce(Box<T>),
) -> bool {
    let Some(running) = task else { return false };
    let listening = running.listen(progress);
    if !matches!(listening, Listening::GoesOn) {
        *task = None;
    }
    match listening {
        Listening::GoesOn => false,
        Listening::Ended(result) => {
            if let Some(result) = result {
                done(result);
            }
            false
        }
        Listening::BrokeOff => true,
    }
}
