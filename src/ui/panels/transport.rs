//! The toolbar above the canvas: selection of a stage or buffer, tool buttons, zoom, and pointer mode.

use eframe::egui::{self, Button, RichText, Ui, WidgetInfo};

use crate::inspect::{Buffer, Intermediate, Stage};
use crate::pipeline::settings::Choice as _;
use crate::ui::command::Command;
use crate::ui::compare::{CompareChange, Mode};
use crate::ui::engine::Shown;
use crate::ui::mesh_view;
use crate::ui::overlays;
use crate::ui::picture_size;
use crate::ui::range;
use crate::ui::session::{PointerMode, Session};
use crate::ui::theme::{self, CONTROL_HEIGHT, Icon, tokens};
use crate::ui::what_if;
use crate::ui::widgets::{combo, icon_button};

/// Draws the toolbar. `scale` is the display scale in screen pixels per picture pixel; `None` means that the picture is
/// fitted to the canvas.
pub(crate) fn toolbar(ui: &mut Ui, session: &Session, scale: Option<f32>, commands: &mut Vec<Command>) {
    ui.horizontal_centered(|ui| {
        stages(ui, session, commands);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            pointer_mode(ui, session, commands);
            ui.separator();
            zoom(ui, session, scale, commands);
        });
    });
}

/// Tool buttons in order of priority. A narrow toolbar omits the last ones, which remain available through keys, menu
/// and palette.
const OPENERS: [Opener; 5] = [Opener::Overlays, Opener::Tiles, Opener::Outside, Opener::WhatIf, Opener::Range];

/// Tool with a button in the toolbar.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Opener {
    Tiles,
    WhatIf,
    Outside,
    Range,
    Overlays,
}

fn stages(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    /// Width reserved for the pointer mode and for the list of buffers and stages with its two buttons, in points.
    const ALWAYS: f32 = 230.0;
    /// Width of a tool button including its spacing, in points.
    const ONE: f32 = CONTROL_HEIGHT + theme::space::S;
    let room = ((ui.available_width() - ALWAYS) / ONE).max(0.0) as usize;
    let shows = |opener| OPENERS.iter().take(room).any(|shown| *shown == opener);
    if icon_button(ui, Icon::ChevronLeft, "Show the previous stage").clicked() {
        commands.push(Command::Show(session.stage_beside_shown(-1)));
    }
    let mut shown = session.shown;
    combo("shown", shown.name(), (ui.available_width() - 408.0).clamp(64.0, 140.0))
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
    if shows(Opener::Tiles) && icon_button(ui, Icon::Columns2, "Compare pictures side by side  (T)").clicked() {
        commands.push(Command::Compare(CompareChange::Toggle(Mode::Tiles)));
    }
    if shows(Opener::WhatIf)
        && icon_button(ui, Icon::Diff, "Show the effect of the last change of a setting  (X)").clicked()
    {
        commands.push(Command::WhatIf(what_if::WhatIfChange::Toggle));
    }
    if shows(Opener::Outside)
        && icon_button(ui, Icon::Box, "Show the mesh view: the scene from a second camera  (M)").clicked()
    {
        commands.push(Command::MeshView(mesh_view::MeshViewChange::Toggle));
    }
    let help = "Show the range controls and the histogram over the picture";
    if shows(Opener::Range) && icon_button(ui, Icon::ChartColumn, help).clicked() {
        commands.push(Command::Range(range::RangeChange::Open(!session.range.open)));
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
        commands.push(Command::Overlays(overlays::OverlayChange::ToggleOpen));
    }
}

fn pointer_mode(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let modes = [
        (
            PointerMode::Camera,
            Icon::Rotate3d,
            "Camera mode",
            "drag to orbit the camera, scroll to dolly, W A S D Q E to fly  (C)",
        ),
        (
            PointerMode::Inspect,
            Icon::MousePointer2,
            "Inspect mode",
            "drag to pan the picture, scroll to zoom, middle-drag to orbit the camera  (C)",
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

/// Minimum free width for the two zoom buttons, in points. In a narrower toolbar, the zoom is available only through
/// menu and keys.
const ZOOM_POINTS: f32 = 64.0;

/// Minimum free width for the zoom factor, in points.
const ENLARGEMENT_POINTS: f32 = 56.0;

/// Minimum free width for the menu of picture sizes, in points.
const SIZE_POINTS: f32 = 110.0;

fn zoom(ui: &mut Ui, session: &Session, scale: Option<f32>, commands: &mut Vec<Command>) {
    if ui.available_width() < ZOOM_POINTS {
        return;
    }
    if icon_button(ui, Icon::Maximize, "Fit the picture into the canvas  (F)").clicked() {
        commands.push(Command::ZoomFit);
    }
    if icon_button(ui, Icon::Square, "Show one picture pixel per screen pixel  (0)").clicked() {
        commands.push(Command::ZoomOne);
    }
    if ui.available_width() >= ENLARGEMENT_POINTS {
        let zoom = scale.map_or_else(|| "fit".to_owned(), |s| format!("{:.0} %", s * 100.0));
        ui.label(RichText::new(zoom).monospace().color(tokens(ui).text_weak))
            .on_hover_text("Zoom. To set it, press Ctrl+G and type, for example, 800% 12,34");
    }
    if ui.available_width() >= SIZE_POINTS {
        picture_size::menu(ui, session, commands);
    }
}
