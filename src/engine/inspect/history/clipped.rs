//! Intersection of the line of sight through a pixel with a triangle that is not entirely between the near and far
//! planes.
//!
//! Projecting such a triangle would invert the part behind the eye. Homogeneous coordinates avoid the division (Olano
//! and Greer, "Triangle Scan Conversion using 2D Homogeneous Coordinates", Graphics Hardware 1997). Each edge of the
//! triangle and the eye span a plane. Three signs give the side of each plane on which the line of sight lies. The line
//! meets the triangle if no two of these signs are opposite.

use glam::{DVec2, DVec4, Vec4};

/// Intersection of a line of sight with a triangle in front of the eye, in clip space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Meeting {
    /// Clip-space z of the intersection, before the division by w.
    pub(super) z: f64,
    /// Clip-space w of the intersection, > 0. In perspective projections, this is the distance along the view axis.
    pub(super) w: f64,
    /// Whether the triangle is front-facing as seen from the eye.
    pub(super) shows_front: bool,
}

/// Intersects the line of sight through `ndc` (normalised device coordinates, y up) with a triangle in clip space.
/// Returns `None` if the line misses the triangle or meets it behind the eye.
pub(super) fn meeting(corners: [Vec4; 3], ndc: DVec2) -> Option<Meeting> {
    let corners = corners.map(Vec4::as_dvec4);
    // Shifts the corners in x and y so that the line of sight lies at the origin. The line meets the triangle if no two
    // of the three cross products have opposite signs.
    let [a, b, c] = corners.map(|p| DVec2::new(p.x, p.y) - ndc * p.w);
    let parts = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
    let sum: f64 = parts.iter().sum();
    let is_between = parts.iter().all(|part| *part >= 0.0) || parts.iter().all(|part| *part <= 0.0);
    if !is_between || sum == 0.0 || !sum.is_finite() {
        return None;
    }
    let point: DVec4 = corners.into_iter().zip(parts).map(|(corner, part)| corner * (part / sum)).sum();
    (point.w > 0.0).then_some(Meeting { z: point.z, w: point.w, shows_front: sum > 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a front-facing (counter-clockwise) triangle at distance `w` ahead of the eye, in clip space.
    fn facing(w: f32) -> [Vec4; 3] {
        [(-1.0, -1.0), (1.0, -1.0), (0.0, 1.0)].map(|(x, y)| Vec4::new(x, y, w - 0.5, w))
    }

    #[test]
    fn a_triangle_ahead_of_the_eye_is_intersected_where_it_lies() {
        let met = meeting(facing(0.25), DVec2::new(0.0, 0.0)).unwrap();
        assert_eq!((met.z, met.w, met.shows_front), (-0.25, 0.25, true));
        let [a, b, c] = facing(0.25);
        assert!(!meeting([a, c, b], DVec2::ZERO).unwrap().shows_front);
        assert_eq!(meeting(facing(0.25), DVec2::new(4.1, -4.0)), None, "past the corner at (4, −4)");
        assert!(meeting(facing(0.25), DVec2::new(3.9, -3.99)).is_some());
    }

    #[test]
    fn only_the_part_of_a_triangle_ahead_of_the_eye_is_intersected() {
        assert_eq!(meeting(facing(-0.25), DVec2::ZERO), None);
        // A triangle of the ground, 1 below the eye, which begins 1 behind the eye and ends 9 ahead of it.
        let ground =
            [Vec4::new(-9.0, -1.0, -2.0, -1.0), Vec4::new(9.0, -1.0, -2.0, -1.0), Vec4::new(0.0, -1.0, 8.0, 9.0)];
        let met = meeting(ground, DVec2::new(0.0, -1.0)).unwrap();
        assert!((met.w - 1.0).abs() < 1e-12 && met.z.abs() < 1e-12, "{met:?}");
        assert_eq!(meeting(ground, DVec2::new(0.0, 0.5)), None, "the sky");
    }
}
