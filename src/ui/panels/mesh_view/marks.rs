//! Drawing of marks over the mesh view, such as the outlines of clipped and culled triangles, the view frustum, and the
//! ray through the picked pixel.

use eframe::egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, Ui, pos2, vec2};

use crate::inspect::mesh_view::{MarkKind, MeshMark};
use crate::ui::format;
use crate::ui::theme::{MARK_EDGE, ON_PIXEL, font_size, tokens};

/// Maximum number of vertices created by clipping for which labels are drawn. A label shows the position t of a vertex
/// along the edge of the triangle. With more vertices, labels would overlap, so none are drawn.
const MAX_NUMBERS: usize = 16;

/// Dash length and gap length of dashed lines, in points.
const DASH: (f32, f32) = (5.0, 4.0);

/// Colour of clipping marks (outlines, removed parts and new vertices): orange, as in the pictures of the pipeline
/// stages.
const CUT: Color32 = Color32::from_rgb(240, 160, 48);

/// Colour of the outlines of culled triangles: red, as in the pictures of the pipeline stages.
const CULLED: Color32 = Color32::from_rgb(232, 96, 96);

/// Draws all marks. `rect.min` is the top-left corner of the picture, and `points_per_px` is the size of a picture
/// pixel in points.
pub(super) fn draw(ui: &Ui, painter: &Painter, rect: Rect, points_per_px: f32, marks: &[MeshMark]) {
    let new = marks.iter().filter(|mark| matches!(mark.kind, MarkKind::NewVertex(_))).count();
    for mark in marks {
        let points: Vec<Pos2> = mark.points.iter().map(|[x, y]| rect.min + vec2(*x, *y) * points_per_px).collect();
        match points[..] {
            [at] => dot(ui, painter, mark.kind, at, new <= MAX_NUMBERS),
            [from, to] => line(ui, painter, mark.kind, rect, [from, to]),
            _ => polygon(ui, painter, mark.kind, rect, points),
        }
    }
}

fn dot(ui: &Ui, painter: &Painter, kind: MarkKind, at: Pos2, with_numbers: bool) {
    let accent = tokens(ui).accent;
    let (color, radius, text) = match kind {
        MarkKind::Eye => (accent, 5.0, Some("eye".to_owned())),
        MarkKind::NewVertex(t) => {
            (CUT, 3.0, t.filter(|_| with_numbers).map(|t| format!("t {}", format::fixed(t.into(), 3))))
        }
        MarkKind::Vertex => (accent, 4.0, Some("vertex".to_owned())),
        _ => (tokens(ui).warning, 3.5, None),
    };
    painter.circle_filled(at, radius + 1.5, MARK_EDGE);
    painter.circle_filled(at, radius, color);
    let Some(text) = text else { return };
    let galley = painter.layout_no_wrap(text, FontId::monospace(font_size::SMALL), ON_PIXEL[0]);
    // Above the dot, because rays lead from it to the side.
    let place = Align2::CENTER_BOTTOM.anchor_size(pos2(at.x, at.y - radius - 5.0), galley.size());
    painter.rect_filled(place.expand(2.0), 2.0, MARK_EDGE);
    painter.galley(place.min, galley, ON_PIXEL[0]);
}

fn line(ui: &Ui, painter: &Painter, kind: MarkKind, rect: Rect, ends: [Pos2; 2]) {
    // Clipped first: the ends may lie far outside, and each dash out there would add an invisible shape.
    let Some(ends) = clipped(rect.expand(2.0), ends) else { return };
    let warning = tokens(ui).warning;
    match kind {
        MarkKind::Ray => {
            painter.line_segment(ends, Stroke::new(3.5, tokens(ui).canvas));
            painter.line_segment(ends, Stroke::new(1.5, warning));
        }
        MarkKind::RayBehind => dashed(painter, ends, Stroke::new(1.0, warning.gamma_multiply(0.7))),
        MarkKind::CutAway => {
            painter.line_segment(ends, Stroke::new(1.0, CUT.gamma_multiply(0.55)));
        }
        MarkKind::Culled => dashed(painter, ends, Stroke::new(1.0, CULLED)),
        _ => {
            // The wider line in the background colour keeps the line visible over triangles.
            painter.line_segment(ends, Stroke::new(2.5, tokens(ui).canvas.gamma_multiply(0.6)));
            painter.line_segment(ends, Stroke::new(1.0, tokens(ui).text_strong));
        }
    }
}

fn dashed(painter: &Painter, ends: [Pos2; 2], stroke: Stroke) {
    painter.extend(Shape::dashed_line(&ends, stroke, DASH.0, DASH.1));
}

fn polygon(ui: &Ui, painter: &Painter, kind: MarkKind, rect: Rect, points: Vec<Pos2>) {
    let accent = tokens(ui).accent;
    if kind == MarkKind::Culled {
        for (place, from) in points.iter().enumerate() {
            line(ui, painter, kind, rect, [*from, points[(place + 1) % points.len()]]);
        }
        return;
    }
    let (fill, stroke) = match kind {
        MarkKind::NearPlane => (accent.gamma_multiply(0.18), Stroke::new(1.0, accent)),
        MarkKind::Selected => (accent.gamma_multiply(0.3), Stroke::new(2.0, accent)),
        _ => (Color32::TRANSPARENT, Stroke::new(1.5, CUT)),
    };
    painter.add(Shape::convex_polygon(points, fill, stroke));
}

/// Clips a line segment to a rectangle (Liang and Barsky, "A New Concept and Method for Line Clipping", 1984). Returns
/// `None` if the segment lies outside.
fn clipped(rect: Rect, [from, to]: [Pos2; 2]) -> Option<[Pos2; 2]> {
    let along = to - from;
    let (mut first, mut last) = (0.0_f32, 1.0_f32);
    let sides = [
        (-along.x, from.x - rect.left()),
        (along.x, rect.right() - from.x),
        (-along.y, from.y - rect.top()),
        (along.y, rect.bottom() - from.y),
    ];
    for (towards, room) in sides {
        if towards == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if towards < 0.0 {
            first = first.max(room / towards);
        } else {
            last = last.min(room / towards);
        }
    }
    (first <= last).then(|| [from + along * first, from + along * last])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_clipped_to_the_rectangle() {
        let rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(10.0, 10.0));
        let cut = |from: (f32, f32), to: (f32, f32)| clipped(rect, [from.into(), to.into()]);
        assert_eq!(cut((2.0, 2.0), (3.0, 4.0)), Some([pos2(2.0, 2.0), pos2(3.0, 4.0)]));
        assert_eq!(cut((-10.0, 5.0), (30.0, 5.0)), Some([pos2(0.0, 5.0), pos2(10.0, 5.0)]));
        assert_eq!(cut((-10.0, -1.0), (30.0, -1.0)), None);
        assert_eq!(cut((-1.0, 5.0), (5.0, 20.0)), Some([pos2(0.0, 7.5), pos2(1.0, 10.0)]));
        assert_eq!(cut((-1.0, 9.0), (5.0, 40.0)), None);
    }
}
