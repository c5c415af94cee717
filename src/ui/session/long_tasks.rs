//! Progress and results of long measurements: stability report, time saved by skipped work, and scaling.

use std::sync::Arc;

use crate::chain::Recipe;
use crate::measure::scaling::{Scaling, ScalingQuantity};
use crate::measure::skipped_work::Savings;
use crate::report::stability::sweep::{StabilityProgress, StabilityReport};
use crate::ui::engine::Request;
use crate::ui::session::Session;
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::{MeasureTask, WindowTask};
use crate::ui::task::BackgroundTask;

/// Progress and results of measurements and exports that take long.
#[derive(Debug, Default)]
pub(crate) struct LongTasks {
    /// Running measurement of all upscalers, if any.
    pub(crate) measuring: Option<Measuring>,
    /// State of the stability report.
    pub(crate) stability: Stability,
    /// Measurement of how much frame time the draws of the view save by skipping unneeded parts of the pipeline.
    pub(crate) savings: PlanSavings,
    /// Measurement of how frame times scale with triangles, pixels, overdraw and threads.
    pub(crate) scaling: ScalingState,
    /// Completed fraction of the running export of a vector drawing, in [0, 1]; `None` if none is running.
    pub(crate) export_progress: Option<f32>,
}

/// Command that starts or cancels a measurement, or changes the view of its results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MeasureCommand {
    /// Measures time and error of every upscaler.
    MeasureUpscalers,
    /// Cancels the measurement of the upscalers.
    CancelUpscalers,
    /// Runs the stability report over all classes of difficult test cases.
    RunStability,
    /// Cancels the stability report.
    CancelStability,
    /// Changes the view of the stability report.
    ShowStability(StabilityView),
    /// Measures how much frame time the current view saves because its draws skip unneeded parts of the pipeline.
    MeasurePlan,
    /// Cancels the measurement started by [`Self::MeasurePlan`].
    CancelPlan,
    /// Measures how the frame time scales with triangles, pixels, overlapping layers and threads.
    MeasureScaling,
    /// Cancels the scaling measurement.
    CancelScaling,
}

impl Feature for LongTasks {
    type Change = MeasureCommand;

    fn apply(session: &mut Session, change: MeasureCommand) -> Option<WindowTask> {
        let tasks = &mut session.features.tasks;
        match change {
            MeasureCommand::ShowStability(view) => tasks.stability.view = view,
            MeasureCommand::CancelStability => tasks.stability.task.iter().for_each(BackgroundTask::cancel),
            MeasureCommand::CancelPlan => tasks.savings.task.iter().for_each(BackgroundTask::cancel),
            MeasureCommand::CancelScaling => tasks.scaling.task.iter().for_each(BackgroundTask::cancel),
            MeasureCommand::MeasureUpscalers => return Some(WindowTask::Measure(MeasureTask::Upscalers)),
            MeasureCommand::CancelUpscalers => return Some(WindowTask::Measure(MeasureTask::CancelUpscalers)),
            MeasureCommand::RunStability => return Some(WindowTask::Measure(MeasureTask::Stability)),
            MeasureCommand::MeasurePlan => return Some(WindowTask::Measure(MeasureTask::Plan)),
            MeasureCommand::MeasureScaling => return Some(WindowTask::Measure(MeasureTask::Scaling)),
        }
        None
    }

    fn leave_scene(&mut self) {
        self.measuring = None;
    }
}

/// Progress of a running measurement of all upscalers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Measuring {
    /// Completed fraction of the measurement, in [0, 1].
    pub(crate) progress: f32,
}

/// View of the stability report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum StabilityView {
    /// Heat map of the errors of every configuration (columns) on every class of difficult cases (rows).
    #[default]
    HeatMap,
    /// Scatter plot of error against time, one point for each configuration.
    ErrorAgainstTime,
}

/// State of the stability report.
#[derive(Debug, Default)]
pub(crate) struct Stability {
    /// The running measurement; `None` if none is running.
    pub(crate) task: Option<StabilityTask>,
    /// Last complete stability report.
    pub(crate) report: Option<Arc<StabilityReport>>,
    /// Progress of the running report; `None` if none is running.
    pub(crate) progress: Option<StabilityProgress>,
    /// View selected in the panel.
    pub(crate) view: StabilityView,
}

/// State of the measurement of how much frame time the draws of a view save by skipping unneeded parts of the pipeline.
#[derive(Debug, Default)]
pub(crate) struct PlanSavings {
    /// The running measurement; `None` if none is running.
    pub(crate) task: Option<SavingsTask>,
    /// Last result, and the request that was measured.
    pub(crate) found: Option<(Arc<Savings>, Request)>,
    /// Completed fraction of the running measurement, from 0 to 1; `None` if none is running.
    pub(crate) progress: Option<f32>,
}

/// State of the scaling measurement.
#[derive(Debug, Default)]
pub(crate) struct ScalingState {
    /// The running measurement; `None` if none is running.
    pub(crate) task: Option<ScalingTask>,
    /// Last result, and the recipe with which it was measured.
    pub(crate) found: Option<(Arc<Scaling>, Recipe)>,
    /// Quantity that is being measured, and the completed fraction of this measurement, from 0 to 1; `None` if no
    /// measurement is running.
    pub(crate) progress: Option<(ScalingQuantity, f32)>,
}

/// A running stability report.
pub(crate) type StabilityTask = BackgroundTask<StabilityProgress, StabilityReport>;

/// A running measurement of how much frame time draws save by skipping unneeded parts of the pipeline. The result
/// includes the request that was measured.
pub(crate) type SavingsTask = BackgroundTask<f32, (Savings, Request)>;

/// A running scaling measurement. The result includes the recipe with which it was measured.
pub(crate) type ScalingTask = BackgroundTask<(ScalingQuantity, f32), (Scaling, Recipe)>;
