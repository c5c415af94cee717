//! The dialog that adds an upscaler which runs as an external process.

use std::time::Duration;

use eframe::egui::{Button, Key, RichText, TextEdit, Ui};

use crate::chain::Recipe;
use crate::manual::Chapter;
use crate::ui::manual::manual_button;
use crate::ui::modal::modal;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::compare::CompareChange;
use crate::ui::theme::tokens;
use crate::ui::widgets::number_field;
use crate::upscale::process::{ProcessSpec, register_process};
use crate::upscale::{Scale, Upscaling};

/// Dialog for adding an upscaler process: its description as on the command line, and its time limit.
pub(crate) struct AddUpscalerDialog {
    text: String,
    /// Time limit for a frame, in seconds.
    limit: f64,
    /// Reason why the last description was refused.
    refused: Option<String>,
}

impl Default for AddUpscalerDialog {
    fn default() -> Self {
        Self { text: String::new(), limit: 2.0, refused: None }
    }
}

impl AddUpscalerDialog {
    /// Draws the dialog. Returns whether it stays open. An added upscaler draws the picture, or picture B of a comparison.
    pub(crate) fn ui(&mut self, ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) -> bool {
        modal(ui, "Add an upscaler process", |ui| {
            ui.label("Name and command of a program in any language. It is started when the upscaler is first used, and answers every frame.");
            let field = TextEdit::singleline(&mut self.text).hint_text("my-net:2,4=python3 net.py");
            let field = ui.add(field.desired_width(f32::INFINITY)).on_hover_text(
                "ID:OPTIONS=COMMAND. Options are scales, “f32” for colours as floats, and “depth” to receive depths. The \
                 command is not interpreted by a shell.",
            );
            if self.text.is_empty() {
                field.request_focus();
            }
            let is_entered = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
            ui.horizontal(|ui| {
                ui.label("Time limit for a frame");
                ui.name_inputs("Time limit for a frame", |ui| {
                    let field = number_field(&mut self.limit, |limit| format!("{limit} s")).speed(0.05);
                    ui.add(field.range(0.01..=3600.0)).on_hover_text("The start may take five times as long");
                });
            });
            if let Some(refused) = &self.refused {
                ui.label(RichText::new(refused).color(tokens(ui).error));
            }
            let mut is_done = false;
            ui.horizontal(|ui| {
                let add = ui.add_enabled(!self.text.trim().is_empty(), Button::new("Add"));
                if add.clicked() || is_entered {
                    match self.add() {
                        Ok(upscaler) => {
                            is_done = true;
                            commands.push(shown(session, upscaler));
                        }
                        Err(reason) => self.refused = Some(reason),
                    }
                }
                is_done |= ui.button("Cancel").clicked();
                manual_button(ui, Chapter::ComparingUpscalers, commands);
            });
            is_done
        })
    }

    /// Registers the upscaler, and returns it at the offered scale nearest to 2.
    fn add(&self) -> Result<Upscaling, String> {
        let spec: ProcessSpec = self.text.trim().parse()?;
        let limit = Duration::try_from_secs_f64(self.limit).map_err(|error| error.to_string())?;
        register_process(&spec, limit).map_err(|error| error.to_string())?;
        Upscaling::new(spec.id(), Scale::TWO).ok_or_else(|| "the upscaler was not added: internal error".to_owned())
    }
}

/// Returns the command that shows an upscaler.
fn shown(session: &Session, upscaler: Upscaling) -> Command {
    let recipe = Recipe { upscaler, ..session.state.recipe };
    match session.features.comparison.is_on() {
        true => Command::Compare(CompareChange::Recipe(1, Box::new(recipe))),
        false => Command::SetRecipe(recipe),
    }
}
