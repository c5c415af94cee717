//! Header above a picture: the letter of its tile and a list of upscalers.

use std::path::Path;

use eframe::egui::{self, Rect, Role, Ui, UiBuilder, WidgetInfo, vec2};

use super::color;
use super::layout::TileLayout;
use crate::chain::Recipe;
use crate::pipeline::settings::Choice as _;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::compare::{CompareChange, Mode};
use crate::ui::session::picture_role::{PictureRole, letter};
use crate::ui::theme::{CONTROL_HEIGHT, space};
use crate::ui::widgets::{combo, icon_button};
use crate::upscale::{Anchor, Upscaling};

/// Draws the row above a picture: one header, or two headers side by side for A and B.
pub(super) fn headers(ui: &mut Ui, index: usize, place: TileLayout, session: &Session, commands: &mut Vec<Command>) {
    if session.features.comparison.mode == Mode::Tiles {
        header(ui, index, place.header, session, commands);
    } else {
        let (left, right) = place.header.split_left_right_at_fraction(0.5);
        header(ui, 0, left, session, commands);
        header(ui, 1, right, session, commands);
    }
}

/// Draws the letter of a tile and the list that sets its upscaler.
fn header(ui: &mut Ui, tile: usize, rect: Rect, session: &Session, commands: &mut Vec<Command>) {
    let recipe = session.state.tiles.recipe(tile, session.state.recipe);
    let builder = UiBuilder::new()
        .id_salt(("tile header", tile))
        .max_rect(rect.shrink2(vec2(space::XS, 1.0)))
        .layout(egui::Layout::left_to_right(egui::Align::Center));
    let mut row = ui.new_child(builder);
    let removable = session.features.comparison.mode == Mode::Tiles && session.state.tiles.count() > 2;
    let name = letter(tile);
    let text = egui::RichText::new(name).strong().color(color(ui, tile));
    let active = tile == session.state.tiles.active;
    let label = row.selectable_label(active, text);
    label.widget_info(|| WidgetInfo::selected(Role::Button, true, active, format!("Tile {name}")));
    if label.on_hover_text("Edit the settings of this tile and inspect its pixels").clicked() {
        commands.push(Command::Compare(CompareChange::Activate(tile)));
    }
    if let Some(file) = session.state.tiles.file(PictureRole::Tile(tile)) {
        file_name(&mut row, tile, file, session, commands);
        return;
    }
    let width = row.available_width() - if removable { CONTROL_HEIGHT + space::S } else { 0.0 };
    let anchors_differ = session.features.comparison.anchors_differ(&session.state.tiles, session.state.recipe);
    let anchor = recipe.upscaler.block_anchor().filter(|_| anchors_differ);
    let chosen = row.name_inputs(format!("Upscaler of {name}"), |ui| upscalers(ui, width.max(40.0), recipe, anchor));
    if let Some(upscaler) = chosen {
        commands.push(Command::Compare(CompareChange::Recipe(tile, Box::new(Recipe { upscaler, ..recipe }))));
    }
    if removable && icon_button(&mut row, crate::ui::theme::Icon::X, &format!("Remove {name}")).clicked() {
        commands.push(Command::Compare(CompareChange::Remove(tile)));
    }
}

/// Draws the name of the picture file in a tile, and a button to draw the scene again.
fn file_name(row: &mut Ui, tile: usize, file: &Path, session: &Session, commands: &mut Vec<Command>) {
    let role = PictureRole::Tile(tile);
    let opened = session.features.comparison.opened(&session.state.tiles, role);
    let name = opened.as_ref().map_or_else(|| crate::text::path(file), |opened| opened.name());
    let width = (row.available_width() - CONTROL_HEIGHT - space::S).max(20.0);
    let label = egui::Label::new(name.as_str()).truncate();
    let label = row.add_sized([width, CONTROL_HEIGHT], label);
    label.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("File of {}: {name}", letter(tile))));
    label.on_hover_ui(|ui| {
        ui.label(crate::text::path(file));
        ui.label(opened.as_ref().map_or_else(|| "not opened".to_owned(), |opened| opened.picture.description()));
    });
    let close = format!("Close the file of {} and draw the scene", letter(tile));
    if icon_button(row, crate::ui::theme::Icon::X, &close).clicked() {
        commands.push(Command::Compare(CompareChange::RemoveFile(role)));
    }
}

/// Draws the list of upscalers and returns the newly selected one. `anchor` is the position of a sample within its
/// block of pixels, which the caption of the list then names. It is `None` at ×1 and if all compared pictures have the
/// same anchor.
fn upscalers(ui: &mut Ui, width: f32, recipe: Recipe, anchor: Option<Anchor>) -> Option<Upscaling> {
    let mut chosen = recipe.upscaler;
    let caption = if anchor.is_some() { chosen.label_with_anchor() } else { chosen.label() };
    let list = combo("tile upscaler", &caption, width).height(480.0).show_ui(ui, |ui| {
        for upscaling in Upscaling::every() {
            ui.selectable_value(&mut chosen, upscaling, upscaling.label()).on_hover_text(upscaling.upscaler().help());
        }
    });
    if let Some(anchor) = anchor {
        let help = format!(
            "The compared pictures use different anchors. This picture uses “{}”. {}",
            anchor.name(),
            anchor.help()
        );
        list.response.on_hover_text(help);
    }
    (chosen != recipe.upscaler).then_some(chosen)
}
