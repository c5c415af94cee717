//! The “Watch” panel: one row per watched pixel, one column per buffer.

use eframe::egui::{
    self, Align2, Button, Color32, FontId, Grid, Painter, RichText, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo,
    vec2,
};

use crate::inspect::watch::{PixelValues, WatchedPixel};
use crate::manual::Chapter;
use crate::ui::format;
use crate::ui::panels::{PanelSpec, scrolling};
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::watch::WatchChange;
use crate::ui::theme::{self, Icon, MARK_EDGE, Tokens, font_size, space, tokens};
use crate::ui::widgets::{empty_state, icon_button, swatch};
use crate::ui::zoom::Placement;

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::InspectingAPixel,
    grows: false,
    titled: true,
    controls: Some(|ui, cx| controls(ui, cx.session, cx.commands)),
    content: |ui, cx| self::ui(ui, cx.session, cx.commands),
};

/// Quantity of a watched pixel: a column of the table.
struct Quantity {
    name: &'static str,
    help: &'static str,
    text: fn(&PixelValues) -> String,
}

/// All quantities, in the order of the columns.
const QUANTITIES: [Quantity; 8] = [
    Quantity {
        name: "Colour",
        help: "Red, green and blue in the finished picture, 0 to 255",
        text: |values| format!("{} {} {}", values.color[0], values.color[1], values.color[2]),
    },
    Quantity {
        name: "Depth",
        help: "Final value of the depth buffer",
        text: |values| values.depth.map_or_else(nothing, format::f32_full),
    },
    Quantity {
        name: "Triangle",
        help: "Number of the visible triangle in the scene",
        text: |values| values.triangle.map_or_else(nothing, |id| id.0.to_string()),
    },
    Quantity {
        name: "Object",
        help: "Object that the visible triangle belongs to",
        text: |values| values.object.clone().unwrap_or_else(nothing),
    },
    Quantity {
        name: "Barycentric: linear",
        help: "Screen-space barycentric weights in the visible triangle",
        text: |values| values.lambda.map_or_else(nothing, weights),
    },
    Quantity {
        name: "Barycentric: perspective-correct",
        help: "Weights of attributes in the visible triangle. If interpolation is affine, they equal the linear ones",
        text: |values| values.perspective_lambda.map_or_else(nothing, weights),
    },
    Quantity {
        name: "Overdraw",
        help: "Number of triangles that cover the pixel's centre",
        text: |values| values.overdraw.to_string(),
    },
    Quantity {
        name: "Shaded",
        help: "Number of shaded fragments at the pixel's centre",
        text: |values| values.shaded.to_string(),
    },
];

/// Minimum width of the table with a row per pixel, in points. A narrower panel lists the quantities of each pixel
/// below one another.
const TABLE_FROM: f32 = 900.0;

/// Draws the controls of the “Watch” panel.
pub(crate) fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let watched = |pixel| session.features.watch.pixels.contains(&pixel);
    let addable = session.pick.is_some_and(|pixel| !watched(pixel));
    let add = ui.add_enabled(addable, Button::new((theme::icon(Icon::Pin), "Watch the picked pixel")));
    if add.on_hover_text("Add the picked pixel to the list  (Enter)").clicked() {
        commands.push(Command::Watch(WatchChange::AddPick));
    }
    let clear = ui.add_enabled(!session.features.watch.pixels.is_empty(), Button::new("Clear"));
    if clear.on_hover_text("Remove all pixels from the list").clicked() {
        commands.push(Command::Watch(WatchChange::Clear));
    }
}

/// Draws the table of watched pixels.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    if session.features.watch.pixels.is_empty() {
        let help = "Press Enter, or the pin in the inspector, to add the picked pixel. Its values in all buffers are \
                    updated after every frame.";
        empty_state(ui, Icon::Pin, "No watched pixels", help);
        return;
    }
    if ui.available_width() < TABLE_FROM {
        return scrolling(ui, |ui| blocks(ui, session, commands));
    }
    scrolling(ui, |ui| {
        Grid::new("watch").num_columns(QUANTITIES.len() + 2).striped(true).spacing([16.0, 2.0]).show(ui, |ui| {
            heading(ui, "Pixel", "Column and row of the pixel; click to pick it");
            for Quantity { name, help, .. } in &QUANTITIES {
                heading(ui, name, help);
            }
            ui.end_row();
            for (number, pixel) in session.features.watch.pixels.iter().copied().enumerate() {
                ui.horizontal(|ui| name(ui, session, number, pixel, commands));
                row(ui, session, pixel);
                remove(ui, pixel, commands);
                ui.end_row();
            }
        });
    });
}

/// Draws the quantities of each watched pixel below one another.
fn blocks(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    for (number, pixel) in session.features.watch.pixels.iter().copied().enumerate() {
        ui.horizontal(|ui| {
            name(ui, session, number, pixel, commands);
            remove(ui, pixel, commands);
        });
        Grid::new(("watch", pixel)).num_columns(2).striped(true).spacing([8.0, 2.0]).show(ui, |ui| {
            match known(session, pixel) {
                Known::Values(values, before) => {
                    for quantity in &QUANTITIES {
                        heading(ui, quantity.name, quantity.help);
                        cell(ui, values, before, quantity.text);
                        ui.end_row();
                    }
                }
                Known::Outside | Known::Pending => absent(ui, known(session, pixel)),
            }
        });
        ui.add_space(space::S);
    }
}

fn heading(ui: &mut Ui, name: &str, help: &str) {
    ui.label(RichText::new(name).small().color(tokens(ui).text_weak)).on_hover_text(help);
}

/// Draws the number, the position and the colour of a watched pixel.
fn name(ui: &mut Ui, session: &Session, number: usize, (x, y): (u32, u32), commands: &mut Vec<Command>) {
    ui.label(RichText::new((number + 1).to_string()).monospace().color(tokens(ui).warning));
    let picked = session.pick == Some((x, y));
    let pixel = ui.add(Button::selectable(picked, RichText::new(format!("{x}, {y}")).monospace()));
    if pixel.on_hover_text("Pick this pixel").clicked() {
        commands.push(Command::Pick(Some((x, y))));
    }
    if let Known::Values(PixelValues { color: [r, g, b, _], .. }, _) = known(session, (x, y)) {
        swatch(ui, Color32::from_rgb(*r, *g, *b));
    }
}

fn remove(ui: &mut Ui, (x, y): (u32, u32), commands: &mut Vec<Command>) {
    if icon_button(ui, Icon::X, &format!("Stop watching {x}, {y}")).clicked() {
        commands.push(Command::Watch(WatchChange::Remove(x, y)));
    }
}

/// Values of a watched pixel in the frame on screen.
#[derive(Clone, Copy)]
enum Known<'a> {
    /// The values, and those before the last change, if any.
    Values(&'a PixelValues, Option<&'a PixelValues>),
    /// The pixel lies outside the picture.
    Outside,
    /// The values are not computed yet.
    Pending,
}

fn known(session: &Session, (x, y): (u32, u32)) -> Known<'_> {
    let Some(row) = session.features.watch.rows.iter().find(|row| (row.x, row.y) == (x, y)) else {
        return Known::Pending;
    };
    let Some(values) = row.values.as_ref() else { return Known::Outside };
    let before = session.features.watch.before(row).and_then(|before: &WatchedPixel| before.values.as_ref());
    Known::Values(values, before)
}

fn absent(ui: &mut Ui, known: Known<'_>) {
    let text = match known {
        Known::Values(..) => return,
        Known::Outside => "outside the picture",
        Known::Pending => "…",
    };
    ui.label(RichText::new(text).color(tokens(ui).text_weak));
}

fn row(ui: &mut Ui, session: &Session, pixel: (u32, u32)) {
    let known = known(session, pixel);
    let Known::Values(values, before) = known else {
        absent(ui, known);
        // Empty cells for the columns without a value.
        (1..QUANTITIES.len()).for_each(|_| drop(ui.label("")));
        return;
    };
    for quantity in &QUANTITIES {
        cell(ui, values, before, quantity.text);
    }
}

fn nothing() -> String {
    "–".to_owned()
}

fn weights(weights: [f32; 3]) -> String {
    weights.map(|weight| format::fixed(f64::from(weight), 4)).join(" ")
}

/// Draws the value of a buffer at a watched pixel. If the value differs from that in `before`, it is highlighted and
/// the tooltip shows the old value.
fn cell(ui: &mut Ui, values: &PixelValues, before: Option<&PixelValues>, text: fn(&PixelValues) -> String) {
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

/// Draws numbered frames around all watched pixels inside the picture.
pub(super) fn markers(
    painter: &Painter,
    placement: Placement,
    session: &Session,
    (width, height): (u32, u32),
    tokens: &Tokens,
) {
    /// Minimum side length of a frame, in points, so that it is visible around small pixels.
    const MIN_POINTS: f32 = 5.0;
    for (number, (x, y)) in session.features.watch.pixels.iter().copied().enumerate() {
        if x >= width || y >= height {
            continue;
        }
        let pixel = placement.rect_of(x, y);
        let frame = egui::Rect::from_center_size(pixel.center(), pixel.size().max(Vec2::splat(MIN_POINTS)));
        painter.rect_stroke(frame.expand(1.0), 0.0, Stroke::new(3.0, MARK_EDGE), StrokeKind::Outside);
        painter.rect_stroke(frame.expand(2.0), 0.0, Stroke::new(1.0, tokens.warning), StrokeKind::Outside);
        let text = (number + 1).to_string();
        let galley = painter.layout_no_wrap(text, FontId::monospace(font_size::SMALL), tokens.warning);
        let place = Align2::LEFT_BOTTOM.anchor_size(frame.right_top() + vec2(3.0, -1.0), galley.size());
        painter.rect_filled(place.expand(1.0), 2.0, MARK_EDGE);
        painter.galley(place.min, galley, tokens.warning);
    }
}
