//! Exact values of the active overlays under the pointer, or at the picked pixel.

use eframe::egui::{Label, RichText, Ui};

use crate::pipeline::settings::Choice as _;
use crate::ui::session::Session;
use crate::ui::theme::{self, tokens};

/// Draws a row with the exact value of each active overlay.
pub(crate) fn ui(ui: &mut Ui, session: &Session, hovered: Option<(u32, u32)>) {
    let Some((view, (x, y))) = session.view.as_ref().zip(hovered.or(session.pick)) else { return };
    for sheet in &view.look_result.sheets {
        ui.horizontal(|ui| {
            ui.set_height(theme::CONTROL_HEIGHT);
            ui.label(RichText::new(sheet.overlay.name()).color(tokens(ui).text_weak));
            let text = sheet.text(x, y).unwrap_or_else(|| "–".to_owned());
            ui.add(Label::new(RichText::new(text).monospace()).truncate());
        });
    }
}
