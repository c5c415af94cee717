//! Tooltip of a row: all statistics of its frame times, its errors, and what a click does.

use eframe::egui::{Grid, RichText, Ui};

use super::rows::MethodRow;
use crate::measure::noise::WITHIN;
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::session::timings::budget;
use crate::ui::theme::{space, tokens};

/// Draws the content of the tooltip of a row.
pub(super) fn ui(ui: &mut Ui, row: &MethodRow, session: &Session) {
    ui.spacing_mut().item_spacing.y = 2.0;
    ui.strong(row.upscaling.label());
    if session.features.timings.budget_winner().best() == Some(row.upscaling) {
        ui.label(format!(
            "Best within the budget: {} within {}",
            budget::best_words(session.features.timings.metric_in_use()),
            budget::text(session.features.timings.budget_ms())
        ));
    }
    if row.native_within_noise {
        ui.label(format!("{WITHIN} of native"));
    }
    ui.add_space(space::XS);
    Grid::new("statistics").num_columns(6).spacing([space::M, 2.0]).show(ui, |ui| {
        numbers(ui, &times(row));
        if let Some(error) = row.error {
            let flips = [
                ("FLIP", error.motion.mean.flip),
                ("worst frame", error.motion.worst.flip),
                ("at rest", error.still.flip),
            ];
            numbers(ui, &flips.map(|(name, flip)| (name, format::fixed(flip, 4))));
        }
    });
    ui.add_space(space::XS);
    ui.label(
        RichText::new("Click: draw with this upscaler. Shift+click: compare the picture with it.")
            .color(tokens(ui).text_weak),
    );
}

/// Adds a line of names to the grid, and below it a line with their values.
fn numbers(ui: &mut Ui, numbers: &[(&str, String)]) {
    for (name, _) in numbers {
        ui.label(RichText::new(*name).small().color(tokens(ui).text_weak));
    }
    ui.end_row();
    for (_, value) in numbers {
        ui.monospace(value);
    }
    ui.end_row();
}

/// Returns the names and values of the statistics of the frame times, in milliseconds except for the number of frames.
fn times(row: &MethodRow) -> [(&'static str, String); 6] {
    let summary = &row.summary;
    let ms = |ms| format::fixed(ms, 2);
    [
        ("p10 ms", ms(summary.p10)),
        ("median", ms(summary.median)),
        ("p90", ms(summary.p90)),
        ("p99", ms(summary.p99)),
        ("maximum", ms(summary.max)),
        ("frames", format::count(summary.n as u64)),
    ]
}
