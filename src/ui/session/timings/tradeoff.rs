//! Trade-off of frame time against error: the measured upscalers with their ranks.

use super::Timings;
use crate::measure::against::ErrorMetrics;
use crate::measure::metric::Metric;
use crate::measure::timing::{Summary, summarize};
use crate::report::upscaling::tradeoff::{Standing, standings};
use crate::ui::session::timings::request::MethodError;
use crate::upscale::Upscaling;

/// Frame time and error of an upscaler.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TradeOff {
    /// Upscaler with its options.
    pub(crate) upscaling: Upscaling,
    /// Statistics of the frame times, in milliseconds.
    pub(crate) ms: Summary,
    /// Error against the reference of the measurement.
    pub(crate) error: MethodError,
    /// Metric by which upscalers are ranked.
    pub(crate) metric: Metric,
    /// Position relative to the Pareto front of frame time and mean error; `None` before the first round is complete, when
    /// the time is provisional.
    pub(crate) standing: Option<Standing<Upscaling>>,
    /// Whether the frame time differs from that of native rendering by no more than the noise.
    pub(crate) native_within_noise: bool,
}

impl TradeOff {
    /// Returns the mean value of the metric over the frames in motion.
    pub(crate) fn mean(&self) -> f64 {
        self.error.motion.mean.value(self.metric)
    }

    /// Returns the mean error in motion by the metric: 0 for pictures that equal the reference.
    pub(crate) fn mean_error(&self) -> f64 {
        self.metric.error(self.mean())
    }
}

impl Timings {
    /// Returns every upscaler of the measurement whose time and error are known. Before the first round is complete, the
    /// time is that of a single frame, and the upscalers are not ranked.
    pub(crate) fn tradeoff(&self) -> Vec<TradeOff> {
        let times = |upscaling: &Upscaling| match self.noise {
            Some(_) => summarize(self.measured.get(upscaling)?),
            None => summarize(&[*self.first_ms.get(upscaling)?]),
        };
        let known = self.errors.iter().filter_map(|(upscaling, error)| Some((*upscaling, times(upscaling)?, *error)));
        let known: Vec<_> = known.collect();
        let metric = self.metric_in_use();
        let points: Vec<_> = known.iter().map(|(_, ms, error)| (ms.median, mean_error(error, metric))).collect();
        let standings = self.noise.map(|noise| standings(&points, &noise));
        let point = |(place, (upscaling, ms, error)): (usize, &(Upscaling, Summary, MethodError))| TradeOff {
            upscaling: *upscaling,
            ms: *ms,
            error: *error,
            metric,
            standing: standings.as_ref().map(|standings| standings[place].map(|other| known[other].0)),
            native_within_noise: self.is_within_noise_of_native(*upscaling),
        };
        known.iter().enumerate().map(point).collect()
    }

    /// Returns the metric that ranks the upscalers: the chosen one, or FLIP if the measurement lacks it.
    pub(crate) fn metric_in_use(&self) -> Metric {
        let is_requested = self.measurement_request.as_ref().is_none_or(|request| request.metric == self.metric);
        let is_known = |error: &MethodError| mean_error(error, self.metric).is_finite();
        let is_measured = ErrorMetrics::always_has(self.metric) || is_requested;
        if is_measured && self.errors.values().all(is_known) { self.metric } else { Metric::Flip }
    }
}

/// Returns the mean error of an upscaler in motion by a metric.
fn mean_error(error: &MethodError, metric: Metric) -> f64 {
    metric.error(error.motion.mean.value(metric))
}
