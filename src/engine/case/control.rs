//! Progress reporting and cancellation of a case, and the size limit of its answer.

use std::cell::Cell;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

use super::{Refusal, Unanswered};

/// Memory limit for the lists in an answer, in bytes. The limit keeps the memory used by an evaluation, including the
/// case and working memory, well below 512 MB.
pub(crate) const MAX_ANSWER_BYTES: u64 = 192 << 20;

/// Returns the number of entries of type `T` that fit into [`MAX_ANSWER_BYTES`].
const fn max_entries<T>() -> u64 {
    MAX_ANSWER_BYTES / size_of::<T>() as u64
}

/// Returns a refusal if `count` entries of type `T` exceed [`MAX_ANSWER_BYTES`].
///
/// `entries` is the plural name of the entries in the message, such as `pixels` in “the answer has more than 5 pixels,
/// the limit”.
pub(super) fn check_length<T>(entries: &str, count: u64) -> Result<(), Refusal> {
    if count > max_entries::<T>() {
        return Err(Refusal(format!("the answer has more than {} {entries}, the limit", max_entries::<T>())));
    }
    Ok(())
}

/// Handle for progress reporting and cancellation of a case under evaluation.
pub struct Control<'a> {
    progress: &'a dyn Fn(f32),
    stop: &'a AtomicBool,
    /// Last reported progress, in units of 1 / [`REPORTS`].
    reported: Cell<u32>,
}

/// Maximum number of progress reports per case. More reports would only keep the receiver busy.
const REPORTS: f64 = 200.0;

/// Number of algorithm steps between two progress reports.
const STEPS_PER_REPORT: u64 = 1 << 10;

impl<'a> Control<'a> {
    /// Creates a control from a progress callback and a cancellation flag.
    ///
    /// `progress` receives the completed fraction of the work, in [0, 1], which never decreases. After `stop` is set,
    /// evaluation ends within a few milliseconds.
    pub fn new(progress: &'a dyn Fn(f32), stop: &'a AtomicBool) -> Self {
        Self { progress, stop, reported: Cell::new(0) }
    }

    /// Returns an error if the case has been cancelled.
    pub(crate) fn check(&self) -> Result<(), Unanswered> {
        if self.stop.load(Ordering::Relaxed) { Err(Unanswered::Cancelled) } else { Ok(()) }
    }

    /// Reports the completed fraction of the work, in [0, 1]. Returns an error if the case has been cancelled.
    pub(crate) fn step(&self, share: f64) -> Result<(), Unanswered> {
        let steps = (share * REPORTS) as u32;
        if steps > self.reported.get() {
            self.reported.set(steps);
            (self.progress)(share as f32);
        }
        self.check()
    }

    /// Collects the results of an algorithm that yields at most one result per step.
    ///
    /// For progress reports, `done` is the number of steps completed before this call, and `of` is the total number of
    /// steps; both may be estimates. Returns an error if the case is cancelled or the results exceed
    /// [`MAX_ANSWER_BYTES`].
    pub(super) fn collect<T>(
        &self,
        entries: &str,
        (done, of): (u64, u64),
        steps: impl Iterator<Item = Option<T>>,
    ) -> Result<Vec<T>, Unanswered> {
        let mut results = Vec::new();
        for (number, result) in (0_u64..).zip(steps) {
            if number.is_multiple_of(STEPS_PER_REPORT) {
                check_length::<T>(entries, results.len() as u64)?;
                self.step(((done + number) as f64 / of.max(1) as f64).min(1.0))?;
            }
            self.check()?;
            results.extend(result);
        }
        check_length::<T>(entries, results.len() as u64)?;
        Ok(results)
    }
}

impl Default for Control<'_> {
    /// Returns a control that reports nothing and is never cancelled.
    fn default() -> Self {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Self::new(&|_| {}, &NEVER)
    }
}

impl fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Control").field("stop", &self.stop).field("reported", &self.reported).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
