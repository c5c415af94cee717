//! Where a model is first seen from: in front, a little to the right and above, unless it turns its back there.
//!
//! Most models look along +z and close on themselves; then any direction sees as much front as back, and the preferred
//! one is taken. A single sheet that faces away would be culled whole and leave an empty picture, so the first view goes
//! to a side that shows clearly more front.

use glam::{DVec3, Vec3};

use crate::scene::{Camera, Scene};

/// The directions towards the eye that are tried, the preferred one first.
const DIRECTIONS: [Vec3; 8] = [
    Vec3::new(0.55, 0.4, 1.0),
    Vec3::new(-0.55, 0.4, 1.0),
    Vec3::new(0.55, 0.4, -1.0),
    Vec3::new(-0.55, 0.4, -1.0),
    Vec3::new(0.55, -0.4, 1.0),
    Vec3::new(-0.55, -0.4, 1.0),
    Vec3::new(0.55, -0.4, -1.0),
    Vec3::new(-0.55, -0.4, -1.0),
];

/// A later direction must show this many times the front of an earlier one to be taken.
const CLEARLY_MORE: f64 = 1.6;

/// A view of the whole scene.
pub(super) fn first_view(scene: &Scene) -> Camera {
    let mut best = (DIRECTIONS[0], front_area(scene, DIRECTIONS[0]));
    for direction in &DIRECTIONS[1..] {
        let area = front_area(scene, *direction);
        if area > best.1 * CLEARLY_MORE {
            best = (*direction, area);
        }
    }
    Camera::fit(scene.bounds(), best.0)
}

/// Area of the triangles that face `direction`, as it is projected along it. Models stand where they are: instances are
/// not moved.
fn front_area(scene: &Scene, direction: Vec3) -> f64 {
    let towards_eye = direction.as_dvec3().normalize();
    let meshes = scene.library.meshes().iter();
    meshes
        .flat_map(|mesh| {
            mesh.triangles.iter().map(|corners| {
                let [a, b, c]: [DVec3; 3] = corners.map(|i| mesh.positions[i as usize].as_dvec3());
                (0.5 * (b - a).cross(c - a)).dot(towards_eye).max(0.0)
            })
        })
        .sum()
}
