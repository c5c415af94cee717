//! Controls of the page of seed fill.

use eframe::egui::Ui;

use super::{hint, list, presets};
use crate::lab::seed_fills::{Paint, SeedFillLesson, SeedFillPreset};
use crate::ui::widgets::{choice, row};

pub(super) fn ui(ui: &mut Ui, lesson: &mut SeedFillLesson, brush: &mut Paint) {
    list(ui, "Region", &mut lesson.region);
    list(ui, "Neighbours", &mut lesson.neighbours);
    list(ui, "Order", &mut lesson.order);
    if let Some(preset) = presets::<SeedFillPreset>(ui) {
        (lesson.grid, lesson.seed) = preset.grid();
    }
    ui.add_space(crate::ui::theme::space::S);
    row(ui, "Paint", "What the main mouse button paints on the grid", |ui| {
        let options = [
            (Paint::Wall, "Wall", "A boundary fill stops here, and so does a flood"),
            (Paint::Spot, "Spot", "Another colour: only a flood stops here"),
            (Paint::Paper, "Paper", "Takes away what is painted"),
        ];
        choice(ui, brush, &options);
    });
    hint(
        ui,
        "Open a picture with Ctrl+O, or drop one here, to fill in it: what is dark becomes wall, what has a colour spot.",
    );
    hint(ui, "Drag the seed (ring). Paint with the main button, wipe with the right one.");
}
