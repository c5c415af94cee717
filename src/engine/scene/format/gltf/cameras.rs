//! Cameras of the file as views of the scene.

use std::f32::consts::PI;

use glam::{DVec3, Vec3};
use gltf_json::camera::Type;

use super::nodes::{Placed, PlacedCamera};
use super::{Remarks, valid};
use crate::math::{Aabb, unit_or};
use crate::scene::{Camera, Projection, SceneView};
use crate::text;

/// Far plane of a camera without one, as a multiple of the distance to the farthest point of the scene.
const FAR_MARGIN: f32 = 2.0;

/// Near plane of an orthographic camera whose near plane passes through its eye, as a fraction of the distance to its
/// far plane.
const LEAST_NEAR: f32 = 1e-6;

/// Returns a view for each camera of the scene. Warns about cameras that cannot be used.
pub(super) fn views(placed: &Placed, bounds: Aabb, remarks: &mut Remarks<'_>) -> Vec<SceneView> {
    let mut views = Vec::new();
    for placed in &placed.cameras {
        let camera = camera(placed, bounds);
        match camera.check() {
            Ok(()) => views.push(SceneView { name: placed.name.clone(), camera }),
            Err(reason) => {
                remarks.warn(format!("the camera {:?} is not usable: {reason}", text::message(&placed.name)));
            }
        }
    }
    views
}

/// Returns the view of a camera. It looks at the middle of the scene if that is in front of it.
fn camera(placed: &PlacedCamera, bounds: Aabb) -> Camera {
    let world = placed.world_from_view;
    let eye = world.w_axis.truncate();
    let forward = -unit_or(world.z_axis.truncate(), Vec3::Z).as_dvec3();
    let (center, radius) =
        if bounds.is_empty() { (DVec3::ZERO, 1.0) } else { (bounds.center().as_dvec3(), bounds.radius()) };
    let along = (center - eye).dot(forward);
    let distance = if along > f64::from(radius) * 0.01 { along } else { f64::from(radius.max(f32::MIN_POSITIVE)) };
    let farthest = ((center - eye).length() as f32 + radius) * FAR_MARGIN;
    let (projection, near, far) = projection(&placed.camera, farthest);
    Camera {
        up: unit_or(world.y_axis.truncate(), Vec3::Y),
        projection,
        near,
        far,
        ..Camera::look_at(eye.as_vec3(), (eye + forward * distance).as_vec3())
    }
}

/// Returns the projection, and the distances of the near and far planes. The aspect ratio is that of the picture.
fn projection(camera: &gltf_json::Camera, farthest: f32) -> (Projection, f32, f32) {
    match (valid(camera.type_), &camera.perspective, &camera.orthographic) {
        (Some(Type::Orthographic), _, Some(flat)) => {
            (Projection::Orthographic { height: 2.0 * flat.ymag }, flat.znear.max(flat.zfar * LEAST_NEAR), flat.zfar)
        }
        (_, Some(perspective), _) => {
            let far = perspective.zfar.unwrap_or_else(|| farthest.max(perspective.znear * FAR_MARGIN));
            (Projection::Perspective { fov_y: perspective.yfov }, perspective.znear, far)
        }
        // Rejected by the check of the view.
        _ => (Projection::Perspective { fov_y: PI }, 0.0, 0.0),
    }
}
