//! What the window knows of measurements that take a while: the stability report, what the plan saves, how cost grows.

use std::sync::Arc;

use super::engine::Request;
use super::task::Task;
use crate::chain::Recipe;
use crate::measure::leaving_out::Savings;
use crate::measure::scaling::{Quantity, Scaling};
use crate::report::stability::sweep::{Progress, Report};

/// How the stability report is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StabilityView {
    /// Classes against configurations.
    #[default]
    HeatMap,
    /// One point for each configuration.
    ErrorAgainstTime,
}

/// What is known of the stability report.
#[derive(Clone, Debug, Default)]
pub struct Stability {
    /// The last one that was finished.
    pub report: Option<Arc<Report>>,
    /// How far the one that is running has come.
    pub progress: Option<Progress>,
    /// How it is shown.
    pub view: StabilityView,
}

/// What is known of what leaving out saves.
#[derive(Clone, Debug, Default)]
pub struct PlanSavings {
    /// The last that was measured, and what it was measured on.
    pub found: Option<(Arc<Savings>, Request)>,
    /// Share of the present measurement that is done.
    pub progress: Option<f32>,
}

/// What is known of how cost grows.
#[derive(Clone, Debug, Default)]
pub struct Growth {
    /// The last that was measured, and the recipe that it was measured with.
    pub found: Option<(Arc<Scaling>, Recipe)>,
    /// What is being measured, and the share of it that is done.
    pub progress: Option<(Quantity, f32)>,
}

/// A stability report that is being made.
pub type Judging = Task<Progress, Report>;

/// Savings that are being measured, and what they are measured on.
pub type MeasuringSavings = Task<f32, (Savings, Request)>;

/// Growth that is being measured, and the recipe that it is measured with.
pub type MeasuringGrowth = Task<(Quantity, f32), (Scaling, Recipe)>;
