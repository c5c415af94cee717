//! The scene from outside, beside the picture: a second camera, and what is selected in it.

mod marks;

mod pane;

mod picture;

use super::session::Session;
use crate::chain::Frame;
use crate::inspect::capture;
use crate::inspect::mesh_view::{Inner, Look, MeshNormals, MeshStyle, fit, shown_at};
use crate::scene::{Camera, TriangleId};
use crate::ui::engine::View;
use crate::ui::vertices;

pub use pane::MeshPane;

/// How the scene is seen from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshView {
    /// Whether it is shown.
    pub open: bool,
    /// How triangles are drawn.
    pub style: MeshStyle,
    /// How far triangles are moved apart, in distances from the middle of their mesh.
    pub apart: f32,
    /// Whether culled triangles are outlined.
    pub culled: bool,
    /// Kinds of normals that are drawn as lines.
    pub normals: MeshNormals,
    /// Where from; to be found if none.
    pub camera: Option<Camera>,
    /// A triangle that was selected here, and the pixel that was picked with it: another pick ends it.
    pub selected: Option<(TriangleId, Option<(u32, u32)>)>,
}

impl Default for MeshView {
    fn default() -> Self {
        Self {
            open: false,
            style: MeshStyle::Fate,
            apart: 0.0,
            culled: true,
            normals: MeshNormals::default(),
            camera: None,
            selected: None,
        }
    }
}

impl MeshView {
    /// The triangle that was selected from outside, unless another pixel than `pick` was picked with it.
    pub fn selected(&self, pick: Option<(u32, u32)>) -> Option<TriangleId> {
        self.selected.filter(|(_, with)| *with == pick).map(|(triangle, _)| triangle)
    }

    /// Forgets what belongs to a scene.
    pub fn leave_scene(&mut self) {
        (self.camera, self.selected) = (None, None);
    }
}

/// A change of that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// Show it, or the picture alone.
    Toggle,
    /// Draw triangles like this.
    Style(MeshStyle),
    /// Move triangles apart.
    Apart(f32),
    /// Outline culled triangles, or don't.
    Culled(bool),
    /// Draw these normals.
    Normals(MeshNormals),
    /// Look from here.
    Look(Camera),
    /// Look from where all is seen, in the same direction; width over height of the picture from outside.
    Fit(f32),
    /// Look from beside the render camera again.
    Reset,
    /// Select a triangle, and pick a pixel that shows it if any does.
    Select(TriangleId),
}

/// Makes a change.
pub fn apply(session: &mut Session, change: Change) {
    let mesh = &mut session.mesh_view;
    match change {
        Change::Toggle => mesh.open ^= true,
        Change::Style(style) => mesh.style = style,
        Change::Apart(apart) => mesh.apart = apart,
        Change::Culled(culled) => mesh.culled = culled,
        Change::Normals(normals) => mesh.normals = normals,
        Change::Look(camera) => mesh.camera = Some(camera),
        Change::Reset => mesh.camera = None,
        Change::Fit(aspect) => {
            if let Some(view) = &session.view {
                mesh.camera = mesh.camera.map(|camera| fit(camera, &view.request.scene, &inner(view), aspect));
            }
        }
        Change::Select(triangle) => {
            if let Some(view) = &session.view {
                session.pick = pixel_of(view, triangle).or(session.pick);
                session.mesh_view.selected = Some((triangle, session.pick));
            }
        }
    }
}

/// A pixel of the frame on screen that shows a triangle.
fn pixel_of(view: &View, triangle: TriangleId) -> Option<(u32, u32)> {
    let frame: &Frame = &view.frame;
    let at = match &view.buffers {
        Some(buffers) => shown_at(&buffers.triangle, triangle),
        None => shown_at(&capture(&view.request.scene, &view.request.recipe, frame).triangle, triangle),
    };
    let (column, row) = at?;
    let (x, y) = frame.drawn.grid.pixel(column, row);
    frame.is_drawn(x, y).then_some((x, y))
}

/// What is looked at from outside.
fn inner(view: &View) -> Inner {
    Inner { camera: view.request.camera, settings: view.request.recipe.pipeline, viewport: view.frame.viewport }
}

/// What is marked.
fn look(session: &Session, view: &View) -> Look {
    let report = view.report.as_ref();
    let visible = report.and_then(|report| report.visible());
    Look {
        pixel: report.map(|report| (report.x, report.y)),
        hit_distance: visible.map(|fragment| view.frame.depth_scale().distance_of(fragment.depth.value)),
        selected: vertices::picked_triangle(session),
        vertex: vertices::followed(session).map(|vertex| vertex.world),
        culled: session.mesh_view.culled,
        apart: session.mesh_view.apart,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::Recipe;
    use crate::scene::SceneSource;
    use crate::ui::engine::Engine;

    #[test]
    fn a_selected_triangle_picks_a_pixel_that_shows_it_and_another_pick_ends_it() {
        let source = SceneSource::named("cubes".into());
        let scene = Arc::new(source.load().unwrap().scene);
        let (home, count) = (scene.home, scene.triangle_count() as u32);
        let mut session = Session::new(scene, source, Recipe::default(), home);
        session.canvas_px = (96, 64);
        let mut engine = Engine::default();
        let (mut shown, mut hidden) = (0, 0);
        for id in (0..count).step_by(61).map(TriangleId) {
            session.pick = None;
            session.view = Some(engine.answer(session.request()));
            apply(&mut session, Change::Select(id));
            assert_eq!(vertices::picked_triangle(&session), Some(id));
            session.view = Some(engine.answer(session.request()));
            let visible = session.view.as_ref().unwrap().report.as_ref().and_then(|r| Some(r.visible()?.triangle));
            assert_eq!(visible, session.pick.map(|_| id));
            *(if session.pick.is_some() { &mut shown } else { &mut hidden }) += 1;
            assert_eq!(session.mesh_view.selected(session.pick), Some(id));
            session.pick = Some((0, 0));
            assert_eq!(session.mesh_view.selected(session.pick), None);
        }
        assert!(shown > 0 && hidden > 0, "{shown} shown, {hidden} hidden");
    }
}
