//! Camera, projection and viewport.

use glam::{DVec2, DVec3, DVec4};

use super::{Fault, Faults, Size};

/// Subpixel positions per pixel along each axis.
const SUBPIXELS: f64 = 256.0;

/// Perspective camera in world space: right-handed, y up, looking along −z.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    pub(crate) eye: DVec3,
    pub(crate) target: DVec3,
    /// Vertical field of view in degrees.
    pub(crate) fov_y_degrees: f64,
    /// Distance of the near plane in world units.
    pub(crate) near: f64,
    /// Distance of the far plane in world units.
    pub(crate) far: f64,
}

/// Transformation from world space to the screen.
pub(crate) struct View {
    camera: Camera,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// Factors of x and y in clip space.
    scale: DVec2,
    size: DVec2,
    snaps: bool,
}

impl View {
    /// Returns the view of `camera` for a picture of the given size, with world y upwards on the screen.
    pub(crate) fn new(camera: Camera, size: Size, faults: Faults) -> Self {
        let forward = (camera.target - camera.eye).normalize();
        let right = forward.cross(DVec3::Y).normalize();
        let up = right.cross(forward);
        let size = DVec2::new(size.width as f64, size.height as f64);
        let aspect = size.x / size.y;
        let focal = 1.0 / (camera.fov_y_degrees.to_radians() / 2.0).tan();
        let focal = if faults.has(Fault::FovHorizontal) { focal * aspect } else { focal };
        let aspect = match () {
            () if faults.has(Fault::AspectIgnored) => 1.0,
            () if faults.has(Fault::AspectInverse) => 1.0 / aspect,
            () => aspect,
        };
        Self {
            camera,
            right: if faults.has(Fault::LeftHanded) { -right } else { right },
            up,
            forward,
            scale: DVec2::new(focal / aspect, focal),
            size,
            snaps: !faults.has(Fault::NoSnapping),
        }
    }

    /// Returns the distance of a point in world space along the line of sight; negative behind the eye.
    pub(crate) fn distance(&self, point: DVec3) -> f64 {
        (point - self.camera.eye).dot(self.forward)
    }

    /// Returns the clip-space position of a point in world space: w is its distance, z/w is 0 at the near plane and 1
    /// at the far plane.
    pub(crate) fn to_clip(&self, point: DVec3) -> DVec4 {
        let offset = point - self.camera.eye;
        let Camera { near, far, .. } = self.camera;
        let w = self.distance(point);
        let z = far * (w - near) / (far - near);
        DVec4::new(offset.dot(self.right) * self.scale.x, offset.dot(self.up) * self.scale.y, z, w)
    }

    /// Returns the screen position, in pixels with y downwards, of a clip-space position with w ≠ 0.
    pub(crate) fn to_screen(&self, clip: DVec4) -> DVec2 {
        let screen = DVec2::new(1.0 + clip.x / clip.w, 1.0 - clip.y / clip.w) * 0.5 * self.size;
        if self.snaps { screen.map(|value| (value * SUBPIXELS).round_ties_even() / SUBPIXELS) } else { screen }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Size = Size { width: 640, height: 360 };

    fn view(faults: &[Fault]) -> View {
        let camera = Camera { eye: DVec3::Z * 5.0, target: DVec3::ZERO, fov_y_degrees: 90.0, near: 1.0, far: 9.0 };
        View::new(camera, SIZE, Faults::new(faults))
    }

    fn screen(point: DVec3, faults: &[Fault]) -> [f64; 2] {
        let view = view(faults);
        view.to_screen(view.to_clip(point)).to_array()
    }

    #[test]
    fn points_lie_where_the_field_of_view_says() {
        // At distance 5, half of the 90° field is 5 units: 180 px.
        let point = DVec3::new(1.0, 2.0, 0.0);
        assert_eq!(screen(point, &[]), [356.0, 108.0]);
        assert_eq!(screen(point, &[Fault::LeftHanded]), [284.0, 108.0]);
        assert_eq!(screen(point, &[Fault::AspectIgnored]), [384.0, 108.0]);
        assert_eq!(screen(point, &[Fault::FovHorizontal]), [384.0, 52.0]);
    }

    #[test]
    fn depth_runs_from_the_near_to_the_far_plane() {
        for (z, depth) in [(4.0, 0.0), (-4.0, 1.0), (0.0, 0.9)] {
            let clip = view(&[]).to_clip(DVec3::new(0.3, -0.2, z));
            assert!((clip.z / clip.w - depth).abs() < 1e-15, "{clip}");
        }
    }

    #[test]
    fn corners_are_snapped_to_a_grid() {
        let point = DVec3::new(1.0 / 36.0 / 512.0 * 1.1, 0.0, 0.0);
        assert_eq!(screen(point, &[]), [320.0 + 1.0 / 256.0, 180.0]);
        assert_ne!(screen(point, &[]), screen(point, &[Fault::NoSnapping]));
    }
}
