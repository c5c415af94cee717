//! The second camera: its initial position, and near and far planes that never clip the scene.

use glam::Vec3;

use super::Inner;
use crate::math::Aabb;
use crate::scene::{Camera, Scene};

/// Initial direction from the target to the second camera, in the render camera's right, up and backward axes.
const FROM: Vec3 = Vec3::new(1.0, 0.6, 0.45);

/// Minimum ratio of the near plane's distance to the far plane's distance. Reversed depth has sufficient precision for
/// this ratio.
const MIN_NEAR: f32 = 1e-5;

/// Returns the bounding box that encloses the scene and the eye of the render camera.
fn bounds(scene: &Scene, inner: &Camera) -> Aabb {
    scene.bounds().union(Aabb::around(std::iter::once(inner.eye)))
}

/// Returns a view of the whole scene and the render camera, from beside and above the camera. `aspect` is the width of
/// the picture divided by its height.
pub fn first_view(scene: &Scene, inner: &Inner, aspect: f32) -> Camera {
    let (right, forward) = (inner.camera.right(), inner.camera.forward());
    let up = right.cross(forward);
    let direction = right * FROM.x + up * FROM.y - forward * FROM.z;
    let target = inner.camera.eye;
    let from = Camera { up: inner.camera.up, ..Camera::look_at(target + direction, target) };
    from.refit(bounds(scene, &inner.camera), aspect)
}

/// Returns a view in the same direction that shows the whole scene and the render camera.
pub fn fit(view: Camera, scene: &Scene, inner: &Inner, aspect: f32) -> Camera {
    view.refit(bounds(scene, &inner.camera), aspect)
}

/// Returns the same view with near and far planes that enclose the scene and the render camera.
pub fn with_planes(view: Camera, scene: &Scene, inner: &Inner) -> Camera {
    let bounds = bounds(scene, &inner.camera);
    let (distance, radius) = (view.eye.distance(bounds.center()), bounds.radius());
    let far = (distance + radius) * 1.01;
    let near = ((distance - radius) * 0.5).max(far * MIN_NEAR);
    let seen = Camera { near, far, ..view };
    if seen.check().is_ok() { seen } else { view }
}
