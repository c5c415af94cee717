//! Progress and results of long measurements: the stability report, the savings of the plan, and the scaling of cost.

use std::sync::Arc;

use super::engine::Request;
use super::task::Task;
use crate::chain::Recipe;
use crate::measure::leaving_out::Savings;
use crate::measure::scaling::{Quantity, Scaling};
use crate::report::stability::sweep::{Progress, Report};

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
pub(crate) struct Stability {
    /// Last complete report.
    pub(crate) report: Option<Arc<Report>>,
    /// Progress of the running report.
    pub(crate) progress: Option<Progress>,
    /// Selected view.
    pub(crate) view: StabilityView,
}

/// State of the measurement of the plan's savings.
#[derive(Clone, Debug, Default)]
pub(crate) struct PlanSavings {
    /// Last result and the request that it was measured on.
    pub(crate) found: Option<(Arc<Savings>, Request)>,
    /// Completed share of the running measurement, in [0, 1].
    pub(crate) progress: Option<f32>,
}

/// State of the scaling measurement.
#[derive(Clone, Debug, Default)]
pub(crate) struct Growth {
    /// Last result and the recipe that it was measured with.
    pub(crate) found: Option<(Arc<Scaling>, Recipe)>,
    /// Quantity being measured and the completed share of the measurement, in [0, 1].
    pub(crate) progress: Option<(Quantity, f32)>,
}

/// A running stability report.
pub(crate) type Judging = Task<Progress, Report>;

/// A running measurement of savings; the result includes the request that it was measured on.
pub(crate) type MeasuringSavings = Task<f32, (Savings, Request)>;

/// A running scaling measurement; the result includes the recipe that it was measured with.
pub(crate) type MeasuringGrowth = Task<(Quantity, f32), (Scaling, Recipe)>;
