//! Dialog that asks where to save: the system's file dialog or, without one, a field for the path.

use std::path::{Path, PathBuf};

use eframe::egui::{Button, Key, Label, RichText, Role, TextEdit, Ui, WidgetInfo};

use super::session::save_item::SaveItem;
use crate::ui::modal::modal;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::file_command::FileCommand;
use crate::ui::system_dialog::{Answer, SystemDialog};
use crate::ui::theme::tokens;

/// Dialog for choosing the path of a saved file.
pub(crate) struct SaveDialog {
    item: SaveItem,
    folder: PathBuf,
    path: String,
    system: Option<SystemDialog>,
    hint: Option<&'static str>,
}

impl SaveDialog {
    /// Creates a dialog for saving `item`, with a suggested path in the current folder.
    pub(crate) fn new(item: SaveItem, session: &Session) -> Self {
        let name = Path::new(item.stem(session)).with_extension(item.extension());
        let path = session.features.files.folder.join(name).display().to_string();
        Self { item, folder: session.features.files.folder.clone(), path, system: None, hint: None }
    }

    /// Opens the system's file dialog. Until it is closed, this dialog only waits for it.
    pub(crate) fn browse(&mut self, ui: &Ui) {
        let target = self.target();
        let (name, extension) = (self.item.extension().to_uppercase(), self.item.extension());
        self.hint = None;
        self.system = Some(SystemDialog::open(ui, move || {
            let file_name = target.file_name().unwrap_or_default().to_string_lossy();
            let dialog = rfd::FileDialog::new().add_filter(name, &[extension]).set_file_name(file_name);
            dialog.set_directory(target.parent().unwrap_or(Path::new("."))).save_file()
        }));
    }

    /// Returns the path at which the file would be saved.
    fn target(&self) -> PathBuf {
        self.item.path(&self.path, &self.folder)
    }

    /// Draws the dialog. Returns whether it stays open.
    pub(crate) fn ui(&mut self, ui: &mut Ui, commands: &mut Vec<Command>) -> bool {
        match self.system.as_ref().and_then(SystemDialog::poll) {
            Some(Answer::Chosen(chosen)) => {
                self.system = None;
                self.path = chosen.display().to_string();
                // The system has asked before replacing the chosen file, but not a file with another name.
                if self.target() == chosen || !self.target().exists() {
                    commands.push(Command::File(FileCommand::SaveTo(self.item, self.target())));
                    return false;
                }
            }
            Some(Answer::Cancelled) => return false,
            Some(Answer::Unavailable) => {
                self.system = None;
                self.hint = Some("This system has no file dialog: it needs a desktop portal or zenity.");
            }
            None => {}
        }
        let title = format!("Save {}", self.item.name());
        if self.system.is_some() {
            return modal(ui, &title, |ui| {
                ui.label("Choose a file in the dialog of the system.");
                if ui.button("Type a path instead").clicked() {
                    self.system = None;
                }
                ui.button("Cancel").clicked()
            });
        }
        modal(ui, &title, |ui| self.field(ui, commands))
    }

    /// Draws the field for the path and the buttons. Returns whether the dialog is done.
    fn field(&mut self, ui: &mut Ui, commands: &mut Vec<Command>) -> bool {
        let field = ui.add(TextEdit::singleline(&mut self.path).desired_width(f32::INFINITY));
        field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Path of the file"));
        let entered = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
        if !entered && ui.memory(|memory| memory.focused().is_none()) {
            field.request_focus();
        }
        let (target, named) = (self.target(), !self.path.trim().is_empty());
        let has_folder = target.parent().is_some_and(Path::is_dir);
        let replaces = named && target.exists();
        let (note, color) = match () {
            () if !named => ("Type a name or a path.".to_owned(), tokens(ui).text_weak),
            () if !has_folder => {
                let folder = target.parent().unwrap_or(&target).display().to_string();
                (format!("The folder {folder} does not exist."), tokens(ui).warning)
            }
            () if replaces => (format!("{} exists and is replaced.", target.display()), tokens(ui).warning),
            () => (format!("Saves to {}", target.display()), tokens(ui).text_weak),
        };
        ui.add(Label::new(RichText::new(note).color(color)).truncate());
        let mut done = false;
        ui.horizontal(|ui| {
            let ready = named && has_folder;
            let save = ui.add_enabled(ready, Button::new(if replaces { "Replace" } else { "Save" }));
            if (save.clicked() || entered) && ready {
                commands.push(Command::File(FileCommand::SaveTo(self.item, target)));
                done = true;
            }
            if ui.button("Browse…").on_hover_text("Open the system file dialog").clicked() {
                self.browse(ui);
            }
            done |= ui.button("Cancel").clicked();
        });
        if let Some(hint) = self.hint {
            ui.label(RichText::new(hint).color(tokens(ui).warning));
        }
        done
    }
}
