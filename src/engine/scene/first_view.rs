//! Initial view of a model: from the front, slightly from the right and above, unless the model is back-facing from
//! there.
//!
//! Most models face +z and are closed. Every direction then shows about as much front-facing as back-facing area, and
//! the preferred direction is used. A single sheet that faces away would be culled and leave the picture empty. The
//! first view therefore moves to a side that shows clearly more front-facing area.

use glam::{DMat3, DVec3, Vec3};

use super::{Camera, Scene};
use crate::math::Aabb;

/// World axis that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// Up is +y.
    #[default]
    Y,
    /// Up is +z.
    Z,
}

impl UpAxis {
    /// Returns the unit vector of the axis.
    pub(crate) fn unit(self) -> Vec3 {
        match self {
            Self::Y => Vec3::Y,
            Self::Z => Vec3::Z,
        }
    }

    /// Returns the axis that is closer to the given up vector.
    pub fn nearest(up: Vec3) -> Self {
        if up.z.abs() > up.y.abs() { Self::Z } else { Self::Y }
    }

    /// Rotates a vector of a y-up world into a world with this axis up.
    fn rotated(self, vector: Vec3) -> Vec3 {
        match self {
            Self::Y => vector,
            Self::Z => Vec3::new(vector.x, -vector.z, vector.y),
        }
    }

    /// Returns the likely up axis of a model with these bounds.
    ///
    /// The result is z if the model stands on z = 0, is centred in y and does not stand on y = 0. Programs with z up
    /// place models this way. Otherwise, and for a flat model, it is y.
    pub(crate) fn guess(bounds: Aabb) -> Self {
        let (size, center) = (bounds.max - bounds.min, bounds.center());
        let stands_on_zero = |axis: usize| bounds.min[axis].abs() <= ON_ZERO * size[axis];
        let has_height = size.z >= MIN_HEIGHT * size.max_element() && size.y > 0.0;
        let is_centred = center.y.abs() <= CENTRED * size.y;
        if has_height && stands_on_zero(2) && is_centred && !stands_on_zero(1) { Self::Z } else { Self::Y }
    }
}

/// A model stands on 0 along an axis if its lowest point is at most this far from 0, as a fraction of its size along
/// the axis.
const ON_ZERO: f32 = 0.01;

/// Models whose height is less than this fraction of their longest side are treated as flat.
const MIN_HEIGHT: f32 = 0.05;

/// A model is centred along an axis if its centre is at most this far from 0, as a fraction of its size along the axis.
const CENTRED: f32 = 0.05;

/// Candidate directions towards the eye in a y-up world, the preferred one first.
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

/// A candidate direction replaces the best earlier one if its projected front-facing area is more than this many times
/// as large.
const CLEARLY_MORE: f64 = 1.6;

/// Returns a view of the whole scene with the up axis `up`, from the preferred direction unless another one shows
/// clearly more front-facing area.
pub(super) fn first_view(scene: &Scene, up: UpAxis) -> Camera {
    let [preferred, others @ ..] = DIRECTIONS.map(|direction| up.rotated(direction));
    let mut best = (preferred, front_area(scene, preferred));
    for direction in others {
        let area = front_area(scene, direction);
        if area > best.1 * CLEARLY_MORE {
            best = (direction, area);
        }
    }
    Camera { up: up.unit(), ..Camera::fit(scene.bounds(), best.0) }
}

/// Returns the projected area of the triangles that face `direction`, in square world units.
fn front_area(scene: &Scene, direction: Vec3) -> f64 {
    let towards_eye = direction.as_dvec3().normalize();
    let instances = scene.instances.iter().map(|instance| {
        // Area vectors are transformed by the matrix of cofactors; here, the direction is transformed instead of each of
        // them.
        let [x, y, z] = DMat3::from_mat4(instance.world_from_model.as_dmat4()).to_cols_array_2d().map(DVec3::from);
        let cofactors = [y.cross(z), z.cross(x), x.cross(y)];
        let towards_eye = DVec3::from(cofactors.map(|column| column.dot(towards_eye)));
        (scene.library.mesh(instance.mesh), towards_eye)
    });
    instances
        .flat_map(|(mesh, towards_eye)| {
            mesh.triangles.iter().map(move |corners| {
                let [a, b, c]: [DVec3; 3] = corners.map(|i| mesh.positions[i as usize].as_dvec3());
                let area = (0.5 * (b - a).cross(c - a)).dot(towards_eye).max(0.0);
                if area.is_finite() { area } else { 0.0 }
            })
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_is_guessed_from_the_ground_that_a_model_stands_on() {
        let guess = |min: [f32; 3], max: [f32; 3]| UpAxis::guess(Aabb { min: min.into(), max: max.into() });
        assert_eq!(guess([-1.0, -1.0, 0.0], [1.0, 1.0, 3.0]), UpAxis::Z);
        assert_eq!(guess([-1.0, 0.0, -1.0], [1.0, 3.0, 1.0]), UpAxis::Y);
        assert_eq!(guess([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]), UpAxis::Y, "it stands on nothing");
        assert_eq!(guess([-1.0, -1.0, 0.0], [1.0, 1.0, 0.0]), UpAxis::Y, "it is flat");
        assert_eq!(guess([-1.0, 0.0, 0.0], [1.0, 1.0, 1.0]), UpAxis::Y, "it stands on both");
        assert_eq!(guess([-1.0, 2.0, 0.0], [1.0, 4.0, 1.0]), UpAxis::Y, "it is not centred");
    }

    #[test]
    fn a_rotated_model_looks_the_same_with_z_up() {
        let direction = Vec3::new(0.55, 0.4, 1.0);
        let turned = UpAxis::Z.rotated(direction);
        assert_eq!(turned.dot(Vec3::Z), direction.dot(Vec3::Y));
        assert_eq!(UpAxis::nearest(UpAxis::Z.unit()), UpAxis::Z);
    }
}
