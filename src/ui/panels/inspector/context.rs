//! Enlarged neighbourhood of the picked pixel, in the colours shown on the canvas.

use eframe::egui::{self, Pos2, Rect, Role, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, vec2};

use super::{one_line, to_color};
use crate::ui::engine::RenderedView;
use crate::ui::session::command::Command;
use crate::ui::theme::{self, tokens};

/// Number of pixels shown on each side of the picked pixel.
const REACH: i64 = 7;

/// Side length of an enlarged pixel, in points.
const CELL: f32 = 8.0;

/// Width and height of the widget, in points.
pub(super) const SIDE: f32 = 132.0;

/// Draws the neighbourhood of the picked pixel; a click picks one of its pixels.
pub(super) fn ui(ui: &mut Ui, view: &RenderedView, picked: (u32, u32), commands: &mut Vec<Command>) {
    let (frame, response) = ui.allocate_exact_size(Vec2::splat(SIDE), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Neighbourhood of the picked pixel"));
    ui.painter().rect_filled(frame, theme::RADIUS, tokens(ui).canvas);
    for (right, down) in (-REACH..=REACH).flat_map(|down| (-REACH..=REACH).map(move |right| (right, down))) {
        if let Some(color) = beside(picked, right, down).and_then(|(x, y)| view.picture.get(x, y)) {
            ui.painter().rect_filled(cell(frame, right, down), 0.0, to_color(color));
        }
    }
    let middle = cell(frame, 0, 0);
    ui.painter().rect_stroke(middle, 0.0, Stroke::new(2.0, egui::Color32::BLACK), StrokeKind::Outside);
    ui.painter().rect_stroke(middle, 0.0, Stroke::new(1.5, tokens(ui).accent), StrokeKind::Outside);
    let what = "The picked pixel and seven pixels on each side; click to pick another one";
    let there = response.hover_pos().and_then(|at| pixel_at(frame, at, picked));
    let Some((x, y)) = there.filter(|(x, y)| view.picture.get(*x, *y).is_some()) else {
        response.on_hover_text(what);
        return;
    };
    if response.clicked() {
        commands.push(Command::Pick(Some((x, y))));
    }
    response.on_hover_text(format!("{x}, {y}: {}\n{what}", one_line(view.value(x, y))));
}

/// Returns the screen rectangle, in points, of the pixel that lies `right` columns and `down` rows from the picked
/// pixel.
fn cell(frame: Rect, right: i64, down: i64) -> Rect {
    Rect::from_center_size(frame.center() + vec2(right as f32, down as f32) * CELL, Vec2::splat(CELL))
}

/// Returns the pixel that the widget shows at the screen position `at`; `None` if it shows no pixel there.
fn pixel_at(frame: Rect, at: Pos2, picked: (u32, u32)) -> Option<(u32, u32)> {
    let from_middle = ((at - frame.center()) / CELL).round();
    let (right, down) = (from_middle.x as i64, from_middle.y as i64);
    (right.abs() <= REACH && down.abs() <= REACH).then(|| beside(picked, right, down)).flatten()
}

/// Returns the pixel `right` columns and `down` rows from (x, y); `None` if a coordinate is negative or overflows.
fn beside((x, y): (u32, u32), right: i64, down: i64) -> Option<(u32, u32)> {
    Some((u32::try_from(i64::from(x) + right).ok()?, u32::try_from(i64::from(y) + down).ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_position_maps_to_the_pixel_drawn_there() {
        let frame = Rect::from_min_size(Pos2::new(10.0, 20.0), Vec2::splat(SIDE));
        for (right, down) in [(0, 0), (-7, 7), (3, -5)] {
            let at = cell(frame, right, down).center() + vec2(3.0, -3.0);
            assert_eq!(pixel_at(frame, at, (50, 60)), beside((50, 60), right, down));
        }
        assert_eq!(pixel_at(frame, cell(frame, -1, 0).center(), (0, 4)), None, "there is no pixel left of column 0");
        assert_eq!(pixel_at(frame, frame.min + vec2(1.0, 1.0), (50, 60)), None, "the border shows no pixel");
    }
}
