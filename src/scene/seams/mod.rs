//! Open seams: where borders of surfaces run along one another without sharing their vertices.
//!
//! An edge that belongs to one triangle only is *open*. Two surfaces that meet share the edges between them, so an open edge
//! with another open edge along it is a fault of the mesh, of one of two kinds:
//!
//! * a **T-junction**: a vertex lies within the open edge of another triangle. Its position is rounded on its own, so it leaves
//!   the edge by a fraction of a pixel, and samples between the two are hit by no triangle, or by two.
//! * an **unwelded vertex**: two vertices whose positions are not the same bits lie closer together than the tolerance.
//!
//! Vertices are the same if their positions in world space are the same bits, whatever their numbers, normals and texture
//! coordinates: objects that share a transform share vertices, too. A vertex lies on an edge if it is closer to it than the
//! [`tolerance`], and an open edge of it runs along that edge. Neither looks at which way triangles face.
//!
//! Cost: sorting of all vertices and edges, and for each open edge one search in a tree of the open vertices; about one second
//! for a million triangles on two threads.

mod tree;

mod weld;

use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

use self::tree::PointTree;
use self::weld::{Welded, is_open};
use super::{Scene, TriangleId};

/// Largest distance of a vertex that lies on an edge, as a share of the diagonal of the scene's box: the rounding error of
/// coordinates of about 1 that a file holds with four decimals.
const TOLERANCE_OF_SCENE: f64 = 1e-4;

/// The same as a share of the edge's length, so that small details of a large scene are not taken for one line.
const TOLERANCE_OF_EDGE: f64 = 1e-2;

/// Rounding of coordinates far from the origin, as a share of the largest coordinate: two steps of f32.
const ROUNDING: f64 = 2.0 * f32::EPSILON as f64;

/// Sine of the largest angle between edges that run along one another.
const LARGEST_SINE: f64 = 0.1;

/// Open edges that are searched between two looks at whether to go on.
const CHUNK: usize = 1024;

/// Kind of a fault of a mesh along an open edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum JunctionKind {
    /// A vertex within the open edge of another triangle.
    TJunction,
    /// A vertex close to, and not the same as, the end of an open edge.
    Unwelded,
}

impl JunctionKind {
    /// Display name.
    pub fn name(self) -> &'static str {
        match self {
            Self::TJunction => "T-junction",
            Self::Unwelded => "unwelded vertex",
        }
    }
}

/// A corner of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Corner {
    /// The triangle.
    pub triangle: TriangleId,
    /// 0, 1 or 2.
    pub corner: u8,
}

/// An edge of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct TriangleEdge {
    /// The triangle.
    pub triangle: TriangleId,
    /// The corner that the edge is opposite to: 0, 1 or 2.
    pub opposite: u8,
}

/// A vertex on an open edge that it is no end of.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Junction {
    /// Kind of the fault.
    pub kind: JunctionKind,
    /// The vertex, as the corner of a triangle on the other side of the edge.
    pub vertex: Corner,
    /// The open edge.
    pub edge: TriangleEdge,
    /// Distance of the vertex from the edge, or from the end of the edge if it is unwelded; world units.
    pub distance: f64,
}

impl Junction {
    /// Describes the fault in one sentence, without its full stop.
    pub fn text(&self) -> String {
        let Self { kind, vertex, edge, distance } = self;
        let vertex = format!("v{} of triangle {}", vertex.corner, vertex.triangle.0);
        let edge = format!("the edge of triangle {} opposite to v{}", edge.triangle.0, edge.opposite);
        match kind {
            JunctionKind::TJunction => format!(
                "T-junction: {vertex} lies within {edge}, {distance:.2e} off it, and is no vertex of that triangle, so the \
                 two sides are rounded apart"
            ),
            JunctionKind::Unwelded => format!(
                "Unwelded vertex: {vertex} lies {distance:.2e} from an end of {edge}, and is not the same vertex, so the two \
                 sides do not meet"
            ),
        }
    }
}

/// Two open edges that run along one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seam {
    /// The vertex of the second edge on the first one; a T-junction rather than an unwelded vertex if there are both.
    pub junction: Junction,
    /// The second edge.
    pub along: TriangleEdge,
}

/// Numbers of faults of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SeamCounts {
    /// Vertices within open edges.
    pub t_junctions: usize,
    /// Vertices that welding with the tolerance would remove.
    pub unwelded: usize,
}

/// The open seams of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seams {
    seams: Vec<Seam>,
    junctions: Vec<Junction>,
    border: Vec<Corner>,
}

impl Seams {
    /// Finds all open seams of a scene. Returns `None` once `stop` is set.
    pub fn find(scene: &Scene, stop: &AtomicBool) -> Option<Self> {
        let mesh = Welded::of(scene, stop)?;
        if mesh.open.is_empty() {
            return Some(Self::default());
        }
        Search::new(&mesh).run(stop)
    }

    /// Finds all open seams of a scene.
    pub fn of(scene: &Scene) -> Self {
        Self::find(scene, &AtomicBool::new(false)).unwrap_or_default()
    }

    /// Returns the pairs of open edges that run along one another.
    pub fn seams(&self) -> &[Seam] {
        &self.seams
    }

    /// Returns the faults, one for each vertex and kind, ordered by kind and vertex.
    pub fn junctions(&self) -> &[Junction] {
        &self.junctions
    }

    /// Returns one corner for each vertex that is the end of an open edge.
    pub fn border(&self) -> &[Corner] {
        &self.border
    }

    /// Returns the numbers of faults.
    pub fn counts(&self) -> SeamCounts {
        let t_junctions = self.junctions.iter().filter(|j| j.kind == JunctionKind::TJunction).count();
        SeamCounts { t_junctions, unwelded: self.junctions.len() - t_junctions }
    }
}

impl SeamCounts {
    /// Returns both numbers in words.
    pub fn text(self) -> String {
        let number = |count: usize, one: &str, many: &str| format!("{count} {}", if count == 1 { one } else { many });
        let t_junctions = number(self.t_junctions, "T-junction", "T-junctions");
        format!("{t_junctions} · {}", number(self.unwelded, "unwelded vertex", "unwelded vertices"))
    }
}

/// Returns the distance from an edge of this length up to which a vertex lies on it, for a scene with this diagonal and
/// largest coordinate; all in world units.
pub fn tolerance(edge: f64, diagonal: f64, largest: f64) -> f64 {
    (TOLERANCE_OF_EDGE * edge).min((TOLERANCE_OF_SCENE * diagonal).max(ROUNDING * largest))
}

/// A vertex found on an open edge, with an open edge of it that runs along.
#[derive(Clone, Copy, Debug)]
struct Hit {
    kind: JunctionKind,
    /// Number of the vertex among all welded ones.
    vertex: u32,
    corner: Corner,
    /// Places of both edges among the open ones.
    edges: [u32; 2],
    /// The vertex that it is to be welded to.
    other: u32,
    distance: f64,
}

/// The search among the open edges of a mesh.
struct Search<'a> {
    mesh: &'a Welded,
    /// Welded vertices that are ends of open edges, ascending.
    vertices: Vec<u32>,
    tree: PointTree,
    /// Open edges by their ends: those of `vertices[i]` are `incident[starts[i]..starts[i + 1]]`.
    starts: Vec<u32>,
    incident: Vec<u32>,
}

impl<'a> Search<'a> {
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

    /// Finds the vertices on one open edge that have an open edge along it.
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
            // A vertex next to an end that is joined to it by an edge across is the other rim of a thin strip.
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
            let line = Line { from, along, length, reach };
            for other_place in self.incident_to(found).iter().copied() {
                let guest = &self.mesh.open[other_place as usize];
                let far = self.mesh.positions[guest.other_end(vertex) as usize];
                if !guest.joins(edge) && line.has_along_it([at, far]) {
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

    /// Returns one seam for each pair of edges.
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

    /// Returns one junction for each vertex within an edge, and one for each vertex that lies beside one with a lower number.
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

    fn border(&self) -> Vec<Corner> {
        let corner = |(place, vertex): (usize, &u32)| {
            self.mesh.open[self.incident[self.starts[place] as usize] as usize].corner_of(*vertex)
        };
        self.vertices.iter().enumerate().map(corner).collect()
    }
}

/// An open edge as a line from one end in one direction.
struct Line {
    from: DVec3,
    along: DVec3,
    length: f64,
    reach: f64,
}

impl Line {
    /// Returns whether an edge whose first end lies on the line runs along it from there.
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
