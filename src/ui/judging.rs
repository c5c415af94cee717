//! What the window knows of measurements that take a while: the stability report, what the plan saves, how cost grows.

use std::sync::Arc;

use super::task::Task;
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
    /// The last that was measured, and the name of the scene that it is of.
    pub found: Option<(Arc<Savings>, String)>,
    /// Share of the present measurement that is done.
    pub progress: Option<f32>,
}

/// What is known of how cost grows.
#[derive(Clone, Debug, Default)]
pub struct Growth {
    /// The last that was measured.
    pub found: Option<Arc<Scaling>>,
    /// What is being measured, and the share of it that is done.
    pub progress: Option<(Quantity, f32)>,
}

/// A stability report that is being made.
pub type Judging = Task<Progress, Report>;

/// Savings that are being measured, and the name of the scene that they are of.
pub type MeasuringSavings = Task<f32, (Savings, String)>;

/// Growth that is being measured.
pub type MeasuringGrowth = Task<(Quantity, f32), Scaling>;
