//! Controls of the line page.

use eframe::egui::Ui;

use super::{hint, list};
use crate::lab::lines::{LineLesson, LineMethod};

pub(super) fn ui(ui: &mut Ui, lesson: &mut LineLesson) {
    list(ui, "Method", &mut lesson.method);
    ui.add_space(crate::ui::theme::space::S);
    ui.checkbox(&mut lesson.last_pixel, "Draw the last pixel")
        .on_hover_text("Also draws the pixel at the second end point. If off, connected lines share no pixel");
    if lesson.method == LineMethod::Midpoint {
        ui.checkbox(&mut lesson.direction_independent, "Same pixels from both ends").on_hover_text(
            "Where the line passes exactly between two pixels, breaks the tie as seen from the end with the smaller x, \
             or the smaller y if both are equal. If off, the pixels of the reversed line are outlined where they \
             differ",
        );
    }
    ui.checkbox(&mut lesson.clip, "Clip to a frame first")
        .on_hover_text("Draws only the part inside the frame, which the Liang–Barsky algorithm finds");
    hint(
        ui,
        "Drag the end points. Drag elsewhere to pan the grid; scroll to zoom: pixels grow, the exact line stays thin.",
    );
}
