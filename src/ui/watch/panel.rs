//! The “Watch” tab: one row per watched pixel, one column per buffer.

use eframe::egui::{self, Button, Color32, Grid, RichText, ScrollArea, Sense, Ui, WidgetInfo};

use super::WatchChange;
use crate::inspect::watch::{PixelValues, WatchedPixel};
use crate::ui::command::Command;
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::theme::{self, Icon, tokens};
use crate::ui::widgets::{empty_state, icon_button, swatch};

/// Columns of the table, each with name and help text.
const COLUMNS: [(&str, &str); 9] = [
    ("Pixel", "Column and row of the pixel; click to pick it"),
    ("Colour", "Red, green and blue in the finished picture, 0 to 255"),
    ("Depth", "Final value of the depth buffer"),
    ("Triangle", "Number of the visible triangle in the scene"),
    ("Object", "Object that the visible triangle belongs to"),
    ("Barycentric: linear", "Screen-space barycentric weights in the visible triangle"),
    (
        "Barycentric: perspective-correct",
        "Weights of attributes in the visible triangle. If interpolation is affine, they equal the linear ones",
    ),
    ("Overdraw", "Number of triangles that cover the pixel's centre"),
    ("Shaded", "Number of shaded fragments at the pixel's centre"),
];

/// Draws the controls of the “Watch” tab, beside the tab names.
pub(crate) fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let watched = |pixel| session.watch.pixels.contains(&pixel);
    let addable = session.pick.is_some_and(|pixel| !watched(pixel));
    let add = ui.add_enabled(addable, Button::new((theme::icon(Icon::Pin), "Watch the picked pixel")));
    if add.on_hover_text("Add the picked pixel to the list  (Enter)").clicked() {
        commands.push(Command::Watch(WatchChange::AddPick));
    }
    let clear = ui.add_enabled(!session.watch.pixels.is_empty(), Button::new("Clear"));
    if clear.on_hover_text("Remove all pixels from the list").clicked() {
        commands.push(Command::Watch(WatchChange::Clear));
    }
}

/// Draws the table of watched pixels.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    if session.watch.pixels.is_empty() {
        let help = "Press Enter, or the pin in the inspector, to add the picked pixel. Its values in all buffers are \
                    updated after every frame.";
        empty_state(ui, Icon::Pin, "No watched pixels", help);
        return;
    }
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        Grid::new("watch").num_columns(COLUMNS.len() + 2).striped(true).spacing([16.0, 2.0]).show(ui, |ui| {
            ui.label("");
            for (name, help) in COLUMNS {
                ui.label(RichText::new(name).small().color(tokens(ui).text_weak)).on_hover_text(help);
            }
            ui.end_row();
            for (number, (x, y)) in session.watch.pixels.iter().copied().enumerate() {
                ui.label(RichText::new((number + 1).to_string()).monospace().color(tokens(ui).warning));
                let picked = session.pick == Some((x, y));
                let pixel = ui.add(Button::selectable(picked, RichText::new(format!("{x}, {y}")).monospace()));
                if pixel.on_hover_text("Pick this pixel").clicked() {
                    commands.push(Command::Pick(Some((x, y))));
                }
                row(ui, session, (x, y));
                if icon_button(ui, Icon::X, &format!("Stop watching {x}, {y}")).clicked() {
                    commands.push(Command::Watch(WatchChange::Remove(x, y)));
                }
                ui.end_row();
            }
        });
    });
}

fn row(ui: &mut Ui, session: &Session, (x, y): (u32, u32)) {
    let row = session.watch.rows.iter().find(|row| (row.x, row.y) == (x, y));
    let Some(values) = row.and_then(|row| row.values.as_ref()) else {
        let text = if row.is_some() { "outside the picture" } else { "…" };
        ui.label(RichText::new(text).color(tokens(ui).text_weak));
        // Empty cells for the columns without a value.
        (2..COLUMNS.len()).for_each(|_| drop(ui.label("")));
        return;
    };
    let before = row.and_then(|row| session.watch.before(row)).and_then(|before: &WatchedPixel| before.values.as_ref());
    let [r, g, b, _] = values.color;
    ui.horizontal(|ui| {
        swatch(ui, Color32::from_rgb(r, g, b));
        let codes = |values: &PixelValues| format!("{} {} {}", values.color[0], values.color[1], values.color[2]);
        cell(ui, values, before, codes);
    });
    cell(ui, values, before, |values| values.depth.map_or_else(nothing, format::f32_full));
    cell(ui, values, before, |values| values.triangle.map_or_else(nothing, |id| id.0.to_string()));
    cell(ui, values, before, |values| values.object.clone().unwrap_or_else(nothing));
    cell(ui, values, before, |values| values.lambda.map_or_else(nothing, weights));
    cell(ui, values, before, |values| values.perspective_lambda.map_or_else(nothing, weights));
    cell(ui, values, before, |values| values.overdraw.to_string());
    cell(ui, values, before, |values| values.shaded.to_string());
}

fn nothing() -> String {
    "–".to_owned()
}

fn weights(weights: [f32; 3]) -> String {
    weights.map(|weight| format::fixed(f64::from(weight), 4)).join(" ")
}

/// Draws the value of a buffer at a watched pixel. If the value differs from that in `before`, it is highlighted and
/// the tooltip shows the old value.
fn cell(ui: &mut Ui, values: &PixelValues, before: Option<&PixelValues>, text: impl Fn(&PixelValues) -> String) {
    let (now, was) = (text(values), before.map(text));
    let changed = was.as_ref().is_some_and(|was| *was != now);
    let weak = !values.is_drawn;
    let color = match (changed, weak) {
        (true, _) => tokens(ui).warning,
        (false, true) => tokens(ui).text_weak,
        (false, false) => tokens(ui).text,
    };
    let shown = if changed { format!("• {now}") } else { now.clone() };
    let label = ui.add(egui::Label::new(RichText::new(&shown).monospace().color(color)).sense(Sense::hover()));
    label.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &shown));
    match was.filter(|_| changed) {
        Some(was) => drop(label.on_hover_text(format!("Before the last change: {was}"))),
        None if weak => drop(label.on_hover_text("Not drawn itself: value of the drawn pixel with the largest weight")),
        None => {}
    }
}
