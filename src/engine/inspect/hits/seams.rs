//! Faults along open seams: samples that neither of the two surfaces along a seam covers, or that both cover.
//!
//! Both edges of each seam are projected by the same stages that draw the frame. A sample outside both edges is a
//! crack; one inside both is a double hit. If the two surfaces lie on the same side, the seam is an outline without
//! faults. A hole between the corners of more than two surfaces belongs to no edge and is not found.

use std::collections::BTreeMap;

use glam::Vec3;
use rayon::prelude::*;

use super::{CountMode, Fault, FaultKind, FaultSearch};
use crate::chain::{Frame, Recipe};
use crate::inspect::vertices::Outcode;
use crate::math::fixed::{snap, to_pixels};
use crate::pipeline::clip::{Cut, Polygon, guard_band_widening};
use crate::pipeline::clip_space::ClipVertex;
use crate::pipeline::cull::{Facing, cull, facing};
use crate::pipeline::observe::Fate;
use crate::pipeline::plan::culling;
use crate::pipeline::project::divided;
use crate::pipeline::raster::{AnyTriangle, Scissor, doubled_area};
use crate::pipeline::settings::{Arithmetic, FillRule, Settings};
use crate::pipeline::vertex::DrawMatrices;
use crate::pipeline::viewport::Viewport;
use crate::scene::seams::{Junction, Seam, Seams, TriangleCorner, TriangleEdge};
use crate::scene::{Scene, TriangleId};

/// Minimum number of seams in a parallel task.
const CHUNK: usize = 256;

/// Finds the faults along open seams in a frame, within a scissor rectangle of the drawn picture, in reading order.
pub(super) fn faults(scene: &Scene, recipe: &Recipe, frame: &Frame, seams: &Seams, scissor: Scissor) -> Vec<Fault> {
    if seams.seams().is_empty() {
        return Vec::new();
    }
    let wanted = seams.seams().iter().flat_map(|seam| [seam.junction.edge.triangle, seam.along.triangle]);
    let placing = Placing::new(scene, recipe, frame, PictureKind::Drawn, wanted);
    let faults_of = |seam: &Seam| {
        let mut faults = Vec::new();
        let (host, guest) = (placing.edge(seam.junction.edge), placing.edge(seam.along));
        if let Some(gap) = host.zip(guest).and_then(|(host, guest)| Gap::between(host, guest, &recipe.pipeline)) {
            let sharing = [seam.junction.edge.triangle, seam.along.triangle];
            gap.each_fault(scissor, |(x, y), kind| faults.push(((y, x), (kind, sharing, seam.junction))));
        }
        faults
    };
    let parts: Vec<_> = seams.seams().par_iter().with_min_len(CHUNK).map(faults_of).collect();
    let mut found = FaultMap::new();
    for ((y, x), fault) in parts.into_iter().flatten() {
        if frame.drawn.grid.sample_at(x, y).is_some() {
            found.entry((y, x)).or_insert(fault);
        }
    }
    FaultSearch::of(frame, &recipe.pipeline, scissor).seam_faults(found)
}

/// Returns the pixel of the full picture at each junction's vertex. The pixel is `None` if the vertex is outside the
/// picture, or if the triangle with the open edge was not rasterized.
pub(in crate::inspect) fn junction_pixels(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    seams: &Seams,
) -> Vec<Option<(u32, u32)>> {
    let wanted = || seams.junctions().iter().map(|junction| junction.edge.triangle);
    let placing = Placing::new(scene, recipe, frame, PictureKind::Full, wanted());
    let pixel =
        |junction: &Junction| placing.pixel(junction.vertex).filter(|_| placing.is_drawn(junction.edge.triangle));
    seams.junctions().iter().map(pixel).collect()
}

/// Counts the vertices within the picture that lie on open edges of rasterized triangles.
pub(in crate::inspect) fn border_in_picture(scene: &Scene, recipe: &Recipe, frame: &Frame, seams: &Seams) -> usize {
    let wanted = || seams.border().iter().map(|corner| corner.triangle);
    let placing = Placing::new(scene, recipe, frame, PictureKind::Full, wanted());
    let is_there = |corner: &&TriangleCorner| placing.is_drawn(corner.triangle) && placing.pixel(**corner).is_some();
    seams.border().iter().filter(is_there).count()
}

/// Map from the row and column of a faulty sample to the kind of fault, the triangles of both sides, and the junction.
pub(super) type FaultMap = BTreeMap<(u32, u32), (FaultKind, [TriangleId; 2], Junction)>;

impl FaultSearch<'_> {
    /// Builds the faults at the given samples, with the triangles that hit each sample and the triangles that should
    /// hit it.
    fn seam_faults(&self, found: FaultMap) -> Vec<Fault> {
        if found.is_empty() {
            return Vec::new();
        }
        let mut hit_by: BTreeMap<(u32, u32), Vec<TriangleId>> = BTreeMap::new();
        self.each_hit(CountMode::Drawn, |index, (column, row)| {
            let (x, y) = self.grid.pixel(column + self.origin.0, row + self.origin.1);
            if found.contains_key(&(y, x)) {
                hit_by.entry((y, x)).or_default().push(self.triangles[index].id);
            }
        });
        let mut fault = |(y, x), kind, [host, guest]: [TriangleId; 2], junction| {
            let hit_by = hit_by.remove(&(y, x)).unwrap_or_default();
            let (due, sharing) = match kind {
                FaultKind::Crack => (hit_by.iter().copied().chain([host]).collect(), [host, guest]),
                FaultKind::DoubleHit => (hit_by.iter().copied().filter(|id| *id != guest).collect(), [guest, host]),
            };
            Fault { x, y, kind, hit_by, due, sharing, junction: Some(junction) }
        };
        found.into_iter().map(|(place, (kind, sharing, junction))| fault(place, kind, sharing, junction)).collect()
    }
}

/// A triangle edge projected to the screen.
#[derive(Clone, Copy)]
struct ScreenEdge {
    /// Endpoints that determine coverage, in px, in the winding order of the triangle.
    ends_px: [[f32; 2]; 2],
    /// Facing of the edge's triangle; [`Facing::Edge`] if the drawn part of the triangle is a line.
    facing: Facing,
}

/// Projection of vertices and edges of a frame's triangles to the screen.
struct Placing<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    first_triangles: Vec<TriangleId>,
    matrices: Vec<DrawMatrices>,
    raster: Viewport,
    /// Requested triangles that the frame rasterizes, ascending.
    drawn: Vec<TriangleId>,
}

/// Picture of a frame before or after upscaling.
#[derive(Clone, Copy)]
enum PictureKind {
    /// The rasterized picture, which an upscaler may enlarge.
    Drawn,
    /// The picture that the frame shows.
    Full,
}

impl<'a> Placing<'a> {
    /// Prepares the projection of the `wanted` triangles to a picture of the frame.
    fn new(
        scene: &'a Scene,
        recipe: &'a Recipe,
        frame: &Frame,
        picture: PictureKind,
        wanted: impl Iterator<Item = TriangleId>,
    ) -> Self {
        let settings = &recipe.pipeline;
        let (camera, raster) = match picture {
            PictureKind::Drawn => (frame.drawn_from(recipe), frame.raster),
            PictureKind::Full => (frame.camera, frame.viewport),
        };
        let mut wanted: Vec<_> = wanted.collect();
        wanted.sort_unstable();
        wanted.dedup();
        let listed = frame.geometry().triangles.iter().map(|triangle| triangle.id);
        let mut drawn: Vec<_> = listed.filter(|id| wanted.binary_search(id).is_ok()).collect();
        drawn.sort_unstable();
        let clip_from_world = camera.clip_from_world_f64(raster.aspect(), settings.depth_format.mapping());
        Self {
            scene,
            settings,
            first_triangles: scene.first_triangles(),
            matrices: scene.instances.iter().map(|instance| DrawMatrices::new(instance, clip_from_world)).collect(),
            raster,
            drawn,
        }
    }

    fn is_drawn(&self, triangle: TriangleId) -> bool {
        self.drawn.binary_search(&triangle).is_ok()
    }

    /// Returns the corners of a triangle in clip space. The source weights of each corner are 1 for itself and 0 for
    /// the others.
    fn corners(&self, triangle: TriangleId) -> Option<[ClipVertex; 3]> {
        let index = self.first_triangles.partition_point(|first| *first <= triangle).checked_sub(1)?;
        let mesh = self.scene.library.mesh(self.scene.instances.get(index)?.mesh);
        let corners = mesh.triangles.get((triangle.0 - self.first_triangles[index].0) as usize)?;
        let mut weight = Vec3::AXES.into_iter();
        Some(corners.map(|corner| {
            let mut vertex = ClipVertex::at(self.matrices[index].clip_position(mesh.positions[corner as usize]));
            vertex.varyings.source_weights = weight.next().unwrap_or_default();
            vertex
        }))
    }

    /// Returns the pixel that contains a vertex; `None` if the vertex is outside the picture.
    fn pixel(&self, TriangleCorner { triangle, corner }: TriangleCorner) -> Option<(u32, u32)> {
        let vertex = self.corners(triangle)?[usize::from(corner)];
        if !Outcode::of(vertex.position, false).is_inside() {
            return None;
        }
        let [x, y] = self.position_px(&vertex);
        let Viewport { width, height } = self.raster;
        Some(((x as u32).min(width - 1), (y as u32).min(height - 1)))
    }

    /// Returns the part of an edge that remains after clipping. Returns `None` if that part has no length, or if the
    /// triangle was not drawn. A triangle that was culled for zero area counts as drawn.
    fn edge(&self, TriangleEdge { triangle, opposite }: TriangleEdge) -> Option<ScreenEdge> {
        let corners = self.corners(triangle)?;
        let mut polygon = Polygon::default();
        let pieces = match polygon.clip(&corners, guard_band_widening(self.raster.width, self.raster.height)).ok()? {
            Cut::Whole => &corners[..],
            Cut::Pieces => polygon.vertices(),
        };
        let px: Vec<[f32; 2]> = pieces.iter().map(|vertex| self.position_px(vertex)).collect();
        let areas = px[1..].windows(2).map(|pair| doubled_area(self.settings.arithmetic, [px[0], pair[0], pair[1]]).0);
        let area = areas.max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        let instance = self.first_triangles.partition_point(|first| *first <= triangle).checked_sub(1)?;
        let culling = culling(&self.scene.library, self.scene.instances.get(instance)?, self.settings);
        match cull(area, culling) {
            None if !self.is_drawn(triangle) => return None,
            None | Some(Fate::ZeroArea) => {}
            Some(_) => return None,
        }
        let is_on_edge =
            |place: usize| pieces[place % pieces.len()].varyings.source_weights[usize::from(opposite)] == 0.0;
        let place = (0..pieces.len()).find(|place| is_on_edge(*place) && is_on_edge(place + 1))?;
        let ends_px = [px[place], px[(place + 1) % px.len()]];
        (ends_px[0] != ends_px[1]).then(|| ScreenEdge { ends_px, facing: facing(area) })
    }

    fn position_px(&self, vertex: &ClipVertex) -> [f32; 2] {
        let (x, y) = self.raster.pixels_from_ndc(divided(vertex).1);
        match self.settings.arithmetic {
            Arithmetic::Fixed => [x, y].map(|px| to_pixels(snap(px))),
            Arithmetic::F32 | Arithmetic::F64 | Arithmetic::Exact => [x, y],
        }
    }
}

/// Gap or overlap between two screen edges whose triangles lie on opposite sides.
struct Gap {
    sides: [GapSide; 2],
}

/// One edge of a gap, and the side on which its surface lies.
struct GapSide {
    ends_px: [[f64; 2]; 2],
    /// Triangle on the surface's side of the edge. Its last corner lies opposite to the edge.
    triangle: AnyTriangle,
}

impl GapSide {
    fn new(ends_px: [[f32; 2]; 2], facing: Facing, rule: FillRule) -> Option<Self> {
        let [[ax, ay], [bx, by]] = ends_px;
        // Vector perpendicular to the edge. It points into the triangle if the triangle appears clockwise.
        let (dx, dy) = (ay - by, bx - ax);
        let inner = if facing == Facing::Back { [ax + dx, ay + dy] } else { [ax - dx, ay - dy] };
        let triangle = AnyTriangle::new(Arithmetic::Exact, [ends_px[0], ends_px[1], inner], rule)?;
        Some(Self { ends_px: ends_px.map(|end| end.map(f64::from)), triangle })
    }

    /// Whether a pixel's centre lies on the surface's side of the edge, or exactly on the edge if the fill rule
    /// includes it.
    fn covers(&self, pixel: (u32, u32)) -> bool {
        let value = self.triangle.sample(pixel).edges[2];
        value > 0.0 || value == 0.0 && self.triangle.owned()[2]
    }

    /// Finds the point on the edge's line whose coordinate on `axis` is `along`. Returns the other coordinate of this
    /// point, in px.
    fn across(&self, axis: usize, along: f64) -> f64 {
        let [from, to] = self.ends_px;
        let t = (along - from[axis]) / (to[axis] - from[axis]);
        from[1 - axis] + (to[1 - axis] - from[1 - axis]) * t
    }

    fn range(&self, axis: usize) -> [f64; 2] {
        let [from, to] = self.ends_px.map(|end| end[axis]);
        [from.min(to), from.max(to)]
    }
}

impl Gap {
    /// Returns the gap between two adjacent edges; `None` if both surfaces lie on the same side, as on an outline.
    fn between(host: ScreenEdge, guest: ScreenEdge, settings: &Settings) -> Option<Self> {
        let rule = if settings.fill_rule.draws_shared_edges_once() { settings.fill_rule } else { FillRule::TopLeft };
        let run =
            |edge: &ScreenEdge| [0, 1].map(|axis| f64::from(edge.ends_px[1][axis]) - f64::from(edge.ends_px[0][axis]));
        let (a, b) = (run(&host), run(&guest));
        let same_way = a[0] * b[0] + a[1] * b[1] > 0.0;
        // Returns the facing that the other triangle must have to lie on the opposite side. This is the same facing if
        // the edges run in opposite directions, otherwise the reverse.
        let opposite = |facing| match (facing, same_way) {
            (Facing::Front, false) | (Facing::Back, true) => Facing::Front,
            (Facing::Front, true) | (Facing::Back, false) => Facing::Back,
            (Facing::Edge, _) => Facing::Edge,
        };
        // A triangle that projects to a line has no side, so it is assumed to lie opposite to the other triangle.
        let facings = match (host.facing, guest.facing) {
            (Facing::Edge, Facing::Edge) => return None,
            (Facing::Edge, guest) => [opposite(guest), guest],
            (host, Facing::Edge) => [host, opposite(host)],
            (host, guest) if opposite(host) == guest => [host, guest],
            _ => return None,
        };
        let sides = [GapSide::new(host.ends_px, facings[0], rule)?, GapSide::new(guest.ends_px, facings[1], rule)?];
        Some(Self { sides })
    }

    /// Calls `sink` with each pixel within the scissor that neither side covers (a crack), or that both cover (a double
    /// hit).
    fn each_fault(&self, scissor: Scissor, mut sink: impl FnMut((u32, u32), FaultKind)) {
        let [host, guest] = &self.sides;
        let length = |axis: usize| host.range(axis)[1] - host.range(axis)[0];
        let axis = if length(0) >= length(1) { 0 } else { 1 };
        let ([a, b], [c, d]) = (host.range(axis), guest.range(axis));
        let bounds = [(scissor.left, scissor.right), (scissor.top, scissor.bottom)];
        let clamp = |axis: usize, at: f64| at.clamp(bounds[axis].0.into(), bounds[axis].1.into()) as u32;
        // Pixels whose centres lie within the extent of both edges.
        let (first, end) = (clamp(axis, (a.max(c) - 0.5).ceil()), clamp(axis, (b.min(d) - 0.5).floor() + 1.0));
        for along in first..end {
            let centre = f64::from(along) + 0.5;
            let (one, other) = (host.across(axis, centre), guest.across(axis, centre));
            let low = clamp(1 - axis, one.min(other).floor() - 1.0);
            let high = clamp(1 - axis, one.max(other).floor() + 2.0);
            for across in low..high {
                let pixel = if axis == 0 { (along, across) } else { (across, along) };
                match (host.covers(pixel), guest.covers(pixel)) {
                    (false, false) => sink(pixel, FaultKind::Crack),
                    (true, true) => sink(pixel, FaultKind::DoubleHit),
                    _ => {}
                }
            }
        }
    }
}
