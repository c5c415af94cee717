//! The vertices of the picked triangle, or of its whole object, in every space from the mesh to the pixel grid. One
//! vertex can be followed, which marks it in the picture.

use super::Session;
use crate::inspect::vertices::{ObjectVertices, VertexStages, corners_of};
use crate::scene::TriangleId;
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::WindowTask;

/// Settings of the vertex table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct VertexTable {
    /// Whether the table lists all vertices of the picked triangle's object, rather than only the corners of the
    /// triangle.
    pub(crate) whole_object: bool,
    /// Vertex that is marked in the picture: index of its object, and its index in the mesh.
    pub(crate) selected: Option<(usize, u32)>,
}

/// Change to the vertex table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum VerticesChange {
    /// Sets whether the table lists all vertices of the object (`true`) or only the corners of the triangle.
    WholeObject(bool),
    /// Marks a vertex in the picture, given by object and vertex index; `None` removes the mark.
    Select(Option<(usize, u32)>),
}

impl VertexTable {
    /// Applies a change to the table.
    pub(crate) fn apply(&mut self, change: VerticesChange) {
        match change {
            VerticesChange::WholeObject(whole) => self.whole_object = whole,
            VerticesChange::Select(selected) => self.selected = selected,
        }
    }
}

impl Feature for VertexTable {
    type Change = VerticesChange;

    fn apply(session: &mut Session, change: VerticesChange) -> Option<WindowTask> {
        session.features.vertices.apply(change);
        None
    }

    fn leave_scene(&mut self) {
        self.selected = None;
    }
}

/// Returns the triangle selected in the mesh view, or otherwise the one visible at the picked pixel.
pub(crate) fn picked_triangle(session: &Session) -> Option<TriangleId> {
    if let Some(selected) = session.features.mesh_view.selected(session.pick) {
        return Some(selected);
    }
    Some(session.view.as_ref()?.report.as_ref()?.visible()?.triangle)
}

/// Returns the index of the picked triangle's object.
pub(crate) fn picked_object(session: &Session) -> Option<u32> {
    let (_, instance, _) = picked(session)?;
    u32::try_from(instance).ok()
}

/// Returns the vertices of an object in the frame on screen.
pub(in crate::ui) fn object(session: &Session, instance: usize) -> Option<ObjectVertices<'_>> {
    let view = session.view.as_ref()?;
    let request = &view.request;
    ObjectVertices::new(&request.scene, &request.camera, &request.recipe.pipeline, view.frame.viewport, instance)
}

/// Returns the followed vertex at every stage of the pipeline, for the frame on screen.
pub(crate) fn followed(session: &Session) -> Option<VertexStages> {
    let (instance, index) = session.features.vertices.selected?;
    object(session, instance)?.stages(index)
}

/// Returns the picked triangle, the index of its object, and the vertex indices of its corners.
pub(in crate::ui) fn picked(session: &Session) -> Option<(TriangleId, usize, [u32; 3])> {
    let triangle = picked_triangle(session)?;
    let (instance, corners) = corners_of(&session.view.as_ref()?.request.scene, triangle)?;
    Some((triangle, instance, corners))
}
