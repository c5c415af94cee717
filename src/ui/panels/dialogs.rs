//! Windows over the window: opening a model, going to a pixel, the key sheet.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use eframe::egui::{Frame, Grid, Id, Key, Modal, RichText, ScrollArea, TextEdit, Ui};

use crate::ui::command::{BINDINGS, Command, MOUSE};
use crate::ui::session::Session;
use crate::ui::theme::tokens;

/// A dialog of the system that comes back empty sooner than this was never shown.
const FASTEST_PERSON: Duration = Duration::from_millis(400);

/// Which dialog is open, and what was typed into it.
#[derive(Default)]
pub enum Dialog {
    /// None.
    #[default]
    Closed,
    /// Opening a model.
    Open(OpenDialog),
    /// Going to a pixel.
    Pixel(String),
    /// The key sheet.
    Keys,
}

/// Opening a model: by path, from the recent ones, or by the system's file dialog.
#[derive(Default)]
pub struct OpenDialog {
    path: String,
    browsing: Option<(Receiver<Option<PathBuf>>, Instant)>,
    hint: Option<&'static str>,
}

impl Dialog {
    /// Draws the open dialog, if any.
    pub fn ui(&mut self, ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
        let stays = match self {
            Self::Closed => true,
            Self::Open(dialog) => dialog.ui(ui, session, commands),
            Self::Pixel(text) => pixel(ui, text, session, commands),
            Self::Keys => keys(ui),
        };
        if !stays {
            *self = Self::Closed;
        }
    }

    /// Whether one is open.
    pub fn is_open(&self) -> bool {
        !matches!(self, Self::Closed)
    }
}

/// Shows `content` as a dialog; `content` returns true to close it. Returns whether it stays open.
fn modal(ui: &Ui, title: &str, content: impl FnOnce(&mut Ui) -> bool) -> bool {
    let modal =
        Modal::new(Id::unique(("dialog", title.to_owned()))).frame(Frame::window(ui.style())).show(ui.ctx(), |ui| {
            ui.set_width(440.0);
            ui.heading(title);
            ui.add_space(8.0);
            content(ui)
        });
    !modal.should_close() && !modal.inner
}

impl OpenDialog {
    fn ui(&mut self, ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) -> bool {
        let chosen = self.poll();
        let stays = modal(ui, "Open a model", |ui| {
            ui.label("Path of a Wavefront OBJ file. You can also drop a file on the window.");
            let field =
                TextEdit::singleline(&mut self.path).hint_text("/path/to/model.obj").desired_width(f32::INFINITY);
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
                    commands.push(Command::Open(PathBuf::from(self.path.trim())));
                    done = true;
                }
                let idle = self.browsing.is_none();
                if ui
                    .add_enabled(idle, eframe::egui::Button::new("Browse …"))
                    .on_hover_text("The system's file dialog")
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
            done | recent(ui, session, commands)
        });
        if let Some(path) = chosen {
            commands.push(Command::Open(path));
            return false;
        }
        stays
    }

    /// Opens the system's dialog on a thread of its own: it blocks until it is closed.
    fn browse(&mut self, ui: &Ui) {
        let (sender, receiver) = channel();
        let context = ui.ctx().clone();
        self.hint = None;
        self.browsing = Some((receiver, Instant::now()));
        std::thread::spawn(move || {
            let file = rfd::FileDialog::new()
                .add_filter("Models and cases", &["obj", "OBJ", "json"])
                .add_filter("Pictures, for the 2D lab", &["png", "jpg", "jpeg", "bmp", "gif", "tif", "tiff", "tga"])
                .pick_file();
            // The window may be gone by now.
            drop(sender.send(file));
            context.request_repaint();
        });
    }

    fn poll(&mut self) -> Option<PathBuf> {
        let (receiver, since) = self.browsing.as_ref()?;
        let answer = receiver.try_recv().ok()?;
        if answer.is_none() && since.elapsed() < FASTEST_PERSON {
            self.hint = Some(
                "This system offers no file dialog (no desktop portal, no zenity). Type the path, or drop the file on the window.",
            );
        }
        self.browsing = None;
        answer
    }
}

fn recent(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) -> bool {
    if session.recent.is_empty() {
        return false;
    }
    ui.add_space(8.0);
    ui.label(RichText::new("Recent").color(tokens(ui).text_weak));
    let mut done = false;
    for path in &session.recent {
        if ui.add(eframe::egui::Button::new(path.display().to_string()).truncate().frame(false)).clicked() {
            commands.push(Command::Open(path.clone()));
            done = true;
        }
    }
    done
}

fn pixel(ui: &mut Ui, text: &mut String, session: &Session, commands: &mut Vec<Command>) -> bool {
    modal(ui, "Go to a pixel", |ui| {
        let viewport = session.viewport();
        ui.label(format!("Column and row, from 0,0 to {},{}.", viewport.width - 1, viewport.height - 1));
        let field = ui.add(TextEdit::singleline(text).hint_text("x,y").desired_width(120.0));
        field.request_focus();
        let pixel = parse_pixel(text).filter(|(x, y)| *x < viewport.width && *y < viewport.height);
        let entered = ui.input(|i| i.key_pressed(Key::Enter));
        let go = ui.add_enabled(pixel.is_some(), eframe::egui::Button::new("Go"));
        if pixel.is_some() && (go.clicked() || entered) {
            commands.push(Command::Pick(pixel));
            return true;
        }
        false
    })
}

fn parse_pixel(text: &str) -> Option<(u32, u32)> {
    let mut numbers = text.split([',', ';', ' ']).filter(|part| !part.is_empty()).map(str::parse);
    let (x, y) = (numbers.next()?.ok()?, numbers.next()?.ok()?);
    numbers.next().is_none().then_some((x, y))
}

fn keys(ui: &mut Ui) -> bool {
    modal(ui, "Keys and mouse", |ui| {
        let height = (ui.ctx().content_rect().height() * 0.7).max(120.0);
        ScrollArea::vertical().max_height(height).show(ui, |ui| {
            Grid::new("keys").num_columns(2).striped(true).spacing([24.0, 4.0]).show(ui, |ui| {
                let mut row = |keys: String, what: &str| {
                    ui.label(RichText::new(keys).monospace().color(tokens(ui).text_strong));
                    ui.label(what);
                    ui.end_row();
                };
                for (gesture, what) in MOUSE {
                    row((*gesture).to_owned(), what);
                }
                let mut listed: Vec<&str> = Vec::new();
                for binding in BINDINGS {
                    // A second key for the same thing is not worth a line.
                    if !listed.contains(&binding.what) {
                        listed.push(binding.what);
                        row(key_name(binding), binding.what);
                    }
                }
            });
        });
        ui.add_space(8.0);
        ui.button("Close").clicked()
    })
}

fn key_name(binding: &crate::ui::command::Binding) -> String {
    let mut name = String::new();
    if binding.modifiers.command || binding.modifiers.ctrl {
        name.push_str("Ctrl + ");
    }
    if binding.modifiers.shift {
        name.push_str("Shift + ");
    }
    name + match binding.key {
        // The toolkit's own signs for these are in none of the fonts.
        Key::ArrowLeft => "←",
        Key::ArrowRight => "→",
        Key::ArrowUp => "↑",
        Key::ArrowDown => "↓",
        key => key.symbol_or_name(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_read_with_any_usual_separator() {
        for text in ["12,34", "12 34", " 12 , 34 ", "12;34"] {
            assert_eq!(parse_pixel(text), Some((12, 34)), "{text}");
        }
        assert_eq!(parse_pixel("12"), None);
        assert_eq!(parse_pixel("1,2,3"), None);
        assert_eq!(parse_pixel("-1,2"), None);
    }
}
