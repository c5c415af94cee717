//! Progress and results of long measurements: the stability report, the savings of the plan, and the scaling of cost.

use std::sync::Arc;

use super::engine::Request;
use super::task::BackgroundTask;
use crate::chain::Recipe;
use crate::measure::scaling::{Scaling, ScalingQuantity};
use crate::measure::skipped_work::Savings;
use crate::report::stability::sweep::{StabilityProgress, StabilityReport};

/// View of the stability report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StabilityView {
    /// Heat map of classes by configurations.
    #[default]
    HeatMap,
    /// Scatter plot of error against time, one point for each configuration.
    ErrorAgainstTime,
}

/// State of the stability report.
#[derive(Clone, Debug, Default)]
pub struct Stability {
    /// Last complete report.
    pub report: Option<Arc<StabilityReport>>,
    /// Progress of the running report.
    pub progress: Option<StabilityProgress>,
    /// Selected view.
    pub(crate) view: StabilityView,
}

/// State of the measurement of the plan's savings.
#[derive(Clone, Debug, Default)]
pub struct PlanSavings {
    /// Last result and the request that it was measured on.
    pub found: Option<(Arc<Savings>, Request)>,
    /// Completed share of the running measurement, in [0, 1].
    pub progress: Option<f32>,
}

/// State of the scaling measurement.
#[derive(Clone, Debug, Default)]
pub struct ScalingState {
    /// Last result and the recipe that it was measured with.
    pub found: Option<(Arc<Scaling>, Recipe)>,
    /// Quantity being measured and the completed share of the measurement, in [0, 1].
    pub progress: Option<(ScalingQuantity, f32)>,
}

/// A running stability report.
pub(crate) type StabilityTask = BackgroundTask<StabilityProgress, StabilityReport>;

/// A running measurement of savings; the result includes the request that it was measured on.
pub(crate) type SavingsTask = BackgroundTask<f32, (Savings, Request)>;

/// A running scaling measurement; the result includes the recipe that it was measured with.
pub(crate) type ScalingTask = BackgroundTask<(ScalingQuantity, f32), (Scaling, Recipe)>;
