//! Controls of the page of lines.

use eframe::egui::Ui;

use super::{hint, list};
use crate::lab::lines::LineLesson;

pub(super) fn ui(ui: &mut Ui, lesson: &mut LineLesson) {
    list(ui, "Way to draw", &mut lesson.method);
    ui.add_space(crate::ui::theme::space::S);
    ui.checkbox(&mut lesson.last_pixel, "Draw the last pixel")
        .on_hover_text("Without it, lines in a row share no pixel, and a line is as many pixels long as it measures");
    ui.checkbox(&mut lesson.clip, "Clip to a frame first").on_hover_text(
        "The part inside of the frame is found by its parameters t (Liang and Barsky), and only that is walked",
    );
    hint(
        ui,
        "Drag the two ends. Drag elsewhere moves the grid, the wheel enlarges it: pixels grow, the true line stays thin.",
    );
}
