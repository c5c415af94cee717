//! The overlay card in the upper right corner of the canvas: a list of overlays with opacity, order and totals.

use eframe::egui::{Align, Button, Layout, Rect, RichText, ScrollArea, Sense, Slider, Ui, UiBuilder, WidgetInfo, vec2};

use super::legend;
use crate::inspect::overlays::Overlay;
use crate::manual::Chapter;
use crate::pipeline::settings::Choice as _;
use crate::ui::engine::RenderedView;
use crate::ui::manual::manual_button;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::overlays::{OverlayChange, OverlayLayer};
use crate::ui::theme::{self, Icon, RADIUS, ROW_HEIGHT, space, tokens};
use crate::ui::widgets::icon_button;

/// Width of the overlay card, in points.
const WIDTH: f32 = 272.0;

/// Distance of the card from the top edge of the canvas, in points. Leaves space for the spinner of a busy renderer.
const TOP: f32 = 36.0;

/// Draws the list of overlays if it is open.
pub(crate) fn ui(ui: &mut Ui, canvas: Rect, session: &Session, view: &RenderedView, commands: &mut Vec<Command>) {
    let overlays = &session.features.overlays;
    if !overlays.open {
        return;
    }
    let width = WIDTH.min(canvas.width() - 2.0 * space::S);
    let height = (canvas.height() - TOP - space::S).max(ROW_HEIGHT);
    let corner = canvas.right_top() + vec2(-space::S - width, TOP);
    let place = Rect::from_min_size(corner, vec2(width, height));
    let mut changes = Vec::new();
    // The background is painted before the content is laid out, so it has the height of the content in the last pass.
    let id = ui.scope_id().with("overlays card");
    let known: f32 = ui.data(|data| data.get_temp(id)).unwrap_or(0.0);
    let card = Rect::from_min_size(corner, vec2(width, known));
    ui.painter().rect_filled(card, RADIUS, tokens(ui).panel.gamma_multiply(0.94));
    ui.interact(card, id.with("ground"), Sense::click_and_drag());
    let builder = UiBuilder::new().max_rect(place.shrink(space::S)).layout(Layout::top_down(Align::Min));
    let mut column = ui.new_child(builder);
    column.spacing_mut().item_spacing.y = 0.0;
    title(&mut column, session, &mut changes, commands);
    ScrollArea::vertical().id_salt("overlays").auto_shrink([false, true]).show(&mut column, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        list(ui, session, view, &mut changes);
    });
    let needed = column.min_rect().height() + 2.0 * space::S;
    if needed != known {
        ui.data_mut(|data| data.insert_temp(id, needed));
        ui.request_repaint();
    }
    commands.extend(changes.into_iter().map(Command::Overlays));
}

fn title(ui: &mut Ui, session: &Session, changes: &mut Vec<OverlayChange>, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.set_height(ROW_HEIGHT);
        ui.label(RichText::new("Overlays").strong());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = space::XS;
            if icon_button(ui, Icon::X, "Hide this list; the overlays stay on  (O)").clicked() {
                changes.push(OverlayChange::Open(false));
            }
            manual_button(ui, Chapter::Reference, commands);
            ui.add_enabled_ui(session.features.overlays.count() > 0, |ui| {
                if icon_button(ui, Icon::Trash2, "Remove all overlays").clicked() {
                    changes.push(OverlayChange::Clear);
                }
                if icon_button(ui, Icon::Download, "Save all totals as CSV in the current folder").clicked() {
                    changes.push(OverlayChange::SaveTotals);
                }
            });
        });
    });
}

/// Draws the list of all overlays: active ones first, from the top layer down.
fn list(ui: &mut Ui, session: &Session, view: &RenderedView, changes: &mut Vec<OverlayChange>) {
    let overlays = &session.features.overlays;
    let on = overlays.layers.iter().rev().map(|layer| layer.overlay);
    let off = Overlay::ALL.iter().copied().filter(|overlay| overlays.layer(*overlay).is_none());
    for overlay in on.chain(off) {
        ui.push_id(overlay.id(), |ui| entry(ui, overlay, session, view, changes));
    }
    let mut marks = overlays.marks;
    let help = "When zoomed in, draws a point at every sample, and ticks on each edge that point into the triangle \
                that owns samples exactly on the edge";
    if ui.checkbox(&mut marks, "Sample points and edge owners").on_hover_text(help).changed() {
        changes.push(OverlayChange::Marks(marks));
    }
    if marks && !overlays.vectors {
        ui.label(RichText::new("Zoom in to see sample points and edges.").small().color(tokens(ui).text_weak));
    }
}

fn entry(ui: &mut Ui, overlay: Overlay, session: &Session, view: &RenderedView, changes: &mut Vec<OverlayChange>) {
    let layer = session.features.overlays.layer(overlay);
    let mut on = layer.is_some();
    ui.horizontal(|ui| {
        ui.set_height(ROW_HEIGHT);
        if ui.checkbox(&mut on, overlay.name()).on_hover_text(overlay.help()).changed() {
            changes.push(OverlayChange::Toggle(overlay));
        }
        let Some(layer) = layer else { return };
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = space::XS;
            let is_top = session.features.overlays.layers.last().is_some_and(|top| top.overlay == overlay);
            ui.add_enabled_ui(!is_top, |ui| {
                let button = Button::new(theme::icon(Icon::ArrowUp)).frame_when_inactive(false);
                let raise = ui.add(button).on_hover_text("Move this overlay up by one layer");
                if raise.on_disabled_hover_text("This overlay is already on top").clicked() {
                    changes.push(OverlayChange::Raise(overlay));
                }
            });
            let mut opacity = layer.opacity;
            ui.spacing_mut().slider_width = 56.0;
            let slider = ui.add(Slider::new(&mut opacity, 0.0..=1.0).show_value(false));
            let name = format!("Opacity of “{}”", overlay.name());
            slider.widget_info(|| WidgetInfo::slider(true, f64::from(layer.opacity), &name));
            if slider.on_hover_text(format!("Opacity {:.0} %", 100.0 * layer.opacity)).changed() {
                changes.push(OverlayChange::Opacity(overlay, opacity));
            }
        });
    });
    if let Some(layer) = layer.filter(|_| overlay.has_length()) {
        ui.indent("length", |ui| length(ui, layer, changes));
    }
    if let Some(sheet) = view.look_result.sheets.iter().find(|sheet| on && sheet.overlay == overlay) {
        ui.indent("legend", |ui| legend::ui(ui, sheet));
        ui.add_space(space::XS);
    }
}

/// Draws the slider for the length of the normals drawn by an overlay.
fn length(ui: &mut Ui, layer: OverlayLayer, changes: &mut Vec<OverlayChange>) {
    ui.horizontal(|ui| {
        ui.set_height(ROW_HEIGHT);
        ui.spacing_mut().slider_width = 96.0;
        let mut length = layer.length;
        let name = format!("Length of “{}”", layer.overlay.name());
        if length_slider(ui, &mut length, &name) {
            changes.push(OverlayChange::Length(layer.overlay, length));
        }
        let text = RichText::new(format!("Length {:.1} %", 100.0 * layer.length)).small();
        ui.label(text.color(tokens(ui).text_weak));
    });
}

/// Draws a slider for the length of normals. Returns whether it was moved.
pub(crate) fn length_slider(ui: &mut Ui, length: &mut f32, name: &str) -> bool {
    /// Range of lengths, as fractions of the diagonal of the scene's bounding box.
    const LENGTHS: std::ops::RangeInclusive<f32> = 0.001..=0.5;
    let slider = ui.add(Slider::new(length, LENGTHS).logarithmic(true).show_value(false));
    slider.widget_info(|| WidgetInfo::slider(true, f64::from(*length), name));
    slider.on_hover_text("Length of normals, relative to the diagonal of the scene's bounding box").changed()
}
