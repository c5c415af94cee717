//! The mesh view: the scene as seen from a second camera, shown beside the picture, and the triangle selected in it.

use super::Session;
use crate::chain::Frame;
use crate::inspect::capture;
use crate::inspect::mesh_view::{Inner, MeshNormals, MeshStyle, fit, shown_at};
use crate::scene::{Camera, TriangleId};
use crate::ui::engine::RenderedView;
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::WindowTask;

use crate::ui::session::workspace::Workspace;
/// Settings of the mesh view, which shows the scene from a second camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MeshView {
    /// Whether the mesh view is visible.
    pub(crate) open: bool,
    /// Drawing style of the triangles.
    pub(crate) style: MeshStyle,
    /// Displacement of triangles away from the centre of their mesh, as a multiple of their distance from that centre.
    pub(crate) explode: f32,
    /// Whether culled triangles are outlined.
    pub(crate) culled: bool,
    /// Normals that are drawn as lines, and their length.
    pub(crate) normals: MeshNormals,
    /// Camera of the mesh view; `None` until its initial pose is computed.
    pub(crate) camera: Option<Camera>,
    /// Triangle selected in the mesh view, and the pixel picked with it. Picking another pixel ends the selection.
    pub(crate) selected: Option<(TriangleId, Option<(u32, u32)>)>,
}

impl Default for MeshView {
    fn default() -> Self {
        Self {
            open: false,
            style: MeshStyle::Fate,
            explode: 0.0,
            culled: true,
            normals: MeshNormals::default(),
            camera: None,
            selected: None,
        }
    }
}

impl MeshView {
    /// Returns the triangle selected in the mesh view; `None` if `pick` is no longer the pixel that was picked with it.
    pub(crate) fn selected(&self, pick: Option<(u32, u32)>) -> Option<TriangleId> {
        self.selected.filter(|(_, with)| *with == pick).map(|(triangle, _)| triangle)
    }
}

/// Change to the mesh view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum MeshViewChange {
    /// Shows or hides the mesh view.
    Toggle,
    /// Sets the drawing style of the triangles.
    Style(MeshStyle),
    /// Sets the displacement of triangles away from the centre of their mesh, as a multiple of their distance from that
    /// centre.
    Explode(f32),
    /// Sets whether culled triangles are outlined.
    Culled(bool),
    /// Sets which normals are drawn, and their length.
    Normals(MeshNormals),
    /// Sets the camera of the mesh view.
    Look(Camera),
    /// Moves the camera of the mesh view until everything is visible, keeping its direction. The value is the aspect
    /// ratio of the view, width over height.
    Fit(f32),
    /// Resets the camera of the mesh view to its initial pose, beside the render camera.
    Reset,
    /// Selects a triangle, and picks a pixel that shows it if there is one.
    Select(TriangleId),
}

impl Feature for MeshView {
    type Change = MeshViewChange;

    fn apply(session: &mut Session, change: MeshViewChange) -> Option<WindowTask> {
        let mesh = &mut session.features.mesh_view;
        match change {
            MeshViewChange::Toggle => {
                let is_shown = session.workspace() == Workspace::Geometry;
                session.show_workspace(if is_shown { session.features.workspaces.base } else { Workspace::Geometry });
            }
            MeshViewChange::Style(style) => mesh.style = style,
            MeshViewChange::Explode(apart) => mesh.explode = apart,
            MeshViewChange::Culled(culled) => mesh.culled = culled,
            MeshViewChange::Normals(normals) => mesh.normals = normals,
            MeshViewChange::Look(camera) => mesh.camera = Some(camera),
            MeshViewChange::Reset => mesh.camera = None,
            MeshViewChange::Fit(aspect) => {
                if let Some(view) = &session.view {
                    mesh.camera = mesh.camera.map(|camera| fit(camera, &view.request.scene, &inner(view), aspect));
                }
            }
            MeshViewChange::Select(triangle) => {
                if let Some(view) = &session.view {
                    session.pick = pixel_of(view, triangle).or(session.pick);
                    session.features.mesh_view.selected = Some((triangle, session.pick));
                }
            }
        }
        None
    }

    fn leave_scene(&mut self) {
        (self.camera, self.selected) = (None, None);
    }
}

/// Returns the column and row of a pixel that shows the triangle in the frame on screen; `None` if there is none.
/// Pixels filled in by the upscaler do not count.
fn pixel_of(view: &RenderedView, triangle: TriangleId) -> Option<(u32, u32)> {
    let frame: &Frame = &view.frame;
    let at = match &view.buffers {
        Some(buffers) => shown_at(&buffers.triangle, triangle),
        None => shown_at(&capture(&view.request.scene, &view.request.recipe, frame).triangle, triangle),
    };
    let (column, row) = at?;
    let (x, y) = frame.drawn.grid.pixel(column, row);
    frame.is_drawn(x, y).then_some((x, y))
}

/// Returns the render camera, its pipeline settings and its viewport.
pub(in crate::ui) fn inner(view: &RenderedView) -> Inner {
    Inner { camera: view.request.camera, settings: view.request.recipe.pipeline, viewport: view.frame.viewport }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::Recipe;
    use crate::scene::SceneSource;
    use crate::ui::engine::Engine;
    use crate::ui::session::vertices;

    #[test]
    fn a_selected_triangle_picks_a_pixel_that_shows_it_and_another_pick_ends_it() {
        let source = SceneSource::named("cubes".into());
        let scene = Arc::new(source.load().unwrap().scene);
        let (home, count) = (scene.home, scene.triangle_count() as u32);
        let mut session = Session::new(scene, source, Recipe::default(), home);
        session.features.canvas.size_px = (96, 64);
        let mut engine = Engine::default();
        let (mut shown, mut hidden) = (0, 0);
        for id in (0..count).step_by(61).map(TriangleId) {
            session.pick = None;
            session.view = Some(engine.answer(session.request()));
            MeshView::apply(&mut session, MeshViewChange::Select(id));
            assert_eq!(vertices::picked_triangle(&session), Some(id));
            session.view = Some(engine.answer(session.request()));
            let visible = session.view.as_ref().unwrap().report.as_ref().and_then(|r| Some(r.visible()?.triangle));
            assert_eq!(visible, session.pick.map(|_| id));
            *(if session.pick.is_some() { &mut shown } else { &mut hidden }) += 1;
            assert_eq!(session.features.mesh_view.selected(session.pick), Some(id));
            session.pick = Some((0, 0));
            assert_eq!(session.features.mesh_view.selected(session.pick), None);
        }
        assert!(shown > 0 && hidden > 0, "{shown} shown, {hidden} hidden");
    }
}
