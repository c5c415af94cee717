//! Progress and cancellation of a vector drawing.

use std::fmt;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Progress callback and cancellation flag of a vector drawing.
#[derive(Clone, Copy)]
pub struct OutlineControl<'a> {
    /// Callback that receives the progress, in [0, 1], at most once per percent. With several threads, reports may
    /// arrive out of order.
    pub progress: &'a (dyn Fn(f32) + Sync),
    /// Flag that cancels the drawing once it is `true`.
    pub cancel: &'a AtomicBool,
}

impl OutlineControl<'_> {
    /// Returns `Some(())`, or `None` once the drawing is cancelled.
    pub(super) fn check(self) -> Option<()> {
        (!self.cancel.load(Ordering::Relaxed)).then_some(())
    }
}

impl fmt::Debug for OutlineControl<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("OutlineControl").field("cancel", &self.cancel).finish_non_exhaustive()
    }
}

/// A step of a vector drawing, divided into equal parts that threads complete in any order.
pub(super) struct ParallelStep<'a> {
    control: OutlineControl<'a>,
    /// Progress of the whole drawing before and after the step, in percent.
    percent: Range<usize>,
    /// Number of equal parts of the step, at least 1.
    parts: usize,
    completed: AtomicUsize,
}

impl<'a> ParallelStep<'a> {
    /// Begins a step of `parts` parts. During the step, the progress of the whole drawing rises from the start to the
    /// end of `percent`.
    pub(super) fn new(control: OutlineControl<'a>, percent: Range<usize>, parts: usize) -> Self {
        Self { control, percent, parts, completed: AtomicUsize::new(0) }
    }

    /// Reports one more completed part. Returns `None` once the drawing is cancelled.
    pub(super) fn advance(&self) -> Option<()> {
        let before = self.completed.fetch_add(1, Ordering::Relaxed);
        let percent = |completed: usize| self.percent.start + self.percent.len() * completed / self.parts;
        if percent(before) < percent(before + 1) {
            (self.control.progress)(percent(before + 1) as f32 / 100.0);
        }
        self.control.check()
    }
}
