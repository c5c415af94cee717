//! Controls of the line page.

use eframe::egui::Ui;

use super::{hint, list};
use crate::lab::lines::{LineLesson, LineMethod};

pub(super) fn ui(ui: &mut Ui, lesson: &mut LineLesson) {
    list(ui, "Method", &mut lesson.method);
    ui.add_space(crate::ui::theme::space::S);
    ui.checkbox(&mut lesson.last_pixel, "Draw the last pixel")
        .on_hover_text("Also draws the pixel at the second endpoint. If off, connected lines share no pixel");
    if lesson.method == LineMethod::Midpoint {
        ui.checkbox(&mut lesson.direction_independent, "Same pixels in both directions").on_hover_text(
            "Always breaks ties, where the line passes exactly between two pixels, as if it started at the endpoint \
             with the smaller x (or the smaller y if both are equal). If off, outlines the pixels in which the \
             reversed line differs",
        );
    }
    ui.checkbox(&mut lesson.clip, "Clip to a rectangle first")
        .on_hover_text("Draws only the part of the line inside a rectangle, found by the Liang–Barsky algorithm");
    hint(
        ui,
        "Drag the endpoints. Drag elsewhere to pan the grid; scroll to zoom: pixels grow, the exact line stays thin.",
    );
}
