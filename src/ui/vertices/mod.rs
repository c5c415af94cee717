//! The vertices of the picked triangle, or of its whole object, at every stage; one of them can be followed in the picture.

mod panel;

use eframe::egui::{Align2, FontId, Painter, Pos2, Stroke, Ui, pos2, vec2};

use super::session::Session;
use super::theme::{MARK_EDGE, ON_PIXEL, font_size, tokens};
use super::zoom::Placement;
use crate::inspect::vertices::{ObjectVertices, VertexStages, corners_of};
use crate::scene::TriangleId;

pub use panel::{controls, ui};

/// What of the vertices is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Vertices {
    /// All vertices of the object, rather than those of the triangle.
    pub whole_object: bool,
    /// Number of the object and of the vertex in its mesh.
    pub selected: Option<(usize, u32)>,
}

/// A change of that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Show the whole object, or the triangle alone.
    WholeObject(bool),
    /// Follow this vertex of this object, or none.
    Select(Option<(usize, u32)>),
}

impl Vertices {
    /// Makes a change.
    pub fn apply(&mut self, change: Change) {
        match change {
            Change::WholeObject(whole) => self.whole_object = whole,
            Change::Select(selected) => self.selected = selected,
        }
    }
}

/// The triangle that was selected from outside, or else the one that the picked pixel shows.
pub fn picked_triangle(session: &Session) -> Option<TriangleId> {
    if let Some(selected) = session.mesh_view.selected(session.pick) {
        return Some(selected);
    }
    Some(session.view.as_ref()?.report.as_ref()?.visible()?.triangle)
}

/// The number of the object that the picked triangle belongs to.
pub fn picked_object(session: &Session) -> Option<u32> {
    let (_, instance, _) = picked(session)?;
    u32::try_from(instance).ok()
}

/// The vertices of an object as the frame on screen has them.
fn object(session: &Session, instance: usize) -> Option<ObjectVertices<'_>> {
    let view = session.view.as_ref()?;
    let request = &view.request;
    ObjectVertices::new(&request.scene, &request.camera, &request.recipe.pipeline, view.frame.viewport, instance)
}

/// The vertex that is followed, as the frame on screen has it.
pub fn followed(session: &Session) -> Option<VertexStages> {
    let (instance, index) = session.vertices.selected?;
    object(session, instance)?.stages(index)
}

/// The object of the picked triangle and the triangle's corners.
fn picked(session: &Session) -> Option<(TriangleId, usize, [u32; 3])> {
    let triangle = picked_triangle(session)?;
    let (instance, corners) = corners_of(&session.view.as_ref()?.request.scene, triangle)?;
    Some((triangle, instance, corners))
}

/// Marks the followed vertex on the picture.
pub fn mark(ui: &Ui, painter: &Painter, placement: Placement, session: &Session) {
    let Some(vertex) = followed(session) else { return };
    let Some(screen) = vertex.screen else { return };
    let [x, y] = screen.px;
    let at = placement.corner + vec2(x, y) * placement.points_per_px;
    if placement.canvas.expand(RING_POINTS).contains(at) {
        ring(ui, painter, at, vertex.index);
    }
}

/// Radius of the mark, in points.
const RING_POINTS: f32 = 5.0;

/// A ring with the number of a vertex, seen on any ground.
pub fn ring(ui: &Ui, painter: &Painter, at: Pos2, index: u32) {
    let accent = tokens(ui).accent;
    painter.circle_stroke(at, RING_POINTS, Stroke::new(4.0, MARK_EDGE));
    painter.circle_stroke(at, RING_POINTS, Stroke::new(2.0, accent));
    let galley = painter.layout_no_wrap(format!("v{index}"), FontId::monospace(font_size::SMALL), ON_PIXEL[0]);
    let place = Align2::LEFT_BOTTOM.anchor_size(pos2(at.x + RING_POINTS + 3.0, at.y - RING_POINTS), galley.size());
    painter.rect_filled(place.expand(2.0), 2.0, MARK_EDGE);
    painter.galley(place.min, galley, ON_PIXEL[0]);
}
