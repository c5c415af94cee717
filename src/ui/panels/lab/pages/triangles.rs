//! Controls of the triangle page.

use eframe::egui::Ui;

use super::{hint, list};
use crate::lab::triangles::TriangleLesson;
use crate::ui::panels::pick;
use crate::ui::widgets::row;

pub(super) fn ui(ui: &mut Ui, lesson: &mut TriangleLesson) {
    list(ui, "View", &mut lesson.view);
    ui.add_space(crate::ui::theme::space::S);
    row(ui, "Rasterizer", "Algorithm that finds the covered pixels", |ui| pick(ui, &mut lesson.rasterizer));
    row(ui, "Arithmetic", "Number format in which coverage is computed", |ui| pick(ui, &mut lesson.arithmetic));
    row(ui, "Fill rule", "Rule that decides whether a pixel centre exactly on an edge is covered", |ui| {
        pick(ui, &mut lesson.rule)
    });
    hint(ui, "Drag the corners. They snap to half pixels, so that pixel centres can lie exactly on edges.");
}
