//! Background evaluation of one part of a test case.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use eframe::egui::Context;

use crate::case::{Case, Control, Options};
use crate::report::comparison::{DisplayedResult, PixelCounts, show};
use crate::ui::task::{BackgroundTask, TaskStatus};

/// Request to evaluate one part of a test case.
#[derive(Clone, Debug)]
pub(crate) struct EvaluationRequest {
    /// Case to evaluate.
    pub(crate) case: Arc<Case>,
    /// Index of the part to evaluate.
    pub(crate) part: usize,
    /// Rasterizer and arithmetic with which the case is evaluated.
    pub(crate) options: Options,
}

impl EvaluationRequest {
    /// Whether both requests have the same result.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        self.is_about(&other.case) && (self.part, self.options) == (other.part, other.options)
    }

    /// Whether the request concerns this case, compared by pointer.
    pub(super) fn is_about(&self, case: &Arc<Case>) -> bool {
        Arc::ptr_eq(&self.case, case)
    }
}

/// Result of an evaluation, together with its request.
#[derive(Debug)]
pub(crate) struct Evaluation {
    /// Request that was evaluated.
    pub(crate) request: EvaluationRequest,
    /// Result to display.
    pub(super) shown: DisplayedResult,
    /// Pixel counts of the result; zero if the result is text.
    pub(super) figures: PixelCounts,
}

impl Evaluation {
    /// Evaluates a request. Returns `None` if cancelled.
    pub(crate) fn new(question: EvaluationRequest, control: &Control<'_>) -> Option<Self> {
        let shown = show(&question.case, question.part, question.options, control)?;
        let figures = match &shown {
            DisplayedResult::Pixels(comparison) => comparison.figures(),
            DisplayedResult::Text(_) => PixelCounts::default(),
        };
        Some(Self { request: question, shown, figures })
    }
}

/// Evaluation in a background thread. Dropping it cancels the evaluation.
#[derive(Debug)]
pub(super) struct Running {
    pub(super) question: EvaluationRequest,
    pub(super) since: Instant,
    /// Completed fraction of the evaluation, from 0 to 1; `None` before the first report.
    pub(super) progress: Option<f32>,
    task: BackgroundTask<f32, Evaluation>,
}

impl Running {
    pub(super) fn start(context: Context, question: EvaluationRequest) -> Self {
        let asked = question.clone();
        let work = move |report_progress: &(dyn Fn(f32) + Sync), stop: &AtomicBool| {
            Evaluation::new(asked, &Control::new(report_progress, stop))
        };
        Self { question, since: Instant::now(), progress: None, task: BackgroundTask::start(context, work) }
    }

    /// Returns the evaluation once it is complete, otherwise `None`. If the thread panicked, the result is an error
    /// message.
    pub(super) fn poll(&mut self) -> Option<Evaluation> {
        match self.task.poll(&mut self.progress) {
            TaskStatus::Ended(Some(evaluation)) => Some(*evaluation),
            TaskStatus::Lost => Some(Evaluation {
                request: self.question.clone(),
                shown: DisplayedResult::Text(vec!["The evaluation stopped because of an internal error".to_owned()]),
                figures: PixelCounts::default(),
            }),
            TaskStatus::Running | TaskStatus::Ended(None) => None,
        }
    }
}
