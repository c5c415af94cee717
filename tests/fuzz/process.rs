//! Memory and time of this process, as reported by Linux.

use std::collections::BTreeMap;
use std::fs;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Stopwatch of a thread that excludes the time for which the thread was ready to run but had no processor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stopwatch {
    begun: Instant,
    waited: Duration,
}

impl Stopwatch {
    /// Starts measuring this thread.
    pub(crate) fn start() -> Self {
        Self { begun: Instant::now(), waited: waited() }
    }

    /// Returns the time since the start; must be called on the same thread.
    pub(crate) fn elapsed(self) -> Duration {
        self.begun.elapsed().saturating_sub(waited().saturating_sub(self.waited))
    }
}

/// Returns the time for which this thread has waited for a processor so far; 0 if the system does not report it.
fn waited() -> Duration {
    // The second number, in nanoseconds; see "Scheduler Statistics" of the kernel's documentation.
    let statistics = fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let waited = statistics.split_whitespace().nth(1).and_then(|nanoseconds| nanoseconds.parse().ok());
    Duration::from_nanos(waited.unwrap_or(0))
}

/// Largest resident memory of each execution in progress up to the last reset, in bytes, by the execution's number.
static ONGOING: Mutex<BTreeMap<u64, u64>> = Mutex::new(BTreeMap::new());

/// Meter of the largest resident memory of the process since the start, independent of meters on other threads.
#[derive(Debug)]
pub(crate) struct PeakMeter {
    number: u64,
    resident: u64,
}

impl PeakMeter {
    /// Starts measuring. The system has one peak per process, so the peak of other measurements is recorded before it
    /// is reset.
    pub(crate) fn start() -> Self {
        let mut ongoing = ONGOING.lock().unwrap_or_else(PoisonError::into_inner);
        let peak = status("VmHWM:").unwrap_or(0);
        ongoing.values_mut().for_each(|known| *known = peak.max(*known));
        // See proc(5): 5 resets the peak of the resident memory. If the system does not support that, growth below
        // earlier peaks is not detected.
        drop(fs::write("/proc/self/clear_refs", "5"));
        let number = ongoing.last_key_value().map_or(0, |(last, _)| last + 1);
        ongoing.insert(number, 0);
        Self { number, resident: status("VmRSS:").unwrap_or(0) }
    }

    /// Returns the peak and its growth since the start, in bytes; 0 if the system does not report them.
    pub(crate) fn finish(self) -> (u64, u64) {
        let known = ONGOING.lock().unwrap_or_else(PoisonError::into_inner).remove(&self.number);
        let peak = known.unwrap_or(0).max(status("VmHWM:").unwrap_or(0));
        (peak, peak.saturating_sub(self.resident))
    }
}

/// Returns a field of the process's status, in bytes; `None` if the system does not report it.
fn status(field: &str) -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with(field))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
}
