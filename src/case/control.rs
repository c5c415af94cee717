//! Progress and cancellation of a case, and the limit of its answer.

use std::cell::Cell;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

use super::{Refusal, Unanswered};

/// Most memory that the lists of an answer take, bytes. With the case itself and working memory, answering stays well below
/// 512 MB.
pub const MAX_ANSWER_BYTES: u64 = 192 << 20;

/// Most entries of type `T` in an answer.
const fn most<T>() -> u64 {
    MAX_ANSWER_BYTES / size_of::<T>() as u64
}

/// Refuses an answer of more entries of type `T` than [`MAX_ANSWER_BYTES`] hold. `entries` completes “more than 5 …”.
pub(super) fn check_length<T>(entries: &str, count: u64) -> Result<(), Refusal> {
    if count > most::<T>() {
        return Err(Refusal(format!("the answer has more than {} {entries}, the most that are listed", most::<T>())));
    }
    Ok(())
}

/// Progress reports and cancellation of a case that is being answered.
pub struct Control<'a> {
    progress: &'a dyn Fn(f32),
    stop: &'a AtomicBool,
    /// Progress steps reported so far.
    reported: Cell<u32>,
}

/// Progress reports of a whole case: more would only keep the listener busy.
const REPORTS: f64 = 200.0;

/// Steps of an algorithm between two looks at the progress.
const STEPS_PER_REPORT: u64 = 1 << 10;

impl<'a> Control<'a> {
    /// `progress` gets the completed share, in [0, 1], never a smaller one than before. Once `stop` is set, the case is given
    /// up within some milliseconds.
    pub fn new(progress: &'a dyn Fn(f32), stop: &'a AtomicBool) -> Self {
        Self { progress, stop, reported: Cell::new(0) }
    }

    /// Fails once the case is cancelled.
    pub(crate) fn check(&self) -> Result<(), Unanswered> {
        if self.stop.load(Ordering::Relaxed) { Err(Unanswered::Cancelled) } else { Ok(()) }
    }

    /// Reports the completed share, in [0, 1], and fails once the case is cancelled.
    pub(crate) fn step(&self, share: f64) -> Result<(), Unanswered> {
        let steps = (share * REPORTS) as u32;
        if steps > self.reported.get() {
            self.reported.set(steps);
            (self.progress)(share as f32);
        }
        self.check()
    }

    /// Lists the results of an algorithm, of which each step gives one or none. `done` steps of `of` came before; both are
    /// estimates. Errors: see [`check_length`]; cancelled.
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
    /// Reports nothing and is never cancelled.
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
