//! Welding of a scene's vertices: vertices with bitwise equal world-space positions become one.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::{TriangleCorner, TriangleEdge};
use crate::scene::{Scene, TriangleId};

/// Index that represents a vertex whose position is not finite.
const NOT_FINITE: u32 = u32::MAX;

/// Edge of a triangle, given by its welded vertices.
#[derive(Clone, Copy, Debug)]
pub(super) struct WeldedEdge {
    /// Indices of the welded vertices at both endpoints, the lower index first.
    pub(super) ends: [u32; 2],
    /// Index of the welded vertex opposite the edge in its triangle.
    pub(super) opposite: u32,
    /// Identifier of the triangle that the edge belongs to.
    pub(super) triangle: TriangleId,
    /// Index of the opposite corner in the triangle: 0, 1 or 2.
    corner: u8,
    /// Whether the triangle lists the endpoint with the higher index first.
    is_flipped: bool,
}

impl WeldedEdge {
    /// Returns the edge, identified by its triangle and the index of the opposite corner.
    pub(super) fn of_triangle(&self) -> TriangleEdge {
        TriangleEdge { triangle: self.triangle, opposite: self.corner }
    }

    /// Returns the endpoint of the edge that is not `end`.
    pub(super) fn other_end(&self, end: u32) -> u32 {
        if self.ends[0] == end { self.ends[1] } else { self.ends[0] }
    }

    /// Returns the corner of the edge's triangle at the endpoint `end`.
    pub(super) fn corner_of(&self, end: u32) -> TriangleCorner {
        let is_first = (self.ends[0] == end) != self.is_flipped;
        TriangleCorner { triangle: self.triangle, corner: (self.corner + if is_first { 1 } else { 2 }) % 3 }
    }

    /// Whether both edges belong to one triangle, or to triangles that share an edge. Such a pair of edges is not a
    /// seam, no matter how thin the triangles are.
    pub(super) fn are_adjacent(&self, other: &Self) -> bool {
        let corners = |edge: &Self| [edge.ends[0], edge.ends[1], edge.opposite];
        corners(self).iter().filter(|corner| corners(other).contains(corner)).count() >= 2
    }

    fn key(&self) -> ([u32; 2], u32, TriangleId) {
        (self.ends, self.opposite, self.triangle)
    }
}

/// Whether an edge is open. `twins` are all edges with the same endpoints; the edge is open if all of them belong to
/// one triangle or to duplicates of it.
pub(super) fn is_open(twins: &[WeldedEdge]) -> bool {
    twins.iter().all(|edge| edge.opposite == twins[0].opposite)
}

/// Welded vertices and edges of a scene. Triangles with two identical corners or with a non-finite corner are skipped.
#[derive(Debug)]
pub(super) struct Welded {
    /// Position of each welded vertex, in world space.
    pub(super) positions: Vec<DVec3>,
    /// Edges of all triangles, sorted so that edges with the same endpoints are adjacent.
    edges: Vec<WeldedEdge>,
    /// Open edges, one for each pair of endpoints.
    pub(super) open: Vec<WeldedEdge>,
    /// Diagonal of the bounding box of all vertices, in world units.
    pub(super) diagonal: f64,
    /// Largest magnitude of a vertex coordinate, in world units.
    pub(super) largest: f64,
}

impl Welded {
    /// Welds the vertices of a scene. Returns `None` if `stop` is set.
    pub(super) fn of(scene: &Scene, stop: &AtomicBool) -> Option<Self> {
        let goes_on = || (!stop.load(Ordering::Relaxed)).then_some(());
        let (numbers, positions) = welded(&placed(scene));
        goes_on()?;
        let mut edges = edges(scene, &numbers);
        drop(numbers);
        goes_on()?;
        edges.par_sort_unstable_by_key(WeldedEdge::key);
        goes_on()?;
        let open =
            edges.chunk_by(|a, b| a.ends == b.ends).filter(|twins| is_open(twins)).map(|twins| twins[0]).collect();
        let zero = DVec3::splat(f64::INFINITY);
        let (least, greatest) =
            positions.iter().fold((zero, -zero), |(least, greatest), at| (at.min(least), at.max(greatest)));
        let largest = least.abs().max(greatest.abs()).max_element();
        Some(Self { positions, edges, open, diagonal: least.distance(greatest), largest })
    }

    /// Returns all edges between two welded vertices, one for each triangle; `None` if there are none.
    pub(super) fn edge(&self, a: u32, b: u32) -> Option<&[WeldedEdge]> {
        let ends = [a.min(b), a.max(b)];
        let first = self.edges.partition_point(|edge| edge.ends < ends);
        let count = self.edges[first..].iter().take_while(|edge| edge.ends == ends).count();
        (count > 0).then(|| &self.edges[first..first + count])
    }
}

/// Returns the positions of all vertices of all instances in world space, one instance after another.
fn placed(scene: &Scene) -> Vec<DVec3> {
    let mut all = Vec::new();
    for instance in &scene.instances {
        let (mesh, world_from_model) = (scene.library.mesh(instance.mesh), instance.world_from_model.as_dmat4());
        // Adding zero turns −0 into +0, which is the same position.
        let place = |p: &glam::Vec3| world_from_model.transform_point3(p.as_dvec3()) + DVec3::ZERO;
        all.par_extend(mesh.positions.par_iter().map(place));
    }
    all
}

/// Welds equal positions. Returns the index of the welded vertex for each position ([`NOT_FINITE`] if the position is
/// not finite), and the position of each welded vertex.
fn welded(all: &[DVec3]) -> (Vec<u32>, Vec<DVec3>) {
    let bits = |at: &DVec3| at.to_array().map(f64::to_bits);
    let mut order: Vec<u32> = (0..all.len() as u32).collect();
    order.par_sort_unstable_by_key(|place| (bits(&all[*place as usize]), *place));
    let mut numbers = vec![NOT_FINITE; all.len()];
    let mut positions = Vec::new();
    for same in order.chunk_by(|a, b| bits(&all[*a as usize]) == bits(&all[*b as usize])) {
        let at = all[same[0] as usize];
        if at.is_finite() {
            same.iter().for_each(|place| numbers[*place as usize] = positions.len() as u32);
            positions.push(at);
        }
    }
    (numbers, positions)
}

/// Returns the edges of all triangles, in no particular order.
fn edges(scene: &Scene, numbers: &[u32]) -> Vec<WeldedEdge> {
    let mut all = Vec::new();
    let mut first_vertex = 0;
    for (instance, first) in scene.instances.iter().zip(scene.first_triangles()) {
        let mesh = scene.library.mesh(instance.mesh);
        let own = &numbers[first_vertex..first_vertex + mesh.positions.len()];
        first_vertex += mesh.positions.len();
        all.par_extend(mesh.triangles.par_iter().enumerate().flat_map_iter(|(place, corners)| {
            let corners = corners.map(|corner| own[corner as usize]);
            edges_of(TriangleId(first.0 + place as u32), corners).into_iter().flatten()
        }));
    }
    all
}

/// Returns the three edges of a triangle; `None` if two corners are identical or a corner is not finite.
fn edges_of(triangle: TriangleId, corners: [u32; 3]) -> Option<[WeldedEdge; 3]> {
    let [a, b, c] = corners;
    if a == b || b == c || c == a || corners.contains(&NOT_FINITE) {
        return None;
    }
    Some([0_u8, 1, 2].map(|corner| {
        let [from, to] = [1, 2].map(|step| corners[(usize::from(corner) + step) % 3]);
        WeldedEdge {
            ends: [from.min(to), from.max(to)],
            opposite: corners[usize::from(corner)],
            triangle,
            corner,
            is_flipped: from > to,
        }
    }))
}
