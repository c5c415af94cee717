//! The panel “Assertions”: lists every assertion with the number of checked fragments, the number of violations, and the
//! first violation.

use std::sync::Arc;

use eframe::egui::{Button, Grid, Label, ProgressBar, RichText, ScrollArea, Sense, Ui};

use crate::inspect::assertions::{Assertion, Finding};
use crate::manual::Chapter;
use crate::pipeline::settings::Choice as _;
use crate::ui::format;
use crate::ui::panels::PanelSpec;
use crate::ui::session::Session;
use crate::ui::session::checks::{ChecksChange, place};
use crate::ui::session::command::Command;
use crate::ui::theme::{self, Icon, tokens};
use crate::ui::widgets::{Status, chip};

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::Stability,
    grows: true,
    titled: true,
    controls: Some(|ui, cx| controls(ui, cx.session, cx.commands)),
    content: |ui, cx| self::ui(ui, cx.session, cx.commands),
};

/// Draws the buttons of the panel.
pub(crate) fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let checks = &session.features.checks;
    let help = "Draw this frame once more and check every fragment";
    let run = Button::new((theme::icon(Icon::ListChecks), "Check this frame"));
    if ui.add_enabled(checks.progress.is_none(), run).on_hover_text(help).clicked() {
        commands.push(Command::Checks(ChecksChange::Run));
    }
    let help = "Check each new frame until an assertion is violated, then pick its pixel. Frames take longer meanwhile";
    if ui.add(Button::selectable(checks.every_frame, "Check every frame")).on_hover_text(help).clicked() {
        commands.push(Command::Checks(ChecksChange::ToggleEveryFrame));
    }
    if let Some(progress) = checks.progress {
        if ui.button("Cancel").on_hover_text("Stop checking").clicked() {
            commands.push(Command::Checks(ChecksChange::Cancel));
        }
        ui.add(ProgressBar::new(progress).desired_width(120.0).show_percentage());
    }
    if checks.every_frame {
        chip(ui, Status::Warning, "checking", "Every frame is checked, which takes longer");
    }
    if let Some((report, frame)) = &checks.found {
        let is_shown = session.view.as_ref().is_some_and(|view| Arc::ptr_eq(&view.frame, frame));
        let whose = if is_shown { "in this frame" } else { "in an earlier frame" };
        let violated = report.findings.iter().filter(|finding| finding.violated > 0).count();
        let text = if violated == 0 {
            format!("all {} assertions hold {whose}", report.findings.len())
        } else {
            format!("{violated} of {} assertions violated {whose}", report.findings.len())
        };
        ui.label(RichText::new(text).color(tokens(ui).text_weak));
    }
}

/// Draws the table of assertions.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        Grid::new("checks").num_columns(5).striped(true).spacing([20.0, 4.0]).show(ui, |ui| {
            for heading in ["", "Assertion", "Checked", "Violated", "First violation"] {
                ui.label(RichText::new(heading).small().color(tokens(ui).text_weak));
            }
            ui.end_row();
            for assertion in Assertion::ALL {
                let found = session.features.checks.found.as_ref();
                let finding = found.and_then(|(report, _)| report.findings.iter().find(|f| f.assertion == *assertion));
                row(ui, session, *assertion, finding, commands);
                ui.end_row();
            }
        });
    });
}

fn row(ui: &mut Ui, session: &Session, assertion: Assertion, finding: Option<&Finding>, commands: &mut Vec<Command>) {
    let (status, word) = match finding {
        None => (Status::Neutral, "not checked"),
        Some(finding) if finding.checked == 0 => (Status::Neutral, "nothing to check"),
        Some(finding) if finding.violated == 0 => (Status::Passed, "holds"),
        Some(_) => (Status::Rejected, "violated"),
    };
    chip(ui, status, word, assertion.help());
    ui.label(assertion.name()).on_hover_text(assertion.help());
    for count in [finding.map(|f| f.checked), finding.map(|f| f.violated)] {
        let text = count.map_or("–".to_owned(), format::count);
        ui.label(RichText::new(text).monospace());
    }
    match finding.and_then(|finding| finding.first.as_ref()).zip(session.features.checks.found.as_ref()) {
        None => {
            ui.label(RichText::new(assertion.help()).color(tokens(ui).text_weak));
        }
        Some((first, (_, frame))) => {
            let (x, y) = place(first, frame);
            let text = format!("{x}, {y}   triangle {}: {}", first.triangle.0, first.text);
            let label = ui.add(Label::new(RichText::new(text).color(tokens(ui).accent)).sense(Sense::click()));
            if label.on_hover_text("Pick this pixel").clicked() {
                commands.push(Command::Pick(Some((x, y))));
            }
        }
    }
}
