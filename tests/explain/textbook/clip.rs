//! Clipping against the near plane (Sutherland and Hodgman 1974).

use glam::{DVec2, DVec3, DVec4};

/// Corner of a triangle in clip space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    /// Clip-space position; z is 0 at the near plane.
    pub(crate) position: DVec4,
    /// Texture coordinates, v upwards.
    pub(crate) uv: DVec2,
    /// Normal in world space.
    pub(crate) normal: DVec3,
}

impl Corner {
    /// Returns the point at `t`, 0…1, on the way to `other`.
    fn lerp(&self, other: &Self, t: f64) -> Self {
        Self {
            position: self.position.lerp(other.position, t),
            uv: self.uv.lerp(other.uv, t),
            normal: self.normal.lerp(other.normal, t),
        }
    }
}

/// Returns the part of a triangle in front of the near plane, as triangles of the same winding.
pub(crate) fn near(triangle: [Corner; 3]) -> Vec<[Corner; 3]> {
    let mut polygon = Vec::with_capacity(4);
    for index in 0..3 {
        let (from, to) = (&triangle[index], &triangle[(index + 1) % 3]);
        let (inside, next_inside) = (from.position.z >= 0.0, to.position.z >= 0.0);
        if inside {
            polygon.push(*from);
        }
        if inside != next_inside {
            polygon.push(from.lerp(to, from.position.z / (from.position.z - to.position.z)));
        }
    }
    (2..polygon.len()).map(|last| [polygon[0], polygon[last - 1], polygon[last]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a triangle whose corners have the given z, and their x and y as texture coordinates.
    fn triangle(z: [f64; 3]) -> [Corner; 3] {
        let corner = |x: f64, y: f64, z: f64| Corner {
            position: DVec4::new(x, y, z, z + 1.0),
            uv: DVec2::new(x, y),
            normal: DVec3::Z,
        };
        [corner(0.0, 0.0, z[0]), corner(4.0, 0.0, z[1]), corner(0.0, 4.0, z[2])]
    }

    fn uvs(z: [f64; 3]) -> Vec<[[f64; 2]; 3]> {
        near(triangle(z)).iter().map(|piece| piece.map(|corner| corner.uv.to_array())).collect()
    }

    #[test]
    fn triangles_in_front_stay_and_those_behind_vanish() {
        assert_eq!(uvs([1.0, 2.0, 3.0]), [[[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]]]);
        assert!(uvs([-1.0, -2.0, -3.0]).is_empty());
    }

    #[test]
    fn one_corner_behind_leaves_a_quadrilateral() {
        // The cuts lie at a quarter of the edges from corner 0.
        assert_eq!(uvs([-1.0, 3.0, 3.0]), [[[1.0, 0.0], [4.0, 0.0], [0.0, 4.0]], [[1.0, 0.0], [0.0, 4.0], [0.0, 1.0]]]);
    }

    #[test]
    fn two_corners_behind_leave_a_triangle() {
        assert_eq!(uvs([3.0, -1.0, -3.0]), [[[0.0, 0.0], [3.0, 0.0], [0.0, 2.0]]]);
    }
}
