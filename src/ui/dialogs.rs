//! Modal dialogs: opening a model, saving, going to a pixel, the key sheet, the command palette, and the list of bookmarks.

use std::path::PathBuf;

use eframe::egui::{Key, RichText, TextEdit, Ui};

use super::modal::{modal, modal_of_width};
use super::panels::add_upscaler::AddUpscalerDialog;
use super::system_dialog::{Answer, SystemDialog};
use crate::image::picture::{format_names, suffixes};
use crate::inspect::project;
use crate::scene::SceneFormat;
use crate::ui::key_sheet;
use crate::ui::palette::Palette;
use crate::ui::panels::place::bookmarks;
use crate::ui::save_dialog::SaveDialog;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::picture_role::PictureRole;
use crate::ui::theme::tokens;

/// The open dialog, with the text typed into it.
#[derive(Default)]
pub(crate) enum Dialog {
    /// No dialog is open.
    #[default]
    Closed,
    /// Dialog for opening a model or a picture.
    Open(OpenDialog),
    /// Dialog for choosing the path of a saved file.
    Save(SaveDialog),
    /// Dialog for going to a pixel, triangle, object or vertex, with the typed text.
    Pixel(String),
    /// Key sheet, with its filter text.
    Keys(String),
    /// Command palette.
    Palette(Box<Palette>),
    /// List of bookmarks.
    Bookmarks,
    /// Dialog for adding an upscaler process.
    AddUpscaler(AddUpscalerDialog),
}

/// Dialog for opening a model or a picture: by path, from the recent files, or with the system's file dialog.
#[derive(Default)]
pub(crate) struct OpenDialog {
    /// Role in a comparison of the picture to open; `None` opens a model.
    role: Option<PictureRole>,
    path: String,
    browsing: Option<SystemDialog>,
    hint: Option<&'static str>,
}

impl Dialog {
    /// Draws the open dialog, if any.
    pub(crate) fn ui(&mut self, ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
        let stays = match self {
            Self::Closed => true,
            Self::Open(dialog) => dialog.ui(ui, session, commands),
            Self::Save(dialog) => dialog.ui(ui, commands),
            Self::Pixel(text) => go_to(ui, text, session, commands),
            Self::Keys(filter) => modal_of_width(ui, "Keys and mouse", key_sheet::width(ui), |ui| {
                key_sheet::ui(ui, filter);
                ui.button("Close").clicked()
            }),
            Self::Palette(palette) => palette.ui(ui, session, commands),
            Self::AddUpscaler(dialog) => dialog.ui(ui, session, commands),
            Self::Bookmarks => modal(ui, "Bookmarks", |ui| bookmarks::ui(ui, session, commands)),
        };
        if !stays {
            *self = Self::Closed;
        }
    }

    /// Whether a dialog is open.
    pub(crate) fn is_open(&self) -> bool {
        !matches!(self, Self::Closed)
    }
}

impl OpenDialog {
    /// Returns a dialog that opens a picture file in a comparison.
    pub(crate) fn of_picture(role: PictureRole) -> Self {
        Self { role: Some(role), ..Self::default() }
    }

    /// Returns the command that opens a file.
    fn command(&self, path: PathBuf) -> Command {
        Command::File(match self.role {
            Some(role) => FileCommand::OpenPicture(role, path),
            None => FileCommand::Open(path),
        })
    }

    /// Returns title, explanation and example of a path.
    fn words(&self) -> (String, String, &'static str) {
        match self.role {
            Some(role) => (
                format!("Open a picture as {}", role.name()),
                format!(
                    "Path of a picture: {}. A sequence is named by its folder or by a pattern such as frame.####.exr. You \
                     can also drop the file or folder on a compared picture.",
                    format_names()
                ),
                "/path/to/picture.exr",
            ),
            None => (
                "Open a model".to_owned(),
                format!(
                    "Path of a model ({}), a case (JSON), or a picture for the 2D lab. You can also drop the file on the \
                     window.",
                    SceneFormat::names()
                ),
                "/path/to/model.obj",
            ),
        }
    }

    fn ui(&mut self, ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) -> bool {
        let chosen = self.poll();
        let (title, explanation, example) = self.words();
        let stays = modal(ui, &title, |ui| {
            ui.label(explanation);
            let field = TextEdit::singleline(&mut self.path).hint_text(example).desired_width(f32::INFINITY);
            let field = ui.add(field);
            if self.path.is_empty() {
                field.request_focus();
            }
            let entered = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
            let mut done = false;
            ui.horizontal(|ui| {
                let ready = !self.path.trim().is_empty();
                let open = ui.add_enabled(ready, eframe::egui::Button::new("Open"));
                if (open.clicked() || entered) && ready {
                    commands.push(self.command(PathBuf::from(self.path.trim())));
                    done = true;
                }
                let idle = self.browsing.is_none();
                if ui
                    .add_enabled(idle, eframe::egui::Button::new("Browse…"))
                    .on_hover_text("Open the system file dialog")
                    .clicked()
                {
                    self.browse(ui);
                }
                if ui.button("Cancel").clicked() {
                    done = true;
                }
            });
            if let Some(hint) = self.hint {
                ui.label(RichText::new(hint).color(tokens(ui).warning));
            }
            done | (self.role.is_none() && recent(ui, session, commands))
        });
        if let Some(path) = chosen {
            commands.push(self.command(path));
            return false;
        }
        stays
    }

    fn browse(&mut self, ui: &Ui) {
        self.hint = None;
        let opens_picture = self.role.is_some();
        self.browsing = Some(SystemDialog::open(ui, move || {
            let pictures: Vec<_> = suffixes().collect();
            let dialog = rfd::FileDialog::new();
            let dialog = if opens_picture {
                dialog.add_filter("Pictures", &pictures)
            } else {
                let models = dialog.add_filter("Models, projects, camera paths and cases", &model_extensions());
                models.add_filter("Pictures, for the 2D lab", &pictures)
            };
            dialog.pick_file()
        }));
    }

    /// Returns the file that was chosen in the system's file dialog, if any.
    fn poll(&mut self) -> Option<PathBuf> {
        let answer = self.browsing.as_ref()?.poll()?;
        self.browsing = None;
        match answer {
            Answer::Chosen(path) => Some(path),
            Answer::Cancelled => None,
            Answer::Unavailable => {
                self.hint = Some(
                    "This system has no file dialog: it needs a desktop portal or zenity. Type the path, or drop the \
                     file on the window.",
                );
                None
            }
        }
    }
}

/// Returns the extensions of models and cases, in lower and upper case, because some file dialogs distinguish them.
fn model_extensions() -> Vec<String> {
    let known = SceneFormat::all_extensions().into_iter().chain(["json", project::EXTENSION]);
    known.flat_map(|extension| [extension.to_owned(), extension.to_uppercase()]).collect()
}

fn recent(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) -> bool {
    if session.features.files.recent.is_empty() {
        return false;
    }
    ui.add_space(8.0);
    ui.label(RichText::new("Recent files").color(tokens(ui).text_weak));
    let mut done = false;
    for path in &session.features.files.recent {
        if ui.add(eframe::egui::Button::new(path.display().to_string()).truncate().frame(false)).clicked() {
            commands.push(Command::File(FileCommand::Open(path.clone())));
            done = true;
        }
    }
    done
}

fn go_to(ui: &mut Ui, text: &mut String, session: &Session, commands: &mut Vec<Command>) -> bool {
    modal(ui, "Go to", |ui| {
        let viewport = session.viewport();
        ui.label(format!("Column and row, from 0,0 to {},{}.", viewport.width - 1, viewport.height - 1));
        ui.label("A triangle (tri 12) or the name of an object: picks a pixel that shows it.");
        ui.label("A zoom and a pixel (800% 12,34): centres the pixel at this zoom.");
        ui.label("A vertex of the picked object (v 12) or another one (vertex 12 of name): follows it in the picture.");
        let field =
            ui.add(TextEdit::singleline(text).hint_text("x,y  or  tri 12  or  v 12  or  name").desired_width(240.0));
        field.request_focus();
        let wanted = session.search_target(text);
        let entered = ui.input(|i| i.key_pressed(Key::Enter));
        let go = ui.add_enabled(wanted.is_ok(), eframe::egui::Button::new("Go"));
        // The message is laid out even if it is empty, so that the dialog does not change its size during typing.
        let complaint = wanted.as_ref().err().map_or("", String::as_str);
        ui.label(RichText::new(complaint).color(tokens(ui).warning));
        match wanted {
            Ok(wanted) if go.clicked() || entered => {
                commands.push(Command::go_to(wanted));
                true
            }
            _ => false,
        }
    })
}
