//! The message line below the menu. It shows an error until it is closed, the progress of loading or exporting, a hint,
//! or a description of the canvas. It is always present, so that messages do not shift the layout.

use std::path::Path;

use eframe::egui::{Align, Color32, Label, Layout, ProgressBar, Rect, RichText, Sense, Ui, Vec2};

use crate::text;
use crate::ui::session::command::Command;
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::lab::LabChange;
use crate::ui::session::picture_role::PictureRole;
use crate::ui::session::workspace::{Panel, WorkspaceChange};
use crate::ui::session::{Dismissal, Notice, Session};
use crate::ui::theme::{self, Icon, tokens};
use crate::ui::widgets::icon_button;

const LAB_HINT: &str = "Step with , and . or play with K; drag the blue rings. Wheel: zoom. L: back to the pipeline.";

/// Opacity of the error colour behind the line, in [0, 1].
const ERROR_TINT: f32 = 0.25;

/// Draws the message line. `loading` is the path of the model being loaded, and its completed fraction from 0 to 1.
pub(crate) fn ui(ui: &mut Ui, session: &Session, loading: Option<(&Path, f32)>, commands: &mut Vec<Command>) {
    ui.horizontal_centered(|ui| {
        if let Some(error) = &session.features.messages.error {
            let tint = tokens(ui).error.gamma_multiply(ERROR_TINT);
            ui.painter().rect_filled(ui.max_rect().expand2(theme::space::S * Vec2::X), theme::RADIUS, tint);
            MessageLine {
                icon: Icon::OctagonAlert,
                color: tokens(ui).error,
                text: error,
                close: Some(Command::Message(Dismissal::Error)),
            }
            .ui(ui, commands);
        } else if let Some(path) = &session.features.messages.offered_picture {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if ui.button("Open in the 2D lab").on_hover_text("Fill and sample the picture in the 2D lab").clicked() {
                commands.push(Command::Lab(LabChange::OpenPicture(path.clone())));
            }
            if ui.button("Compare as B").on_hover_text("Compare the picture with the rendered one").clicked() {
                commands.push(Command::File(FileCommand::OpenPicture(PictureRole::Tile(1), path.clone())));
            }
            let text = format!("{} is a picture, not a scene", text::clean(&name));
            MessageLine {
                icon: Icon::Image,
                color: tokens(ui).accent,
                text: &text,
                close: Some(Command::Message(Dismissal::Offer)),
            }
            .ui(ui, commands);
        } else if let Some((path, completed)) = loading {
            ui.spinner();
            if ui.button("Cancel").on_hover_text("Stop loading and keep the current scene").clicked() {
                commands.push(Command::File(FileCommand::CancelLoading));
            }
            ui.add(ProgressBar::new(completed).desired_width(120.0));
            ui.add(Label::new(format!("Loading {}… {:.0} %", path.display(), 100.0 * completed)).truncate());
        } else if let Some(completed) = session.features.tasks.export_progress {
            ui.spinner();
            if ui.button("Cancel").on_hover_text("Stop the export").clicked() {
                commands.push(Command::File(FileCommand::CancelExport));
            }
            ui.add(ProgressBar::new(completed).desired_width(120.0));
            ui.add(Label::new(format!("Exporting… {:.0} %", 100.0 * completed)).truncate());
        } else if let Some(notice) = &session.features.messages.notice {
            show_notice(ui, notice, commands);
        } else if session.features.lab.open {
            MessageLine { icon: Icon::Lightbulb, color: tokens(ui).accent, text: LAB_HINT, close: None }
                .ui(ui, commands);
        } else if let Some(words) = session.features.what_if.unseen_change(&session.state.recipe) {
            let text = format!("{words}.  Press X to show the effect of this change.");
            MessageLine { icon: Icon::Diff, color: tokens(ui).accent, text: &text, close: None }.ui(ui, commands);
        } else {
            let (name, help) = (session.shown.name(), session.shown.help());
            MessageLine { icon: Icon::Eye, color: tokens(ui).text_weak, text: &format!("{name}: {help}"), close: None }
                .ui(ui, commands);
        }
    });
}

fn show_notice(ui: &mut Ui, notice: &Notice, commands: &mut Vec<Command>) {
    let close = Some(Command::Message(Dismissal::Notice));
    match notice {
        Notice::Saved(path) => {
            if ui.button("Open folder").on_hover_text("Show the saved file in the file manager").clicked() {
                commands.push(Command::File(FileCommand::OpenFolder(path.clone())));
            }
            let text = format!("Saved {}", path.display());
            MessageLine { icon: Icon::Check, color: tokens(ui).passed, text: &text, close }.ui(ui, commands);
        }
        Notice::Warnings(count) => {
            if ui.button("Show log").on_hover_text("List all warnings, with file and line").clicked() {
                commands.push(Command::Workspace(WorkspaceChange::Panel(Panel::Log)));
                commands.push(Command::Message(Dismissal::Notice));
            }
            let text = format!("Opened with {count} {}", if *count == 1 { "warning" } else { "warnings" });
            MessageLine { icon: Icon::TriangleAlert, color: tokens(ui).warning, text: &text, close }.ui(ui, commands);
        }
    }
}

/// A message with an icon.
struct MessageLine<'a> {
    icon: Icon,
    /// Colour of the icon.
    color: Color32,
    text: &'a str,
    /// Command of the close button; `None` if the line has no close button.
    close: Option<Command>,
}

impl MessageLine<'_> {
    /// Draws the line.
    fn ui(self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let Self { icon, color, text, close } = self;
        let (place, _): (Rect, _) = ui.allocate_exact_size(Vec2::splat(theme::ICON_SIZE), Sense::hover());
        theme::paint_icon(ui.painter(), place.center(), icon, theme::ICON_SIZE, color);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some(close) = close
                && icon_button(ui, Icon::X, "Close this message").clicked()
            {
                commands.push(close);
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(Label::new(RichText::new(text).color(tokens(ui).text)).truncate().selectable(true));
            });
        });
    }
}
