//! The view: where from, where to, how wide, and the matrices that follow.
//!
//! World is right-handed with y up; the camera looks down −z of its own space. Clip space has z/w in [0, 1] with
//! near = 0, or near = 1 when depth is reversed (then float precision grows where perspective eats it; Reed, "Depth
//! Precision Visualized", 2015). Navigation is plain arithmetic here, so that window and tests share it.

use glam::{DMat4, Mat4, Vec2, Vec3};
use serde::{Deserialize, Serialize};

use crate::math::{Aabb, unit_or};

/// How view space is flattened.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Projection {
    /// Far things are smaller.
    Perspective {
        /// Vertical field of view, radians.
        fov_y: f32,
    },
    /// Parallel lines stay parallel.
    Orthographic {
        /// Height of the visible slab, world units.
        height: f32,
    },
}

/// A view onto a scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Where the eye is, world space.
    pub eye: Vec3,
    /// What it looks at; also the point that orbiting turns around.
    pub target: Vec3,
    /// Roughly upwards; need not be perpendicular to the line of sight.
    pub up: Vec3,
    /// Perspective or orthographic.
    pub projection: Projection,
    /// Distance of the near plane, > 0 for perspective.
    pub near: f32,
    /// Distance of the far plane, > near.
    pub far: f32,
}

/// Default vertical field of view: 45°, near a 50 mm lens's diagonal on a desktop window.
pub const DEFAULT_FOV_Y: f32 = std::f32::consts::FRAC_PI_4;

/// Closest that orbiting may come to straight up or down, radians: at the pole the up vector would lose its meaning.
const POLE_MARGIN: f32 = 0.01;

impl Camera {
    /// A perspective view with planes that suit the distance.
    pub fn look_at(eye: Vec3, target: Vec3) -> Self {
        let distance = (eye.as_dvec3().distance(target.as_dvec3()) as f32).max(f32::MIN_POSITIVE);
        Self {
            eye,
            target,
            up: Vec3::Y,
            projection: Projection::Perspective { fov_y: DEFAULT_FOV_Y },
            near: distance * 0.01,
            far: distance * 100.0,
        }
    }

    /// A perspective view from `direction` (towards the eye) that shows all of `bounds` in a picture of any shape
    /// at least as wide as high.
    pub fn fit(bounds: Aabb, direction: Vec3) -> Self {
        let (center, radius) = if bounds.is_empty() { (Vec3::ZERO, 1.0) } else { (bounds.center(), bounds.radius()) };
        // Bounded so that planes and distances derived from it stay finite.
        let radius = radius.clamp(1e-30, 1e34);
        let distance = radius / (DEFAULT_FOV_Y * 0.5).sin();
        Self {
            near: (distance - radius) * 0.25,
            far: distance + radius * 2.0,
            ..Self::look_at(center + unit_or(direction.as_dvec3(), Vec3::Z) * distance, center)
        }
    }

    /// This view's direction and projection kind, moved so that all of `bounds` is seen.
    pub fn refit(&self, bounds: Aabb) -> Self {
        let fitted = Self { up: self.up, ..Self::fit(bounds, self.eye - self.target) };
        match self.projection {
            Projection::Perspective { .. } => fitted,
            Projection::Orthographic { .. } => fitted.with_orthographic(true),
        }
    }

    /// Distance from the eye to the target.
    pub fn distance(&self) -> f32 {
        self.eye.as_dvec3().distance(self.target.as_dvec3()) as f32
    }

    /// Unit vector along the line of sight; −z if eye and target coincide.
    pub fn forward(&self) -> Vec3 {
        unit_or(self.target.as_dvec3() - self.eye.as_dvec3(), Vec3::NEG_Z)
    }

    /// Unit vector to the right in the picture. Picks another up vector when the given one is parallel to the sight.
    pub fn right(&self) -> Vec3 {
        let forward = self.forward();
        let right = forward.cross(self.up.normalize_or(Vec3::Y));
        right.try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector())
    }

    /// View space from world space: the eye at the origin, looking down −z.
    pub fn view_from_world(&self) -> Mat4 {
        self.view_from_world_f64().as_mat4()
    }

    /// [`Camera::view_from_world`] before it is rounded: far from the origin the eye's position only cancels against an
    /// object's if neither was rounded before.
    pub fn view_from_world_f64(&self) -> DMat4 {
        let (forward, right) = (self.forward(), self.right());
        let up = right.cross(forward);
        let rotation = Mat4::from_cols(
            Vec3::new(right.x, up.x, -forward.x).extend(0.0),
            Vec3::new(right.y, up.y, -forward.y).extend(0.0),
            Vec3::new(right.z, up.z, -forward.z).extend(0.0),
            glam::Vec4::W,
        );
        rotation.as_dmat4() * DMat4::from_translation(-self.eye.as_dvec3())
    }

    /// Clip space from view space, z/w = 0 at the near plane and 1 at the far plane, or the other way round when
    /// `reversed`. `aspect` is width over height.
    ///
    /// Entries are computed in f64 and rounded once (Upchurch and Desbrun, "Tightening the Precision of Perspective
    /// Rendering", 2012).
    pub fn clip_from_view(&self, aspect: f32, reversed: bool) -> Mat4 {
        let (near, far) = (f64::from(self.near), f64::from(self.far));
        let (z_at_0, z_at_1) = if reversed { (far, near) } else { (near, far) };
        let mut m = Mat4::ZERO;
        match self.projection {
            Projection::Perspective { fov_y } => {
                let scale_y = 1.0 / (f64::from(fov_y) * 0.5).tan();
                m.x_axis.x = (scale_y / f64::from(aspect)) as f32;
                m.y_axis.y = scale_y as f32;
                m.z_axis.z = (z_at_1 / (z_at_0 - z_at_1)) as f32;
                m.w_axis.z = (z_at_0 * (z_at_1 / (z_at_0 - z_at_1))) as f32;
                m.z_axis.w = -1.0;
            }
            Projection::Orthographic { height } => {
                let scale_y = 2.0 / f64::from(height);
                m.x_axis.x = (scale_y / f64::from(aspect)) as f32;
                m.y_axis.y = scale_y as f32;
                m.z_axis.z = (1.0 / (z_at_0 - z_at_1)) as f32;
                m.w_axis.z = (z_at_0 / (z_at_0 - z_at_1)) as f32;
                m.w_axis.w = 1.0;
            }
        }
        m
    }

    /// Clip space from world space.
    pub fn clip_from_world(&self, aspect: f32, reversed: bool) -> Mat4 {
        self.clip_from_view(aspect, reversed) * self.view_from_world()
    }

    /// The view of the mirror image in z that corresponds to this view of the original.
    pub fn mirrored_z(self) -> Self {
        let mirror = Vec3::new(1.0, 1.0, -1.0);
        Self { eye: self.eye * mirror, target: self.target * mirror, up: self.up * mirror, ..self }
    }

    /// Turns around the target: `yaw` to the right and `pitch` upwards, radians. Stops short of the poles.
    pub fn orbit(&mut self, yaw: f32, pitch: f32) {
        let up = self.up.normalize_or(Vec3::Y);
        let offset = self.eye - self.target;
        let elevation = unit_or(offset.as_dvec3(), Vec3::Z).dot(up).clamp(-1.0, 1.0).asin();
        let limit = std::f32::consts::FRAC_PI_2 - POLE_MARGIN;
        let pitch = (elevation + pitch).clamp(-limit, limit) - elevation;
        let lifted = glam::Quat::from_axis_angle(self.right(), -pitch) * offset;
        self.eye = self.target + glam::Quat::from_axis_angle(up, -yaw) * lifted;
    }

    /// Looks around from a fixed eye: `yaw` to the right and `pitch` upwards, radians.
    pub fn look(&mut self, yaw: f32, pitch: f32) {
        let eye = self.eye;
        std::mem::swap(&mut self.eye, &mut self.target);
        self.orbit(yaw, -pitch);
        std::mem::swap(&mut self.eye, &mut self.target);
        self.eye = eye;
    }

    /// Shifts eye and target in the picture plane by `offset` in units of the picture's height (y down), so that the
    /// target follows the pointer.
    pub fn pan(&mut self, offset: Vec2) {
        let right = self.right();
        let up = right.cross(self.forward());
        let shift = (up * offset.y - right * offset.x) * self.visible_height();
        self.eye += shift;
        self.target += shift;
    }

    /// Multiplies the distance to the target (perspective) or the visible height (orthographic) by `factor`.
    pub fn dolly(&mut self, factor: f32) {
        if let Projection::Orthographic { height } = &mut self.projection {
            *height = (*height * factor).clamp(1e-30, 1e34);
        }
        let offset = (self.eye - self.target) * factor;
        if offset.is_finite() && offset != Vec3::ZERO {
            self.eye = self.target + offset;
        }
    }

    /// Moves eye and target along right, up and forward by `steps`, in units of the distance to the target.
    pub fn fly(&mut self, steps: Vec3) {
        let (right, forward) = (self.right(), self.forward());
        let up = right.cross(forward);
        let shift = (right * steps.x + up * steps.y + forward * steps.z) * self.distance();
        self.eye += shift;
        self.target += shift;
    }

    /// Height of what is visible at the target's distance, world units.
    pub fn visible_height(&self) -> f32 {
        match self.projection {
            Projection::Perspective { fov_y } => 2.0 * self.distance() * (fov_y * 0.5).tan(),
            Projection::Orthographic { height } => height,
        }
    }

    /// The same view in the other projection, with the target at the same size.
    pub fn with_orthographic(mut self, orthographic: bool) -> Self {
        self.projection = if orthographic {
            Projection::Orthographic { height: self.visible_height() }
        } else {
            Projection::Perspective { fov_y: DEFAULT_FOV_Y }
        };
        self
    }
}

/// A view as written in camera files: `{"eye": [..], "target": [..], "up": [..], "fov_y_degrees": .., "near": .., "far": ..}`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraFile {
    /// World space.
    pub eye: Vec3,
    /// World space.
    pub target: Vec3,
    /// World space.
    #[serde(default = "y_up")]
    pub up: Vec3,
    /// Vertical field of view.
    pub fov_y_degrees: f32,
    /// Distance of the near plane.
    pub near: f32,
    /// Distance of the far plane.
    pub far: f32,
}

fn y_up() -> Vec3 {
    Vec3::Y
}

impl TryFrom<CameraFile> for Camera {
    type Error = String;

    fn try_from(file: CameraFile) -> Result<Self, String> {
        let CameraFile { eye, target, up, fov_y_degrees, near, far } = file;
        if !(eye.is_finite() && target.is_finite() && up.is_finite()) {
            return Err("eye, target and up must be finite".to_owned());
        }
        if eye == target {
            return Err("eye and target are the same point".to_owned());
        }
        if !(fov_y_degrees > 0.0 && fov_y_degrees < 180.0) {
            return Err(format!("fov_y_degrees must lie between 0 and 180, not {fov_y_degrees}"));
        }
        if !(near > 0.0 && far > near && far.is_finite()) {
            return Err(format!("near and far must satisfy 0 < near < far, not {near} and {far}"));
        }
        Ok(Self {
            eye,
            target,
            up,
            projection: Projection::Perspective { fov_y: fov_y_degrees.to_radians() },
            near,
            far,
        })
    }
}

impl From<Camera> for CameraFile {
    fn from(camera: Camera) -> Self {
        let fov_y = match camera.projection {
            Projection::Perspective { fov_y } => fov_y,
            Projection::Orthographic { .. } => DEFAULT_FOV_Y,
        };
        Self {
            eye: camera.eye,
            target: camera.target,
            up: camera.up,
            fov_y_degrees: fov_y.to_degrees(),
            near: camera.near,
            far: camera.far,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec4Swizzles as _;

    use super::*;

    fn ndc(camera: &Camera, reversed: bool, p: Vec3) -> Vec3 {
        let clip = camera.clip_from_world(1.0, reversed) * p.extend(1.0);
        clip.xyz() / clip.w
    }

    #[test]
    fn near_and_far_planes_map_to_the_ends_of_the_depth_range() {
        for orthographic in [false, true] {
            let camera = Camera::look_at(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO).with_orthographic(orthographic);
            let near = camera.eye + camera.forward() * camera.near;
            let far = camera.eye + camera.forward() * camera.far;
            for (reversed, ends) in [(false, [0.0, 1.0]), (true, [1.0, 0.0])] {
                for (point, z) in [near, far].into_iter().zip(ends) {
                    let got = ndc(&camera, reversed, point).z;
                    assert!((got - z).abs() < 1e-5, "{orthographic} {reversed}: {got} for {z}");
                }
            }
        }
    }

    #[test]
    fn right_is_right_and_up_is_up() {
        let camera = Camera::look_at(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO);
        assert!(ndc(&camera, false, Vec3::X * 0.1).x > 0.0);
        assert!(ndc(&camera, false, Vec3::Y * 0.1).y > 0.0);
    }

    #[test]
    fn a_fitted_box_is_wholly_visible_at_any_size() {
        for scale in [1e-20_f32, 1.0, 1e30] {
            let bounds = Aabb { min: Vec3::splat(-scale), max: Vec3::new(scale, 2.0 * scale, 3.0 * scale) };
            let camera = Camera::fit(bounds, Vec3::new(1.0, 1.0, 1.0));
            for corner in bounds.corners() {
                let p = ndc(&camera, false, corner);
                assert!(p.abs().max_element() <= 1.0 && p.z >= 0.0, "{scale}: {p}");
            }
        }
    }

    #[test]
    fn orbiting_keeps_the_distance_and_stops_at_the_poles() {
        let mut camera = Camera::look_at(Vec3::new(0.0, 1.0, 5.0), Vec3::ZERO);
        let distance = camera.distance();
        for _ in 0..100 {
            camera.orbit(0.1, 0.1);
        }
        assert!((camera.distance() - distance).abs() < 1e-3);
        assert!(camera.forward().dot(Vec3::NEG_Y) > 0.99 && camera.right().is_finite());
    }

    #[test]
    fn looking_straight_down_has_a_finite_view() {
        let camera = Camera { up: Vec3::Y, ..Camera::look_at(Vec3::Y * 3.0, Vec3::ZERO) };
        assert!(camera.view_from_world().is_finite());
    }

    #[test]
    fn camera_files_are_checked() {
        let good = CameraFile::from(Camera::look_at(Vec3::Z, Vec3::ZERO));
        assert!(Camera::try_from(good).is_ok());
        for bad in [
            CameraFile { near: 0.0, ..good },
            CameraFile { far: good.near, ..good },
            CameraFile { fov_y_degrees: 180.0, ..good },
            CameraFile { target: good.eye, ..good },
        ] {
            assert!(Camera::try_from(bad).is_err());
        }
    }
}
