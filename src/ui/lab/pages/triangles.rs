//! Controls of the triangle page.

use eframe::egui::Ui;

use super::{hint, list};
use crate::lab::triangles::TriangleLesson;
use crate::ui::panels::pick;
use crate::ui::widgets::row;

pub(super) fn ui(ui: &mut Ui, lesson: &mut TriangleLesson) {
    list(ui, "Shown", &mut lesson.view);
    ui.add_space(crate::ui::theme::space::S);
    row(ui, "Rasterizer", "How covered pixels are found", |ui| pick(ui, &mut lesson.rasterizer));
    row(ui, "Arithmetic", "The number format that decides coverage", |ui| pick(ui, &mut lesson.arithmetic));
    row(ui, "Fill rule", "Which triangle owns a pixel centre on an edge", |ui| pick(ui, &mut lesson.rule));
    hint(ui, "Drag the corners; they snap to half pixels, where centres lie exactly on edges.");
}
