//! Progress and cancellation of tasks that take long.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

/// Progress callback and cancellation flag of a task.
#[derive(Clone, Copy)]
pub struct TaskControl<'a> {
    /// Callback that receives the progress, in [0, 1]. With several threads, reports may arrive out of order.
    pub progress: &'a (dyn Fn(f32) + Sync),
    /// Flag that cancels the task once it is `true`.
    pub cancel: &'a AtomicBool,
}

impl TaskControl<'static> {
    /// Returns a control without progress reports and cancellation.
    pub fn quiet() -> Self {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Self { progress: &|_| {}, cancel: &NEVER }
    }
}

impl TaskControl<'_> {
    /// Returns `Some(())`, or `None` once the task is cancelled.
    pub(super) fn check(self) -> Option<()> {
        (!self.cancel.load(Ordering::Relaxed)).then_some(())
    }
}

impl fmt::Debug for TaskControl<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TaskControl").field("cancel", &self.cancel).finish_non_exhaustive()
    }
}
