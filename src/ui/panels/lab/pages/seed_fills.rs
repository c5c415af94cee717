//! Controls of the seed fill page.

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
    row(ui, "Paint", "Paint that the left mouse button applies to the grid", |ui| {
        let options = [
            (Paint::Wall, "Wall", "Stops a boundary fill and a flood fill"),
            (Paint::Spot, "Spot", "Pixel of another colour: stops only a flood fill"),
            (Paint::Paper, "Paper", "Erase walls and spots"),
        ];
        choice(ui, brush, &options);
    });
    hint(
        ui,
        "Open a picture with Ctrl+O, or drop one here, to fill it: dark pixels become walls, coloured pixels become \
         spots.",
    );
    hint(ui, "Drag the ring to move the seed. Paint with the left mouse button, erase with the right one.");
}
