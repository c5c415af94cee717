//! Renderer side of earlier frames: draws one frame per step.

use super::TemporalRequest;
use crate::inspect::temporal::{PixelHistory, TemporalSearch};

/// Search for the history of the newest requested pixel.
#[derive(Debug, Default)]
pub(crate) struct TemporalSearcher {
    request: Option<TemporalRequest>,
    search: Option<TemporalSearch>,
}

impl TemporalSearcher {
    /// Replaces the request; `None` cancels the search.
    pub(crate) fn set(&mut self, request: Option<TemporalRequest>) {
        (self.request, self.search) = (request, None);
    }

    /// Whether a result is missing.
    pub(crate) fn has_work(&self) -> bool {
        self.request.is_some()
    }

    /// Whether the search has begun and is not complete.
    pub(crate) fn has_begun(&self) -> bool {
        self.search.is_some()
    }

    /// Draws the next frame. Returns the request and its result after the last one.
    pub(crate) fn step(&mut self) -> Option<(TemporalRequest, PixelHistory)> {
        let request = self.request.take()?;
        let mut search = match self.search.take() {
            Some(search) => search,
            None => TemporalSearch::new(request.clip(), request.pixel)?,
        };
        if search.step() {
            (self.request, self.search) = (Some(request), Some(search));
            return None;
        }
        Some((request, search.finish()))
    }
}
