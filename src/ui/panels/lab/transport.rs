//! The playback bar below the grid: buttons for first, back, play, forward and last, and a slider over the steps.

use std::time::Duration;

use eframe::egui::{RichText, Slider, Ui, WidgetInfo};

use crate::ui::format;
use crate::ui::session::lab::{Lab, LabChange};
use crate::ui::theme::{Icon, tokens};
use crate::ui::widgets::icon_button;

/// Maximum time by which one frame advances playback, in seconds. Prevents a jump after the window was hidden.
const LONGEST_TICK: f32 = 0.25;

/// Minimum time between two frames during playback.
const SHORTEST_FRAME: Duration = Duration::from_millis(16);

/// Width reserved to the right of the slider for two buttons, the step count and the speed, in points.
const REST_POINTS: f32 = 300.0;

/// Minimum width of the slider, in points.
const LEAST_SLIDER: f32 = 60.0;

/// Minimum free width for the slider beside the step count, in points.
const SLIDER_FROM: f32 = 160.0;

/// Draws the playback bar and advances playback.
pub(super) fn ui(ui: &mut Ui, lab: &Lab, changes: &mut Vec<LabChange>) {
    ui.horizontal_centered(|ui| {
        let all = lab.recording.steps.len();
        let mut button = |ui: &mut Ui, icon, name: &str, change| {
            if icon_button(ui, icon, name).clicked() {
                changes.push(change);
            }
        };
        button(ui, Icon::ChevronFirst, "Go to the start  (Home)", LabChange::Go(0));
        button(ui, Icon::StepBack, "Step back  (,)", LabChange::StepBy(-1));
        let back = if lab.playing < 0 { (Icon::Pause, 0) } else { (Icon::Rewind, -1) };
        button(ui, back.0, "Play backwards", LabChange::Play(back.1));
        let on = if lab.playing > 0 { (Icon::Pause, 0) } else { (Icon::Play, 1) };
        button(ui, on.0, "Play  (K)", LabChange::Play(on.1));
        button(ui, Icon::StepForward, "Step forward  (.)", LabChange::StepBy(1));
        button(ui, Icon::ChevronLast, "Go to the end  (End)", LabChange::Go(usize::MAX));
        let step = lab.step.min(all);
        if ui.available_width() >= SLIDER_FROM {
            steps(ui, step, all, changes);
        }
        let more = if lab.recording.cut_off { " (truncated)" } else { "" };
        let text = format!("{} / {}{more}", format::count(step as u64), format::count(all as u64));
        ui.label(RichText::new(text).monospace().color(tokens(ui).text)).on_hover_text("Completed steps / all steps");
        speed(ui, lab, changes);
    });
    if lab.playing != 0 {
        changes.push(LabChange::Tick(ui.input(|i| i.stable_dt).min(LONGEST_TICK)));
        ui.request_repaint_after(SHORTEST_FRAME);
    }
}

/// Draws the slider over the steps.
fn steps(ui: &mut Ui, mut step: usize, all: usize, changes: &mut Vec<LabChange>) {
    ui.spacing_mut().slider_width = (ui.available_width() - REST_POINTS).max(LEAST_SLIDER);
    let slider = ui.add_enabled(all > 0, Slider::new(&mut step, 0..=all).show_value(false));
    slider.widget_info(|| WidgetInfo::slider(true, step as f64, "Completed steps"));
    if slider.on_hover_text("Completed steps").changed() {
        changes.push(LabChange::Go(step));
    }
}

fn speed(ui: &mut Ui, lab: &Lab, changes: &mut Vec<LabChange>) {
    /// Minimum free width for the speed slider, in points.
    const ROOM_POINTS: f32 = 150.0;
    if ui.available_width() < ROOM_POINTS {
        return;
    }
    let mut speed = lab.speed;
    ui.spacing_mut().slider_width = 70.0;
    let slider = Slider::new(&mut speed, 1.0..=400.0).logarithmic(true).custom_formatter(|v, _| format!("{v:.0} / s"));
    let slider = ui.add(slider).on_hover_text("Playback speed in steps per second");
    slider.widget_info(|| WidgetInfo::slider(true, speed.into(), "Steps per second"));
    if slider.changed() {
        changes.push(LabChange::Speed(speed));
    }
}
