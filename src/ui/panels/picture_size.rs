//! Menu in the toolbar for the size of the picture: presets, a custom size, or the size of the canvas.

use eframe::egui::{RichText, Ui};

use crate::pipeline::viewport::{MAX_SIDE_PX, Viewport};
use crate::ui::session::command::Command;
use crate::ui::session::{PictureSize, Session};
use crate::ui::theme::tokens;
use crate::ui::widgets::integer_field;

/// Selectable sizes in pixels, each with its help text.
const PRESETS: [(u32, u32, &str); 6] = [
    (160, 90, "Few, large pixels: edges and grids are easy to see"),
    (320, 180, "Large pixels"),
    (640, 360, "A quarter of the pixels of HD"),
    (1280, 720, "HD, the default"),
    (1920, 1080, "Full HD"),
    (3840, 2160, "4K"),
];

/// Help text of the menu.
const HELP: &str = "Size of the picture in pixels. It does not depend on the layout of the window, and neither do \
                    timings, errors and the picked pixel";

/// Help text of [`PictureSize::MatchWindow`].
const MATCH_WINDOW: &str = "One picture pixel per screen pixel. Whatever resizes the canvas also changes the picture, \
                            its timings and its errors";

/// Draws the button that shows the size of the picture and opens the menu.
pub(crate) fn menu(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let Viewport { width, height } = session.viewport();
    let text = RichText::new(label(width, height)).monospace();
    let mut size = session.state.size;
    let response = ui.menu_button(text, |ui| {
        for (width, height, help) in PRESETS {
            ui.selectable_value(&mut size, PictureSize::Fixed(width, height), label(width, height)).on_hover_text(help);
        }
        ui.separator();
        custom(ui, session.viewport(), &mut size);
        ui.separator();
        ui.selectable_value(&mut size, PictureSize::MatchWindow, "Match window").on_hover_text(MATCH_WINDOW);
        if size == PictureSize::MatchWindow {
            ui.set_max_width(220.0);
            ui.label(RichText::new(MATCH_WINDOW).small().color(tokens(ui).text_weak));
        }
    });
    response.response.on_hover_text(HELP);
    if size != session.state.size && size == size.checked() {
        commands.push(Command::SetSize(size));
    }
}

/// Draws the fields for a custom width and height.
fn custom(ui: &mut Ui, Viewport { mut width, mut height }: Viewport, size: &mut PictureSize) {
    ui.horizontal(|ui| {
        ui.label("Custom");
        let field = |ui: &mut Ui, side: &mut u32, name: &str| {
            let field = integer_field(side).range(1..=MAX_SIDE_PX).update_while_editing(false);
            let response = ui.add(field);
            ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(name));
            response.changed()
        };
        let is_wider = field(ui, &mut width, "Width in pixels");
        ui.label("×");
        if field(ui, &mut height, "Height in pixels") || is_wider {
            *size = PictureSize::Fixed(width, height);
        }
    });
}

/// Returns a size as text, such as “1280 × 720”.
fn label(width: u32, height: u32) -> String {
    format!("{width} × {height}")
}
