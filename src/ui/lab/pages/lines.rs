//! Controls of the page of lines.

use eframe::egui::Ui;

use super::{hint, list};
use crate::lab::lines::{LineLesson, LineMethod};

pub(super) fn ui(ui: &mut Ui, lesson: &mut LineLesson) {
    list(ui, "Way to draw", &mut lesson.method);
    ui.add_space(crate::ui::theme::space::S);
    ui.checkbox(&mut lesson.last_pixel, "Draw the last pixel")
        .on_hover_text("Without it, lines in a row share no pixel, and a line is as many pixels long as it measures");
    if lesson.method == LineMethod::Midpoint {
        ui.checkbox(&mut lesson.direction_independent, "Same pixels from both ends").on_hover_text(
            "Where the line passes exactly between two pixels, the tie is decided as from the end with the smaller x, or \
             the smaller y if these are equal. Without it, each direction takes the other pixel, which is outlined",
        );
    }
    ui.checkbox(&mut lesson.clip, "Clip to a frame first").on_hover_text(
        "The part inside of the frame is found by its parameters t (Liang and Barsky), and only that is walked",
    );
    hint(
        ui,
        "Drag the two ends. Drag elsewhere moves the grid, the wheel enlarges it: pixels grow, the true line stays thin.",
    );
}
