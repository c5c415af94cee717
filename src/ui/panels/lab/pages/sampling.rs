//! Controls of the sampling page.

use eframe::egui::{Slider, Ui};

use super::{hint, list};
use crate::lab::sampling::{SamplingLesson, SamplingMethod, SamplingScene};
use crate::ui::widgets::{row, slider};

/// Maximum number of sample points per axis.
const MAX_POINTS: u32 = 8;

pub(super) fn ui(ui: &mut Ui, lesson: &mut SamplingLesson) {
    list(ui, "Scene", &mut lesson.scene);
    list(ui, "Sampling method", &mut lesson.method);
    ui.add_space(crate::ui::theme::space::S);
    if matches!(lesson.method, SamplingMethod::Grid | SamplingMethod::Jittered) {
        row(ui, "Points", "Number n of sample points along each axis of a pixel, which has n × n points", |ui| {
            ui.add(Slider::new(&mut lesson.points, 1..=MAX_POINTS));
        });
    }
    match lesson.scene {
        SamplingScene::Edge => {
            row(ui, "Angle", "Direction of the edge", |ui| slider(ui, &mut lesson.angle_degrees, 0.0..=360.0, "°", 1));
        }
        SamplingScene::Wheel => {
            row(ui, "Turns per frame", "Rotation of the wheel per frame, in turns", |ui| {
                slider(ui, &mut lesson.turns_per_frame, 0.0..=0.5, "", 3)
            });
        }
        SamplingScene::Picture => hint(ui, "Open a picture with Ctrl+O, or drop one here."),
        SamplingScene::ZonePlate | SamplingScene::ChessBoard => {}
    }
    hint(ui, "Drag the handle to move the pattern. Click a pixel to show its samples.");
}
