//! Camera: eye, target, projection, and the matrices derived from them.
//!
//! World space is right-handed with y up; the camera looks down −z in view space. In clip space, z/w is in [0, 1]. A
//! [`DepthMapping`] selects whether the near plane maps to 0 or, for reversed depth, to 1. Reversed depth maps large
//! distances, which perspective compresses, to values near 0, where floats are most precise (Reed, "Depth Precision
//! Visualized", 2015). Navigation consists of methods of the camera, so that window and tests share it.

mod navigation;

use std::f32::consts::{FRAC_PI_4, PI};

use glam::{DMat4, Mat4, Vec3, Vec4};
use serde::{Deserialize, Serialize};

use super::DepthMapping;
use crate::math::{Aabb, unit_or};

/// Projection from view space to clip space.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Projection {
    /// Perspective projection: distant objects appear smaller.
    Perspective {
        /// Vertical field of view, in radians.
        fov_y: f32,
    },
    /// Orthographic projection: parallel lines stay parallel.
    Orthographic {
        /// Height of the visible volume, in world units.
        height: f32,
    },
}

/// View of a scene: position, direction, projection, and near and far planes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Position of the eye, in world space.
    pub eye: Vec3,
    /// Point that the camera looks at and orbits around, in world space.
    pub target: Vec3,
    /// Approximate up direction, in world space. It need not be perpendicular to the line of sight.
    pub up: Vec3,
    /// Perspective or orthographic projection.
    pub projection: Projection,
    /// Distance of the near plane from the eye, in world units; greater than 0.
    pub near: f32,
    /// Distance of the far plane from the eye, in world units; greater than `near`. In perspective,
    /// [`DepthMapping::REVERSED_INFINITE`] ignores it.
    pub far: f32,
    /// Transform from this view to the drawn picture; `None` if the picture shows exactly this view. Not serialized.
    #[serde(skip)]
    pub sub_view: Option<SubView>,
}

/// Transform from a view to a drawn picture that covers a different rectangle. Examples are a low-resolution picture
/// whose last pixels extend past the edge, and a picture shifted by a fraction of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubView {
    /// Aspect ratio of the view: width over height.
    pub aspect: f32,
    /// Scale in x and y, from normalised device coordinates of the view to those of the drawn picture.
    pub scale: [f32; 2],
    /// Offset in x and y, in normalised device coordinates, added after the scale.
    pub shift: [f32; 2],
}

impl SubView {
    /// Returns the transform that applies this one first and `next` after it. It keeps the aspect ratio of this view.
    pub(crate) fn followed_by(self, next: Self) -> Self {
        let scale = [0, 1].map(|axis| self.scale[axis] * next.scale[axis]);
        let shift = [0, 1].map(|axis| self.shift[axis] * next.scale[axis] + next.shift[axis]);
        Self { aspect: self.aspect, scale, shift }
    }

    fn clip_from_clip(self) -> Mat4 {
        let ([scale_x, scale_y], [shift_x, shift_y]) = (self.scale, self.shift);
        Mat4::from_cols(Vec4::X * scale_x, Vec4::Y * scale_y, Vec4::Z, Vec4::new(shift_x, shift_y, 0.0, 1.0))
    }
}

/// Default vertical field of view: 45°, about that of a 50 mm lens along the diagonal of 35 mm film.
pub(crate) const DEFAULT_FOV_Y: f32 = FRAC_PI_4;

impl Camera {
    /// Creates a perspective view, with near and far planes derived from the distance between eye and target.
    ///
    /// # Examples
    /// ```
    /// use glam::Vec3;
    /// use rasterscope_engine::scene::Camera;
    ///
    /// let camera = Camera::look_at(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO);
    /// assert_eq!(camera.distance(), 4.0);
    /// assert_eq!(camera.forward(), Vec3::NEG_Z);
    /// assert_eq!(camera.right(), Vec3::X);
    /// assert!(camera.near < 4.0 && camera.far > 4.0);
    /// ```
    pub fn look_at(eye: Vec3, target: Vec3) -> Self {
        let distance = (eye.as_dvec3().distance(target.as_dvec3()) as f32).max(f32::MIN_POSITIVE);
        Self {
            eye,
            target,
            up: Vec3::Y,
            projection: Projection::Perspective { fov_y: DEFAULT_FOV_Y },
            near: distance * 0.01,
            far: distance * 100.0,
            sub_view: None,
        }
    }

    /// Creates a perspective view that shows all of `bounds` in any picture that is at least as wide as it is high.
    /// `direction` points from the bounds towards the eye.
    pub(crate) fn fit(bounds: Aabb, direction: Vec3) -> Self {
        Self::fit_into(bounds, direction, 1.0)
    }

    /// Returns a view with this direction and projection type that shows all of `bounds`. `aspect` is width over
    /// height.
    pub fn refit(&self, bounds: Aabb, aspect: f32) -> Self {
        let fitted = Self { up: self.up, ..Self::fit_into(bounds, self.eye - self.target, aspect) };
        match self.projection {
            Projection::Perspective { .. } => fitted,
            Projection::Orthographic { .. } => fitted.with_orthographic(true),
        }
    }

    /// Creates a view whose view cone touches the bounding sphere of `bounds`. The cone fits the narrower side of the
    /// picture.
    fn fit_into(bounds: Aabb, direction: Vec3, aspect: f32) -> Self {
        let (center, radius) = if bounds.is_empty() { (Vec3::ZERO, 1.0) } else { (bounds.center(), bounds.radius()) };
        // The clamp keeps the planes and distances derived from the radius finite.
        let radius = radius.clamp(1e-30, 1e34);
        let half_angle = ((DEFAULT_FOV_Y * 0.5).tan() * aspect.clamp(0.01, 1.0)).atan();
        let distance = radius / half_angle.sin();
        Self {
            near: (distance - radius) * 0.25,
            far: distance + radius * 2.0,
            ..Self::look_at(center + unit_or(direction.as_dvec3(), Vec3::Z) * distance, center)
        }
    }

    /// Returns the distance from the eye to the target, in world units.
    pub fn distance(&self) -> f32 {
        self.eye.as_dvec3().distance(self.target.as_dvec3()) as f32
    }

    /// Returns the unit vector along the line of sight; −z if eye and target coincide.
    pub fn forward(&self) -> Vec3 {
        unit_or(self.target.as_dvec3() - self.eye.as_dvec3(), Vec3::NEG_Z)
    }

    /// Returns the unit vector that points right in the picture; an arbitrary perpendicular to the line of sight if
    /// `up` is parallel to it.
    pub fn right(&self) -> Vec3 {
        let forward = self.forward();
        let right = forward.cross(self.up.normalize_or(Vec3::Y));
        right.try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector())
    }

    /// Returns the matrix from world space to view space, with the eye at the origin, looking down −z.
    #[cfg(test)]
    pub(crate) fn view_from_world(&self) -> Mat4 {
        self.view_from_world_f64().as_mat4()
    }

    /// Returns the matrix from world space to view space in f64. Far from the origin, the vector from the eye to a
    /// position is a small difference of large numbers. It is accurate only if neither number was rounded to f32
    /// before.
    pub(crate) fn view_from_world_f64(&self) -> DMat4 {
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

    /// Returns the matrix from world space to clip space in f64; only the entries of [`Camera::clip_from_view`] are
    /// rounded to f32.
    pub fn clip_from_world_f64(&self, aspect: f32, mapping: DepthMapping) -> DMat4 {
        self.clip_from_view(aspect, mapping).as_dmat4() * self.view_from_world_f64()
    }

    /// Returns the matrix from view space to clip space, where z/w is the depth of `mapping`. `aspect` is width over
    /// height.
    ///
    /// In perspective, z/w is the depth of [`DepthMapping::in_clip_space`].
    ///
    /// Entries are computed in f64 and rounded once (Upchurch and Desbrun, "Tightening the Precision of Perspective
    /// Rendering", 2012).
    pub(crate) fn clip_from_view(&self, aspect: f32, mapping: DepthMapping) -> Mat4 {
        let (near, far) = (f64::from(self.near), f64::from(self.far));
        let aspect = self.sub_view.map_or(aspect, |window| window.aspect);
        let mut m = Mat4::ZERO;
        match self.projection {
            Projection::Perspective { fov_y } => {
                let scale_y = 1.0 / (f64::from(fov_y) * 0.5).tan();
                m.x_axis.x = (scale_y / f64::from(aspect)) as f32;
                m.y_axis.y = scale_y as f32;
                // w is −z, and z/w is the depth of `mapping`, so clip-space z is that depth times w.
                let mapping = mapping.in_clip_space();
                let factor = mapping.factor([near, far]);
                let [zero, _] = mapping.zero_and_one([near, far]);
                let [z_from_z, z_from_one] = match mapping {
                    DepthMapping::REVERSED_INFINITE => [0.0, factor],
                    DepthMapping { reversed: true, .. } => [factor, zero * factor],
                    DepthMapping { reversed: false, .. } => [-factor, zero * -factor],
                };
                m.z_axis.z = z_from_z as f32;
                m.w_axis.z = z_from_one as f32;
                m.z_axis.w = -1.0;
            }
            Projection::Orthographic { height } => {
                let scale_y = 2.0 / f64::from(height);
                m.x_axis.x = (scale_y / f64::from(aspect)) as f32;
                m.y_axis.y = scale_y as f32;
                let [z_at_0, z_at_1] = mapping.zero_and_one([near, far]);
                m.z_axis.z = (1.0 / (z_at_0 - z_at_1)) as f32;
                m.w_axis.z = (z_at_0 / (z_at_0 - z_at_1)) as f32;
                m.w_axis.w = 1.0;
            }
        }
        self.sub_view.map_or(m, |window| window.clip_from_clip() * m)
    }

    /// Whether z = 0 in clip space is the far plane instead of the near plane.
    pub(crate) fn has_zero_at_far(&self, mapping: DepthMapping) -> bool {
        let is_perspective = matches!(self.projection, Projection::Perspective { .. });
        if is_perspective { mapping.in_clip_space().is_reversed() } else { mapping.is_reversed() }
    }

    /// Returns the matrix from world space to clip space. `aspect` is width over height.
    #[cfg(test)]
    pub(crate) fn clip_from_world(&self, aspect: f32, mapping: DepthMapping) -> Mat4 {
        self.clip_from_view(aspect, mapping) * self.view_from_world()
    }

    /// Returns this view with eye, target and up vector mirrored in z. Its picture of the mirrored scene is this view's
    /// picture of the original scene with left and right swapped.
    pub fn mirrored_z(self) -> Self {
        let mirror = Vec3::new(1.0, 1.0, -1.0);
        Self { eye: self.eye * mirror, target: self.target * mirror, up: self.up * mirror, ..self }
    }

    /// Returns the height of the visible volume at the target's distance, in world units.
    pub(crate) fn visible_height(&self) -> f32 {
        match self.projection {
            Projection::Perspective { fov_y } => 2.0 * self.distance() * (fov_y * 0.5).tan(),
            Projection::Orthographic { height } => height,
        }
    }

    /// Returns this view as an orthographic or a perspective view. Objects at the target's distance keep their size in
    /// the picture.
    ///
    /// A view converted to perspective has the default field of view and a matching distance.
    pub fn with_orthographic(self, orthographic: bool) -> Self {
        match self.projection {
            Projection::Perspective { .. } if orthographic => {
                Self { projection: Projection::Orthographic { height: self.visible_height() }, ..self }
            }
            Projection::Orthographic { height } if !orthographic => self.perspective_of(height),
            _ => self,
        }
    }

    /// Returns the perspective view whose visible volume is `height` world units high at the target's distance. The
    /// near and far planes keep their world positions unless they would be behind or too close to the eye.
    fn perspective_of(self, height: f32) -> Self {
        let distance = (height * 0.5 / (DEFAULT_FOV_Y * 0.5).tan()).max(self.min_distance());
        let shift = distance - self.distance();
        let near = (self.near + shift).max(distance * 0.01);
        Self {
            eye: self.target - self.forward() * distance,
            projection: Projection::Perspective { fov_y: DEFAULT_FOV_Y },
            near,
            far: (self.far + shift).max(near * 2.0),
            ..self
        }
    }

    /// Checks that the view can be rendered. Returns an error if values are not finite or out of range, or if eye and
    /// target coincide.
    pub fn check(&self) -> Result<(), String> {
        let Self { eye, target, up, projection, near, far, sub_view: _ } = *self;
        if !(eye.is_finite() && target.is_finite() && up.is_finite()) {
            return Err("eye, target and up must be finite".to_owned());
        }
        if eye == target {
            return Err("eye and target are the same point".to_owned());
        }
        match projection {
            Projection::Perspective { fov_y } if !(fov_y > 0.0 && fov_y < PI) => {
                return Err(format!("fov_y_degrees must lie between 0 and 180, not {}", fov_y.to_degrees()));
            }
            Projection::Orthographic { height } if !(height > 0.0 && height.is_finite()) => {
                return Err(format!("the visible height must be above 0 and finite, not {height}"));
            }
            _ => {}
        }
        if !(near > 0.0 && far > near && far.is_finite()) {
            return Err(format!("near and far must satisfy 0 < near < far, not {near} and {far}"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec4Swizzles as _;

    use super::*;

    fn ndc(camera: &Camera, mapping: DepthMapping, p: Vec3) -> Vec3 {
        let clip = camera.clip_from_world(1.0, mapping) * p.extend(1.0);
        clip.xyz() / clip.w
    }

    #[test]
    fn near_and_far_planes_map_to_the_ends_of_the_depth_range() {
        for orthographic in [false, true] {
            let camera = Camera::look_at(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO).with_orthographic(orthographic);
            let near = camera.eye + camera.forward() * camera.near;
            let far = camera.eye + camera.forward() * camera.far;
            for (mapping, ends) in [(DepthMapping::STANDARD, [0.0, 1.0]), (DepthMapping::REVERSED, [1.0, 0.0])] {
                for (point, z) in [near, far].into_iter().zip(ends) {
                    let got = ndc(&camera, mapping, point).z;
                    assert!((got - z).abs() < 1e-5, "{orthographic} {mapping:?}: {got} for {z}");
                }
            }
        }
    }

    #[test]
    fn right_is_right_and_up_is_up() {
        let camera = Camera::look_at(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO);
        assert!(ndc(&camera, DepthMapping::STANDARD, Vec3::X * 0.1).x > 0.0);
        assert!(ndc(&camera, DepthMapping::STANDARD, Vec3::Y * 0.1).y > 0.0);
    }

    #[test]
    fn a_fitted_box_is_wholly_visible_at_any_size() {
        for scale in [1e-20_f32, 1.0, 1e30] {
            let bounds = Aabb { min: Vec3::splat(-scale), max: Vec3::new(scale, 2.0 * scale, 3.0 * scale) };
            let camera = Camera::fit(bounds, Vec3::new(1.0, 1.0, 1.0));
            for corner in bounds.corners() {
                let p = ndc(&camera, DepthMapping::STANDARD, corner);
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
    fn a_refitted_box_is_wholly_visible_in_pictures_of_any_shape() {
        let bounds = Aabb { min: Vec3::splat(-1.0), max: Vec3::new(1.0, 2.0, 3.0) };
        for (aspect, orthographic) in [0.05, 0.5, 1.0, 3.0].into_iter().flat_map(|a| [(a, false), (a, true)]) {
            let view = Camera::look_at(Vec3::ONE, Vec3::ZERO).with_orthographic(orthographic).refit(bounds, aspect);
            for corner in bounds.corners() {
                let clip = view.clip_from_world(aspect, DepthMapping::STANDARD) * corner.extend(1.0);
                let p = clip.xyz() / clip.w;
                assert!(p.abs().max_element() <= 1.0 && p.z >= 0.0, "{aspect} {orthographic}: {p}");
            }
        }
    }

    #[test]
    fn the_target_keeps_its_size_there_and_back_between_projections() {
        let mut view = Camera::look_at(Vec3::new(1.0, 2.0, 5.0), Vec3::X);
        for fov_y in [0.1, DEFAULT_FOV_Y, 2.5] {
            view.projection = Projection::Perspective { fov_y };
            let flat = view.with_orthographic(true);
            let back = flat.with_orthographic(false);
            for other in [flat, back] {
                assert!((other.visible_height() / view.visible_height() - 1.0).abs() < 1e-5, "{fov_y}: {other:?}");
                assert!(other.forward().distance(view.forward()) < 1e-5, "{fov_y}: {other:?}");
                assert_eq!(other.check(), Ok(()));
            }
        }
    }

    #[test]
    fn repeated_dollying_keeps_the_line_of_sight() {
        for target in [Vec3::ZERO, Vec3::new(3.0, -70.0, 0.1)] {
            for orthographic in [false, true] {
                let mut camera =
                    Camera::look_at(target + Vec3::new(1.0, 2.0, 5.0), target).with_orthographic(orthographic);
                let forward = camera.forward();
                for _ in 0..1000 {
                    camera.dolly(0.9);
                }
                assert!(camera.forward().dot(forward) > 0.99, "{target} {orthographic}: {}", camera.forward());
                assert!(camera.distance() < 0.01 && camera.visible_height() > 0.0);
                camera.dolly(2.0);
                assert!(camera.forward().dot(forward) > 0.99);
            }
        }
    }

    #[test]
    fn invalid_views_are_rejected() {
        let good = Camera::look_at(Vec3::Z, Vec3::ZERO);
        assert_eq!((good.check(), good.with_orthographic(true).check()), (Ok(()), Ok(())));
        for bad in [
            Camera { near: 0.0, ..good },
            Camera { far: good.near, ..good },
            Camera { far: f32::INFINITY, ..good },
            Camera { target: good.eye, ..good },
            Camera { up: Vec3::NAN, ..good },
            Camera { projection: Projection::Perspective { fov_y: PI }, ..good },
            Camera { projection: Projection::Orthographic { height: 0.0 }, ..good },
            Camera { projection: Projection::Orthographic { height: f32::INFINITY }, ..good },
        ] {
            assert!(bad.check().is_err(), "{bad:?}");
        }
    }
}
