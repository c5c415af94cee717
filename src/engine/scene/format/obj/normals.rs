//! Computation of normals for face corners without one.
//!
//! Input: positions and triangles with a non-zero area. Output: unit normals, whose indices are stored in the corners.
//! A corner's normal is the mean of the normals of the faces around its vertex. Each face is weighted by its angle at
//! the vertex (Thürmer and Wüthrich, "Computing Vertex Normals from Polygonal Facets", 1998). Only faces of the same
//! smoothing group (`s`) contribute. In a file without smoothing groups, only faces within [`CREASE_DEGREES`] of the
//! corner's own face contribute, so that a box keeps its hard edges and a curved surface is smooth. Faces are
//! neighbours if they share a vertex in the file, even across objects and materials, so that no seam is visible where
//! the material changes.
//!
//! Comparing every face around a vertex with every other is quadratic. If many faces share a vertex, such as the tip of
//! a fan of thousands of triangles, faces with nearly equal directions are merged first, which bounds the work.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::attributes::AttributeLists;
use super::faces::{FaceCorner, Faces, NONE, Smoothing};
use super::vertices::Stopped;
use crate::math::unit_or;
use crate::scene::load::{Load, bytes_of};

/// Maximum angle between faces that are shaded as one smooth surface, in degrees.
pub(super) const CREASE_DEGREES: f64 = 45.0;

/// Number of vertices between progress reports.
const VERTICES_PER_REPORT: usize = 1 << 14;

/// Number of faces around a vertex above which faces of nearly equal direction are merged.
const CROWD: usize = 32;

/// Maximum angle between face directions that are merged, in degrees. Fewer than 300 directions can all differ from
/// each other by more than this angle.
const CROWD_DEGREES: f64 = 15.0;

/// Computes a normal for every corner without one, appends it to `lists` and stores its index in `faces`. Returns
/// whether the crease angle determined which edges are hard.
///
/// # Errors
/// Returns an error if the load is cancelled or memory does not suffice.
pub(super) fn fill(lists: &mut AttributeLists, faces: &mut Faces, load: &mut Load<'_>) -> Result<bool, Stopped> {
    let AttributeLists { positions, normals, .. } = lists;
    let Faces { triangles, smoothing, .. } = faces;
    if triangles.as_flattened().iter().all(|corner| corner.normal != NONE) {
        return Ok(false);
    }
    let given = normals.capacity();
    let transient = bytes_of::<Vec3>(triangles.len()) + bytes_of::<u32>(positions.len() + 3 * triangles.len());
    let most = bytes_of::<Vec3>(3 * triangles.len());
    load.charge(transient.saturating_add(most))?;
    let mut uses_crease = false;
    let smoothing_of = |triangle: usize| {
        let later = smoothing.partition_point(|run| run.first <= triangle);
        if later == 0 { Smoothing::Crease } else { smoothing[later - 1].smoothing }
    };
    let faces: Vec<Vec3> = triangles.iter().map(|t| face_normal(positions, t)).collect();
    if !smoothing.is_empty() {
        flat(&faces, triangles, normals, |triangle| smoothing_of(triangle) == Smoothing::Off);
    }
    let incidence = Incidence::new(positions.len(), triangles.as_flattened());
    for vertex in 0..positions.len() {
        if vertex.is_multiple_of(VERTICES_PER_REPORT) {
            load.advance(vertex as f32 / positions.len() as f32)?;
        }
        let corners = incidence.corners_at(vertex);
        if corners.iter().all(|c| triangles.as_flattened()[*c as usize].normal != NONE) {
            continue;
        }
        let weighted = corners.iter().map(|corner| {
            let (triangle, k) = (*corner as usize / 3, *corner as usize % 3);
            let weight = angle(positions, &triangles[triangle], k);
            Face { unit: faces[triangle].as_dvec3(), weight, smoothing: smoothing_of(triangle) }
        });
        let (directions, membership) = merge_directions(weighted, corners.len());
        let first = normals.len();
        let mut number = |direction: &MergedNormal| match direction.smoothing {
            Smoothing::Crease => number_of(direction.smooth(&directions), first, normals),
            Smoothing::Off | Smoothing::Group(_) => {
                normals.push(unit_or(direction.weighted, direction.unit.as_vec3()));
                normals.len() as u32 - 1
            }
        };
        let numbers: Vec<u32> = directions.iter().map(&mut number).collect();
        uses_crease |= has_crease(&directions);
        for (corner, direction) in corners.iter().zip(membership) {
            let corner = &mut triangles.as_flattened_mut()[*corner as usize];
            if corner.normal == NONE {
                corner.normal = numbers[direction];
            }
        }
    }
    load.release(transient + most);
    load.charge(bytes_of::<Vec3>(normals.capacity() - given))?;
    Ok(uses_crease)
}

/// Assigns the face normals to the corners of all triangles for which `chosen` returns `true`, except to corners that
/// already have a normal. Consecutive corners with equal face normals share one entry of `normals`.
fn flat(faces: &[Vec3], triangles: &mut [[FaceCorner; 3]], normals: &mut Vec<Vec3>, chosen: impl Fn(usize) -> bool) {
    for (place, triangle) in triangles.iter_mut().enumerate().filter(|(place, _)| chosen(*place)) {
        for corner in triangle.iter_mut().filter(|corner| corner.normal == NONE) {
            if normals.last() != Some(&faces[place]) {
                normals.push(faces[place]);
            }
            corner.normal = normals.len() as u32 - 1;
        }
    }
}

fn face_normal(positions: &[Vec3], triangle: &[FaceCorner; 3]) -> Vec3 {
    let [a, b, c] = triangle.map(|corner| positions[corner.position as usize].as_dvec3());
    let normal = (b - a).cross(c - a);
    if normal.is_finite() { unit_or(normal, Vec3::Z) } else { Vec3::Z }
}

/// Returns the angle of a triangle at its corner `k`, in radians.
fn angle(positions: &[Vec3], triangle: &[FaceCorner; 3], k: usize) -> f64 {
    let at = |i: usize| positions[triangle[i % 3].position as usize].as_dvec3();
    let angle = (at(k + 1) - at(k)).angle_between(at(k + 2) - at(k));
    // A triangle with a non-finite corner has no weight.
    if angle.is_finite() { angle } else { 0.0 }
}

/// Returns the index of `normal` in `normals`, searching from index `first` on. Appends `normal` if it is not found.
fn number_of(normal: Vec3, first: usize, normals: &mut Vec<Vec3>) -> u32 {
    let known = normals[first..].iter().position(|n| *n == normal);
    let number = known.map_or(normals.len(), |offset| first + offset);
    if known.is_none() {
        normals.push(normal);
    }
    number as u32
}

/// Face adjacent to a vertex, with its contribution to the vertex normal.
struct Face {
    /// Unit normal of the face.
    unit: DVec3,
    /// Angle of the face at the vertex, in radians, by which its normal is weighted.
    weight: f64,
    smoothing: Smoothing,
}

/// Faces adjacent to one vertex that are merged because their directions are nearly equal or they share a smoothing
/// group.
struct MergedNormal {
    unit: DVec3,
    smoothing: Smoothing,
    /// Sum of the faces' unit normals, each weighted by the face's angle at the vertex, in radians.
    weighted: DVec3,
}

/// Two directions count as equal if the cosine of the angle between them is at least 1 minus this tolerance for
/// rounding.
const FLAT: f64 = 1e-6;

/// Whether two faces without a smoothing group differ in direction, so that the crease angle determines whether their
/// edge is hard.
fn has_crease(directions: &[MergedNormal]) -> bool {
    let mut creased = directions.iter().filter(|direction| direction.smoothing == Smoothing::Crease);
    creased.next().is_some_and(|first| creased.any(|other| other.unit.dot(first.unit) < 1.0 - FLAT))
}

impl MergedNormal {
    /// Returns the normalised sum of the weighted normals in `all` that have the same smoothing as this normal and
    /// whose direction differs from it by at most the crease angle.
    fn smooth(&self, all: &[Self]) -> Vec3 {
        let limit = CREASE_DEGREES.to_radians().cos();
        let alike = |d: &&Self| d.smoothing == self.smoothing && d.unit.dot(self.unit) >= limit;
        let sum = all.iter().filter(alike).map(|d| d.weighted).sum();
        unit_or(sum, self.unit.as_vec3())
    }
}

/// Merges the `count` faces adjacent to a vertex if they share a smoothing group or, for more than [`CROWD`] faces, if
/// their directions are nearly equal. Returns the merged normals and, for each face, the index of its merged normal.
fn merge_directions(faces: impl Iterator<Item = Face>, count: usize) -> (Vec<MergedNormal>, Vec<usize>) {
    let limit = if count > CROWD { CROWD_DEGREES.to_radians().cos() } else { f64::INFINITY };
    let mut directions: Vec<MergedNormal> = Vec::new();
    let mut groups: HashMap<i64, usize> = HashMap::new();
    let membership = faces
        .map(|Face { unit, weight, smoothing }| {
            let near = match smoothing {
                Smoothing::Crease => {
                    directions.iter().position(|d| d.smoothing == smoothing && d.unit.dot(unit) >= limit)
                }
                // The corners of these faces already have their face normals.
                Smoothing::Off => directions.iter().position(|d| d.smoothing == smoothing),
                Smoothing::Group(group) => match directions.last() {
                    Some(last) if last.smoothing == smoothing => Some(directions.len() - 1),
                    _ => groups.get(&group).copied(),
                },
            };
            let place = near.unwrap_or(directions.len());
            match directions.get_mut(place) {
                Some(direction) => direction.weighted += unit * weight,
                None => {
                    directions.push(MergedNormal { unit, smoothing, weighted: unit * weight });
                    if let Smoothing::Group(group) = smoothing {
                        groups.insert(group, place);
                    }
                }
            }
            place
        })
        .collect();
    (directions, membership)
}

/// Triangle corners at each vertex, as one flat list, with the start of each vertex's range in the list.
struct Incidence {
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl Incidence {
    fn new(vertices: usize, corners: &[FaceCorner]) -> Self {
        let mut ends = vec![0_u32; vertices + 1];
        for corner in corners {
            ends[corner.position as usize] += 1;
        }
        let mut sum = 0;
        for end in &mut ends {
            sum += *end;
            *end = sum;
        }
        // Each vertex's range is filled from its end, and its entry in `ends` moves down to the start of the range.
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

    use std::path::Path;

    use super::super::attributes::tests::unlimited;
    use super::super::faces::SmoothingRun;
    use super::*;

    fn filled(positions: &[Vec3], triangles: &[[u32; 3]]) -> (Vec<[FaceCorner; 3]>, Vec<Vec3>) {
        smoothed(positions, triangles, &[])
    }

    /// Computes normals with the given smoothing of each triangle. If `smoothing` is empty, the crease angle decides.
    fn smoothed(
        positions: &[Vec3],
        triangles: &[[u32; 3]],
        smoothing: &[Smoothing],
    ) -> (Vec<[FaceCorner; 3]>, Vec<Vec3>) {
        let corner = |position| FaceCorner { position, uv: NONE, normal: NONE };
        let runs = smoothing.iter().enumerate().map(|(first, smoothing)| SmoothingRun { first, smoothing: *smoothing });
        let mut lists = AttributeLists { positions: positions.to_vec(), ..AttributeLists::default() };
        let mut faces = Faces {
            triangles: triangles.iter().map(|t| t.map(corner)).collect(),
            smoothing: runs.collect(),
            ..Faces::default()
        };
        fill(&mut lists, &mut faces, &mut unlimited(Path::new("a.obj"))).unwrap();
        (faces.triangles, lists.normals)
    }

    /// Returns the corners and normals of two squares that share the edge x = 0. The second square is rotated by
    /// `degrees` around that edge.
    fn hinge(degrees: f32) -> (Vec<[FaceCorner; 3]>, Vec<Vec3>) {
        let (rise, run) = degrees.to_radians().sin_cos();
        let xz = [[-1.0, 0.0], [0.0, 0.0], [run, rise]];
        let positions: Vec<_> = xz.iter().flat_map(|[x, z]| [0.0, 1.0].map(|y| Vec3::new(*x, y, *z))).collect();
        filled(&positions, &[[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]])
    }

    #[test]
    fn a_gentle_bend_is_smooth_and_a_sharp_one_keeps_its_edge() {
        let at_the_edge = |(triangles, normals): (Vec<[FaceCorner; 3]>, Vec<Vec3>)| {
            let of = |c: FaceCorner| normals[c.normal as usize];
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
        for smoothing in [Smoothing::Crease, Smoothing::Off, Smoothing::Group(1)] {
            let corner = |position, normal| FaceCorner { position, uv: NONE, normal };
            let mut lists = AttributeLists {
                positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
                normals: vec![Vec3::X],
                ..AttributeLists::default()
            };
            let mut faces = Faces {
                triangles: vec![[corner(0, 0), corner(1, NONE), corner(2, 0)]],
                smoothing: vec![SmoothingRun { first: 0, smoothing }],
                ..Faces::default()
            };
            fill(&mut lists, &mut faces, &mut unlimited(Path::new("a.obj"))).unwrap();
            let normals = faces.triangles[0].map(|c| lists.normals[c.normal as usize]);
            assert_eq!(normals, [Vec3::X, Vec3::Z, Vec3::X], "{smoothing:?}");
        }
    }

    #[test]
    fn smoothing_groups_decide_whatever_the_angle() {
        // Two pairs of triangles meet at the edge x = 0.
        for degrees in [10.0_f32, 45.0, 90.0, 150.0] {
            let (rise, run) = degrees.to_radians().sin_cos();
            let xz = [[-1.0, 0.0], [0.0, 0.0], [run, rise]];
            let positions: Vec<_> = xz.iter().flat_map(|[x, z]| [0.0, 1.0].map(|y| Vec3::new(*x, y, *z))).collect();
            let triangles = [[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]];
            let at_the_edge = |[left, right]: [Smoothing; 2]| {
                let (triangles, normals) = smoothed(&positions, &triangles, &[left, left, right, right]);
                [triangles[0][1], triangles[2][0]].map(|corner| normals[corner.normal as usize])
            };
            let half = degrees.to_radians() / 2.0;
            let between = Vec3::new(-half.sin(), 0.0, half.cos());
            let tilted = Vec3::new(-rise, 0.0, run);
            let group = Smoothing::Group;
            for (smoothing, expected) in [
                ([group(1), group(1)], [between; 2]),
                ([group(1), group(2)], [Vec3::Z, tilted]),
                ([group(1), Smoothing::Off], [Vec3::Z, tilted]),
                ([Smoothing::Off, Smoothing::Off], [Vec3::Z, tilted]),
            ] {
                for (found, expected) in at_the_edge(smoothing).into_iter().zip(expected) {
                    assert!((found - expected).length() < 1e-5, "{degrees}° {smoothing:?}: {found} {expected}");
                }
            }
        }
    }

    #[test]
    fn corners_that_are_not_finite_leave_their_neighbours_alone() {
        let broken =
            [Vec3::NAN, Vec3::splat(f32::INFINITY), Vec3::new(f32::NAN, 1.0, 2.0), Vec3::new(1.0, 2.0, f32::NAN)];
        let positions = [[Vec3::ZERO, Vec3::X, Vec3::Y].as_slice(), &broken].concat();
        let (triangles, normals) = filled(&positions, &[[0, 1, 2], [0, 2, 3], [1, 4, 2], [0, 2, 5], [1, 6, 2]]);
        assert_eq!(triangles[0].map(|corner| normals[corner.normal as usize]), [Vec3::Z; 3]);
        assert!(normals.iter().all(|normal| normal.is_normalized()));
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
