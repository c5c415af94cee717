//! Vector lines and marks over enlarged pixels: overlay lines, sample points, and triangle edges, coloured by whether
//! samples exactly on the edge belong to the triangle.

use std::sync::{Arc, Weak};

use eframe::egui::{Color32, Id, Painter, Pos2, Stroke, pos2, vec2};

use crate::chain::{Frame, Recipe};
use crate::inspect::overlays::{EdgeMarks, edge_marks};
use crate::ui::engine::RenderedView;
use crate::ui::session::Session;
use crate::ui::theme::MARK_EDGE;
use crate::ui::zoom::Placement;
use crate::upscale::Sampling;

/// Minimum size of a pixel, in points, for lines to be drawn as vectors.
pub(crate) const VECTORS_FROM: f32 = 4.0;

/// Minimum size of a pixel, in points, for sample points and edge ticks to be drawn.
const MARKS_FROM: f32 = 12.0;

/// Maximum number of lines and edges drawn; more would be illegible.
const MAX_LINES: usize = 20_000;

/// Colour of an edge whose triangle owns the samples exactly on the edge.
const OWNED: Color32 = Color32::from_rgb(80, 220, 130);

/// Colour of an edge whose triangle does not own the samples exactly on the edge.
const NOT_OWNED: Color32 = Color32::from_rgb(240, 110, 110);

/// Draws the vector lines and marks of all active overlays.
pub(crate) fn paint(painter: &Painter, placement: Placement, session: &Session, view: &RenderedView) {
    if placement.points_per_px < VECTORS_FROM {
        return;
    }
    let at = |[x, y]: [f32; 2]| placement.corner + vec2(x, y) * placement.points_per_px;
    for sheet in &view.look_result.sheets {
        let opacity = session.features.overlays.layer(sheet.overlay).map_or(1.0, |layer| layer.opacity);
        let color = sheet.line_color().map_or(Color32::WHITE, |[r, g, b, _]| Color32::from_rgb(r, g, b));
        let lines = sheet.lines.iter().map(|ends| ends.map(at)).filter(|[a, b]| meets(placement, *a, *b));
        for ends in lines.take(MAX_LINES) {
            two_tone(painter, ends, color, opacity);
        }
    }
    if session.features.overlays.marks && placement.points_per_px >= MARKS_FROM {
        for edge in marks(painter, placement, view).iter() {
            owner(painter, edge, at);
        }
        samples(painter, placement, view);
    }
}

/// Whether the bounding box of the line from `a` to `b`, both in points, overlaps the canvas.
fn meets(placement: Placement, a: Pos2, b: Pos2) -> bool {
    placement.canvas.intersects(eframe::egui::Rect::from_two_pos(a, b).expand(1.0))
}

/// Draws a line with a dark outline, visible on any background.
fn two_tone(painter: &Painter, ends: [Pos2; 2], color: Color32, opacity: f32) {
    painter.line_segment(ends, Stroke::new(2.5, MARK_EDGE.gamma_multiply(opacity)));
    painter.line_segment(ends, Stroke::new(1.0, color.gamma_multiply(opacity)));
}

/// Cache of the edges in the visible part of a frame. Finding these edges takes a pass over all triangles.
#[derive(Clone)]
struct EdgeCache {
    /// Frame to which the edges belong. The weak reference allows the buffers of a frame to be reused when it is no
    /// longer shown.
    frame: Weak<Frame>,
    recipe: Recipe,
    /// Left, top, right and bottom edges of the visible part of the picture, in picture pixels.
    seen_px: [f32; 4],
    edges: Arc<Vec<EdgeMarks>>,
}

/// Returns the edges in the visible part of the picture. They are taken from the cache if frame, recipe and visible
/// part are unchanged.
fn marks(painter: &Painter, placement: Placement, view: &RenderedView) -> Arc<Vec<EdgeMarks>> {
    let (min, max) = (placement.to_picture(placement.canvas.min), placement.to_picture(placement.canvas.max));
    let (seen_px, recipe) = ([min.x, min.y, max.x, max.y], view.request.recipe);
    let id = Id::unique("marked edges");
    let is_same = |known: &EdgeCache| {
        std::ptr::eq(known.frame.as_ptr(), Arc::as_ptr(&view.frame))
            && (known.recipe, known.seen_px) == (recipe, seen_px)
    };
    let known: Option<EdgeCache> = painter.ctx().data(|data| data.get_temp(id));
    if let Some(known) = known.filter(is_same) {
        return known.edges;
    }
    let edges = Arc::new(edge_marks(&view.frame, &recipe, seen_px, MAX_LINES));
    let known = EdgeCache { frame: Arc::downgrade(&view.frame), recipe, seen_px, edges: edges.clone() };
    painter.ctx().data_mut(|data| data.insert_temp(id, known));
    edges
}

/// Draws a triangle edge. If its triangle owns the samples exactly on the edge, the edge is green with ticks into the
/// triangle, otherwise red.
fn owner(painter: &Painter, edge: &EdgeMarks, at: impl Fn([f32; 2]) -> Pos2) {
    /// Spacing and length of ticks, in points.
    const TICKS: (f32, f32) = (14.0, 6.0);
    let [from, to] = edge.ends_px.map(at);
    // Offset inwards, so that the edges of two adjacent triangles are both visible.
    let inward = vec2(edge.inward[0], edge.inward[1]);
    let ends = [from + inward * 1.5, to + inward * 1.5];
    let color = if edge.owned { OWNED } else { NOT_OWNED };
    two_tone(painter, ends, color, 1.0);
    if !edge.owned {
        return;
    }
    let clip = painter.clip_rect().expand(TICKS.0);
    let length = (to - from).length();
    let along = (to - from) / length.max(1.0);
    for step in 1..(length / TICKS.0).min(2000.0) as u32 {
        let foot = ends[0] + along * (step as f32 * TICKS.0);
        if clip.contains(foot) {
            painter.line_segment([foot, foot + inward * TICKS.1], Stroke::new(1.5, color));
        }
    }
}

/// Draws a point at the centre of each pixel that was rendered, not reconstructed by the upscaler.
fn samples(painter: &Painter, placement: Placement, view: &RenderedView) {
    let Sampling::Grid(grid) = view.frame.sampling else { return };
    let (columns, rows) = placement.visible(view.picture.size());
    for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x, y))) {
        if grid.sample_at(x, y).is_some() {
            let place = placement.rect_of(x, y).center();
            painter.circle_filled(pos2(place.x, place.y), 2.5, MARK_EDGE);
            painter.circle_filled(pos2(place.x, place.y), 1.5, Color32::WHITE);
        }
    }
}
