//! Picture files on tiles: stored values of a pixel, and files that are dropped.

use eframe::egui::{FontId, Rect, Response, Ui, Vec2};

use super::{PlacedTile, line_x};
use crate::image::file::is_named_picture;
use crate::image::sequence::FileSequence;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::compare::Mode;
use crate::ui::session::compare::compute::Compared;
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::picture_role::{PictureRole, letter};
use crate::ui::theme::{RADIUS, font_size, space, tokens};

/// Draws the stored values of picture files at a pixel, with the names of their channels, in the upper right corner of
/// the picture.
pub(super) fn readout(
    ui: &Ui,
    PlacedTile { index, layout, .. }: PlacedTile<'_>,
    (x, y): (u32, u32),
    session: &Session,
    compared: &Compared,
) {
    let tiles = if session.features.comparison.mode == Mode::Tiles { index..index + 1 } else { 0..2 };
    let lines: Vec<String> = tiles
        .filter_map(|tile| {
            let file = compared.tiles.get(tile)?.file.as_ref()?;
            Some(format!("{} at {x},{y}:  {}", letter(tile), file.values_at((x, y))))
        })
        .collect();
    if lines.is_empty() {
        return;
    }
    let painter = ui.painter().with_clip_rect(layout.picture);
    let width = (layout.picture.width() - 4.0 * space::S).max(40.0);
    let font = FontId::monospace(font_size::SMALL);
    let text = painter.layout(lines.join("\n"), font, tokens(ui).text, width);
    let size = text.size() + Vec2::splat(2.0 * space::XS);
    let corner = layout.picture.right_top() + Vec2::new(-space::S - size.x, space::S);
    painter.rect_filled(Rect::from_min_size(corner, size), RADIUS, tokens(ui).panel.gamma_multiply(0.92));
    painter.galley(corner + Vec2::splat(space::XS), text, tokens(ui).text);
}

/// Opens a picture file that was dropped on a tile. If the position of the pointer is unknown, it becomes B.
pub(super) fn dropped(ui: &Ui, responses: &[Response], session: &Session, commands: &mut Vec<Command>) {
    let Some(file) = ui.input(|i| i.raw.dropped_files.last().cloned()) else { return };
    let path = file.path().to_owned();
    if !is_named_picture(&path) && !FileSequence::is_named_by(&path) {
        return;
    }
    let pointer = ui.input(|i| i.pointer.latest_pos());
    let on = pointer.and_then(|at| responses.iter().position(|response| response.rect.contains(at)));
    let tile = match (session.features.comparison.mode, on) {
        (Mode::Tiles, Some(tile)) => tile,
        (Mode::Wipe, Some(_)) => {
            let line = line_x(responses[0].rect, session.features.comparison.wipe);
            usize::from(pointer.is_none_or(|at| at.x >= line))
        }
        _ => 1,
    };
    commands.push(Command::File(FileCommand::OpenPicture(PictureRole::Tile(tile), path)));
}
