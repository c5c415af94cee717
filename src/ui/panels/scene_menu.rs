//! The menu “Scene”: lessons about black pixels, and a gallery of the built-in scenes with their pictures.

use eframe::egui::{
    Direction, Grid, Label, Layout, Rect, Response, RichText, Role, Sense, Ui, UiBuilder, Vec2, WidgetInfo, vec2,
};

use crate::inspect::lesson;
use crate::scene::builtin::{self, Builtin};
use crate::ui::session::command::Command;
use crate::ui::session::file_command::FileCommand;
use crate::ui::theme::{RADIUS, ROW_HEIGHT, space, tokens};
use crate::ui::thumbnails::{self, Thumbnails};

/// Draws the content of the menu “Scene”: lessons, and the gallery of built-in scenes.
pub(super) fn ui(ui: &mut Ui, thumbnails: &mut Thumbnails, commands: &mut Vec<Command>) {
    /// Number of scenes in a row.
    const COLUMNS: usize = 4;
    ui.menu_button("Why is this pixel black?", |ui| lessons(ui, commands));
    ui.separator();
    Grid::new("scenes").spacing(Vec2::splat(space::XS)).show(ui, |ui| {
        for (index, scene) in builtin::ALL.iter().enumerate() {
            if scene_button(ui, thumbnails, index, scene).clicked() {
                commands.push(Command::File(FileCommand::OpenBuiltin(scene.id.to_owned())));
                ui.close();
            }
            if index % COLUMNS == COLUMNS - 1 {
                ui.end_row();
            }
        }
    });
}

/// Draws a button with the thumbnail of a scene above its title.
fn scene_button(ui: &mut Ui, thumbnails: &mut Thumbnails, index: usize, scene: &Builtin) -> Response {
    /// Width of a title, in points. Wider than the thumbnail, because titles are longer.
    const WIDTH: f32 = 160.0;
    let size = vec2(WIDTH, thumbnails::LARGE.y + ROW_HEIGHT + space::XS);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, scene.title));
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, RADIUS, tokens(ui).control_hovered);
    }
    let center = rect.center_top() + vec2(0.0, space::XS + thumbnails::LARGE.y / 2.0);
    thumbnails.paint(ui, index, Rect::from_center_size(center, thumbnails::LARGE));
    let line = rect.with_min_y(rect.bottom() - ROW_HEIGHT).shrink2(vec2(space::XS, 0.0));
    let centered = Layout::centered_and_justified(Direction::LeftToRight);
    let title = RichText::new(scene.title).small().color(tokens(ui).text);
    ui.new_child(UiBuilder::new().max_rect(line).layout(centered)).add(Label::new(title).truncate());
    response.on_hover_ui(|ui| {
        ui.strong(scene.title);
        ui.label(scene.summary);
    })
}

/// Draws a menu entry for each lesson. The entry opens a scene with a black spot, applies the settings that produce the
/// spot, and picks it.
fn lessons(ui: &mut Ui, commands: &mut Vec<Command>) {
    for lesson in lesson::ALL {
        if ui
            .button(lesson.question)
            .on_hover_text("Open a small scene and pick its black spot: the panel “Pixel” names the cause")
            .clicked()
        {
            commands.push(Command::File(FileCommand::OpenLesson(lesson)));
            ui.close();
        }
    }
}
