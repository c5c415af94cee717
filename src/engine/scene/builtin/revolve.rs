//! Surfaces of revolution: a profile in the half plane (radius, height), revolved around the y axis.
//!
//! The profile is a path from the top down, with the solid on its right. It consists of lines and arcs with given
//! endpoints, so pieces meet exactly and a solid closes without rounding errors. Every piece has its own normals: a
//! joint is smooth where tangents agree and sharp elsewhere. u runs once around the axis, to the right as seen from
//! outside. v is the normalised arc length down the profile.

use std::f32::consts::TAU;

use glam::{Mat2, Vec2, Vec3};

use crate::scene::MeshData;

/// Point of a profile, as (radius, height).
#[derive(Clone, Copy)]
struct ProfilePoint {
    at: Vec2,
    /// Unit normal, pointing away from the solid.
    normal: Vec2,
}

/// Profile of a surface of revolution, as a path from the top down.
pub(super) struct Profile {
    end: Vec2,
    points: Vec<ProfilePoint>,
}

impl Profile {
    /// Starts a profile at (`radius`, `height`).
    pub(super) fn from(radius: f32, height: f32) -> Self {
        Self { end: Vec2::new(radius, height), points: Vec::new() }
    }

    /// Appends a straight segment to (`radius`, `height`).
    pub(super) fn line_to(mut self, radius: f32, height: f32) -> Self {
        let to = Vec2::new(radius, height);
        let normal = (to - self.end).perp().normalize();
        self.points.extend([self.end, to].map(|at| ProfilePoint { at, normal }));
        self.end = to;
        self
    }

    /// Appends a circular arc of `steps` chords to (`radius`, `height`).
    ///
    /// `sweep_degrees` is the angle of the arc: a positive, clockwise arc bulges outwards, a negative one inwards.
    pub(super) fn arc_to(mut self, radius: f32, height: f32, sweep_degrees: f32, steps: u32) -> Self {
        let (from, to) = (self.end, Vec2::new(radius, height));
        let sweep = sweep_degrees.to_radians();
        // The centre lies on the chord's bisector, on the right of an arc that turns clockwise by at most 180°.
        let center = (from + to) * 0.5 - (to - from).perp() * (0.5 / (sweep * 0.5).tan());
        for step in 0..=steps {
            let spoke = Mat2::from_angle(-sweep * step as f32 / steps as f32) * (from - center);
            let at = match step {
                0 => from,
                _ if step == steps => to,
                _ => center + spoke,
            };
            self.points.push(ProfilePoint { at, normal: spoke.normalize() * sweep.signum() });
        }
        self.end = to;
        self
    }

    /// Returns the mesh that the profile sweeps in one full turn, with `segments` slices.
    pub(super) fn revolve(&self, name: &str, segments: u32) -> MeshData {
        let mut mesh = MeshData { name: name.to_owned(), ..MeshData::default() };
        for (point, v) in self.points.iter().zip(self.lengths()) {
            for segment in 0..=segments {
                push_vertex(&mut mesh, point, segment, segments, v);
            }
        }
        let row = segments + 1;
        for (i, pair) in self.points.windows(2).enumerate() {
            let [above, below] = [pair[0].at, pair[1].at];
            if above == below {
                continue;
            }
            for segment in 0..segments {
                let a = i as u32 * row + segment;
                let [b, c, d] = [a + row, a + row + 1, a + 1];
                // A strip that ends on the axis has one triangle per slice instead of two.
                match (above.x == 0.0, below.x == 0.0) {
                    (true, _) => mesh.triangles.push([a, b, c]),
                    (_, true) => mesh.triangles.push([a, b, d]),
                    _ => mesh.triangles.extend([[a, b, c], [a, c, d]]),
                }
            }
        }
        mesh
    }

    /// Returns the normalised arc length at each point of the profile, from 0 to 1.
    fn lengths(&self) -> Vec<f32> {
        let mut length = 0.0;
        let mut previous = self.points.first().map_or(Vec2::ZERO, |p| p.at);
        let lengths: Vec<f32> = self
            .points
            .iter()
            .map(|p| {
                length += p.at.distance(previous);
                previous = p.at;
                length
            })
            .collect();
        lengths.into_iter().map(|l| l / length).collect()
    }
}

/// Adds the vertex of a profile point, rotated around the axis to boundary `segment` of `segments` slices. On the axis,
/// each slice has its own vertex, in the middle of the slice.
fn push_vertex(mesh: &mut MeshData, point: &ProfilePoint, segment: u32, segments: u32, v: f32) {
    let on_axis = point.at.x == 0.0;
    let turn = segment as f32 + if on_axis { 0.5 } else { 0.0 };
    // The last column uses the angle of the first, so that the seam closes exactly.
    let (sin, cos) = (turn % segments as f32 / segments as f32 * TAU).sin_cos();
    mesh.positions.push(Vec3::new(point.at.x * sin, point.at.y, point.at.x * cos));
    mesh.normals.push(Vec3::new(point.normal.x * sin, point.normal.y, point.normal.x * cos));
    mesh.uvs.push(Vec2::new(turn / segments as f32, v));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_circle_is_a_sphere() {
        let mesh = Profile::from(0.0, 1.0).arc_to(0.0, -1.0, 180.0, 8).revolve("sphere", 12);
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            assert!((position.length() - 1.0).abs() < 1e-6 && position.distance(*normal) < 1e-6);
        }
        assert_eq!(mesh.triangles.len(), 12 * (2 * 8 - 2), "poles have one triangle per slice");
    }

    #[test]
    fn a_hollow_arc_has_its_normals_towards_its_centre() {
        let profile = Profile::from(1.0, 1.0).arc_to(2.0, 0.0, -90.0, 4);
        for point in &profile.points {
            let to_center = Vec2::new(2.0, 1.0) - point.at;
            assert!(point.normal.distance(to_center) < 1e-6, "{:?}", point.at);
        }
    }

    #[test]
    fn v_grows_with_length_from_zero_to_one() {
        let lengths = Profile::from(0.0, 1.0).line_to(1.0, 1.0).line_to(1.0, -2.0).lengths();
        assert_eq!(lengths, [0.0, 0.25, 0.25, 1.0]);
    }
}
