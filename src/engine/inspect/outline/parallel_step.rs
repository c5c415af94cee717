//! Steps of a vector drawing that several threads complete.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::inspect::control::TaskControl;

/// A step of a vector drawing, divided into equal parts that threads complete in any order.
pub(super) struct ParallelStep<'a> {
    control: TaskControl<'a>,
    /// Progress of the whole drawing before and after the step, in percent.
    percent: Range<usize>,
    /// Number of equal parts of the step, at least 1.
    parts: usize,
    completed: AtomicUsize,
}

impl<'a> ParallelStep<'a> {
    /// Begins a step of `parts` parts. During the step, the progress of the whole drawing rises from the start to the
    /// end of `percent`.
    pub(super) fn new(control: TaskControl<'a>, percent: Range<usize>, parts: usize) -> Self {
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
