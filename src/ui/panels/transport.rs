//! Over the canvas: which stage or buffer is shown, how large, and what the pointer does.

use eframe::egui::{self, Button, RichText, Ui, WidgetInfo};

use crate::inspect::{Buffer, Intermediate, Stage};
use crate::pipeline::settings::Choice as _;
use crate::ui::command::Command;
use crate::ui::compare::{Change, Mode};
use crate::ui::engine::Shown;
use crate::ui::mesh_view;
use crate::ui::overlays;
use crate::ui::range;
use crate::ui::session::{PointerMode, Session};
use crate::ui::theme::{self, CONTROL_HEIGHT, Icon, tokens};
use crate::ui::what_if;
use crate::ui::widgets::{combo, icon_button};

/// Draws the bar over the canvas: what is shown, how large, and what the pointer does. `scale` is the enlargement on
/// screen, `None` when the picture is fitted.
pub fn toolbar(ui: &mut Ui, session: &Session, scale: Option<f32>, commands: &mut Vec<Command>) {
    ui.horizontal_centered(|ui| {
        stages(ui, session, commands);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            pointer_mode(ui, session, commands);
            ui.separator();
            zoom(ui, session, scale, commands);
        });
    });
}

/// What the bar does without from the last one on where it is narrow: keys, menu and palette offer them, too.
const OPENERS: [Opener; 5] = [Opener::Overlays, Opener::Tiles, Opener::Outside, Opener::WhatIf, Opener::Range];

/// A button that opens a tool.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Opener {
    Tiles,
    WhatIf,
    Outside,
    Range,
    Overlays,
}

fn stages(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    /// Room for the list of what is shown with its two buttons and for those of the pointer, in points.
    const ALWAYS: f32 = 230.0;
    /// Room for one button more, in points.
    const ONE: f32 = CONTROL_HEIGHT + theme::space::S;
    let room = ((ui.available_width() - ALWAYS) / ONE).max(0.0) as usize;
    let shows = |opener| OPENERS.iter().take(room).any(|shown| *shown == opener);
    if icon_button(ui, Icon::ChevronLeft, "Show the stage before  ([)").clicked() {
        commands.push(Command::StepStage(-1));
    }
    let mut shown = session.shown;
    combo("shown", shown.name(), (ui.available_width() - 408.0).clamp(64.0, 140.0))
        .height(480.0)
        .show_ui(ui, |ui| {
            ui.weak("Buffers of the frame");
            for buffer in Buffer::ALL {
                ui.selectable_value(&mut shown, Shown::Buffer(*buffer), buffer.name()).on_hover_text(buffer.help());
            }
            ui.weak("Pictures after a stage");
            for stage in Stage::ALL {
                ui.selectable_value(&mut shown, Shown::Stage(*stage), stage.name()).on_hover_text(stage.help());
            }
            ui.weak("Numbers on the way");
            for number in Intermediate::ALL {
                let value = Shown::Intermediate(*number);
                ui.selectable_value(&mut shown, value, number.name()).on_hover_text(number.help());
            }
        })
        .response
        .on_hover_text("What the canvas shows: a buffer of the finished frame, or the picture after a stage");
    if shown != session.shown {
        commands.push(Command::Show(shown));
    }
    if icon_button(ui, Icon::ChevronRight, "Show the stage after  (])").clicked() {
        commands.push(Command::StepStage(1));
    }
    if shows(Opener::Tiles) && icon_button(ui, Icon::Columns2, "Compare pictures side by side  (T)").clicked() {
        commands.push(Command::Compare(Change::Toggle(Mode::Tiles)));
    }
    if shows(Opener::WhatIf) && icon_button(ui, Icon::Diff, "What did the last change of a setting do?  (X)").clicked()
    {
        commands.push(Command::WhatIf(what_if::Change::Toggle));
    }
    if shows(Opener::Outside)
        && icon_button(ui, Icon::Box, "See the scene from outside, with the camera's view  (M)").clicked()
    {
        commands.push(Command::MeshView(mesh_view::Change::Toggle));
    }
    let help = "Range and histogram of what is shown, on the picture";
    if shows(Opener::Range) && icon_button(ui, Icon::ChartColumn, help).clicked() {
        commands.push(Command::Range(range::Change::Open(!session.range.open)));
    }
    if shows(Opener::Overlays) {
        overlays_button(ui, session, commands);
    }
}

fn overlays_button(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let count = session.overlays.count();
    let name = if count > 0 { format!("Overlays ({count})") } else { "Overlays".to_owned() };
    let text = if count > 0 { count.to_string() } else { String::new() };
    let help = "edges, counts, sizes and faults over the picture, each with a legend  (O)";
    let button = Button::selectable(session.overlays.open, (theme::icon(Icon::Layers), text));
    let response = ui.add(button).on_hover_text(format!("{name}: {help}"));
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, session.overlays.open, &name));
    if response.clicked() {
        commands.push(Command::Overlays(overlays::Change::ToggleOpen));
    }
}

fn pointer_mode(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let modes = [
        (
            PointerMode::Camera,
            Icon::Rotate3d,
            "Camera mode",
            "Drag turns the scene, wheel comes closer, W A S D Q E fly  (C)",
        ),
        (
            PointerMode::Inspect,
            Icon::MousePointer2,
            "Inspect mode",
            "Drag moves the picture, wheel enlarges it; middle-drag turns the scene  (C)",
        ),
    ];
    for (mode, icon, name, help) in modes {
        let button = Button::new(theme::icon(icon)).selected(session.pointer_mode == mode);
        let response = ui.add(button).on_hover_text(format!("{name}: {help}"));
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, name));
        if response.clicked() {
            commands.push(Command::SetPointerMode(mode));
        }
    }
}

/// Room for the two buttons of the enlargement, in points. Where there is less, menu and keys have to do.
const ZOOM_POINTS: f32 = 64.0;

/// Room for size and enlargement in figures, in points.
const FIGURES_POINTS: f32 = 160.0;

/// Room for the enlargement alone, in points.
const ENLARGEMENT_POINTS: f32 = 56.0;

fn zoom(ui: &mut Ui, session: &Session, scale: Option<f32>, commands: &mut Vec<Command>) {
    if ui.available_width() < ZOOM_POINTS {
        return;
    }
    if icon_button(ui, Icon::Maximize, "Fit the picture into the canvas  (F)").clicked() {
        commands.push(Command::ZoomFit);
    }
    if icon_button(ui, Icon::Square, "One picture pixel per screen pixel  (0)").clicked() {
        commands.push(Command::ZoomOne);
    }
    let viewport = session.viewport();
    let zoom = scale.map_or_else(|| "fit".to_owned(), |s| format!("{:.0} %", s * 100.0));
    let text = match ui.available_width() {
        room if room >= FIGURES_POINTS => format!("{} × {}  {zoom}", viewport.width, viewport.height),
        room if room >= ENLARGEMENT_POINTS => zoom,
        _ => return,
    };
    ui.label(RichText::new(text).monospace().color(tokens(ui).text_weak))
        .on_hover_text("Size of the picture in px, and its enlargement on screen. Ctrl+G sets it: 800% 12,34");
}
