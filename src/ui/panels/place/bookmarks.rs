//! The list of bookmarks, with actions to open, rename and delete them.

use eframe::egui::{self, Button, Grid, RichText, ScrollArea, TextEdit, Ui, WidgetInfo};

use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::place::PlaceChange;
use crate::ui::theme::{CONTROL_HEIGHT, Icon, tokens};
use crate::ui::widgets::{empty_state, icon_button};

/// Width of the name field of a bookmark, in points.
const NAME_POINTS: f32 = 270.0;

/// Draws the list of bookmarks. Returns whether the dialog should close.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) -> bool {
    let bookmarks = &session.features.places.bookmarks;
    let mut changes = Vec::new();
    if bookmarks.is_empty() {
        let help = "Ctrl+B bookmarks scene, view, settings, the shown buffer or stage, and the picked pixel.";
        empty_state(ui, Icon::Bookmark, "No bookmarks yet", help);
    }
    let height = ui.ctx().content_rect().height() * 0.6;
    ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
        Grid::new("bookmarks").num_columns(4).spacing([8.0, 4.0]).show(ui, |ui| {
            for (number, bookmark) in bookmarks.iter().enumerate() {
                let key = if number < 9 { format!("Ctrl+{}", number + 1) } else { String::new() };
                ui.label(RichText::new(key).monospace().color(tokens(ui).text_weak));
                let mut name = bookmark.name.clone();
                let field = ui.add_sized([NAME_POINTS, CONTROL_HEIGHT], TextEdit::singleline(&mut name));
                field.widget_info(|| {
                    WidgetInfo::labeled(egui::Role::TextInput, true, format!("Name of bookmark {}", number + 1))
                });
                if field.changed() {
                    changes.push(PlaceChange::Rename(number, name));
                }
                let go = ui.add(Button::new("Open"));
                go.widget_info(|| {
                    WidgetInfo::labeled(egui::Role::Button, true, format!("Open bookmark {}", number + 1))
                });
                if go.on_hover_text(bookmark.place.command_line()).clicked() {
                    changes.push(PlaceChange::Jump(number));
                }
                if icon_button(ui, Icon::Trash2, &format!("Delete bookmark {}", number + 1)).clicked() {
                    changes.push(PlaceChange::Remove(number));
                }
                ui.end_row();
            }
        });
    });
    ui.add_space(8.0);
    let mut done = changes.iter().any(|change| matches!(change, PlaceChange::Jump(_)));
    ui.horizontal(|ui| {
        if ui.button("Bookmark the current view").on_hover_text("Ctrl+B").clicked() {
            changes.push(PlaceChange::Bookmark);
        }
        done |= ui.button("Close").clicked();
    });
    commands.extend(changes.into_iter().map(Command::Place));
    done
}
