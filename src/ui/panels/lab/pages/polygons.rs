//! Controls of the polygon page.

use eframe::egui::Ui;

use super::{hint, list, presets};
use crate::lab::polygons::{PolygonLesson, PolygonPreset};
use crate::ui::theme::{self, Icon};

pub(super) fn ui(ui: &mut Ui, lesson: &mut PolygonLesson) {
    list(ui, "Operation", &mut lesson.method);
    if let Some(preset) = presets::<PolygonPreset>(ui) {
        lesson.contours = preset.contours();
    }
    ui.add_space(theme::space::S);
    ui.horizontal(|ui| {
        if ui
            .button((theme::icon(Icon::Plus), "Add contour"))
            .on_hover_text("Add a small triangle in the middle of the grid as a contour")
            .clicked()
        {
            lesson.add_contour();
        }
        let turn = ui.button("Reverse winding").on_hover_text("Reverse the vertex order of the last contour");
        if let (true, Some(last)) = (turn.clicked(), lesson.contours.last_mut()) {
            last.reverse();
        }
    });
    hint(ui, "Drag a corner to move it. Double-click to add one to the nearest edge, right-click to remove one.");
}
