//! The second camera: where it stands at first, and planes that never cut what it looks at.

use glam::Vec3;

use super::Inner;
use crate::math::Aabb;
use crate::scene::{Camera, Scene};

/// Where the second camera stands, seen from what it looks at, in the first one's right, up and back.
const FROM: Vec3 = Vec3::new(1.0, 0.6, 0.45);

/// The nearest that its near plane comes, as a share of the far one: reversed depth bears it.
const LEAST_NEAR: f32 = 1e-5;

/// The box around the scene and the eye of the render camera.
fn bounds(scene: &Scene, inner: &Camera) -> Aabb {
    scene.bounds().union(Aabb::around(std::iter::once(inner.eye)))
}

/// A view that shows the whole scene and the render camera, from beside and above it, in a picture of this shape.
pub fn first_view(scene: &Scene, inner: &Inner, aspect: f32) -> Camera {
    let (right, forward) = (inner.camera.right(), inner.camera.forward());
    let up = right.cross(forward);
    let direction = right * FROM.x + up * FROM.y - forward * FROM.z;
    let target = inner.camera.eye;
    let from = Camera { up: inner.camera.up, ..Camera::look_at(target + direction, target) };
    from.refit(bounds(scene, &inner.camera), aspect)
}

/// A view in the same direction from which all of that is seen.
pub fn fit(view: Camera, scene: &Scene, inner: &Inner, aspect: f32) -> Camera {
    view.refit(bounds(scene, &inner.camera), aspect)
}

/// The same view with planes in front of and behind everything.
pub fn with_planes(view: Camera, scene: &Scene, inner: &Inner) -> Camera {
    let bounds = bounds(scene, &inner.camera);
    let (distance, radius) = (view.eye.distance(bounds.center()), bounds.radius());
    let far = (distance + radius) * 1.01;
    let near = ((distance - radius) * 0.5).max(far * LEAST_NEAR);
    let seen = Camera { near, far, ..view };
    if seen.check().is_ok() { seen } else { view }
}
