//! The view of an open test case. It shows two enlarged pictures side by side: the pixels covered by the tested
//! rasterizer, and the exact result. Pixels that differ are coloured. A worst case of the stability report has a
//! rasterizer and an arithmetic of its own; any other case uses those of the recipe. A background thread evaluates the case; until it is done, the last result stays visible.

mod evaluation;

mod pictures;

use std::time::Duration;

use eframe::egui::{Label, ProgressBar, RichText, Role, ScrollArea, TextStyle, Ui, WidgetInfo};

use crate::case::Control;
use crate::report::comparison::{DisplayedResult, parts};
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::open_case::OpenCase;
use crate::ui::theme::{Icon, space, tokens};
use crate::ui::widgets::{combo, icon_button};

pub(crate) use evaluation::Evaluation;
pub(crate) use evaluation::EvaluationRequest;

use crate::ui::session::open_case::CaseChange;
use evaluation::Running;
use pictures::Pictures;

/// Evaluation time after which progress is shown.
const SLOW_ANSWER: Duration = Duration::from_millis(200);

/// View of the open case, and its last evaluation.
#[derive(Default)]
pub(crate) struct CaseView {
    evaluation: Option<Evaluation>,
    /// Evaluation that is running, if any.
    running: Option<Running>,
    pictures: Pictures,
    /// Index of the differing pixel that the view last moved to.
    visited: Option<usize>,
}

impl CaseView {
    /// Shows a finished evaluation, and cancels the running one.
    pub(crate) fn adopt(&mut self, answer: Evaluation) {
        let is_about_the_same = self.evaluation.as_ref().is_some_and(|old| old.request.is_about(&answer.request.case));
        if !is_about_the_same {
            self.pictures = Pictures::default();
        }
        self.pictures.invalidate();
        self.visited = None;
        self.running = None;
        self.evaluation = Some(answer);
    }

    /// Draws the session's open case. If `waits` is `true`, the case is evaluated synchronously before it is drawn.
    pub(crate) fn ui(&mut self, ui: &mut Ui, session: &Session, waits: bool, commands: &mut Vec<Command>) {
        let Some(open) = &session.features.case else { return };
        let options = session.options_of(open);
        self.request_evaluation(ui, EvaluationRequest { case: open.case.clone(), part: open.part, options }, waits);
        ui.add_space(space::XS);
        ui.horizontal_wrapped(|ui| {
            ui.add_space(space::S);
            self.bar(ui, session, open, commands);
        });
        match &self.evaluation {
            Some(Evaluation { shown: DisplayedResult::Text(lines), .. }) => text(ui, lines),
            Some(Evaluation { shown: DisplayedResult::Pixels(comparison), .. }) => self.pictures.ui(ui, comparison),
            None => {}
        }
    }

    /// Stores a finished evaluation, and starts a new one if the request has changed.
    fn request_evaluation(&mut self, ui: &Ui, question: EvaluationRequest, waits: bool) {
        if let Some(answer) = self.running.as_mut().and_then(Running::poll) {
            self.adopt(answer);
        }
        if self.evaluation.as_ref().is_some_and(|answered| !answered.request.is_about(&question.case)) {
            self.evaluation = None;
        }
        if self.evaluation.as_ref().is_some_and(|answered| answered.request.is_same(&question)) {
            self.running = None;
        } else if self.running.as_ref().is_some_and(|running| running.question.is_same(&question)) {
            // The evaluation is already running.
        } else if !waits {
            self.running = Some(Running::start(ui.ctx().clone(), question));
            ui.request_repaint_after(SLOW_ANSWER);
        } else if let Some(answer) = Evaluation::new(question, &Control::default()) {
            self.adopt(answer);
        }
    }

    fn bar(&mut self, ui: &mut Ui, session: &Session, open: &OpenCase, commands: &mut Vec<Command>) {
        let OpenCase { case, part, .. } = open;
        let part = *part;
        if icon_button(ui, Icon::X, "Close the case  (Esc)").clicked() {
            commands.push(Command::Case(CaseChange::Close));
        }
        ui.label(RichText::new(&case.id).strong());
        let parts = parts(case);
        if parts > 1 {
            if icon_button(ui, Icon::ChevronLeft, "Previous triangle").clicked() {
                commands.push(Command::Case(CaseChange::Part(part.saturating_sub(1))));
            }
            ui.label(format!("triangle {} of {parts}", part + 1));
            if icon_button(ui, Icon::ChevronRight, "Next triangle").clicked() {
                commands.push(Command::Case(CaseChange::Part((part + 1).min(parts - 1))));
            }
        }
        let mut options = session.options_of(open);
        choose(ui, "Rasterizer of the case", &mut options.rasterizer);
        choose(ui, "Arithmetic of the case", &mut options.arithmetic);
        if options != session.options_of(open) {
            commands.push(Command::Case(CaseChange::Options(options)));
        }
        if let Some(running) = &self.running {
            if running.since.elapsed() >= SLOW_ANSWER {
                self.progress(ui, commands);
            }
            return;
        }
        self.findings(ui);
    }

    /// Draws the progress of the evaluation. Cancelling restores the last evaluation, or closes the case if there is
    /// none.
    fn progress(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let Some(running) = &self.running else { return };
        let cancelled = ui.button("Cancel").on_hover_text("Stop the evaluation and keep the last result").clicked();
        ui.add(ProgressBar::new(running.progress.unwrap_or(0.0)).desired_width(200.0).show_percentage());
        if !cancelled {
            return;
        }
        match &self.evaluation {
            Some(Evaluation { request: EvaluationRequest { part, options, .. }, .. }) => {
                commands.extend([Command::Case(CaseChange::Part(*part)), Command::Case(CaseChange::Options(*options))]);
            }
            None => commands.push(Command::Case(CaseChange::Close)),
        }
    }

    /// Draws the number of pixels that differ from the exact result, and buttons that step through them.
    fn findings(&mut self, ui: &mut Ui) {
        let Some(Evaluation { shown: DisplayedResult::Pixels(comparison), figures, .. }) = &self.evaluation else {
            return;
        };
        if comparison.exact.is_none() {
            let text = format!("{} pixels covered; no exact result for this kind of case", figures.covered);
            ui.add(Label::new(RichText::new(text).color(tokens(ui).text_weak)).truncate());
            return;
        }
        let text = format!("{} of {} pixels differ", figures.differing, figures.concerned);
        let color = if figures.differing == 0 { tokens(ui).passed } else { tokens(ui).warning };
        ui.label(RichText::new(text).color(color).strong());
        if !figures.first.is_empty() {
            let count = figures.first.len();
            let before = icon_button(ui, Icon::ArrowLeft, "Previous differing pixel").clicked();
            let after = icon_button(ui, Icon::ArrowRight, "Next differing pixel").clicked();
            if before || after {
                let next = match (self.visited, before) {
                    (None, _) => 0,
                    (Some(at), true) => (at + count - 1) % count,
                    (Some(at), false) => (at + 1) % count,
                };
                self.visited = Some(next);
                self.pictures.visit(figures.first[next]);
            }
        }
    }
}

/// Draws a result that consists of lines of text. Only the visible lines are laid out.
fn text(ui: &mut Ui, lines: &[String]) {
    let height = ui.text_style_height(&TextStyle::Monospace);
    ScrollArea::both().auto_shrink(false).show_rows(ui, height, lines.len(), |ui, visible| {
        for line in &lines[visible] {
            ui.add(Label::new(RichText::new(line).monospace().color(tokens(ui).text)).extend());
        }
    });
}

fn choose<C: crate::pipeline::settings::Choice>(ui: &mut Ui, name: &str, value: &mut C) {
    let list = combo(name, value.name(), 112.0).show_ui(ui, |ui| {
        for choice in C::ALL {
            ui.selectable_value(value, *choice, choice.name()).on_hover_text(choice.help());
        }
    });
    list.response.on_hover_text(name).widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, name));
}
