//! Controls above the rows: order, filter by scale, and time budget.

use std::collections::BTreeSet;

use eframe::egui::{Button, Response, RichText, Role, Ui, WidgetInfo};

use super::rows::MethodRow;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::timings::{RowOrder, TimingsChange, budget};
use crate::ui::theme::{CONTROL_HEIGHT, space, tokens};
use crate::ui::widgets::number_field;
use crate::upscale::Upscaling;

/// Width that the buttons of all scales need, in points. If less is left of the first line, they are on the second.
const SCALES_WIDTH: f32 = 230.0;

/// Draws the controls for `rows`, which are all rows, hidden or not.
pub(super) fn ui(ui: &mut Ui, rows: &[MethodRow], session: &Session, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = space::XS;
        ui.set_row_height(CONTROL_HEIGHT);
        order(ui, rows, session, commands);
        if ui.available_rect_before_wrap().width() < SCALES_WIDTH {
            ui.end_row();
            ui.set_row_height(CONTROL_HEIGHT);
        } else {
            ui.add_space(space::S);
        }
        scales(ui, rows, session, commands);
        budget_field(ui, session, commands);
        ui.add_space(space::S);
        frame_counts(ui, rows);
    });
}

fn order(ui: &mut Ui, rows: &[MethodRow], session: &Session, commands: &mut Vec<Command>) {
    weak(ui, "Sort by");
    let has_errors = rows.iter().any(|row| row.error.is_some());
    for (order, name, help) in RowOrder::ALL {
        let is_present = session.features.timings.list.order == order;
        let is_possible = order != RowOrder::Error || has_errors;
        let button = ui.add_enabled(is_possible, Button::selectable(is_present, name));
        let words = format!("Sort by {}", name.to_lowercase());
        button.widget_info(|| WidgetInfo::selected(Role::Button, is_possible, is_present, &words));
        let why = "No errors yet: “Measure all upscalers” measures them";
        if button.on_hover_text(help).on_disabled_hover_text(why).clicked() {
            commands.push(Command::Timings(TimingsChange::Order(order)));
        }
    }
}

/// Draws a toggle button for every scale in `rows`, unless they all have the same scale.
fn scales(ui: &mut Ui, rows: &[MethodRow], session: &Session, commands: &mut Vec<Command>) {
    let methods = rows.iter().map(|row| row.upscaling).filter(|upscaling| !upscaling.is_native());
    let scales: BTreeSet<_> = methods.map(Upscaling::scale).collect();
    if scales.len() < 2 {
        return;
    }
    weak(ui, "Scale");
    for scale in scales {
        let is_shown = session.features.timings.list.shows_scale(scale);
        let button = ui.selectable_label(is_shown, format!("×{scale}"));
        let words = format!("Show scale ×{scale}");
        button.widget_info(|| WidgetInfo::selected(Role::Button, true, is_shown, &words));
        if button.on_hover_text(format!("Show or hide the methods at ×{scale}")).clicked() {
            commands.push(Command::Timings(TimingsChange::ToggleScale(scale)));
        }
    }
    ui.add_space(space::S);
}

fn budget_field(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    weak(ui, "Budget");
    let mut ms = session.features.timings.budget_ms();
    let speed = ms * 0.02;
    let field = number_field(&mut ms, budget::text).speed(speed).range(budget::MIN_MS..=budget::MAX_MS);
    let response = ui.name_inputs("Time budget of a frame", |ui| ui.add(field));
    let help = "Time budget of a frame: the method with the lowest error within it gets a star. Drag the number or the \
                vertical line";
    if response.on_hover_text(help).changed() {
        commands.push(Command::Timings(TimingsChange::Budget(ms)));
    }
}

/// Draws the smallest and the largest number of frames of a row.
fn frame_counts(ui: &mut Ui, rows: &[MethodRow]) {
    let counts = || rows.iter().map(|row| row.summary.n);
    let (Some(fewest), Some(most)) = (counts().min(), counts().max()) else { return };
    let text = if fewest == most { format!("n = {most}") } else { format!("n = {fewest} to {most}") };
    weak(ui, &text).on_hover_text("Number of frames of each method");
}

fn weak(ui: &mut Ui, text: &str) -> Response {
    ui.label(RichText::new(text).color(tokens(ui).text_weak))
}
