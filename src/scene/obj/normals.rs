//! Normals for corners that come without one.
//!
//! In: positions and triangles, each with an area. Out: unit normals, and their numbers in the corners. A corner's
//! normal is the mean of the normals of the faces around its vertex, weighted by their angles there (Thürmer and
//! Wüthrich, "Computing Vertex Normals from Polygonal Facets", 1998), of those faces only that turn away from its own
//! by no more than [`CREASE_DEGREES`]: so a box keeps its edges and a bunny is smooth. Faces are neighbours where
//! they share a vertex in the file, across objects and materials, so no seam shows where the material changes.
//!
//! Comparing every face around a vertex with every other is quadratic. Around a crowded vertex (the tip of a fan of
//! thousands) faces of nearly one direction are therefore put together first, which bounds the work.

use glam::{DVec3, Vec3};

use super::faces::{Corner, NONE};
use crate::math::unit_or;

/// Largest angle between faces that are shaded as one surface.
const CREASE_DEGREES: f64 = 45.0;

/// Faces around a vertex from which on nearly equal directions are put together.
const CROWD: usize = 32;

/// Largest angle between directions that are put together; not 300 directions can all differ by more.
const CROWD_DEGREES: f64 = 15.0;

/// Gives a normal to every corner without one: adds them to `normals` and writes their numbers into `triangles`.
pub(super) fn fill(positions: &[Vec3], triangles: &mut [[Corner; 3]], normals: &mut Vec<Vec3>) {
    if triangles.as_flattened().iter().all(|corner| corner.normal != NONE) {
        return;
    }
    let faces: Vec<Vec3> = triangles.iter().map(|t| face_normal(positions, t)).collect();
    let incidence = Incidence::new(positions.len(), triangles.as_flattened());
    for vertex in 0..positions.len() {
        let corners = incidence.corners_at(vertex);
        if corners.iter().all(|c| triangles.as_flattened()[*c as usize].normal != NONE) {
            continue;
        }
        let weighted = corners.iter().map(|corner| {
            let (triangle, k) = (*corner as usize / 3, *corner as usize % 3);
            (faces[triangle].as_dvec3(), angle(positions, &triangles[triangle], k))
        });
        let (directions, membership) = gather(weighted, corners.len());
        let first = normals.len();
        let numbers: Vec<u32> = directions.iter().map(|d| number_of(d.smooth(&directions), first, normals)).collect();
        for (corner, direction) in corners.iter().zip(membership) {
            let corner = &mut triangles.as_flattened_mut()[*corner as usize];
            if corner.normal == NONE {
                corner.normal = numbers[direction];
            }
        }
    }
}

fn face_normal(positions: &[Vec3], triangle: &[Corner; 3]) -> Vec3 {
    let [a, b, c] = triangle.map(|corner| positions[corner.position as usize].as_dvec3());
    unit_or((b - a).cross(c - a), Vec3::Z)
}

/// Angle of the triangle at its corner `k`, radians.
fn angle(positions: &[Vec3], triangle: &[Corner; 3], k: usize) -> f64 {
    let at = |i: usize| positions[triangle[i % 3].position as usize].as_dvec3();
    (at(k + 1) - at(k)).angle_between(at(k + 2) - at(k))
}

/// The number of `normal` among those from `first` on, adding it if it is new.
fn number_of(normal: Vec3, first: usize, normals: &mut Vec<Vec3>) -> u32 {
    let known = normals[first..].iter().position(|n| *n == normal);
    let number = known.map_or(normals.len(), |offset| first + offset);
    if known.is_none() {
        normals.push(normal);
    }
    number as u32
}

/// Faces around one vertex that point (nearly) the same way.
struct Direction {
    unit: DVec3,
    /// Sum of the faces' unit normals, each times its angle at the vertex.
    weighted: DVec3,
}

impl Direction {
    /// Unit mean over all directions on this one's side of a crease.
    fn smooth(&self, all: &[Self]) -> Vec3 {
        let limit = CREASE_DEGREES.to_radians().cos();
        let sum = all.iter().filter(|d| d.unit.dot(self.unit) >= limit).map(|d| d.weighted).sum();
        unit_or(sum, self.unit.as_vec3())
    }
}

/// The directions among `count` faces, given as (unit normal, weight), and for each face the direction it went to.
fn gather(faces: impl Iterator<Item = (DVec3, f64)>, count: usize) -> (Vec<Direction>, Vec<usize>) {
    let limit = if count > CROWD { CROWD_DEGREES.to_radians().cos() } else { f64::INFINITY };
    let mut directions: Vec<Direction> = Vec::new();
    let membership = faces
        .map(|(unit, weight)| {
            let near = directions.iter().position(|d| d.unit.dot(unit) >= limit);
            let place = near.unwrap_or(directions.len());
            match directions.get_mut(place) {
                Some(direction) => direction.weighted += unit * weight,
                None => directions.push(Direction { unit, weighted: unit * weight }),
            }
            place
        })
        .collect();
    (directions, membership)
}

/// Which corners meet at each vertex: one flat list, and where each vertex's part of it starts.
struct Incidence {
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl Incidence {
    fn new(vertices: usize, corners: &[Corner]) -> Self {
        let mut ends = vec![0_u32; vertices + 1];
        for corner in corners {
            ends[corner.position as usize] += 1;
        }
        let mut sum = 0;
        for end in &mut ends {
            sum += *end;
            *end = sum;
        }
        // Filled from the back, each end moves down to be its start.
        let mut order = vec![0_u32; corners.len()];
        for (number, corner) in corners.iter().enumerate().rev() {
            let start = &mut ends[corner.position as usize];
            *start -= 1;
            order[*start as usize] = number as u32;
        }
        Self { starts: ends, corners: order }
    }

    fn corners_at(&self, vertex: usize) -> &[u32] {
        &self.corners[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    fn filled(positions: &[Vec3], triangles: &[[u32; 3]]) -> (Vec<[Corner; 3]>, Vec<Vec3>) {
        let corner = |position| Corner { position, uv: NONE, normal: NONE };
        let mut triangles: Vec<_> = triangles.iter().map(|t| t.map(corner)).collect();
        let mut normals = Vec::new();
        fill(positions, &mut triangles, &mut normals);
        (triangles, normals)
    }

    /// Two squares that share the edge x = 0, the second raised by `degrees` around it.
    fn hinge(degrees: f32) -> (Vec<[Corner; 3]>, Vec<Vec3>) {
        let (rise, run) = degrees.to_radians().sin_cos();
        let xz = [[-1.0, 0.0], [0.0, 0.0], [run, rise]];
        let positions: Vec<_> = xz.iter().flat_map(|[x, z]| [0.0, 1.0].map(|y| Vec3::new(*x, y, *z))).collect();
        filled(&positions, &[[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]])
    }

    #[test]
    fn a_gentle_bend_is_smooth_and_a_sharp_one_keeps_its_edge() {
        let at_the_edge = |(triangles, normals): (Vec<[Corner; 3]>, Vec<Vec3>)| {
            let of = |c: Corner| normals[c.normal as usize];
            (of(triangles[0][1]), of(triangles[2][0]))
        };
        let (left, right) = at_the_edge(hinge(30.0));
        assert_eq!(left, right);
        let (left, right) = at_the_edge(hinge(90.0));
        assert!((left - Vec3::Z).length() < 1e-6 && (right - Vec3::NEG_X).length() < 1e-6, "{left} {right}");
    }

    #[test]
    fn a_flat_sheet_has_one_normal_per_vertex() {
        let (_, normals) = hinge(0.0);
        assert_eq!(normals, vec![Vec3::Z; 6]);
    }

    #[test]
    fn given_normals_are_left_alone() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let corner = |position, normal| Corner { position, uv: NONE, normal };
        let mut triangles = [[corner(0, 0), corner(1, NONE), corner(2, 0)]];
        let mut normals = vec![Vec3::X];
        fill(&positions, &mut triangles, &mut normals);
        assert_eq!(triangles[0].map(|c| normals[c.normal as usize]), [Vec3::X, Vec3::Z, Vec3::X]);
    }

    #[test]
    fn a_vertex_shared_by_a_hundred_thousand_faces_has_few_directions() {
        let count = 100_000;
        let around = (0..count).map(|i| (i as f32 / count as f32 * std::f32::consts::TAU).sin_cos());
        let positions: Vec<_> =
            std::iter::once(Vec3::Z * 3.0).chain(around.map(|(y, x)| Vec3::new(x, y, 0.0))).collect();
        let triangles: Vec<_> = (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % count]).collect();
        let (triangles, normals) = filled(&positions, &triangles);
        let tip: HashSet<u32> = triangles.iter().map(|[tip, ..]| tip.normal).collect();
        assert!(tip.len() < 300, "{}", tip.len());
        assert!(normals.iter().all(|n| n.is_normalized()));
    }
}
