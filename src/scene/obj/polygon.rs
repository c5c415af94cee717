//! From a polygon in space to triangles.
//!
//! In: the corners of one face, in order. Out: triples of corner numbers, turning as the face does. The face is laid
//! flat along its normal by Newell's method (Sutherland, Sproull and Schumacker, 1974), which also suits corners that
//! do not quite lie in a plane. A fan is taken where every triangle of it has positive area, which is linear and
//! keeps corners in the middle of an edge; else ears are clipped (Meisters, 1975; Held, 2001, by the crate `earcut`),
//! so that concave faces keep their outline. Triangles without area are left out: they cover nothing. A face so
//! far from flat that its projection crosses itself becomes a plain fan, which at least leaves no hole.
//! All in f64, where the products of f32 coordinates neither overflow nor vanish.

use earcut::Earcut;
use glam::{DVec2, DVec3, Vec3};

/// Corners from which a fan is tried: one may lie on a straight edge, where its fan would have a triangle without area.
const FAN_APEXES: usize = 4;

/// Most corners of a face whose ears are clipped: for outlines that cross themselves the time grows faster than they do.
const MAX_EAR_CORNERS: usize = 1 << 16;

/// Largest relative difference in area between a face and its triangles that counts as rounding.
const AREA_TOLERANCE: f64 = 1e-6;

/// Area relative to the face's, below which a triangle of it is rounding.
const SLIVER: f64 = 1e-14;

/// How well triangles stand for a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// They cover just what it covers.
    Whole,
    /// There are none: its corners lie on a line or a point, or it crosses itself such that its areas cancel.
    NoArea,
    /// It crosses itself; they cover roughly what it covers.
    Crossing,
    /// There are none: it has too many corners for a face that is no fan.
    TooLarge,
}

/// Height of a corner above the plane, relative to the root of the area, from which on a face is not flat.
const FLATNESS: f64 = 1e-4;

/// A face on its plane.
struct Flat {
    /// Twice its area; 0 if it has no normal.
    doubled_area: f64,
    /// Largest distance of a corner from the plane through the first.
    height: f64,
}

/// Turns polygons into triangles and keeps its buffers between them.
#[derive(Default)]
pub(super) struct Triangulator {
    flat: Vec<DVec2>,
    earcut: Earcut<f64>,
    ears: Vec<u32>,
}

impl Triangulator {
    /// Replaces `triangles` by those of the polygon with these corners, given as numbers of corners.
    pub(super) fn triangulate(&mut self, corners: &[Vec3], triangles: &mut Vec<[u32; 3]>) -> Outcome {
        triangles.clear();
        let Flat { doubled_area, height } = self.lay_flat(corners);
        if doubled_area <= 0.0 {
            return Outcome::NoArea;
        }
        let count = corners.len();
        let least = SLIVER * doubled_area;
        if let Some(apex) = (0..count.min(FAN_APEXES)).find(|apex| self.is_fan(*apex, least)) {
            triangles.extend(fan(apex, count).map(|t| t.map(|corner| corner as u32)));
            return Outcome::Whole;
        }
        if count > MAX_EAR_CORNERS {
            return Outcome::TooLarge;
        }
        let outcome = self.clip_ears(doubled_area, least, triangles);
        // What the ears leave out has no area on the plane, but may have one in space and leave a hole.
        if triangles.len() < count - 2 && height > FLATNESS * doubled_area.sqrt() {
            let has_area = |[a, b, c]: &[usize; 3]| {
                let [a, b, c] = [a, b, c].map(|corner| corners[*corner].as_dvec3());
                (b - a).cross(c - a) != DVec3::ZERO
            };
            triangles.clear();
            triangles.extend(fan(0, count).filter(has_area).map(|t| t.map(|corner| corner as u32)));
            return Outcome::Whole;
        }
        outcome
    }

    /// Projects the corners along their normal, counter-clockwise.
    ///
    /// Along the normal and not along the nearest axis: corners that do not lie in a plane would fold over each other.
    fn lay_flat(&mut self, corners: &[Vec3]) -> Flat {
        let origin = corners.first().map_or(DVec3::ZERO, |c| c.as_dvec3());
        let relative = |i: usize| corners[i % corners.len()].as_dvec3() - origin;
        let normal: DVec3 = (0..corners.len()).map(|i| relative(i).cross(relative(i + 1))).sum();
        let Some(unit) = (normal / normal.abs().max_element()).try_normalize() else {
            return Flat { doubled_area: 0.0, height: 0.0 };
        };
        let (u, v) = unit.any_orthonormal_pair();
        self.flat.clear();
        self.flat.extend((0..corners.len()).map(|i| DVec2::new(relative(i).dot(u), relative(i).dot(v))));
        let height = (0..corners.len()).map(|i| relative(i).dot(unit).abs()).fold(0.0, f64::max);
        Flat { doubled_area: normal.dot(unit), height }
    }

    fn doubled_area(&self, [a, b, c]: [usize; 3]) -> f64 {
        (self.flat[b] - self.flat[a]).perp_dot(self.flat[c] - self.flat[a])
    }

    /// Whether all triangles of the fan from `apex` turn as the polygon does, with more than `least` doubled area.
    fn is_fan(&self, apex: usize, least: f64) -> bool {
        fan(apex, self.flat.len()).all(|triangle| self.doubled_area(triangle) > least)
    }

    fn clip_ears(&mut self, doubled_area: f64, least: f64, triangles: &mut Vec<[u32; 3]>) -> Outcome {
        self.earcut.earcut(self.flat.iter().map(DVec2::to_array), &[], &mut self.ears);
        let mut covered = 0.0;
        for &[a, b, c] in self.ears.as_chunks::<3>().0 {
            let area = self.doubled_area([a, b, c].map(|corner| corner as usize));
            covered += area.abs();
            if area > least {
                triangles.push([a, b, c]);
            } else if area < -least {
                triangles.push([a, c, b]);
            }
        }
        if triangles.is_empty() {
            Outcome::NoArea
        } else if (covered - doubled_area).abs() <= AREA_TOLERANCE * doubled_area {
            Outcome::Whole
        } else {
            Outcome::Crossing
        }
    }
}

/// The triangles of a fan from corner `apex` of `count`.
fn fan(apex: usize, count: usize) -> impl Iterator<Item = [usize; 3]> {
    (1..count - 1).map(move |i| [apex, (apex + i) % count, (apex + i + 1) % count])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangulate(corners: &[Vec3]) -> (Vec<[u32; 3]>, Outcome) {
        let mut triangles = Vec::new();
        let outcome = Triangulator::default().triangulate(corners, &mut triangles);
        (triangles, outcome)
    }

    fn area_vector(corners: &[Vec3], triangles: &[[u32; 3]]) -> Vec3 {
        let corner = |i: u32| corners[i as usize];
        triangles.iter().map(|[a, b, c]| (corner(*b) - corner(*a)).cross(corner(*c) - corner(*a)) * 0.5).sum()
    }

    fn area(corners: &[Vec3], triangles: &[[u32; 3]]) -> f32 {
        let one = |t: &[u32; 3]| area_vector(corners, std::slice::from_ref(t)).length();
        triangles.iter().map(one).sum()
    }

    fn flat(points: &[[f32; 2]]) -> Vec<Vec3> {
        points.iter().map(|[x, y]| Vec3::new(*x, *y, 0.0)).collect()
    }

    #[test]
    fn a_concave_polygon_keeps_its_area_and_its_side_in_every_direction() {
        let arrow = flat(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]]);
        for turn in 0..24 {
            let rotation = glam::Quat::from_scaled_axis(Vec3::new(0.3, 0.5, 0.8) * turn as f32);
            let corners: Vec<_> = arrow.iter().map(|c| rotation * *c).collect();
            let (triangles, outcome) = triangulate(&corners);
            assert_eq!((triangles.len(), outcome), (3, Outcome::Whole));
            assert!((area(&corners, &triangles) - 10.0).abs() < 1e-4);
            assert!((area_vector(&corners, &triangles) - rotation * Vec3::Z * 10.0).length() < 1e-4);
        }
    }

    #[test]
    fn a_corner_in_the_middle_of_an_edge_is_kept() {
        let (triangles, _) = triangulate(&flat(&[[1.0, 0.0], [2.0, 0.0], [0.0, 2.0], [0.0, 0.0]]));
        let used = |corner: u32| triangles.iter().flatten().any(|c| *c == corner);
        assert!((0..4).all(used), "{triangles:?}");
    }

    #[test]
    fn a_convex_polygon_is_a_fan_from_its_first_corner() {
        let square = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(triangulate(&square), (vec![[0, 1, 2], [0, 2, 3]], Outcome::Whole));
    }

    #[test]
    fn corners_on_a_line_or_a_point_give_nothing() {
        for points in [[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], [[1.0, 1.0]; 3], [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]]] {
            assert_eq!(triangulate(&flat(&points)), (vec![], Outcome::NoArea));
        }
    }

    #[test]
    fn a_star_that_crosses_itself_is_reported() {
        let star: Vec<_> = (0..5)
            .map(|i| (i as f32 * 2.0 * std::f32::consts::TAU / 5.0).sin_cos())
            .map(|(y, x)| Vec3::new(x, y, 0.0))
            .collect();
        assert_eq!(triangulate(&star).1, Outcome::Crossing);
    }

    #[test]
    fn a_giant_polygon_that_is_no_fan_is_left_out_at_once() {
        let zigzag = (0..200_000_u64).map(|i| [(i * 7919 % 10_007) as f32, (i * 104_729 % 10_009) as f32]);
        assert_eq!(triangulate(&flat(&zigzag.collect::<Vec<_>>())), (vec![], Outcome::TooLarge));
    }

    #[test]
    fn extreme_sizes_neither_overflow_nor_vanish() {
        for scale in [1e-38, 1e38] {
            let corners = flat(&[[0.0, 0.0], [scale, 0.0], [scale, scale], [0.5 * scale, 0.1 * scale], [0.0, scale]]);
            assert_eq!(triangulate(&corners).0.len(), 3);
        }
    }

    #[test]
    fn a_comb_with_twenty_thousand_corners_is_whole() {
        let teeth = (0..10_000).flat_map(|i| [[i as f32, 0.0], [i as f32 + 0.5, 5.0]]);
        let corners: Vec<_> = teeth.chain([[10_000.0, -1.0], [0.0, -1.0]]).collect::<Vec<_>>();
        let reversed: Vec<_> = flat(&corners).into_iter().rev().collect();
        let (triangles, outcome) = triangulate(&reversed);
        assert_eq!((triangles.len(), outcome), (20_000, Outcome::Whole));
    }
}
