//! Request for a measurement of all upscalers, and their errors.

use crate::measure::against::ErrorMetrics;
use crate::measure::metric::Metric;
use crate::measure::motion::{MotionError, Turn};
use crate::measure::reference::Reference;
use crate::ui::engine::Request;

/// Request to measure the time and error of all upscalers.
#[derive(Clone, Debug)]
pub(crate) struct MeasureRequest {
    /// Number that identifies the responses to this request.
    pub(crate) number: u64,
    /// Scene, view and recipe to measure. Only the upscaler of the recipe is varied.
    pub(crate) of: Request,
    /// Reference against which errors are computed.
    pub(crate) reference: Reference,
    /// Motion of the camera over the measured frames.
    pub(crate) turn: Turn,
    /// Metric to measure besides those of every measurement.
    pub(crate) metric: Metric,
}

/// Error of an upscaler over the frames measured so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MethodError {
    /// Error of the still view after it has converged.
    pub(crate) still: ErrorMetrics,
    /// Error over the frames in motion. If the camera is still, this is the error of the still view.
    pub(crate) motion: MotionError,
}
