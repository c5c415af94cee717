//! Tools of the bar above the canvas. Tools that do not fit move into a menu at the end of the bar.

use eframe::egui::{self, Button, RichText, Ui, WidgetInfo};

use crate::ui::panels::picture_size;
use crate::ui::session::canvas_state::CanvasChange;
use crate::ui::session::command::Command;
use crate::ui::session::compare::{CompareChange, Mode};
use crate::ui::session::{PointerMode, Session, mesh_view, overlays, range, what_if};
use crate::ui::theme::{self, CONTROL_HEIGHT, Icon, space, tokens};
use crate::ui::widgets::{icon_button, overflow_menu};

/// Tool of the bar above the canvas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tool {
    PictureSize,
    Overlays,
    PointerModes,
    Fit,
    OneToOne,
    Tiles,
    MeshView,
    WhatIf,
    Range,
    ZoomFactor,
}

/// Tools at the left end of the bar, from left to right.
pub(super) const LEFT: [Tool; 5] = [Tool::Tiles, Tool::WhatIf, Tool::MeshView, Tool::Range, Tool::Overlays];

/// Tools at the right end of the bar, from right to left.
const RIGHT: [Tool; 5] = [Tool::PointerModes, Tool::OneToOne, Tool::Fit, Tool::ZoomFactor, Tool::PictureSize];

/// Button that selects a pointer mode.
#[derive(Clone, Copy)]
struct PointerModeButton {
    mode: PointerMode,
    icon: Icon,
    name: &'static str,
    help: &'static str,
}

/// Buttons of all pointer modes.
const POINTER_MODES: [PointerModeButton; 3] = [
    PointerModeButton {
        mode: PointerMode::Orbit,
        icon: Icon::Rotate3d,
        name: "Orbit mode",
        help: "drag to orbit the camera, scroll to zoom, middle-drag to pan the picture, click to pick a pixel",
    },
    PointerModeButton {
        mode: PointerMode::Pan,
        icon: Icon::Hand,
        name: "Pan mode",
        help: "drag to pan the picture, scroll to zoom  (P)",
    },
    PointerModeButton {
        mode: PointerMode::Camera,
        icon: Icon::Video,
        name: "Camera mode",
        help: "drag to orbit the camera, scroll to dolly, W A S D Q E to fly  (C)",
    },
];

/// Inputs of the tools, and the list to which they append commands.
pub(super) struct ToolContext<'a> {
    pub(super) session: &'a Session,
    /// Display scale in screen pixels per picture pixel; `None` if the picture is fitted to the canvas.
    pub(super) scale: Option<f32>,
    pub(super) commands: &'a mut Vec<Command>,
}

/// Control of a tool.
#[expect(clippy::large_enum_variant, reason = "a few live for the time of one call")]
enum ToolControl {
    /// Plain button.
    Button(ToolButton),
    /// Menu of the size of the picture.
    PictureSize,
    /// Button of the list of overlays, with their number.
    Overlays,
    /// One button for each pointer mode.
    PointerModes,
    /// Zoom factor as text.
    ZoomFactor,
}

/// Button that pushes a command.
struct ToolButton {
    icon: Icon,
    name: &'static str,
    command: Command,
}

impl Tool {
    /// All tools, in the order in which they keep their place in a narrow bar.
    const BY_PRIORITY: [Self; 10] = [
        Self::PictureSize,
        Self::Overlays,
        Self::PointerModes,
        Self::Fit,
        Self::OneToOne,
        Self::Tiles,
        Self::MeshView,
        Self::WhatIf,
        Self::Range,
        Self::ZoomFactor,
    ];

    /// Returns the tools that fit into `width` points, beside the menu with the others.
    pub(super) fn fitting(width: f32) -> Vec<Self> {
        let mut room = width - CONTROL_HEIGHT - space::S;
        let mut fits = |tool: &Self| {
            room -= tool.width();
            room >= 0.0
        };
        // Stops at the first tool without room, so that the order of priority holds for any width.
        Self::BY_PRIORITY.into_iter().take_while(|tool| fits(tool)).collect()
    }

    /// Returns the width of tools and of the menu with the others, including the space beside them, in points.
    pub(super) fn width_of_all(tools: &[Self]) -> f32 {
        CONTROL_HEIGHT + space::S + tools.iter().map(|tool| tool.width()).sum::<f32>()
    }

    /// Returns the width of the tool in the bar including the space beside it, in points. Generous estimate.
    fn width(self) -> f32 {
        const ICON: f32 = CONTROL_HEIGHT + space::S;
        match self {
            Self::PictureSize => 108.0,
            Self::Overlays => ICON + 2.0 * space::L,
            Self::PointerModes => 3.0 * ICON + 2.0 * space::L,
            Self::ZoomFactor => 56.0,
            Self::Fit | Self::OneToOne | Self::Tiles | Self::MeshView | Self::WhatIf | Self::Range => ICON,
        }
    }

    /// Returns the control of the tool.
    fn control(self, session: &Session) -> ToolControl {
        let button = |icon, name, command| ToolControl::Button(ToolButton { icon, name, command });
        match self {
            Self::Fit => {
                button(Icon::Maximize, "Fit the picture into the canvas  (F)", Command::Canvas(CanvasChange::Fit))
            }
            Self::OneToOne => button(
                Icon::Square,
                "Show one picture pixel per screen pixel  (0)",
                Command::Canvas(CanvasChange::OneToOne),
            ),
            Self::Tiles => button(
                Icon::Columns2,
                "Compare pictures side by side  (T)",
                Command::Compare(CompareChange::Toggle(Mode::Tiles)),
            ),
            Self::MeshView => button(
                Icon::Box,
                "Show the mesh view: the scene from a second camera  (M)",
                Command::MeshView(mesh_view::MeshViewChange::Toggle),
            ),
            Self::WhatIf => button(
                Icon::Diff,
                "Show the effect of the last change of a setting  (X)",
                Command::WhatIf(what_if::WhatIfChange::Toggle),
            ),
            Self::Range => button(
                Icon::ChartColumn,
                "Show the range controls and the histogram over the picture",
                Command::Range(range::RangeChange::Open(!session.features.range.open)),
            ),
            Self::PictureSize => ToolControl::PictureSize,
            Self::Overlays => ToolControl::Overlays,
            Self::PointerModes => ToolControl::PointerModes,
            Self::ZoomFactor => ToolControl::ZoomFactor,
        }
    }

    /// Draws the tool in the bar.
    pub(super) fn show(self, ui: &mut Ui, cx: &mut ToolContext<'_>) {
        match self.control(cx.session) {
            ToolControl::Button(ToolButton { icon, name, command }) => {
                if icon_button(ui, icon, name).clicked() {
                    cx.commands.push(command);
                }
            }
            ToolControl::PictureSize => picture_size::menu(ui, cx.session, cx.commands),
            ToolControl::Overlays => overlays_button(ui, cx, ""),
            ToolControl::PointerModes => {
                // The bar is laid out from right to left.
                for mode in POINTER_MODES.into_iter().rev() {
                    pointer_mode(ui, cx, mode, false);
                }
                ui.separator();
            }
            ToolControl::ZoomFactor => {
                ui.label(RichText::new(zoom_text(cx.scale)).monospace().color(tokens(ui).text_weak))
                    .on_hover_text("Zoom. To set it, press Ctrl+G and type, for example, 800% 12,34");
            }
        }
    }

    /// Draws the tool as an entry of the menu.
    fn entry(self, ui: &mut Ui, cx: &mut ToolContext<'_>) {
        match self.control(cx.session) {
            ToolControl::Button(ToolButton { icon, name, command }) => {
                if ui.button((theme::icon(icon), name)).clicked() {
                    cx.commands.push(command);
                    ui.close();
                }
            }
            ToolControl::PictureSize => picture_size::menu(ui, cx.session, cx.commands),
            ToolControl::Overlays => overlays_button(ui, cx, "Overlays  (O)"),
            ToolControl::PointerModes => {
                for mode in POINTER_MODES {
                    pointer_mode(ui, cx, mode, true);
                }
            }
            ToolControl::ZoomFactor => {
                ui.label(RichText::new(format!("Zoom: {}", zoom_text(cx.scale))).color(tokens(ui).text_weak));
            }
        }
    }
}

fn zoom_text(scale: Option<f32>) -> String {
    scale.map_or_else(|| "fit".to_owned(), |scale| format!("{:.0} %", scale * 100.0))
}

/// Draws the right end of the bar from right to left: the tools among `shown`, and the menu with all others.
pub(super) fn right_end(ui: &mut Ui, shown: &[Tool], cx: &mut ToolContext<'_>) {
    let hidden: Vec<_> = RIGHT.into_iter().rev().chain(LEFT).filter(|tool| !shown.contains(tool)).collect();
    if !hidden.is_empty() {
        overflow_menu(ui, "More tools of the picture", |ui| hidden.iter().for_each(|tool| tool.entry(ui, cx)));
    }
    RIGHT.iter().filter(|tool| shown.contains(tool)).for_each(|tool| tool.show(ui, cx));
}

fn overlays_button(ui: &mut Ui, cx: &mut ToolContext<'_>, words: &str) {
    let (open, count) = (cx.session.features.overlays.open, cx.session.features.overlays.count());
    let name = if count > 0 { format!("Overlays ({count})") } else { "Overlays".to_owned() };
    let text = match count {
        0 => words.to_owned(),
        _ if words.is_empty() => count.to_string(),
        _ => format!("{words}  {count}"),
    };
    let help = "edges, counts, sizes and faults over the picture, each with a legend  (O)";
    let button = labelled(Icon::Layers, &text).selected(open).frame_when_inactive(open).frame(true);
    let response = ui.add(button).on_hover_text(format!("{name}: {help}"));
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, open, &name));
    if response.clicked() {
        cx.commands.push(Command::Overlays(overlays::OverlayChange::ToggleOpen));
        ui.close();
    }
}

/// Returns a button with an icon, and with words if there are any.
fn labelled(icon: Icon, words: &str) -> Button<'_> {
    match words {
        "" => Button::new(theme::icon(icon)),
        _ => Button::new((theme::icon(icon), words)),
    }
}

fn pointer_mode(ui: &mut Ui, cx: &mut ToolContext<'_>, button: PointerModeButton, with_name: bool) {
    let PointerModeButton { mode, icon, name, help } = button;
    let words = if with_name { name } else { "" };
    let button = labelled(icon, words).selected(cx.session.features.canvas.pointer_mode == mode);
    let response = ui.add(button).on_hover_text(format!("{name}: {help}"));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, name));
    if response.clicked() {
        cx.commands.push(Command::Canvas(CanvasChange::PointerMode(mode)));
        ui.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tool_has_one_place_and_one_priority() {
        for tool in Tool::BY_PRIORITY {
            let places = LEFT.iter().chain(&RIGHT).filter(|other| **other == tool);
            assert_eq!(places.count(), 1, "{tool:?}");
        }
        assert_eq!(LEFT.len() + RIGHT.len(), Tool::BY_PRIORITY.len());
        assert_eq!(Tool::fitting(2000.0).len(), Tool::BY_PRIORITY.len());
        assert!(Tool::fitting(20.0).is_empty());
    }
}
