//! Which clusters of a mesh are outside the view as a whole, and what of the mesh is left without them.
//!
//! A cluster is left out only if every triangle of it is found outside by the classic way too: all three corners beyond the
//! same plane, *by the coordinates that the pipeline computes*. Those are off from the exact ones by rounding. With u = 2⁻²⁴
//! the half of a float's last place, a component of a vertex v in clip space is a sum of four terms, each rounded once as a
//! product and at most three times in sums: it is off by at most 4u (1 + O(u)) · M, where M = Σ |mᵢ| |vᵢ| is that sum with every
//! term positive, and where products underflow by 3 · 2⁻¹⁵⁰ more. The distance from a plane is the difference of two
//! components, or a single one, in doubles: its sign is that of the exact difference. So if the exact distance is less than
//! −(8u · max M + 2⁻¹⁴⁷) for every point of a box, no vertex in it is found inside. [`ROUNDING`] and [`UNDERFLOW`] are more than
//! that by a factor of four and more, which covers the roundings of the test itself: it is computed in doubles. Over a box, an
//! affine function is greatest at a corner, which the signs of its coefficients name, and M is greatest at the largest
//! magnitudes on each axis.
//!
//! A vertex that overflows is no matter: its triangles are dropped because of it, whatever cluster they are in.

use std::ops::Range;

use glam::{Mat4, Vec4};

use super::super::clip::Plane;
use super::super::plan::Outside;
use super::super::vertex::{ROUNDING, UNDERFLOW};
use crate::math::lanes::*;
use crate::scene::Mesh;
use crate::scene::clusters::{BLOCK, Boxes, Clusters};

/// Ranges in ascending order with gaps between them: mostly one.
#[derive(Clone, Debug)]
pub(super) enum Ranges {
    One(Range<usize>),
    Some(Vec<Range<usize>>),
}

impl Ranges {
    /// All of them.
    pub(super) fn as_slice(&self) -> &[Range<usize>] {
        match self {
            Self::One(range) => std::slice::from_ref(range),
            Self::Some(ranges) => ranges,
        }
    }

    /// Numbers in all of them.
    pub(super) fn count(&self) -> usize {
        self.as_slice().iter().map(Range::len).sum()
    }
}

/// What of a mesh is drawn.
#[derive(Clone, Debug)]
pub(super) struct Kept {
    pub(super) triangles: Ranges,
    /// All that these refer to, and perhaps others.
    pub(super) vertices: Ranges,
}

impl Kept {
    /// All of a mesh.
    pub(super) fn all(mesh: &Mesh) -> Self {
        Self { triangles: Ranges::One(0..mesh.triangles.len()), vertices: Ranges::One(0..mesh.positions.len()) }
    }

    /// A mesh without the clusters that are outside, and how many those are.
    pub(super) fn without_outside(mesh: &Mesh, clip_from_model: Mat4, lanes: Lanes) -> (Self, Outside) {
        let clusters = mesh.clusters();
        let beyond = beyond(clusters, clip_from_model, lanes);
        let left_out = beyond.iter().filter(|beyond| **beyond).count();
        let outside = Outside { left_out, all: clusters.len() };
        if left_out == 0 {
            return (Self::all(mesh), outside);
        }
        let inside = || (0..clusters.len()).filter(|cluster| !beyond[*cluster]);
        let mut triangles: Vec<Range<usize>> = Vec::new();
        for next in inside().map(|cluster| clusters.triangles(cluster)) {
            match triangles.last_mut() {
                Some(last) if last.end == next.start => last.end = next.end,
                _ => triangles.push(next),
            }
        }
        let vertices = union(inside().flat_map(|cluster| clusters.blocks(cluster)), mesh.positions.len());
        (Self { triangles: Ranges::Some(triangles), vertices: Ranges::Some(vertices) }, outside)
    }
}

/// Ranges of `len` vertices that hold all of some blocks, given as ranges that may overlap. In time that grows with the number
/// of ranges and of blocks, however long they are.
fn union(ranges: impl Iterator<Item = Range<usize>>, len: usize) -> Vec<Range<usize>> {
    // How many ranges begin at a block, less those that end before it.
    let mut changes = vec![0_i32; len.div_ceil(BLOCK) + 1];
    for range in ranges {
        changes[range.start] += 1;
        changes[range.end] -= 1;
    }
    let (mut out, mut open): (Vec<Range<usize>>, i32) = (Vec::new(), 0);
    for (block, change) in changes.into_iter().enumerate() {
        let before = open > 0;
        open += change;
        let at = (block * BLOCK).min(len);
        match (before, open > 0) {
            (false, true) => out.push(at..len),
            (true, false) => {
                if let Some(last) = out.last_mut() {
                    last.end = at;
                }
            }
            _ => {}
        }
    }
    out
}

/// The distance from a plane as an affine function of model space, and what its terms may be as large as.
#[derive(Clone, Copy, Debug)]
struct Distance {
    coefficients: [f64; 4],
    magnitudes: [f64; 4],
}

impl Distance {
    fn new(plane: Plane, clip_from_model: Mat4) -> Self {
        let columns: [Vec4; 4] = std::array::from_fn(|column| clip_from_model.col(column));
        Self {
            coefficients: columns.map(|column| plane.distance(column, 1.0)),
            magnitudes: columns.map(|column| plane.magnitude(column.abs().as_dvec4())),
        }
    }
}

/// The planes that clusters are looked at from. That of the eye would tell nothing which those of depth do not: where w < 0,
/// z ≥ 0 and w ≥ z are not both met.
const PLANES: [Plane; 6] = [Plane::Near, Plane::Far, Plane::Left, Plane::Right, Plane::Bottom, Plane::Top];

/// For each cluster whether it is outside as a whole.
fn beyond(clusters: &Clusters, clip_from_model: Mat4, lanes: Lanes) -> Vec<bool> {
    let distances = PLANES.map(|plane| Distance::new(plane, clip_from_model));
    let mut out = vec![false; clusters.len()];
    on_lanes!(lanes, simd => {
        for (boxes, out) in clusters.boxes().iter().zip(out.chunks_mut(LANES)) {
            let bits = beyond_any(simd, boxes, &distances);
            for (lane, out) in out.iter_mut().enumerate() {
                *out = bits >> lane & 1 != 0;
            }
        }
    });
    out
}

/// Bits of those of eight boxes all of whose vertices the pipeline finds beyond one of some planes.
#[inline(always)]
fn beyond_any<S: Simd>(simd: S, boxes: &Boxes, distances: &[Distance; PLANES.len()]) -> u64 {
    let [least, greatest] = each!(end in [0, 1] => {
        each!(axis in [0, 1, 2] => widen(simd, F32::load_array(simd, boxes[end][axis])))
    });
    let farthest = each!(axis in [0, 1, 2] => least[axis].abs().max(greatest[axis].abs()));
    let mut bits = 0;
    for Distance { coefficients, magnitudes } in distances {
        let mut most = F64::splat(simd, coefficients[3]);
        let mut magnitude = F64::splat(simd, magnitudes[3]);
        for axis in 0..3 {
            let corner = if coefficients[axis] > 0.0 { greatest[axis] } else { least[axis] };
            most += corner * coefficients[axis];
            magnitude += farthest[axis] * magnitudes[axis];
        }
        let slack = magnitude * ROUNDING + UNDERFLOW;
        bits |= most.simd_lt(-slack).to_bitmask();
    }
    bits
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// Eight boxes of two corners each.
    fn boxes(corners: &[[Vec3; 2]; LANES]) -> Boxes {
        let end = |end: fn(Vec3, Vec3) -> Vec3| -> [[f32; LANES]; 3] {
            std::array::from_fn(|axis| corners.map(|[a, b]| end(a, b)[axis]))
        };
        [end(Vec3::min), end(Vec3::max)]
    }

    fn bits(corners: &[[Vec3; 2]; LANES], matrix: Mat4, lanes: Lanes) -> u64 {
        let distances = PLANES.map(|plane| Distance::new(plane, matrix));
        let boxes = boxes(corners);
        on_lanes!(lanes, simd => beyond_any(simd, &boxes, &distances))
    }

    /// Whether the pipeline finds some vertices beyond one plane.
    fn is_outside(vertices: &[Vec3], matrix: Mat4) -> bool {
        let clip = || vertices.iter().map(|vertex| matrix * vertex.extend(1.0));
        Plane::ALL.iter().any(|plane| clip().all(|position| plane.distance(position, 1.0) < 0.0))
    }

    /// Matrices and boxes next to a plane: made so that the exact distance is zero or nearly so, at scales from where products
    /// underflow to where they are huge.
    #[test]
    fn what_is_left_out_has_all_its_vertices_beyond_a_plane() {
        let mut random = fastrand::Rng::with_seed(21);
        let (mut left_out, mut kept_though_outside) = (0, 0);
        for round in 0..6000 {
            let mut number = || random.f32() * 2.0 - 1.0;
            let mut matrix = Mat4::from_cols_array(&std::array::from_fn(|_| number()));
            let (plane, scale) =
                (PLANES[round % PLANES.len()], [1e-42_f32, 1e-30, 1e-4, 1.0, 1e3, 1e18][round / 6 % 6]);
            let corners: [[Vec3; 2]; LANES] = std::array::from_fn(|_| {
                let a = Vec3::from_array(std::array::from_fn(|_| number()));
                let edge = Vec3::from_array(std::array::from_fn(|_| number())) * 1e-6;
                [a, a + edge]
            });
            // The plane goes through the first box, as nearly as floats can tell.
            let at = matrix * corners[0][0].extend(1.0);
            let off = plane.distance(at, 1.0) as f32 * [1.0, 1.000_001, 0.999_999][round / 36 % 3];
            match plane {
                Plane::Near => matrix.w_axis.z -= off,
                Plane::Left => matrix.w_axis.x -= off,
                Plane::Right => matrix.w_axis.x += off,
                Plane::Bottom => matrix.w_axis.y -= off,
                Plane::Top => matrix.w_axis.y += off,
                _ => matrix.w_axis.z += off,
            }
            let matrix = matrix * scale;
            for lanes in Lanes::all() {
                let bits = bits(&corners, matrix, lanes);
                for (lane, [a, b]) in corners.iter().enumerate() {
                    let mix = |t: f32| *a + (*b - *a) * t;
                    let all = [*a, *b, Vec3::new(a.x, b.y, a.z), Vec3::new(b.x, a.y, b.z), mix(0.25), mix(0.5)];
                    let outside = is_outside(&all, matrix);
                    if bits >> lane & 1 != 0 {
                        assert!(outside, "{} {plane:?} {matrix:?} {a:?} {b:?}", lanes.name());
                        left_out += 1;
                    } else if outside {
                        kept_though_outside += 1;
                    }
                }
            }
        }
        // Of boxes next to a plane, and where all numbers underflow, some are kept; far fewer than are left out.
        assert!(left_out > 3 * kept_though_outside && kept_though_outside > 0, "{left_out} {kept_though_outside}");
    }

    #[test]
    fn numbers_that_are_none_leave_nothing_out() {
        let corners = [[Vec3::splat(5.0), Vec3::splat(6.0)]; LANES];
        for lanes in Lanes::all() {
            assert_eq!(bits(&corners, Mat4::IDENTITY, lanes), 0xff);
            assert_eq!(bits(&corners, Mat4::IDENTITY * f32::NAN, lanes), 0);
            assert_eq!(bits(&corners, Mat4::IDENTITY * f32::INFINITY, lanes), 0);
        }
    }

    #[test]
    fn blocks_are_joined() {
        /// Both by their ends.
        fn joined<const N: usize>(ranges: [[usize; 2]; N], len: usize) -> Vec<[usize; 2]> {
            let joined = union(ranges.into_iter().map(|[start, end]| start..end), len);
            joined.into_iter().map(|range| [range.start, range.end]).collect()
        }
        let len = 10 * BLOCK + 1;
        assert_eq!(joined([], len), [[0; 2]; 0]);
        assert_eq!(joined([[0, 1]], len), [[0, BLOCK]]);
        assert_eq!(joined([[9, 11], [0, 1]], len), [[0, BLOCK], [9 * BLOCK, len]]);
        assert_eq!(joined([[0, 2], [2, 3]], len), [[0, 3 * BLOCK]]);
        assert_eq!(joined([[0, 9], [2, 3], [4, 5]], len), [[0, 9 * BLOCK]]);
        assert_eq!(joined([[0, 1]], 5), [[0, 5]]);
    }
}
