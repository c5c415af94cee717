//! The toolbar above the canvas: selection of a stage or buffer, and tools.

use eframe::egui::{self, Ui};

use super::tools::{self, Tool, ToolContext};
use crate::inspect::{Buffer, Intermediate, Stage};
use crate::pipeline::settings::Choice as _;
use crate::ui::engine::Shown;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::theme::{CONTROL_HEIGHT, Icon, space};
use crate::ui::widgets::{combo, icon_button};

/// Minimum and maximum width of the list of buffers and stages, in points.
const SHOWN_POINTS: (f32, f32) = (96.0, 140.0);

/// Draws the toolbar. `scale` is the display scale in screen pixels per picture pixel; `None` means that the picture is
/// fitted to the canvas.
pub(crate) fn toolbar(ui: &mut Ui, session: &Session, scale: Option<f32>, commands: &mut Vec<Command>) {
    ui.horizontal_centered(|ui| {
        let beside = ui.available_width() - 2.0 * (CONTROL_HEIGHT + space::S) - space::S;
        let tools = Tool::fitting(beside - SHOWN_POINTS.0);
        let room = beside - Tool::width_of_all(&tools);
        shown(ui, session, room.clamp(SHOWN_POINTS.0, SHOWN_POINTS.1), commands);
        let mut cx = ToolContext { session, scale, commands };
        tools::LEFT.iter().filter(|tool| tools.contains(tool)).for_each(|tool| tool.show(ui, &mut cx));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            tools::right_end(ui, &tools, &mut cx);
        });
    });
}

/// Draws the list of buffers and stages, `width` points wide, between buttons for the previous and the next stage.
fn shown(ui: &mut Ui, session: &Session, width: f32, commands: &mut Vec<Command>) {
    if icon_button(ui, Icon::ChevronLeft, "Show the previous stage").clicked() {
        commands.push(Command::Show(session.stage_beside_shown(-1)));
    }
    let mut shown = session.shown;
    combo("shown", shown.name(), width)
        .height(480.0)
        .show_ui(ui, |ui| {
            ui.weak("Buffers of the finished frame");
            for buffer in Buffer::ALL {
                ui.selectable_value(&mut shown, Shown::Buffer(*buffer), buffer.name()).on_hover_text(buffer.help());
            }
            ui.weak("Pictures after a stage");
            for stage in Stage::ALL {
                ui.selectable_value(&mut shown, Shown::Stage(*stage), stage.name()).on_hover_text(stage.help());
            }
            ui.weak("Intermediate values");
            for number in Intermediate::ALL {
                let value = Shown::Intermediate(*number);
                ui.selectable_value(&mut shown, value, number.name()).on_hover_text(number.help());
            }
        })
        .response
        .on_hover_text(
            "Content of the canvas: a buffer of the finished frame, the picture after a stage, or an \
                        intermediate value",
        );
    if shown != session.shown {
        commands.push(Command::Show(shown));
    }
    if icon_button(ui, Icon::ChevronRight, "Show the next stage").clicked() {
        commands.push(Command::Show(session.stage_beside_shown(1)));
    }
}
