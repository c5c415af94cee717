//! Controls of the circle page.

use eframe::egui::Ui;

use super::{hint, list};
use crate::lab::circles::CircleLesson;

pub(super) fn ui(ui: &mut Ui, lesson: &mut CircleLesson) {
    list(ui, "Method", &mut lesson.method);
    ui.add_space(crate::ui::theme::space::S);
    ui.checkbox(&mut lesson.sides, "Show the sign of F(x, y)").on_hover_text(
        "Colours each pixel by the side of the curve that its centre lies on: the sign of the implicit function F",
    );
    hint(ui, "Drag the handles of the centre and of the radius; an ellipse has two radii.");
}
