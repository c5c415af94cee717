//! Outline of the triangle that was drawn last, and of its object, over a partially drawn picture.

use eframe::egui::{Painter, Pos2, Rect, Stroke, StrokeKind, Vec2, vec2};

use crate::ui::engine::RenderedView;
use crate::ui::theme::{MARK_EDGE, SIGNAL};
use crate::ui::zoom::Placement;

/// Opacity of the object's outline, in [0, 1].
const OBJECT_OPACITY: f32 = 0.55;

/// Maximum number of lines of an object's outline that are drawn.
const MAX_LINES: usize = 20_000;

/// Size below which a frame around the triangle makes it easier to find, in points.
const SMALL: f32 = 10.0;

/// Draws the outline of the last triangle and of its object if the view shows a partially drawn frame.
pub(crate) fn paint(painter: &Painter, placement: Placement, view: &RenderedView) {
    let last = view.timeline.as_ref().filter(|_| view.request.triangle_limit.is_some());
    let Some(last) = last.and_then(|timeline| timeline.last.as_ref()) else { return };
    let at = |[x, y]: [f32; 2]| placement.corner + vec2(x, y) * placement.points_per_px;
    let faint = SIGNAL.gamma_multiply(OBJECT_OPACITY);
    for ends in last.silhouette.iter().take(MAX_LINES) {
        painter.line_segment(ends.map(at), Stroke::new(1.0, faint));
    }
    let corners = last.corners_px.map(at);
    let bounds = Rect::from_points(&corners);
    let is_small = bounds.size().max_elem() < SMALL;
    let thickness = if is_small { 1.0 } else { 2.0 };
    for (width, color) in [(2.0 * thickness, MARK_EDGE), (thickness, SIGNAL)] {
        for ends in sides(corners) {
            painter.line_segment(ends, Stroke::new(width, color));
        }
    }
    if is_small {
        let frame = Rect::from_center_size(bounds.center(), Vec2::splat(2.0 * SMALL));
        for (width, color) in [(4.0, MARK_EDGE), (2.0, SIGNAL)] {
            painter.rect_stroke(frame, 2.0, Stroke::new(width, color), StrokeKind::Middle);
        }
    }
}

fn sides([a, b, c]: [Pos2; 3]) -> [[Pos2; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}
