//! Keys and dropped files, turned into commands.

use eframe::egui::{self, Ui};

use super::Workbench;
use crate::image::file::is_named_picture;
use crate::image::sequence::FileSequence;
use crate::ui::key_map::BINDINGS;
use crate::ui::panels::navigate::FLYING_KEYS;
use crate::ui::session::command::Command;
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::picture_role::PictureRole;
use crate::ui::session::{PointerMode, Session};

impl Workbench {
    pub(super) fn keys(&self, ui: &Ui, commands: &mut Vec<Command>) {
        // An open menu handles its own keys: Esc closes the menu and nothing else.
        if ui.text_edit_focused() || self.dialog.is_open() || egui::Popup::is_any_open(ui.ctx()) {
            return;
        }
        // A focused widget handles plain keys such as Space and the arrows itself.
        let has_focus = ui.egui_wants_keyboard_input();
        // In camera mode, or while the pointer is over the mesh view, the flying keys (W A S D Q E) are reserved for
        // moving a camera and run no commands.
        let flies = self.session.features.canvas.pointer_mode == PointerMode::Camera || self.widgets.mesh.hovered;
        for binding in BINDINGS {
            let is_flying = flies && binding.modifiers == egui::Modifiers::NONE && FLYING_KEYS.contains(&binding.key);
            let is_taken = is_flying || (has_focus && !binding.works_beside_focus());
            if !is_taken && ui.input_mut(|i| i.consume_shortcut(&binding.shortcut())) {
                commands.push((binding.command)());
            }
        }
        // The toolkit reports the copy shortcut as a separate event.
        if !has_focus && ui.input(|i| i.events.contains(&egui::Event::Copy)) {
            commands.push(Command::File(FileCommand::CopyPicture));
        }
    }
}

/// Opens the last of the files dropped on the window. Pictures dropped during a comparison take part in it.
pub(super) fn dropped_files(ui: &Ui, session: &Session, commands: &mut Vec<Command>) {
    let Some(file) = ui.input(|i| i.raw.dropped_files.last().cloned()) else { return };
    let path = file.path().to_owned();
    let is_picture = is_named_picture(&path) || FileSequence::is_named_by(&path);
    // The tiles find out on which of them the file was dropped.
    let is_compared = session.features.comparison.is_on() && session.features.case.is_none() && is_picture;
    if !is_compared {
        commands.push(Command::File(match FileSequence::is_named_by(&path) {
            true => FileCommand::OpenPicture(PictureRole::Tile(1), path),
            false => FileCommand::Open(path),
        }));
    }
}
