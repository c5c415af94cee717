//! A part of a case that is answered in the background.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use eframe::egui::Context;

use crate::case::{Case, Control, Options};
use crate::report::comparison::{Figures, Shown, show};
use crate::ui::task::{Listening, Task};

/// Part of a case to evaluate, and the options for it.
#[derive(Clone, Debug)]
pub struct Question {
    /// The case.
    pub case: Arc<Case>,
    /// Number of the part.
    pub part: usize,
    /// Algorithms and arithmetic of the evaluation.
    pub options: Options,
}

impl Question {
    /// Whether both have the same answer.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        self.is_about(&other.case) && (self.part, self.options) == (other.part, other.options)
    }

    /// Whether this is about a case.
    pub(super) fn is_about(&self, case: &Arc<Case>) -> bool {
        Arc::ptr_eq(&self.case, case)
    }
}

/// A question with its answer.
#[derive(Debug)]
pub struct Evaluation {
    /// The question.
    pub question: Question,
    /// Its answer.
    pub(super) shown: Shown,
    /// The figures of an answer in pixels.
    pub(super) figures: Figures,
}

impl Evaluation {
    /// Answers a question; `None` if it was cancelled.
    pub fn new(question: Question, control: &Control<'_>) -> Option<Self> {
        let shown = show(&question.case, question.part, question.options, control)?;
        let figures = match &shown {
            Shown::Pixels(comparison) => comparison.figures(),
            Shown::Text(_) => Figures::default(),
        };
        Some(Self { question, shown, figures })
    }
}

/// An evaluation on a thread of its own. Dropping it cancels it.
#[derive(Debug)]
pub(super) struct Running {
    pub(super) question: Question,
    pub(super) since: Instant,
    /// Completed share, in [0, 1].
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

    /// Returns the evaluation once it is complete. If the thread panicked, it says so instead of the answer.
    pub(super) fn poll(&mut self) -> Option<Evaluation> {
        match self.task.listen(&mut self.progress) {
            Listening::Ended(Some(evaluation)) => Some(*evaluation),
            Listening::BrokeOff => Some(Evaluation {
                question: self.question.clone(),
                shown: Shown::Text(vec!["The answer stopped by an error of the program".to_owned()]),
                figures: Figures::default(),
            }),
            Listening::GoesOn | Listening::Ended(None) => None,
        }
    }
}
