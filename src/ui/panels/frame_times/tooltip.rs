//! Tooltip of a row: all statistics of its frame times, its errors, and what a click does.

use eframe::egui::{Grid, RichText, Ui};

use super::rows::MethodRow;
use crate::measure::noise::WITHIN;
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::theme::{space, tokens};
use crate::ui::timings::budget;

/// Draws the content of the tooltip of a row.
pub(super) fn ui(ui: &mut Ui, row: &MethodRow, session: &Session) {
    ui.spacing_mut().item_spacing.y = 2.0;
    ui.strong(row.upscaling.label());
    if session.timings.budget_winner().best() == Some(row.upscaling) {
        ui.label(format!("Best within the budget: lowest FLIP within {}", budget::text(session.timings.budget_ms())));
    }
    if row.native_within_noise {
        ui.label(format!("{WITHIN} of native"));
    }
    ui.add_space(space::XS);
    Grid::new("statistics").num_columns(2).spacing([space::L, 2.0]).show(ui, |ui| {
        for (name, value) in statistics(row) {
            ui.label(RichText::new(name).color(tokens(ui).text_weak));
            ui.monospace(value);
            ui.end_row();
        }
    });
    ui.add_space(space::XS);
    ui.label(
        RichText::new("Click: draw with this upscaler. Shift+click: compare the picture with it.")
            .color(tokens(ui).text_weak),
    );
}

/// Returns the names and values of all statistics of a row.
fn statistics(row: &MethodRow) -> Vec<(&'static str, String)> {
    let summary = &row.summary;
    let mut lines = vec![("Frames", format::count(summary.n as u64))];
    let times = [
        ("Minimum", summary.min),
        ("10th percentile", summary.p10),
        ("Median", summary.median),
        ("90th percentile", summary.p90),
        ("99th percentile", summary.p99),
        ("Maximum", summary.max),
    ];
    lines.extend(times.map(|(name, ms)| (name, format::ms(ms))));
    if let Some(error) = row.error {
        let errors = [
            ("FLIP, mean over the frames", error.motion.mean.flip),
            ("FLIP of the worst frame", error.motion.worst.flip),
            ("FLIP at rest", error.still.flip),
        ];
        lines.extend(errors.map(|(name, flip)| (name, format::fixed(flip, 4))));
    }
    lines
}
