//! CPU times of the window's most recent frames.

use std::collections::VecDeque;

use crate::measure::timing::{Summary, summarize};

/// Maximum number of recent window frames whose times are stored.
const RECENT: usize = 240;

/// CPU times of the window's most recent frames, in milliseconds.
#[derive(Clone, Debug, Default)]
pub(crate) struct WindowTimes {
    recent: VecDeque<f64>,
}

impl WindowTimes {
    /// Adds the CPU time of a window frame, in milliseconds.
    pub(crate) fn record(&mut self, milliseconds: f64) {
        if self.recent.len() == RECENT {
            self.recent.pop_front();
        }
        self.recent.push_back(milliseconds);
    }

    /// Returns statistics of the recorded times, in milliseconds; `None` if there are none.
    pub(crate) fn summary(&self) -> Option<Summary> {
        summarize(&self.recent.iter().copied().collect::<Vec<_>>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_passes_make_room_for_new_ones() {
        let mut times = WindowTimes::default();
        assert!(times.summary().is_none());
        times.record(900.0);
        (0..RECENT).for_each(|_| times.record(2.0));
        let summary = times.summary().unwrap();
        assert_eq!((summary.n, summary.max), (RECENT, 2.0));
    }
}
