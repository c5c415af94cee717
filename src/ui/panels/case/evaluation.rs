//! Background evaluation of a part of a case.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use eframe::egui::Context;

use crate::case::{Case, Control, Options};
use crate::report::comparison::{Figures, Shown, show};
use crate::ui::task::{Listening, Task};

/// Part of a case to evaluate, and the options for it.
#[derive(Clone, Debug)]
pub(crate) struct Question {
    /// Case to evaluate.
    pub(crate) case: Arc<Case>,
    /// Index of the part.
    pub(crate) part: usize,
    /// Algorithms and arithmetic of the evaluation.
    pub(crate) options: Options,
}

impl Question {
    /// Whether both questions have the same result.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        self.is_about(&other.case) && (self.part, self.options) == (other.part, other.options)
    }

    /// Whether the question is about this case, compared by pointer.
    pub(super) fn is_about(&self, case: &Arc<Case>) -> bool {
        Arc::ptr_eq(&self.case, case)
    }
}

/// Question with its result.
#[derive(Debug)]
pub(crate) struct Evaluation {
    /// Evaluated question.
    pub(crate) question: Question,
    /// Result to display.
    pub(super) shown: Shown,
    /// Figures of a result in pixels; default for text.
    pub(super) figures: Figures,
}

impl Evaluation {
    /// Evaluates a question. Returns `None` if cancelled.
    pub(crate) fn new(question: Question, control: &Control<'_>) -> Option<Self> {
        let shown = show(&question.case, question.part, question.options, control)?;
        let figures = match &shown {
            Shown::Pixels(comparison) => comparison.figures(),
            Shown::Text(_) => Figures::default(),
        };
        Some(Self { question, shown, figures })
    }
}

/// Evaluation in a background thread; dropping it cancels it.
#[derive(Debug)]
pub(super) struct Running {
    pub(super) question: Question,
    pub(super) since: Instant,
    /// Completed share in [0, 1].
    pub(super) progress: Option<f32>,
    task: Task<f32, Evaluation>,
}

impl Running {
    pub(super) fn start(context: Context, question: Question) -> Self {
        let asked = question.clone();
        let work =
            move |tell: &(dyn Fn(f32) + Sync), stop: &AtomicBool| Evaluation::new(asked, &Control::new(tell, stop));
        Self { question, since: Instant::now(), progress: None, task: Task::start(context, work) }
    }

    /// Returns the evaluation once it is complete. If the thread panicked, its result is an error message.
    pub(super) fn poll(&mut self) -> Option<Evaluation> {
        match self.task.listen(&mut self.progress) {
            Listening::Ended(Some(evaluation)) => Some(*evaluation),
            Listening::BrokeOff => Some(Evaluation {
                question: self.question.clone(),
                shown: Shown::Text(vec!["The evaluation stopped: internal error".to_owned()]),
                figures: Figures::default(),
            }),
            Listening::GoesOn | Listening::Ended(None) => None,
        }
    }
}
