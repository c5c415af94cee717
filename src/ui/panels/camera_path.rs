//! Controls of the recorded camera path in the strip below the picture.

use eframe::egui::{RichText, Ui};

use crate::ui::session::Session;
use crate::ui::session::camera_path::CameraPathChange;
use crate::ui::session::command::Command;
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::save_item::SaveItem;
use crate::ui::theme::{Icon, tokens};
use crate::ui::widgets::icon_button;

/// Draws the controls that record key views and follow the path.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let path = &session.features.camera_path;
    let mut change = |change| commands.push(Command::CameraPath(change));
    ui.separator();
    if icon_button(ui, Icon::Plus, "Add key view").clicked() {
        change(CameraPathChange::Add);
    }
    if path.keys.is_empty() {
        return;
    }
    if icon_button(ui, Icon::Minus, "Remove key view").clicked() {
        change(CameraPathChange::Remove);
    }
    let mut follows = path.follows;
    ui.checkbox(&mut follows, "Follow path").on_hover_text("Move the camera along the key views when the time changes");
    if follows != path.follows {
        change(CameraPathChange::Follow(follows));
    }
    let count = path.keys.len();
    let words = if count == 1 { "1 key view".to_owned() } else { format!("{count} key views") };
    let times: Vec<_> = path.keys.iter().map(|key| format!("{:.2} s", key.time_s)).collect();
    ui.label(RichText::new(words).color(tokens(ui).text_weak)).on_hover_text(times.join(", "));
    if icon_button(ui, Icon::Save, "Save camera path (JSON) as…").clicked() {
        commands.push(Command::File(FileCommand::SaveAs(SaveItem::CameraPath)));
    }
}
