//! Open seams: borders of surfaces that run along one another without sharing vertices.
//!
//! An edge that belongs to only one triangle is *open*. Adjacent surfaces should share the edges between them. An open
//! edge that runs along another open edge is therefore a fault of the mesh, of one of two kinds:
//!
//! * a **T-junction**: a vertex lies within the open edge of another triangle. Its position is rounded independently,
//!   so it deviates from the edge by a fraction of a pixel. Samples between vertex and edge are covered by no triangle,
//!   or by two.
//! * an **unwelded vertex**: two vertices whose positions are not bitwise equal lie closer together than the tolerance.
//!
//! Vertices are identical if their world-space positions are bitwise equal, regardless of indices, normals and texture
//! coordinates. Objects with the same transform therefore share vertices, too. A vertex lies on an edge if two
//! conditions hold: it is closer to the edge than the [`tolerance`], and an open edge that ends at the vertex runs
//! along that edge. Neither condition depends on the facing of the triangles.
//!
//! Cost: all vertices and edges are sorted, and each open edge needs one search in a tree of the open vertices. This
//! takes about one second for a million triangles on two threads.

mod tree;

mod weld;

use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

use self::tree::PointTree;
use self::weld::{Welded, is_open};
use super::{Scene, TriangleId};

/// Maximum distance at which a vertex counts as lying on an edge, as a fraction of the diagonal of the scene's bounding
/// box. It corresponds to the rounding of coordinates of about 1 in a file with four decimals.
const TOLERANCE_OF_SCENE: f64 = 1e-4;

/// Maximum distance at which a vertex counts as lying on an edge, as a fraction of the edge's length. Prevents fine
/// details of a large scene from being mistaken for seams.
const TOLERANCE_OF_EDGE: f64 = 1e-2;

/// Rounding error of coordinates far from the origin, relative to the largest coordinate: two ulps of f32.
const ROUNDING: f64 = 2.0 * f32::EPSILON as f64;

/// Sine of the maximum angle between two edges that are treated as running alongside each other.
const LARGEST_SINE: f64 = 0.1;

/// Number of open edges searched between cancellation checks.
const CHUNK: usize = 1024;

/// Kind of fault of a mesh along an open edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum JunctionKind {
    /// A vertex lies within the open edge of another triangle.
    TJunction,
    /// A vertex is close, but not identical, to an endpoint of an open edge.
    Unwelded,
}

impl JunctionKind {}

/// Corner of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub(crate) struct TriangleCorner {
    /// Identifier of the triangle.
    pub(crate) triangle: TriangleId,
    /// Index of the corner: 0, 1 or 2.
    pub(crate) corner: u8,
}

/// Edge of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub(crate) struct TriangleEdge {
    /// Identifier of the triangle.
    pub(crate) triangle: TriangleId,
    /// Index of the opposite corner: 0, 1 or 2.
    pub(crate) opposite: u8,
}

/// Vertex that lies on an open edge but is not one of its endpoints.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Junction {
    /// Kind of fault: T-junction or unwelded vertex.
    pub kind: JunctionKind,
    /// Vertex on the edge, given as a corner of a triangle on the other side of the edge.
    pub(crate) vertex: TriangleCorner,
    /// Open edge on which the vertex lies.
    pub(crate) edge: TriangleEdge,
    /// Distance of a T-junction's vertex from the edge, or of an unwelded vertex from the endpoint of the edge, in
    /// world units.
    pub(crate) distance: f64,
}

impl Junction {
    /// Describes the fault in one sentence, without a final full stop.
    pub fn text(&self) -> String {
        let Self { kind, vertex, edge, distance } = self;
        let vertex = format!("v{} of triangle {}", vertex.corner, vertex.triangle.0);
        let edge = format!("the edge of triangle {} opposite to v{}", edge.triangle.0, edge.opposite);
        match kind {
            JunctionKind::TJunction => format!(
                "T-junction: {vertex} lies within {edge}, {distance:.2e} units off it, but is not a vertex of that \
                 triangle, so the two sides round differently; to fix it, split the edge there"
            ),
            JunctionKind::Unwelded => format!(
                "Unwelded vertex: {vertex} lies {distance:.2e} units from an end of {edge}, but is not the same \
                 vertex, so the two sides do not meet; to fix it, weld the vertices"
            ),
        }
    }
}

/// Pair of open edges that run along one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Seam {
    /// Vertex of the second edge that lies on the first edge. If the pair has both kinds of fault, this is the
    /// T-junction.
    pub(crate) junction: Junction,
    /// Second edge of the pair.
    pub(crate) along: TriangleEdge,
}

/// Numbers of seam faults in a scene, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SeamCounts {
    /// Number of vertices within open edges.
    pub(crate) t_junctions: usize,
    /// Number of vertices that welding within the tolerance would remove.
    pub(crate) unwelded: usize,
}

/// Open seams of a scene, with the faults along them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seams {
    seams: Vec<Seam>,
    junctions: Vec<Junction>,
    border: Vec<TriangleCorner>,
}

impl Seams {
    /// Finds all open seams of a scene. Returns `None` if `stop` is set.
    pub fn find(scene: &Scene, stop: &AtomicBool) -> Option<Self> {
        let mesh = Welded::of(scene, stop)?;
        if mesh.open.is_empty() {
            return Some(Self::default());
        }
        OpenEdgeSearch::new(&mesh).run(stop)
    }

    /// Finds all open seams of a scene, without cancellation.
    pub fn of(scene: &Scene) -> Self {
        Self::find(scene, &AtomicBool::new(false)).unwrap_or_default()
    }

    /// Returns the pairs of open edges that run along one another.
    pub(crate) fn seams(&self) -> &[Seam] {
        &self.seams
    }

    /// Returns the faults, one per vertex and kind, ordered by kind and vertex.
    pub(crate) fn junctions(&self) -> &[Junction] {
        &self.junctions
    }

    /// Returns one triangle corner for each vertex that is an endpoint of an open edge.
    pub(crate) fn border(&self) -> &[TriangleCorner] {
        &self.border
    }

    /// Returns the number of faults of each kind.
    pub(crate) fn counts(&self) -> SeamCounts {
        let t_junctions = self.junctions.iter().filter(|j| j.kind == JunctionKind::TJunction).count();
        SeamCounts { t_junctions, unwelded: self.junctions.len() - t_junctions }
    }
}

impl SeamCounts {
    /// Returns the counts as text, such as "2 T-junctions · 1 unwelded vertex".
    pub fn text(self) -> String {
        let number = |count: usize, one: &str, many: &str| format!("{count} {}", if count == 1 { one } else { many });
        let t_junctions = number(self.t_junctions, "T-junction", "T-junctions");
        format!("{t_junctions} · {}", number(self.unwelded, "unwelded vertex", "unwelded vertices"))
    }
}

/// Returns the maximum distance at which a vertex counts as lying on an edge, in world units.
///
/// `edge` is the length of the edge, `diagonal` the diagonal of the scene's bounding box, and `largest` the largest
/// magnitude of a vertex coordinate, all in world units.
pub(crate) fn tolerance(edge: f64, diagonal: f64, largest: f64) -> f64 {
    (TOLERANCE_OF_EDGE * edge).min((TOLERANCE_OF_SCENE * diagonal).max(ROUNDING * largest))
}

/// Vertex that lies on an open edge, and another open edge that ends at this vertex and runs along the first.
#[derive(Clone, Copy, Debug)]
struct Hit {
    kind: JunctionKind,
    /// Index of the welded vertex.
    vertex: u32,
    corner: TriangleCorner,
    /// Indices into the list of open edges: the edge on which the vertex lies, and the vertex's own edge.
    edges: [u32; 2],
    /// Index of the welded vertex that `vertex` would be merged with; for a T-junction, `vertex` itself.
    other: u32,
    distance: f64,
}

/// Search for pairs of open edges that run along one another.
struct OpenEdgeSearch<'a> {
    mesh: &'a Welded,
    /// Indices of the welded vertices that are endpoints of open edges, in ascending order.
    vertices: Vec<u32>,
    tree: PointTree,
    /// Start of each vertex's range in `incident`: `vertices[i]` is an endpoint of the open edges
    /// `incident[starts[i]..starts[i + 1]]`.
    starts: Vec<u32>,
    incident: Vec<u32>,
}

impl<'a> OpenEdgeSearch<'a> {
    fn new(mesh: &'a Welded) -> Self {
        let mut ends: Vec<(u32, u32)> =
            mesh.open.iter().zip(0..).flat_map(|(edge, place)| edge.ends.map(|end| (end, place))).collect();
        ends.par_sort_unstable();
        let (mut vertices, mut starts) = (Vec::new(), Vec::new());
        for (place, (vertex, _)) in (0..).zip(&ends) {
            if vertices.last() != Some(vertex) {
                vertices.push(*vertex);
                starts.push(place);
            }
        }
        starts.push(ends.len() as u32);
        let incident = ends.into_iter().map(|(_, edge)| edge).collect();
        let points: Vec<_> = vertices.iter().map(|vertex| mesh.positions[*vertex as usize]).collect();
        Self { mesh, vertices, tree: PointTree::new(&points), starts, incident }
    }

    fn run(&self, stop: &AtomicBool) -> Option<Seams> {
        let chunks = self.mesh.open.par_chunks(CHUNK).enumerate().map(|(chunk, edges)| {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            let mut hits = Vec::new();
            (0..edges.len()).for_each(|place| self.hits_of((chunk * CHUNK + place) as u32, &mut hits));
            Some(hits)
        });
        let hits: Vec<Hit> = chunks.collect::<Option<Vec<_>>>()?.concat();
        Some(Seams { seams: self.seams(&hits), junctions: self.junctions(&hits), border: self.border() })
    }

    /// Appends a hit for each vertex that lies on the open edge with index `place` and has an open edge that runs along
    /// it.
    fn hits_of(&self, place: u32, hits: &mut Vec<Hit>) {
        let edge = &self.mesh.open[place as usize];
        let [from, to] = edge.ends.map(|end| self.mesh.positions[end as usize]);
        let length = from.distance(to);
        let reach = tolerance(length, self.mesh.diagonal, self.mesh.largest);
        let along = (to - from) / length;
        if !along.is_finite() {
            return;
        }
        self.tree.near([from, to], reach, |found| {
            let vertex = self.vertices[found as usize];
            if edge.ends.contains(&vertex) || edge.opposite == vertex {
                return;
            }
            let at = self.mesh.positions[vertex as usize];
            let close = (0..2).find(|end| at.distance([from, to][*end]) <= reach);
            // A vertex that a closed edge connects to an endpoint is on the opposite border of a thin strip.
            let is_across = |end: &u32| self.mesh.edge(vertex, *end).is_some_and(|twins| !is_open(twins));
            if edge.ends.iter().any(is_across) {
                return;
            }
            let is_joined = close.is_some_and(|end| self.mesh.edge(vertex, edge.ends[end]).is_some());
            let t = (at - from).dot(along);
            let (kind, other, distance) = match close {
                Some(end) if !is_joined => (JunctionKind::Unwelded, edge.ends[end], at.distance([from, to][end])),
                _ if t > 0.0 && t < length => (JunctionKind::TJunction, vertex, at.distance(from + along * t)),
                _ => return,
            };
            let line = OpenEdgeLine { from, along, length, reach };
            for other_place in self.incident_to(found).iter().copied() {
                let guest = &self.mesh.open[other_place as usize];
                let far = self.mesh.positions[guest.other_end(vertex) as usize];
                if !guest.are_adjacent(edge) && line.has_along_it([at, far]) {
                    let corner = guest.corner_of(vertex);
                    hits.push(Hit { kind, vertex, corner, edges: [place, other_place], other, distance });
                }
            }
        });
    }

    fn incident_to(&self, found: u32) -> &[u32] {
        &self.incident[self.starts[found as usize] as usize..self.starts[found as usize + 1] as usize]
    }

    fn junction(&self, hit: &Hit) -> Junction {
        let Hit { kind, corner, edges, distance, .. } = *hit;
        Junction { kind, vertex: corner, edge: self.mesh.open[edges[0] as usize].of_triangle(), distance }
    }

    /// Returns one seam for each pair of edges. Of several hits of a pair, T-junctions take precedence over unwelded
    /// vertices, then the smallest distance decides.
    fn seams(&self, hits: &[Hit]) -> Vec<Seam> {
        let pair = |hit: &Hit| (hit.edges[0].min(hit.edges[1]), hit.edges[0].max(hit.edges[1]));
        let mut best: Vec<&Hit> = hits.iter().collect();
        best.sort_by(|a, b| {
            (pair(a), a.kind)
                .cmp(&(pair(b), b.kind))
                .then(a.distance.total_cmp(&b.distance))
                .then(a.edges.cmp(&b.edges))
        });
        best.dedup_by_key(|hit| pair(hit));
        let seam = |hit: &Hit| Seam {
            junction: self.junction(hit),
            along: self.mesh.open[hit.edges[1] as usize].of_triangle(),
        };
        best.into_iter().map(seam).collect()
    }

    /// Returns one junction for each vertex within an open edge, and one for each unwelded vertex that is close to a
    /// vertex with a lower index.
    fn junctions(&self, hits: &[Hit]) -> Vec<Junction> {
        let is_counted = |hit: &&Hit| hit.kind == JunctionKind::TJunction || hit.other < hit.vertex;
        let mut best: Vec<&Hit> = hits.iter().filter(is_counted).collect();
        best.sort_by(|a, b| {
            (a.kind, a.vertex)
                .cmp(&(b.kind, b.vertex))
                .then(a.distance.total_cmp(&b.distance))
                .then(a.edges.cmp(&b.edges))
        });
        best.dedup_by_key(|hit| (hit.kind, hit.vertex));
        let mut junctions: Vec<Junction> = best.into_iter().map(|hit| self.junction(hit)).collect();
        junctions.sort_by_key(|junction| (junction.kind, junction.vertex));
        junctions
    }

    fn border(&self) -> Vec<TriangleCorner> {
        let corner = |(place, vertex): (usize, &u32)| {
            self.mesh.open[self.incident[self.starts[place] as usize] as usize].corner_of(*vertex)
        };
        self.vertices.iter().enumerate().map(corner).collect()
    }
}

/// Open edge as a line segment: start point, unit direction, length and tolerance.
struct OpenEdgeLine {
    from: DVec3,
    along: DVec3,
    length: f64,
    reach: f64,
}

impl OpenEdgeLine {
    /// Whether the edge from `at`, a point on the segment, to `far` runs along the segment within the tolerance.
    fn has_along_it(&self, [at, far]: [DVec3; 2]) -> bool {
        let run = far - at;
        let own_length = run.length();
        let advance = run.dot(self.along);
        let is_parallel = run.cross(self.along).length() <= LARGEST_SINE * own_length;
        if !is_parallel || own_length == 0.0 {
            return false;
        }
        let start = (at - self.from).dot(self.along);
        let end = (start + advance).clamp(0.0, self.length);
        let shared = (end - start.clamp(0.0, self.length)).abs();
        let last = at + run * ((end - start) / advance).clamp(0.0, 1.0);
        let is_near = (last - self.from - self.along * (last - self.from).dot(self.along)).length() <= self.reach;
        is_near && shared >= (2.0 * self.reach).min(0.5 * own_length)
    }
}

#[cfg(test)]
pub(crate) mod tests;
