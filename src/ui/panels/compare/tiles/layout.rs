//! Layout of the tiles on the canvas.

use eframe::egui::{Rect, Vec2, vec2};

use super::figures::{LINE, figure_lines};
use crate::ui::session::compare::Mode;
use crate::ui::session::{PictureSize, Session};
use crate::ui::theme::{CONTROL_HEIGHT, space};

/// Height of the row above a picture, in points.
const HEADER: f32 = CONTROL_HEIGHT + space::XS;

/// Gap between tiles, in points.
const GAP: f32 = space::XS;

/// Screen rectangles of the parts of one tile, in points.
#[derive(Clone, Copy)]
pub(super) struct TileLayout {
    pub(super) header: Rect,
    pub(super) picture: Rect,
    pub(super) footer: Rect,
}

/// Computes the rectangles of all tiles on the canvas.
pub(super) fn places(canvas: Rect, session: &Session) -> Vec<TileLayout> {
    let comparison = &session.features.comparison;
    let shown = if comparison.mode == Mode::Tiles { comparison.shown(&session.state.tiles) } else { 1 };
    let aspect = match session.state.size {
        PictureSize::Fixed(width, height) => width as f32 / height.max(1) as f32,
        PictureSize::MatchWindow => 1.4,
    };
    // Space for the region's error metrics is reserved before the user draws the region, so that the pictures keep
    // their size.
    let blocks = if comparison.region.is_some() || comparison.draws_region { 2.0 } else { 1.0 };
    let layout = |columns: usize| {
        let rows = shown.div_ceil(columns);
        let cell = (canvas.size() + Vec2::splat(GAP)) / vec2(columns as f32, rows as f32) - Vec2::splat(GAP);
        let lines = if comparison.mode == Mode::Tiles { figure_lines(cell.x) } else { figure_lines(cell.x / 2.0) };
        let footer = blocks * lines as f32 * LINE + space::XS;
        let picture = vec2(cell.x, (cell.y - HEADER - footer).max(1.0));
        (cell.floor(), picture.floor(), footer)
    };
    let area = |columns: &usize| {
        let (_, picture, _) = layout(*columns);
        let height = picture.y.min(picture.x / aspect);
        // Prefers a layout with few empty cells if picture areas are nearly equal.
        height * height * aspect * shown as f32 / (*columns * shown.div_ceil(*columns)) as f32
    };
    let columns = (1..=shown.max(1)).max_by(|a, b| area(a).total_cmp(&area(b))).unwrap_or(1);
    let (cell, picture, footer) = layout(columns);
    let place = |index: usize| {
        let step = (cell + Vec2::splat(GAP)) * vec2((index % columns) as f32, (index / columns) as f32);
        let min = canvas.min + step;
        let top = min + vec2(0.0, HEADER);
        TileLayout {
            header: Rect::from_min_size(min, vec2(cell.x, HEADER)),
            picture: Rect::from_min_size(top, picture),
            footer: Rect::from_min_size(top + vec2(0.0, picture.y), vec2(cell.x, footer)),
        }
    };
    (0..shown).map(place).collect()
}
