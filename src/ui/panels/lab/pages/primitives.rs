//! Controls of the page about primitive topologies.

use eframe::egui::Ui;

use super::{hint, list, presets};
use crate::lab::primitives::{PrimitiveLesson, VertexPreset};

pub(super) fn ui(ui: &mut Ui, lesson: &mut PrimitiveLesson) {
    list(ui, "Primitive type", &mut lesson.kind);
    if let Some(preset) = presets::<VertexPreset>(ui) {
        lesson.vertices = preset.vertices();
    }
    hint(ui, "Drag the vertices.");
}
