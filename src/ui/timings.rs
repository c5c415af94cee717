//! Frame times, kept apart by what they were measured on: the recent frames of the present scene, settings and size, and
//! the last measurement of all upscalers. Times of different pictures never share a line.

use std::collections::{BTreeMap, VecDeque};

use super::engine::Request;
use crate::chain::Recipe;
use crate::measure::timing::summarize;
use crate::upscale::Upscaling;

/// Recent frames kept.
const RECENT: usize = 240;

/// All frame times that the window knows, in ms.
#[derive(Debug, Default)]
pub struct Timings {
    recent: VecDeque<f64>,
    recent_of: Option<Request>,
    measured: BTreeMap<Upscaling, Vec<f64>>,
    measured_of: Option<Request>,
}

impl Timings {
    /// Adds the time of a frame that was drawn for `request`. Frames of another scene, recipe or size start anew; the
    /// view may move.
    pub fn record_recent(&mut self, request: &Request, milliseconds: f64) {
        let goes_on = self.recent_of.as_ref().is_some_and(|old| {
            std::sync::Arc::ptr_eq(&old.scene, &request.scene)
                && old.recipe == request.recipe
                && old.viewport == request.viewport
        });
        if !goes_on {
            self.recent.clear();
            self.recent_of = Some(request.clone());
        }
        if self.recent.len() == RECENT {
            self.recent.pop_front();
        }
        self.recent.push_back(milliseconds);
    }

    /// Starts a measurement.
    pub fn begin_measurement(&mut self, request: Request) {
        self.measured.clear();
        self.measured_of = Some(request);
    }

    /// Adds a sample of the measurement.
    pub fn record_measured(&mut self, upscaling: Upscaling, milliseconds: f64) {
        if self.measured_of.is_some() {
            self.measured.entry(upscaling).or_default().push(milliseconds);
        }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Whether there is a measurement to show, begun or complete.
    pub fn has_measurement(&self) -> bool {
        !self.measured.is_empty()
    }

    /// Whether the measurement was made on what `request` shows, whatever its upscaler.
    pub fn measurement_fits(&self, request: &Request) -> bool {
        let upscaler = Upscaling::NATIVE;
        let plain = |r: &Request| Request {
            recipe: Recipe { upscaler, ..r.recipe },
            shown: request.shown,
            pick: None,
            triangle_limit: None,
            ..r.clone()
        };
        self.measured_of.as_ref().is_some_and(|measured| plain(measured).same_view(&plain(request)))
    }

    /// Median of a method over the median of native, if both were measured on what `request` shows.
    pub fn share_of_native(&self, request: &Request, upscaling: Upscaling) -> Option<f64> {
        let median = |u| summarize(self.measured.get(&u)?).map(|summary| summary.median);
        let fits = self.measurement_fits(request);
        fits.then(|| Some(median(upscaling)? / median(Upscaling::NATIVE)?)).flatten()
    }

    /// The measurement, or else the recent frames, per method; oldest first.
    pub fn series(&self) -> Vec<(Upscaling, Vec<f64>)> {
        if self.has_measurement() {
            return self.measured.iter().map(|(upscaling, times)| (*upscaling, times.clone())).collect();
        }
        match &self.recent_of {
            Some(request) => vec![(request.recipe.upscaler, self.recent.iter().copied().collect())],
            None => Vec::new(),
        }
    }
}
