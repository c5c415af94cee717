//! Movements of a camera by a viewer: orbit, pan, dolly and fly.

use std::f32::consts::FRAC_PI_2;

use glam::{Vec2, Vec3};

use super::{Camera, Projection};
use crate::math::unit_or;

/// Minimum angle between the line of sight and the up vector when orbiting, in radians. At the poles, the up vector
/// would not define a rotation.
const POLE_MARGIN: f32 = 0.01;

impl Camera {
    /// Orbits the eye around the target by `yaw` to the left and `pitch` upwards, in radians, so that the scene follows
    /// a pointer that moves right and down. Stops short of the poles.
    pub fn orbit(&mut self, yaw: f32, pitch: f32) {
        let up = self.up.normalize_or(Vec3::Y);
        let offset = self.eye - self.target;
        let elevation = unit_or(offset.as_dvec3(), Vec3::Z).dot(up).clamp(-1.0, 1.0).asin();
        let limit = FRAC_PI_2 - POLE_MARGIN;
        let pitch = (elevation + pitch).clamp(-limit, limit) - elevation;
        let lifted = glam::Quat::from_axis_angle(self.right(), -pitch) * offset;
        self.eye = self.target + glam::Quat::from_axis_angle(up, -yaw) * lifted;
    }

    /// Pans eye and target in the picture plane, so that objects at the target's distance follow the pointer. `offset`
    /// is in units of the picture's height, with y pointing down.
    pub fn pan(&mut self, offset: Vec2) {
        let right = self.right();
        let up = right.cross(self.forward());
        let shift = (up * offset.y - right * offset.x) * self.visible_height();
        self.eye += shift;
        self.target += shift;
    }

    /// Dollies the camera: multiplies the distance to the target, and the visible height of an orthographic view, by
    /// `factor`. A minimum distance keeps eye and target numerically distinct.
    pub fn dolly(&mut self, factor: f32) {
        let factor = factor.max((self.min_distance() / self.distance()).min(1.0));
        if let Projection::Orthographic { height } = &mut self.projection {
            *height = (*height * factor).clamp(1e-30, 1e34);
        }
        let offset = (self.eye - self.target) * factor;
        if offset.is_finite() && offset != Vec3::ZERO {
            self.eye = self.target + offset;
        }
    }

    /// Returns the minimum distance between eye and target, in world units. At smaller distances, rounding of their
    /// coordinates would change the line of sight.
    pub(super) fn min_distance(&self) -> f32 {
        (self.eye.abs().max(self.target.abs()).max_element() * 1e-5).max(1e-30)
    }

    /// Moves eye and target: `steps.x` to the right, `steps.y` upwards and `steps.z` forwards, in units of the distance
    /// between eye and target.
    pub fn fly(&mut self, steps: Vec3) {
        let (right, forward) = (self.right(), self.forward());
        let up = right.cross(forward);
        let shift = (right * steps.x + up * steps.y + forward * steps.z) * self.distance();
        self.eye += shift;
        self.target += shift;
    }
}
