//! The picked point: the place on a triangle that was picked. The picked pixel follows it through changes of the camera
//! and of the picture size.

use std::sync::Arc;

use glam::{DMat3, DMat4, DVec3, DVec4};

use super::Session;
use crate::inspect::vertices::corners_of;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, DepthMapping, Scene, TriangleId};
use crate::ui::engine::RenderedView;
use crate::ui::session::feature::Feature;
use crate::ui::session::first_pick::FirstPick;
use crate::ui::session::window_task::WindowTask;

/// Point on a triangle, and the pixel that shows its place in the current view.
#[derive(Clone, Debug)]
pub(crate) struct PickedPoint {
    scene: Arc<Scene>,
    /// Triangle that was visible at the picked pixel.
    pub(crate) triangle: TriangleId,
    /// Index of the instance of the triangle.
    pub(crate) instance: usize,
    corners: [u32; 3],
    /// Perspective-correct barycentric weights of the point. Their sum is 1.
    pub(crate) weights: [f64; 3],
    /// Column and row of the pixel with the point; `None` if the point lies outside the picture.
    pixel: Option<(u32, u32)>,
    camera: Camera,
    viewport: Viewport,
}

/// Picked point, and the state of the automatic first pick. The picked pixel itself is part of the session.
#[derive(Debug, Default)]
pub(crate) struct Picking {
    /// Point on the triangle at the picked pixel; `None` if the pixel shows no triangle or is not explained yet.
    pub(crate) point: Option<PickedPoint>,
    /// State of the automatic first pick.
    pub(crate) first: FirstPick,
}

impl Feature for Picking {
    /// Column and row of the pixel to pick; `None` clears the pick.
    type Change = Option<(u32, u32)>;

    fn apply(session: &mut Session, pixel: Self::Change) -> Option<WindowTask> {
        session.pick = pixel;
        None
    }

    fn leave_scene(&mut self) {
        self.first = FirstPick::Due;
    }
}

/// Visibility of the picked point in the frame on screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PointVisibility {
    /// The centre of the pixel shows the triangle of the point, or one with a common corner.
    Visible,
    /// The centre of the pixel shows another surface, or none.
    Hidden,
    /// The point lies outside the picture.
    Outside,
}

impl PickedPoint {
    /// Returns the point at the centre of the picked pixel; `None` if the pixel shows no triangle.
    fn of(view: &RenderedView) -> Option<Self> {
        let report = view.report.as_ref()?;
        let scene = Arc::clone(&view.request.scene);
        let triangle = report.visible()?.triangle;
        let (instance, corners) = corners_of(&scene, triangle)?;
        let (camera, viewport) = (view.request.camera, view.frame.viewport);
        let clip = clip_corners(&scene, &camera, viewport, instance, corners)?;
        let ndc_x = (f64::from(report.x) + 0.5) / f64::from(viewport.width) * 2.0 - 1.0;
        let ndc_y = 1.0 - (f64::from(report.y) + 0.5) / f64::from(viewport.height) * 2.0;
        // The weighted sum of the corners has x/w and y/w of the pixel's centre, and the weights have the sum 1.
        let rows = clip.map(|corner| DVec3::new(corner.x - ndc_x * corner.w, corner.y - ndc_y * corner.w, 1.0));
        let weights = DMat3::from_cols(rows[0], rows[1], rows[2]).inverse() * DVec3::Z;
        let pixel = Some((report.x, report.y));
        let weights = weights.is_finite().then(|| weights.to_array())?;
        Some(Self { scene, triangle, instance, corners, weights, pixel, camera, viewport })
    }

    /// Moves the pixel to the place of the point in another view.
    fn project(&mut self, camera: Camera, viewport: Viewport) {
        (self.camera, self.viewport) = (camera, viewport);
        self.pixel = clip_corners(&self.scene, &camera, viewport, self.instance, self.corners).and_then(|clip| {
            let point: DVec4 = clip.into_iter().zip(self.weights).map(|(corner, weight)| corner * weight).sum();
            let x = (point.x / point.w * 0.5 + 0.5) * f64::from(viewport.width);
            let y = (0.5 - point.y / point.w * 0.5) * f64::from(viewport.height);
            let inside = point.w > 0.0
                && (0.0..f64::from(viewport.width)).contains(&x)
                && (0.0..f64::from(viewport.height)).contains(&y);
            inside.then_some((x as u32, y as u32))
        });
    }

    /// Whether a triangle is that of the point, or has a corner in common with it.
    fn touches(&self, triangle: TriangleId) -> bool {
        let Some((instance, corners)) = corners_of(&self.scene, triangle) else { return false };
        let positions = &self.scene.library.mesh(self.scene.instances[instance].mesh).positions;
        let at = |corner: u32| positions.get(corner as usize);
        instance == self.instance && corners.iter().any(|corner| self.corners.iter().any(|own| at(*own) == at(*corner)))
    }

    /// Returns the visibility of the point in a frame; `None` if the frame shows another view or explains another pixel.
    fn visibility(&self, view: &RenderedView) -> Option<PointVisibility> {
        let is_current = view.request.camera == self.camera && view.frame.viewport == self.viewport;
        if self.pixel.is_none() {
            return is_current.then_some(PointVisibility::Outside);
        }
        let report = view.report.as_ref().filter(|report| is_current && Some((report.x, report.y)) == self.pixel)?;
        let is_visible = report.visible().is_some_and(|fragment| self.touches(fragment.triangle));
        Some(if is_visible { PointVisibility::Visible } else { PointVisibility::Hidden })
    }
}

/// Returns the corners of a triangle in clip space.
fn clip_corners(
    scene: &Scene,
    camera: &Camera,
    viewport: Viewport,
    instance: usize,
    corners: [u32; 3],
) -> Option<[DVec4; 3]> {
    let instance = scene.instances.get(instance)?;
    let positions = &scene.library.mesh(instance.mesh).positions;
    let clip_from_world = camera.clip_from_world_f64(viewport.aspect(), DepthMapping::STANDARD);
    let clip_from_model: DMat4 = clip_from_world * instance.world_from_model.as_dmat4();
    let corner = |index: u32| positions.get(index as usize).map(|position| position.as_dvec3().extend(1.0));
    let [a, b, c] = corners.map(corner);
    Some([a?, b?, c?].map(|position| clip_from_model * position))
}

impl Session {
    /// Updates the picked point: takes it from the frame on screen after a new pick, and moves the picked pixel to it
    /// after a change of the camera or the picture size.
    pub(crate) fn follow_picked_point(&mut self) {
        let (camera, viewport) = (self.state.camera, self.viewport());
        if let Some(point) = &mut self.features.picking.point {
            if !Arc::ptr_eq(&point.scene, &self.scene) || point.pixel != self.pick {
                self.features.picking.point = None;
            } else if (point.camera, point.viewport) != (camera, viewport) {
                point.project(camera, viewport);
                if let Some((_, with)) = &mut self.features.mesh_view.selected
                    && *with == self.pick
                {
                    *with = point.pixel;
                }
                self.pick = point.pixel;
                return;
            }
        }
        let view = self.view_of_scene().filter(|view| {
            let is_current = view.request.camera == camera && view.frame.viewport == viewport;
            is_current && view.report.as_ref().is_some_and(|report| Some((report.x, report.y)) == self.pick)
        });
        if self.features.picking.point.is_none()
            && let Some(point) = view.and_then(PickedPoint::of)
        {
            self.features.picking.point = Some(point);
        }
    }

    /// Returns the visibility of the picked point in the frame on screen; `None` if it is not known yet, or if no
    /// triangle was picked.
    pub(crate) fn point_visibility(&self) -> Option<PointVisibility> {
        self.features.picking.point.as_ref()?.visibility(self.view_of_scene()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::Recipe;
    use crate::scene::SceneSource;
    use crate::ui::app::Workbench;
    use crate::ui::headless::Headless;
    use crate::ui::session::PictureSize;
    use crate::ui::session::command::Command;
    use crate::ui::worker::Worker;
    use eframe::egui;

    fn workbench() -> (Workbench, Headless) {
        let source = SceneSource::named("chess".into());
        let scene = source.load().unwrap().scene;
        let home = scene.home;
        let mut session = Session::new(Arc::new(scene), source, Recipe::default(), home);
        session.state.size = PictureSize::Fixed(160, 90);
        (Workbench::new(session, Worker::inline()), Headless::new(egui::vec2(900.0, 600.0), 1.0, egui::Theme::Dark))
    }

    #[test]
    fn the_pick_stays_on_its_object_through_camera_and_size() {
        let (mut app, mut headless) = workbench();
        let mut rest = |app: &mut Workbench| {
            for _ in 0..3 {
                headless.pass(Vec::new(), |ui| app.show(ui));
            }
        };
        rest(&mut app);
        app.session_mut().apply(Command::Pick(Some((84, 48))));
        rest(&mut app);
        let first = app.session().features.picking.point.clone().expect("a triangle");
        assert!((first.weights.iter().sum::<f64>() - 1.0).abs() < 1e-9 && first.weights.iter().all(|w| *w > 0.0));
        let same = |app: &Workbench| {
            let point = app.session().features.picking.point.as_ref().expect("it is kept");
            assert_eq!((point.triangle, point.weights), (first.triangle, first.weights));
        };
        app.session_mut().state.size = PictureSize::Fixed(320, 180);
        rest(&mut app);
        same(&app);
        let (x, y) = app.session().pick.unwrap();
        assert!(x.abs_diff(169) <= 1 && y.abs_diff(97) <= 1, "{x}, {y}");
        assert_eq!(app.session().point_visibility(), Some(PointVisibility::Visible));
        app.session_mut().state.camera.orbit(5.0_f32.to_radians(), 0.0);
        rest(&mut app);
        same(&app);
        // From behind, the point is hidden or its triangle faces away; the pixel explains what hides it.
        app.session_mut().state.camera.orbit(std::f32::consts::PI, 0.0);
        rest(&mut app);
        same(&app);
        assert_eq!(app.session().point_visibility(), Some(PointVisibility::Hidden));
        // Looking away, the point lies outside, and it returns with the view.
        let camera = app.session().state.camera;
        app.session_mut().state.camera.target = camera.eye * 2.0 - camera.target;
        rest(&mut app);
        assert_eq!((app.session().pick, app.session().point_visibility()), (None, Some(PointVisibility::Outside)));
        app.session_mut().state.camera = app.session().scene.home;
        app.session_mut().state.size = PictureSize::Fixed(160, 90);
        rest(&mut app);
        same(&app);
        assert_eq!(app.session().pick, Some((84, 48)));
        app.session_mut().apply(Command::Pick(Some((20, 80))));
        rest(&mut app);
        assert_ne!(app.session().features.picking.point.as_ref().unwrap().triangle, first.triangle);
    }
}
