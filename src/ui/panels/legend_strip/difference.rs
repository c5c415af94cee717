//! Legend of a difference image: its colours, or the number of changed pixels.

use eframe::egui::{Label, RichText, Ui};

use crate::pipeline::settings::Choice as _;
use crate::ui::format;
use crate::ui::legend::{ScaleLegend, note};
use crate::ui::session::Session;
use crate::ui::theme::tokens;

/// Draws the legend, one part beside the other.
pub(super) fn ui(ui: &mut Ui, session: &Session) {
    let difference = session.features.comparison.compared.as_ref().and_then(|compared| compared.difference.as_ref());
    let Some(difference) = difference else {
        note(ui, "No difference is drawn yet");
        return;
    };
    let strong = |ui: &mut Ui, text: String| {
        ui.add(Label::new(RichText::new(text).color(tokens(ui).text)).extend());
    };
    if let Some(changes) = &difference.changes {
        let words = match changes.count {
            0 => "No pixel differs between A and B".to_owned(),
            1 => "1 pixel differs between A and B".to_owned(),
            count => format!("{} pixels differ between A and B", format::count(count)),
        };
        strong(ui, words);
        if changes.count > 0 {
            note(ui, "marked over the dimmed B");
        }
        return;
    }
    let (kind, gain) = difference.kind;
    let (low, high) = kind.range(gain);
    let number = |value: f64| format::fixed(value, if high >= 10.0 { 0 } else { 3 });
    strong(ui, format!("{} difference ×{gain}", kind.name()));
    ScaleLegend { ends: [number(low), number(high)] }.ui(ui, |share| kind.color(f64::from(share)));
    note(ui, kind.help().trim_end_matches('.'));
}
