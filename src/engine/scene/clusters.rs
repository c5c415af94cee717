//! Clusters of a mesh: runs of consecutive triangles, which are culled as a whole by their bounding box and the bounds
//! of their triangle planes.
//!
//! Triangles keep their order, because it decides depth ties and defines the triangle ids. Most meshes list neighbours
//! next to each other, so runs are spatially compact. Otherwise the boxes of the runs are nearly as large as the box of
//! the mesh, and nothing is culled. The only cost is then one box test per [`CLUSTER`] triangles.

use std::ops::Range;
use std::sync::Arc;

use glam::Vec3;

use crate::math::Aabb;
use crate::math::lanes::LANES;

/// Number of triangles per cluster, a multiple of the SIMD lane count.
pub(crate) const CLUSTER: usize = 128;

/// Number of vertices per block, which is processed or skipped as a whole; a multiple of the SIMD lane count.
pub(crate) const BLOCK: usize = 32;

/// Maximum number of block ranges per cluster. A cluster with more ranges gets a single one, from its first block to
/// its last. A cluster within one row of a grid mesh needs two ranges: one for each row of vertices.
const MAX_RANGES: usize = 8;

/// Minimum number of clusters per mesh. Smaller meshes have no clusters, because culling them would save little.
const MIN_CLUSTERS: usize = 4;

/// Bounding boxes of eight clusters in model space, in SIMD layout: minimum x, y, z, then maximum x, y, z.
pub(crate) type Boxes = [[[f32; LANES]; 3]; 2];

/// Bounds of the triangle planes of eight clusters in model space, in SIMD layout.
///
/// A plane is n·p = d, where the unit normal n points to the side from which the triangle appears counter-clockwise.
/// Triangles with two coincident corners are excluded, because they have no area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ClusterPlanes {
    /// Conservative lower and upper bounds of each component of the unit normals n.
    pub(crate) normals: [[[f32; LANES]; 3]; 2],
    /// Conservative lower and upper bounds of the plane offsets d, in model units.
    pub(crate) offsets: [[f32; LANES]; 2],
    /// Lower bound of the triangles' altitudes, in model units. The altitude is twice the area divided by the longest
    /// edge. The bound is 0, and the plane bounds are invalid, if a triangle is too thin for a reliable normal or has a
    /// non-finite corner, or if no triangle is usable.
    pub(crate) altitudes: [f32; LANES],
}

/// Clusters of one mesh, in the order of its triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Clusters {
    count: usize,
    triangles: usize,
    /// Boxes of eight clusters per entry. Unused lanes of the last entry repeat the box of the last cluster.
    boxes: Vec<Boxes>,
    /// Plane bounds of eight clusters per entry, in the order of `boxes`.
    planes: Vec<ClusterPlanes>,
    /// Ranges of vertex blocks, cluster by cluster, as [first block, one past the last block].
    blocks: Arc<[[u32; 2]]>,
    /// Index of each cluster's first range in `blocks`, followed by the total number of ranges.
    starts: Arc<[u32]>,
}

impl Clusters {
    /// Builds the clusters of a mesh. All vertex indices in `triangles` must be valid for `positions`.
    pub(super) fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        if triangles.len() < MIN_CLUSTERS * CLUSTER {
            return Self::default();
        }
        let (mut blocks, mut starts) = (Vec::new(), vec![0]);
        // Most recent cluster that referred to each block, counted from 1; 0 means none.
        let mut last = vec![0; positions.len().div_ceil(BLOCK)];
        let mut own = Vec::new();
        for (cluster, numbers) in (1..).zip(cluster_numbers(triangles)) {
            own.clear();
            for block in numbers.iter().map(|vertex| *vertex as usize / BLOCK) {
                if std::mem::replace(&mut last[block], cluster) != cluster {
                    own.push(block as u32);
                }
            }
            own.sort_unstable();
            push_ranges(&own, &mut blocks);
            starts.push(blocks.len() as u32);
        }
        let (blocks, starts) = (blocks.into(), starts.into());
        Self { blocks, starts, ..Self::default() }.moved(positions, triangles)
    }

    /// Returns the clusters of the mesh with other positions and the same triangles.
    pub(super) fn moved(&self, positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let (blocks, starts) = (Arc::clone(&self.blocks), Arc::clone(&self.starts));
        let count = starts.len().saturating_sub(1);
        let numbers = || cluster_numbers(triangles).take(count);
        let bounds: Vec<Aabb> =
            numbers().map(|numbers| visible_bounds(numbers.iter().map(|i| positions[*i as usize]))).collect();
        let plane_bounds: Vec<PlaneBounds> = numbers().map(|numbers| plane_bounds(positions, numbers)).collect();
        Self {
            count,
            triangles: if count == 0 { 0 } else { triangles.len() },
            boxes: bounds.chunks(LANES).map(boxes).collect(),
            planes: plane_bounds.chunks(LANES).map(planes).collect(),
            blocks,
            starts,
        }
    }

    /// Returns the number of clusters.
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    /// Whether the mesh has no clusters.
    pub(crate) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Returns the bounding boxes, with eight clusters per entry.
    pub(crate) fn boxes(&self) -> &[Boxes] {
        &self.boxes
    }

    /// Returns the bounds of the triangle planes, with eight clusters per entry.
    pub(crate) fn planes(&self) -> &[ClusterPlanes] {
        &self.planes
    }

    /// Returns the range of a cluster's triangles, as indices within the mesh.
    pub(crate) fn triangles(&self, cluster: usize) -> Range<usize> {
        cluster * CLUSTER..((cluster + 1) * CLUSTER).min(self.triangles)
    }

    /// Returns the ranges of vertex blocks that contain all vertices of a cluster. A block has [`BLOCK`] vertices.
    pub(crate) fn blocks(&self, cluster: usize) -> impl Iterator<Item = Range<usize>> {
        let own = self.starts[cluster] as usize..self.starts[cluster + 1] as usize;
        self.blocks[own].iter().map(|[first, end]| *first as usize..*end as usize)
    }

    /// Returns the heap memory used by the clusters, in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.boxes.capacity() * size_of::<Boxes>()
            + self.planes.capacity() * size_of::<ClusterPlanes>()
            + size_of_val(&*self.blocks)
            + size_of_val(&*self.starts)
    }
}

/// Returns the vertex indices of the triangles of each cluster.
fn cluster_numbers(triangles: &[[u32; 3]]) -> impl Iterator<Item = &[u32]> {
    triangles.chunks(CLUSTER).map(<[[u32; 3]]>::as_flattened)
}

/// Returns the bounding box of the points, or [`Aabb::EVERYTHING`] if a point is not finite. Infinite bounds prevent
/// the triangles from being culled as a whole, so that they reach the stage that rejects them.
pub(super) fn visible_bounds(points: impl IntoIterator<Item = Vec3>) -> Aabb {
    let (mut bounds, mut all_finite) = (Aabb::EMPTY, true);
    for point in points {
        all_finite &= point.is_finite();
        bounds = bounds.union(Aabb { min: point, max: point });
    }
    if all_finite { bounds } else { Aabb::EVERYTHING }
}

/// Appends ascending block indices as ranges of consecutive blocks. Merges more than [`MAX_RANGES`] ranges into one.
fn push_ranges(own: &[u32], ranges: &mut Vec<[u32; 2]>) {
    let first = ranges.len();
    for next in own.chunk_by(|a, b| a + 1 == *b) {
        ranges.push([next[0], next[next.len() - 1] + 1]);
    }
    if let [[start, _], .., [_, end]] = ranges[first..]
        && ranges.len() - first > MAX_RANGES
    {
        ranges.truncate(first);
        ranges.push([start, end]);
    }
}

/// Plane bounds of one cluster: the minimum of the normal's x, y, z and of the offset, the maximum of the same four,
/// and the minimum altitude.
type PlaneBounds = ([[f32; 4]; 2], f32);

/// Upper bound of the rounding error of each component of a unit normal. The rounding error of a plane offset d is at
/// most this constant times the sum of the absolute coordinates of the vertex from which d is computed.
///
/// In f64, the error of an edge cross product is at most 2⁻⁵⁰ of the product of the edge lengths. For a triangle that
/// is thicker than [`MIN_ALTITUDE_RATIO`], this error is at most `PLANE_ERROR` times the cross product. Rounding to f32
/// adds less.
const PLANE_ERROR: f64 = 1e-6;

/// Minimum of the coordinate sum by which [`PLANE_ERROR`] is multiplied for a plane offset. It keeps the product above
/// the rounding error of f32 near the origin.
const MIN_SIZE: f64 = 1e-30;

/// Ratio of altitude to longest edge at or below which a triangle is too thin for a reliable normal.
const MIN_ALTITUDE_RATIO: f64 = 1e-6;

/// Computes the plane bounds of triangles, given as a flat list of vertex indices.
fn plane_bounds(positions: &[Vec3], numbers: &[u32]) -> PlaneBounds {
    let (mut ends, mut altitude) = ([[f32::INFINITY; 4], [f32::NEG_INFINITY; 4]], f32::INFINITY);
    for corners in numbers.as_chunks::<3>().0 {
        let [a, b, c] = corners.map(|i| positions[i as usize]);
        if !(a.is_finite() && b.is_finite() && c.is_finite()) {
            altitude = 0.0;
            continue;
        }
        if a == b || b == c || c == a {
            continue;
        }
        let [a, b, c] = [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()];
        let doubled_area_normal = (b - a).cross(c - a);
        let doubled_area = doubled_area_normal.length();
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let own = doubled_area / longest;
        if own.is_nan() || own <= MIN_ALTITUDE_RATIO * longest {
            altitude = 0.0;
            continue;
        }
        let normal = doubled_area_normal / doubled_area;
        let size = a.abs().element_sum().max(MIN_SIZE);
        let plane = [(normal.x, 1.0), (normal.y, 1.0), (normal.z, 1.0), (normal.dot(a), size)];
        for (i, (at, size)) in plane.into_iter().enumerate() {
            ends[0][i] = ends[0][i].min((at - PLANE_ERROR * size) as f32);
            ends[1][i] = ends[1][i].max((at + PLANE_ERROR * size) as f32);
        }
        altitude = altitude.min((own * (1.0 - PLANE_ERROR)) as f32);
    }
    let is_told = ends.as_flattened().iter().all(|end| end.is_finite()) && altitude >= f32::MIN_POSITIVE;
    (ends, if is_told { altitude } else { 0.0 })
}

/// Converts the plane bounds of up to eight clusters to SIMD layout. Unused lanes repeat the last cluster.
fn planes(facing: &[PlaneBounds]) -> ClusterPlanes {
    let of = |lane: usize| facing[lane.min(facing.len() - 1)];
    let end = |end: usize, i: usize| std::array::from_fn(|lane| of(lane).0[end][i]);
    ClusterPlanes {
        normals: [0, 1].map(|at| [0, 1, 2].map(|axis| end(at, axis))),
        offsets: [0, 1].map(|at| end(at, 3)),
        altitudes: std::array::from_fn(|lane| of(lane).1),
    }
}

/// Converts up to eight boxes to SIMD layout. Unused lanes repeat the last box.
fn boxes(bounds: &[Aabb]) -> Boxes {
    let of = |lane: usize| bounds[lane.min(bounds.len() - 1)];
    let ends: [fn(Aabb) -> Vec3; 2] = [|bounds| bounds.min, |bounds| bounds.max];
    ends.map(|end| std::array::from_fn(|axis| std::array::from_fn(|lane| end(of(lane))[axis])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_triangle_is_within_the_box_and_the_vertices_of_its_cluster() {
        let mut random = fastrand::Rng::with_seed(9);
        for count in [MIN_CLUSTERS * CLUSTER, 9 * CLUSTER + 1, 17 * CLUSTER - 1] {
            let positions: Vec<Vec3> =
                (0..count).map(|_| Vec3::from_array(std::array::from_fn(|_| random.f32() - 0.5))).collect();
            let mut corner = |i: usize| (i + random.usize(..100)).min(count - 1) as u32;
            let triangles: Vec<[u32; 3]> = (0..count).map(|i| std::array::from_fn(|_| corner(i))).collect();
            let clusters = Clusters::new(&positions, &triangles);
            assert_eq!(clusters.len(), count.div_ceil(CLUSTER));
            let mut next = 0;
            for cluster in 0..clusters.len() {
                let own = clusters.triangles(cluster);
                assert_eq!(own.start, next);
                next = own.end;
                let [min, max] = clusters.boxes()[cluster / LANES]
                    .map(|end| Vec3::from_array(end.map(|axis| axis[cluster % LANES])));
                let mut seen = Aabb::EMPTY;
                for number in triangles[own].as_flattened() {
                    assert!(clusters.blocks(cluster).any(|blocks| blocks.contains(&(*number as usize / BLOCK))));
                    seen = seen.union(Aabb::around([positions[*number as usize]]));
                }
                assert_eq!(seen, Aabb { min, max });
            }
            assert_eq!(next, count);
        }
    }

    #[test]
    fn consecutive_blocks_form_one_range_and_too_many_ranges_are_merged() {
        let mut ranges = vec![[7, 9]];
        push_ranges(&[1, 2, 3, 5, 8, 9], &mut ranges);
        assert_eq!(ranges, [[7, 9], [1, 4], [5, 6], [8, 10]]);
        let mut ranges = vec![[7, 9]];
        push_ranges(&(0..2 * MAX_RANGES as u32 + 2).step_by(2).collect::<Vec<_>>(), &mut ranges);
        assert_eq!(ranges, [[7, 9], [0, 2 * MAX_RANGES as u32 + 1]]);
    }

    #[test]
    fn planes_are_within_their_bounds_and_slivers_have_none() {
        let positions =
            [[0.0, 0.0, 5.0], [2.0, 0.0, 5.0], [0.0, 1.0, 5.0], [0.0, 0.0, 5.0], [1.0, 1e-7, 5.0], [0.0, 1.0, 4.0]];
        let positions = positions.map(Vec3::from_array);
        let ([least, greatest], altitude) = plane_bounds(&positions, &[0, 1, 2, 0, 3, 1, 0, 1, 5]);
        let altitude_of_first = 2.0 / 5.0_f32.sqrt();
        assert!(altitude <= altitude_of_first && altitude > altitude_of_first - 1e-5, "{altitude}");
        // The first triangle faces along z, the last one at 45° between y and z.
        let half = 0.5_f64.sqrt();
        let exact = [(0.0, 0.0), (0.0, half), (half, 1.0), (5.0 * half, 5.0)];
        for (i, (from, to)) in exact.into_iter().enumerate() {
            assert!(f64::from(least[i]) < from && f64::from(greatest[i]) > to, "{i}: {} {}", least[i], greatest[i]);
            assert!(f64::from(least[i]) > from - 1e-5 && f64::from(greatest[i]) < to + 1e-5, "{i}");
        }
        assert_eq!(plane_bounds(&positions, &[0, 1, 2, 0, 1, 4]).1, 0.0);
        assert_eq!(plane_bounds(&positions, &[0, 3, 1]).1, 0.0, "no triangle with an area");
    }

    #[test]
    fn small_meshes_have_no_clusters() {
        let triangles = vec![[0, 1, 2]; MIN_CLUSTERS * CLUSTER - 1];
        assert!(Clusters::new(&[Vec3::ZERO, Vec3::X, Vec3::Y], &triangles).is_empty());
    }
}
