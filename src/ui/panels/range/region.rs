//! Selection of a region of the picture by dragging on the canvas.

use eframe::egui::{CursorIcon, Painter, PointerButton, Pos2, Rect, Stroke, StrokeKind, Ui};

use crate::measure::region::PixelRegion;
use crate::ui::session::command::Command;
use crate::ui::session::range::RangeChange;
use crate::ui::session::{PointerMode, Session};
use crate::ui::theme::{MARK_EDGE, tokens};
use crate::ui::zoom::{PlacedPicture, Placement};

/// Region being dragged, given by the pixels at two opposite corners.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RegionDrag {
    corners: Option<[(u32, u32); 2]>,
}

impl RegionDrag {
    /// Handles the selection of a region with the pointer on a picture. Returns whether dragging currently selects a
    /// region.
    pub(crate) fn follow(
        &mut self,
        ui: &Ui,
        picture: PlacedPicture<'_>,
        session: &Session,
        commands: &mut Vec<Command>,
    ) -> bool {
        let PlacedPicture { response, placement, size_px: size, .. } = picture;
        // In camera mode, dragging with Shift pans the camera.
        let is_free = session.features.canvas.pointer_mode != PointerMode::Camera;
        let wanted = session.features.range.draws_region || is_free && ui.input(|i| i.modifiers.shift_only());
        if !wanted && self.corners.is_none() {
            return false;
        }
        if session.features.range.draws_region && response.hovered() {
            ui.set_cursor_icon(CursorIcon::Crosshair);
        }
        let pixel_at = |place: Option<Pos2>| place.and_then(|place| nearest(placement, place, size));
        let pixel = pixel_at(response.interact_pointer_pos());
        if response.drag_started_by(PointerButton::Primary) {
            // egui reports a drag only after some movement, so the start is the press position.
            let first = pixel_at(ui.input(|i| i.pointer.press_origin()));
            self.corners = first.zip(pixel).map(|(first, end)| [first, end]);
        } else if let (true, Some([_, end]), Some(pixel)) =
            (response.dragged_by(PointerButton::Primary), &mut self.corners, pixel)
        {
            *end = pixel;
        }
        if response.drag_stopped()
            && let Some(corners) = self.corners.take()
        {
            commands.push(Command::Range(RangeChange::Region(Some(between(corners)))));
            return true;
        }
        wanted || self.corners.is_some()
    }

    /// Draws the outline of the region being dragged, or otherwise of the selected region.
    pub(crate) fn paint(&self, ui: &Ui, painter: &Painter, placement: Placement, session: &Session) {
        let Some(region) = self.corners.map(between).or(session.features.range.region) else { return };
        let (first, last) =
            (placement.rect_of(region.left, region.top), placement.rect_of(region.right, region.bottom));
        let rect = Rect::from_min_max(first.min, last.min);
        painter.rect_stroke(rect, 0.0, Stroke::new(3.0, MARK_EDGE), StrokeKind::Middle);
        painter.rect_stroke(rect, 0.0, Stroke::new(1.0, tokens(ui).accent), StrokeKind::Middle);
    }
}

/// Returns the pixel nearest to a position in the window; `None` for an empty picture.
fn nearest(placement: Placement, pointer: Pos2, (width, height): (u32, u32)) -> Option<(u32, u32)> {
    let place = placement.to_picture(pointer);
    let clamp = |at: f32, size: u32| Some((at.max(0.0) as u32).min(size.checked_sub(1)?));
    Some((clamp(place.x, width)?, clamp(place.y, height)?))
}

/// Returns the smallest region that contains both pixels.
fn between([a, b]: [(u32, u32); 2]) -> PixelRegion {
    PixelRegion { left: a.0.min(b.0), top: a.1.min(b.1), right: a.0.max(b.0) + 1, bottom: a.1.max(b.1) + 1 }
}

/// Returns the part of the picture that is visible on the canvas.
pub(crate) fn visible(placement: Placement, size: (u32, u32)) -> Option<PixelRegion> {
    let (columns, rows) = placement.visible(size);
    let region = PixelRegion { left: columns.start, top: rows.start, right: columns.end, bottom: rows.end };
    (!columns.is_empty() && !rows.is_empty()).then_some(region)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_contains_both_corners_in_either_order() {
        let region = PixelRegion { left: 2, top: 3, right: 6, bottom: 10 };
        assert_eq!(between([(2, 9), (5, 3)]), region);
        assert_eq!(between([(5, 3), (2, 9)]), region);
        assert_eq!(between([(7, 7); 2]), PixelRegion { left: 7, top: 7, right: 8, bottom: 8 });
    }
}
