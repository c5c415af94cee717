//! Keys and dropped files, turned into commands.

use eframe::egui::{self, Ui};

use super::Workbench;
use crate::ui::command::{BINDINGS, Command};
use crate::ui::files::FileCommand;
use crate::ui::navigate::FLYING_KEYS;
use crate::ui::session::PointerMode;

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

pub(super) fn dropped_files(ui: &Ui, commands: &mut Vec<Command>) {
    if let Some(file) = ui.input(|i| i.raw.dropped_files.last().cloned()) {
        commands.push(Command::File(FileCommand::Open(file.path().to_owned())));
    }
}
