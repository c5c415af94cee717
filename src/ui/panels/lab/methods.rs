//! Comparison of all methods for the same task in the 2D lab: a table, and a plot of error against time.

use std::f32::consts::SQRT_2;

use eframe::egui::{Align, Color32, Frame, Label, Layout, Panel, Rect, RichText, ScrollArea, Sense, Ui, Vec2, vec2};
use egui_plot::{MarkerShape, Plot, PlotPoints, Points};

use super::readout::in_words;
use crate::lab::recording::{MethodComparison, MethodResult};
use crate::ui::format;
use crate::ui::session::lab::LabChange;
use crate::ui::theme::{CONTROL_HEIGHT, Icon, tokens};
use crate::ui::widgets::{figure, icon_button, section_header};

/// Width of the column of method names, in points.
const NAME_POINTS: f32 = 200.0;

/// Width of the column of errors, in points.
const ERROR_POINTS: f32 = 80.0;

/// Width of the column of times, in points.
const TIME_POINTS: f32 = 90.0;

/// Width of the table of methods, in points.
const TABLE_POINTS: f32 = 440.0;

/// Radius of a mark in the plot, in points.
const MARK: f32 = 5.0;

/// Lower bound of plotted times, in microseconds. A measured time may be 0, which has no logarithm.
const SHORTEST_MICROS: f64 = 1e-3;

/// Margins around the points of the plot, as fractions of the plotted range.
const MARGIN: Vec2 = vec2(0.08, 0.2);

/// Draws the comparison of methods: a table, and a plot of error against time.
pub(super) fn ui(ui: &mut Ui, comparison: &MethodComparison, changes: &mut Vec<LabChange>) {
    let title = format!("Error and time: {}", comparison.task);
    section_header(ui, &title, |ui| {
        if icon_button(ui, Icon::X, "Close the comparison").clicked() {
            changes.push(LabChange::CloseComparison);
        }
    });
    Panel::left("lab rivals table").frame(Frame::NONE).show_separator_line(false).exact_size(TABLE_POINTS).show(
        ui,
        |ui| {
            ScrollArea::vertical().id_salt("rivals").auto_shrink(false).show(ui, |ui| table(ui, comparison));
        },
    );
    plot(ui, comparison);
}

fn table(ui: &mut Ui, comparison: &MethodComparison) {
    let weak = tokens(ui).text_weak;
    ui.label(RichText::new(format!("error: {}", comparison.error)).color(weak).small());
    if let Some(note) = &comparison.note {
        ui.add(Label::new(RichText::new(note).color(tokens(ui).text)).wrap());
    }
    for (number, rival) in comparison.methods.iter().enumerate() {
        ui.horizontal(|ui| {
            let (place, _) = ui.allocate_exact_size(vec2(CONTROL_HEIGHT, CONTROL_HEIGHT), Sense::hover());
            if is_square(ui, number) {
                let square = Rect::from_center_size(place.center(), Vec2::splat(MARK * SQRT_2));
                ui.painter().rect_filled(square, 0.0, color(ui, number));
            } else {
                ui.painter().circle_filled(place.center(), MARK, color(ui, number));
            }
            let left_aligned = Layout::left_to_right(Align::Center);
            ui.allocate_ui_with_layout(vec2(NAME_POINTS, CONTROL_HEIGHT), left_aligned, |ui| {
                ui.set_min_width(NAME_POINTS);
                ui.add(Label::new(rival.name).truncate());
            });
            figure(ui, &error(rival), ERROR_POINTS, tokens(ui).text);
            figure(ui, &in_words(rival.time), TIME_POINTS, tokens(ui).text);
        });
    }
}

fn error(rival: &MethodResult) -> String {
    if rival.error.fract() == 0.0 { format::fixed(rival.error, 0) } else { format::fixed(rival.error, 4) }
}

fn color(ui: &Ui, number: usize) -> Color32 {
    let series = &tokens(ui).series;
    series[number % series.len()]
}

/// Whether the marker of a method is a square instead of a circle, because its series colour is already used.
fn is_square(ui: &Ui, number: usize) -> bool {
    number >= tokens(ui).series.len()
}

fn plot(ui: &mut Ui, comparison: &MethodComparison) {
    let shape = |number| if is_square(ui, number) { MarkerShape::Square } else { MarkerShape::Circle };
    let marks: Vec<_> = (0..comparison.methods.len()).map(|number| (color(ui, number), shape(number))).collect();
    Plot::new("error against time")
        .set_margin_fraction(MARGIN)
        .x_axis_label("log₁₀ of time in µs")
        .y_axis_label("error")
        .allow_scroll(false)
        .show(ui, |plot| {
            for (rival, (color, shape)) in comparison.methods.iter().zip(marks) {
                let at = [(rival.time.as_secs_f64() * 1e6).max(SHORTEST_MICROS).log10(), rival.error];
                plot.points(Points::new(rival.name, PlotPoints::from(vec![at])).radius(MARK).color(color).shape(shape));
            }
        });
}
