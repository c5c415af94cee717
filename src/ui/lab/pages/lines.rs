//! Controls of the line page.

use eframe::egui::Ui;

use super::{hint, list};
use crate::lab::lines::{LineLesson, LineMethod};

pub(super) fn ui(ui: &mut Ui, lesson: &mut LineLesson) {
    list(ui, "Method", &mut lesson.method);
    ui.add_space(crate::ui::theme::space::S);
    ui.checkbox(&mut lesson.last_pixel, "Draw the last pixel")
        .on_hover_text("Without it, connected lines share no pixel, and a line has as many pixels as its length");
    if lesson.method == LineMethod::Midpoint {
        ui.checkbox(&mut lesson.direction_independent, "Same pixels from both ends").on_hover_text(
            "Where the line passes exactly between two pixels, breaks the tie as from the end with the smaller x, or \
             the smaller y if these are equal. Without it, each direction takes the other pixel, which is outlined",
        );
    }
    ui.checkbox(&mut lesson.clip, "Clip to a frame first")
        .on_hover_text("Finds the part inside the frame by its parameters t (Liang–Barsky) and draws only that");
    hint(
        ui,
        "Drag the two ends. Drag elsewhere to move the grid; turn the wheel to zoom: pixels grow, the exact line stays \
         thin.",
    );
}
