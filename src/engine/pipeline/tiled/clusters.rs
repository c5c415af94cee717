//! Cluster culling: finds the clusters of a mesh that cannot be visible, and the ranges of the mesh that remain. A
//! cluster is culled if it is outside the view or back-facing. With front-face culling, “back-facing” refers to the
//! culled side.
//!
//! A cluster is culled only if the classic (scalar) path also drops every triangle of it, *with the rounded numbers
//! that the pipeline computes*. Vertices that overflow need no special treatment, because their triangles are dropped
//! anyway.
//!
//! **Outside**: all vertices are beyond the same plane. Computed coordinates differ from the exact ones by rounding.
//! Let u = 2⁻²⁴ be the unit roundoff of f32. A clip-space component of a vertex v is a sum of four terms. Each term is
//! rounded once as a product and at most three times in sums. The component is off by at most 4u (1 + O(u)) · M, where
//! M = Σ |mᵢ| |vᵢ| is that sum with every term positive. If products underflow, it is off by 3 · 2⁻¹⁵⁰ more. The
//! distance from a plane is a single component or the difference of two. The difference is computed in doubles, so it
//! has the sign of the exact difference of these components. Therefore, if the exact distance is less than −8u · max M
//! − 2⁻¹⁴⁷ for every point of a box, every vertex in the box is outside according to the pipeline's computation.
//! [`ROUNDING`] and [`UNDERFLOW`] exceed these terms by at least a factor of four. This covers the rounding of the
//! culling test itself, which is computed in doubles. Over a box, an affine function has its maximum at the corner that
//! the signs of its coefficients select. M has its maximum where the magnitude of each coordinate is largest.
//!
//! **Back-facing**: the bounds are derived in [`back_facing`].
//!
//! [`ROUNDING`]: crate::pipeline::vertex::ROUNDING
//! [`UNDERFLOW`]: crate::pipeline::vertex::UNDERFLOW

mod affine;
mod back_facing;

use std::ops::Range;

use affine::{Affine, EightBoxes, PLANES};
use back_facing::BackFacingTest;
use glam::Mat4;

use super::super::plan::{Containment, CullStats};
use super::super::settings::Culling;
use super::super::viewport::Viewport;
use crate::math::lanes::*;
use crate::scene::Mesh;
use crate::scene::clusters::{BLOCK, Boxes, ClusterPlanes, Clusters};

/// Disjoint index ranges in ascending order; in most cases there is only one.
#[derive(Clone, Debug)]
pub(super) enum Ranges {
    One(Range<usize>),
    Some(Vec<Range<usize>>),
}

impl Ranges {
    /// Returns the ranges as a slice.
    pub(super) fn as_slice(&self) -> &[Range<usize>] {
        match self {
            Self::One(range) => std::slice::from_ref(range),
            Self::Some(ranges) => ranges,
        }
    }

    /// Returns the total length of the ranges.
    pub(super) fn count(&self) -> usize {
        self.as_slice().iter().map(Range::len).sum()
    }
}

/// Parts of a mesh that remain after cluster culling.
#[derive(Clone, Debug)]
pub(super) struct VisibleClusters {
    pub(super) triangles: Ranges,
    /// Ranges of vertices that include all vertices of the remaining triangles, and possibly others.
    pub(super) vertices: Ranges,
}

impl VisibleClusters {
    /// Returns all triangles and vertices of a mesh.
    pub(super) fn all(mesh: &Mesh) -> Self {
        Self { triangles: Ranges::One(0..mesh.triangles.len()), vertices: Ranges::One(0..mesh.positions.len()) }
    }

    /// Culls the clusters of a mesh. Returns the parts that remain, and the number of clusters culled for each reason.
    pub(super) fn cull_clusters(mesh: &Mesh, view: &ClusterCulling, lanes: Lanes) -> (Self, CullStats) {
        let clusters = mesh.clusters();
        let fates = fates(clusters, view, lanes);
        let count = |fate| fates.iter().filter(|other| **other == fate).count();
        let unseen = CullStats {
            outside: count(ClusterFate::Outside),
            turned_away: count(ClusterFate::BackFacing),
            all: clusters.len(),
        };
        if unseen.culled() == 0 {
            return (Self::all(mesh), unseen);
        }
        let kept = || (0..clusters.len()).filter(|cluster| fates[*cluster] == ClusterFate::Kept);
        let mut triangles: Vec<Range<usize>> = Vec::new();
        for next in kept().map(|cluster| clusters.triangles(cluster)) {
            match triangles.last_mut() {
                Some(last) if last.end == next.start => last.end = next.end,
                _ => triangles.push(next),
            }
        }
        let vertices = union(kept().flat_map(|cluster| clusters.blocks(cluster)), mesh.positions.len());
        (Self { triangles: Ranges::Some(triangles), vertices: Ranges::Some(vertices) }, unseen)
    }
}

/// Result of the culling tests of a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ClusterFate {
    /// The cluster may be visible, so its triangles are processed.
    Kept,
    /// The cluster lies entirely beyond one clip plane.
    Outside,
    /// All triangles of the cluster are removed by face culling.
    BackFacing,
}

/// Merges ranges of vertex blocks, which may overlap, into disjoint ranges of vertices. The mesh has `len` vertices.
/// The running time is proportional to the number of ranges plus the number of blocks in the mesh.
fn union(ranges: impl Iterator<Item = Range<usize>>, len: usize) -> Vec<Range<usize>> {
    // For each block, the number of ranges that begin with it minus the number of ranges whose last block is the one
    // before it.
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

/// Cluster culling tests of one mesh in one view.
#[derive(Clone, Debug)]
pub(super) struct ClusterCulling {
    /// Whether all of the mesh is inside the view, so that no cluster is outside and no triangle is clipped.
    all_inside: bool,
    distances: [Affine; PLANES.len()],
    /// Back-facing test; `None` if face culling is off.
    side: Option<BackFacingTest>,
}

impl ClusterCulling {
    pub(super) fn new(clip_from_model: Mat4, containment: Containment, culling: Culling, viewport: Viewport) -> Self {
        Self {
            all_inside: containment == Containment::Inside,
            distances: PLANES.map(|plane| Affine::distance(plane, clip_from_model, 1.0)),
            side: match culling {
                Culling::None => None,
                Culling::Back => Some(BackFacingTest::new(clip_from_model, viewport, -1.0)),
                Culling::Front => Some(BackFacingTest::new(clip_from_model, viewport, 1.0)),
            },
        }
    }
}

/// Returns the culling result of each cluster.
fn fates(clusters: &Clusters, view: &ClusterCulling, lanes: Lanes) -> Vec<ClusterFate> {
    let mut out = vec![ClusterFate::Kept; clusters.len()];
    on_lanes!(lanes, simd => {
        for ((boxes, planes), out) in clusters.boxes().iter().zip(clusters.planes()).zip(out.chunks_mut(LANES)) {
            let [outside, turned_away] = eight_fates(simd, boxes, planes, view);
            if outside | turned_away == 0 {
                continue;
            }
            for (lane, out) in out.iter_mut().enumerate() {
                if outside >> lane & 1 != 0 {
                    *out = ClusterFate::Outside;
                } else if turned_away >> lane & 1 != 0 {
                    *out = ClusterFate::BackFacing;
                }
            }
        }
    });
    out
}

/// Returns two bit masks over eight clusters. The first selects clusters whose vertices all lie beyond one clip plane
/// when the pipeline transforms them. The second selects clusters that are back-facing.
#[inline(always)]
fn eight_fates<S: Simd>(simd: S, boxes: &Boxes, planes: &ClusterPlanes, view: &ClusterCulling) -> [u64; 2] {
    let boxes = &EightBoxes::new(simd, boxes);
    let mut outside = 0;
    for distance in view.distances.iter().filter(|_| !view.all_inside) {
        let slack = distance.slack(simd, boxes);
        outside |= distance.greatest(simd, boxes).simd_lt(-slack).to_bitmask();
    }
    let turned_away = match &view.side {
        Some(side) if outside != ALL => side.back_facing(simd, boxes, planes, !view.all_inside),
        _ => 0,
    };
    [outside, turned_away]
}

/// Bit mask that selects all eight clusters.
const ALL: u64 = (1 << LANES) - 1;

#[cfg(test)]
mod tests;
