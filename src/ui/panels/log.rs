//! The log: a list of all messages, newest last.

use eframe::egui::{Label, RichText, Ui};

use crate::manual::Chapter;
use crate::ui::panels::{PanelSpec, framed};
use crate::ui::session::{Session, Severity};
use crate::ui::theme::{Icon, tokens};
use crate::ui::widgets::{Status, empty_state};

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::GettingStarted,
    grows: true,
    titled: true,
    controls: None,
    content: |ui, cx| framed(ui, |ui| self::ui(ui, cx.session)),
};

/// Draws all messages of the log.
pub(crate) fn ui(ui: &mut Ui, session: &Session) {
    if session.features.messages.log.is_empty() {
        empty_state(ui, Icon::ScrollText, "No messages", "Errors and the warnings of loaded models are listed here.");
        return;
    }
    for line in &session.features.messages.log {
        let (status, word) = match line.level {
            Severity::Info => (Status::Neutral, "info"),
            Severity::Warning => (Status::Warning, "warning"),
            Severity::Error => (Status::Error, "error"),
        };
        ui.horizontal(|ui| {
            ui.label(RichText::new(format!("{word:7}")).monospace().color(status.color(tokens(ui))));
            ui.add(Label::new(&line.text).wrap().selectable(true));
        });
    }
}
