//! Survey of a frame's triangles: their screen positions, and which of them the geometry stages dropped, for lookups at
//! any pixel.
//!
//! The stages run again on all threads, with the matrices, plans and arithmetic of the frame. The survey takes about
//! 5 MB for 100 000 triangles. It is valid for every pixel of the frame and every position of the triangle slider.

use std::sync::Arc;

use glam::{DMat4, DVec2, Vec3, Vec4};
use rayon::prelude::*;

use super::clipped::{Meeting, meeting};
use super::near_miss::distance_px;
use crate::chain::{Frame, Recipe};
use crate::image::Image;
use crate::inspect::pixel::{Absent, Cause};
use crate::pipeline::clip::{clip, guard_band_widening};
use crate::pipeline::clip_space::{ClipPlane, ClipVertex};
use crate::pipeline::cull::{Facing, cull, facing};
use crate::pipeline::observe::{Fate, Observer};
use crate::pipeline::plan::{DrawPlan, PipelinePart, culling};
use crate::pipeline::raster::{SampleArea, Scissor, Span, doubled_area};
use crate::pipeline::settings::{Choice as _, Culling, Settings};
use crate::pipeline::vertex::DrawMatrices;
use crate::pipeline::viewport::Viewport;
use crate::scene::seams::Seams;
use crate::scene::{Camera, Projection, Scene, TriangleId};

/// Maximum distance in px at which a triangle with collinear snapped corners counts as passing through a pixel's
/// centre. Snapping moves each corner by at most 1/512 px along each axis.
const SNAPPED_BY_PX: f64 = 1.0 / 256.0;

/// Minimum number of triangles or vertices in a parallel task.
const CHUNK: usize = 4096;

/// The triangles of one frame, with the reasons why they may have no fragment at a pixel.
#[derive(Clone, Debug)]
pub struct Survey {
    triangles: SurveyedTriangles,
    camera: Camera,
    raster: Viewport,
    /// Open seams of the scene; `None` until they are known.
    seams: Option<Arc<Seams>>,
}

/// Surveyed triangles of a frame or of a part of it, in scene order.
#[derive(Clone, Debug, Default)]
struct SurveyedTriangles {
    /// Triangles that were projected to the screen and then culled.
    dropped: Vec<PlacedTriangle>,
    /// Triangles that the full frame rasterizes.
    rasterized: Vec<PlacedTriangle>,
    crossing: Vec<CrossingTriangle>,
    not_finite: Vec<(TriangleId, u32)>,
}

impl SurveyedTriangles {
    fn append(&mut self, mut later: Self) {
        self.dropped.append(&mut later.dropped);
        self.rasterized.append(&mut later.rasterized);
        self.crossing.append(&mut later.crossing);
        self.not_finite.append(&mut later.not_finite);
    }
}

/// A screen-space triangle, or a piece of a clipped one, with the reason why it may have no fragment at a pixel that it
/// covers.
#[derive(Clone, Copy, Debug)]
struct PlacedTriangle {
    id: TriangleId,
    instance: u32,
    corners_px: [[f32; 2]; 3],
    cause: Cause,
}

/// A triangle that is not entirely between the near and far planes, with its corners in clip space.
#[derive(Clone, Copy, Debug)]
struct CrossingTriangle {
    id: TriangleId,
    instance: u32,
    corners: [Vec4; 3],
}

/// View of a frame whose triangles are surveyed.
struct SurveyedView<'a> {
    settings: &'a Settings,
    raster: Viewport,
    /// Factor by which the guard band is wider than the picture.
    widening: f32,
    clip_from_world: DMat4,
}

/// One draw of a frame whose triangles are surveyed.
struct SurveyedDraw<'a> {
    view: &'a SurveyedView<'a>,
    instance: u32,
    first: TriangleId,
    triangles: &'a [[u32; 3]],
    /// Whether the draw plan transforms vertices; otherwise no triangle of the draw reaches the screen.
    runs: bool,
    may_cross: bool,
    culling: Culling,
    vertices: Vec<ClipVertex>,
    positions_px: Vec<[f32; 2]>,
}

impl<'a> SurveyedDraw<'a> {
    /// Transforms the vertices of the instance with this index, whose first triangle in the scene is `first`.
    fn new(view: &'a SurveyedView<'a>, scene: &'a Scene, plan: &DrawPlan, index: usize, first: TriangleId) -> Self {
        let instance = &scene.instances[index];
        let mesh = scene.library.mesh(instance.mesh);
        let matrices = DrawMatrices::new(instance, view.clip_from_world);
        let vertex = |p: &Vec3| ClipVertex::at(matrices.clip_from_model * p.extend(1.0));
        let vertices: Vec<_> = mesh.positions.par_iter().with_min_len(CHUNK).map(vertex).collect();
        let positions_px =
            vertices.par_iter().with_min_len(CHUNK).map(|vertex| position_px(view.raster, vertex)).collect();
        Self {
            view,
            instance: index as u32,
            first,
            triangles: &mesh.triangles,
            runs: plan.runs(PipelinePart::Vertices),
            may_cross: plan.runs(PipelinePart::Clipping),
            culling: plan.culling(),
            vertices,
            positions_px,
        }
    }

    /// Surveys all triangles of the draw, in parallel.
    fn survey(&self) -> SurveyedTriangles {
        let chunks = self.triangles.par_chunks(CHUNK).enumerate();
        let parts: Vec<SurveyedTriangles> =
            chunks.map(|(chunk, triangles)| self.found_in(chunk * CHUNK, triangles)).collect();
        let mut all = SurveyedTriangles::default();
        parts.into_iter().for_each(|part| all.append(part));
        all
    }

    /// Surveys a chunk of triangles; `place` is the index of its first triangle in the mesh.
    fn found_in(&self, place: usize, triangles: &[[u32; 3]]) -> SurveyedTriangles {
        let mut found = SurveyedTriangles::default();
        for (id, corners) in (self.first.0 + place as u32..).map(TriangleId).zip(triangles) {
            let whole = corners.map(|corner| self.vertices[corner as usize]);
            let positions = whole.map(|corner| corner.position);
            if positions.iter().any(|p| p.z < 0.0 || p.z > p.w) {
                found.crossing.push(CrossingTriangle { id, instance: self.instance, corners: positions });
            }
            if !self.runs {
                continue;
            }
            if self.may_cross && !positions.iter().all(|position| is_inside(*position)) {
                let pieces = self.clipped(id, &whole, &mut found.not_finite);
                self.take_pieces(&pieces, id, &mut found);
            } else {
                self.take_pieces(&[corners.map(|corner| self.positions_px[corner as usize])], id, &mut found);
            }
        }
        found
    }

    /// Clips a triangle and returns the screen corners of the remaining pieces, in px.
    fn clipped(
        &self,
        id: TriangleId,
        whole: &[ClipVertex; 3],
        not_finite: &mut Vec<(TriangleId, u32)>,
    ) -> Vec<[[f32; 2]; 3]> {
        let mut not_finite = NotFinite { found: not_finite, instance: self.instance };
        let pieces = clip(whole, &[[0, 1, 2]], id, self.view.widening, &mut not_finite);
        pieces
            .iter()
            .map(|piece| piece.vertices.each_ref().map(|corner| position_px(self.view.raster, corner)))
            .collect()
    }

    /// Adds the pieces of one triangle to the rasterized or the dropped triangles, each with its cause.
    fn take_pieces(&self, pieces: &[[[f32; 2]; 3]], id: TriangleId, found: &mut SurveyedTriangles) {
        let causes = pieces.iter().map(|corners_px| {
            let (area, _) = doubled_area(self.view.settings.arithmetic, *corners_px);
            match cull(area, self.culling) {
                None => Cause::NotDrawnYet,
                Some(Fate::BackFacing) => Cause::BackFacing,
                Some(Fate::FrontFacing) => Cause::FrontFacing,
                Some(_) => Cause::ZeroArea,
            }
        });
        // A zero-area piece is ignored if another piece of the triangle has area.
        let has_area = causes.clone().any(|cause| cause != Cause::ZeroArea);
        for (corners_px, cause) in pieces.iter().zip(causes).filter(|(_, cause)| !has_area || *cause != Cause::ZeroArea)
        {
            let piece = PlacedTriangle { id, instance: self.instance, corners_px: *corners_px, cause };
            if cause == Cause::NotDrawnYet { &mut found.rasterized } else { &mut found.dropped }.push(piece);
        }
    }
}

/// Returns the screen position of a vertex before snapping, in px, computed by the same operations as in
/// [`Viewport::project`].
fn position_px(raster: Viewport, vertex: &ClipVertex) -> [f32; 2] {
    let inv_w = 1.0 / vertex.position.w;
    raster.pixels_from_ndc(vertex.position.truncate() * inv_w).into()
}

impl Survey {
    /// Surveys the triangles of `frame`, which was drawn from `scene` with `recipe`.
    pub fn of(scene: &Scene, recipe: &Recipe, frame: &Frame) -> Self {
        let (camera, settings, raster) = (frame.drawn_from(recipe), &recipe.pipeline, frame.raster);
        let view = SurveyedView {
            settings,
            raster,
            widening: guard_band_widening(raster.width, raster.height),
            clip_from_world: camera.clip_from_world_f64(raster.aspect(), settings.depth_format.mapping()),
        };
        let mut triangles = SurveyedTriangles::default();
        for (index, first) in scene.first_triangles().into_iter().enumerate() {
            triangles.append(SurveyedDraw::new(&view, scene, &frame.plans[index], index, first).survey());
        }
        Self { triangles, camera, raster, seams: None }
    }

    /// Whether the survey is also valid for another frame of the same recipe and scene. Camera and size must match, but
    /// the frame may stop at an earlier triangle.
    pub fn fits(&self, recipe: &Recipe, frame: &Frame) -> bool {
        self.camera == frame.drawn_from(recipe) && self.raster == frame.raster
    }

    /// Returns the number of triangles that would cover each sample but were culled as back-facing or front-facing. The
    /// image has the packed layout of the framebuffer.
    pub(crate) fn culled_coverage(&self, settings: &Settings, frame: &Frame) -> Image<u32> {
        let (width, height) = frame.drawn.color.size();
        let mut counts = Image::filled(width, height, 0);
        let rules = settings.coverage_rules();
        let area = SampleArea::full(frame.drawn.grid, self.raster);
        let culled = |piece: &&PlacedTriangle| matches!(piece.cause, Cause::BackFacing | Cause::FrontFacing);
        let mut spans: Vec<Span> = Vec::new();
        for piece in self.triangles.dropped.iter().filter(culled) {
            spans.clear();
            rules.cover_within(piece.corners_px, area, &mut spans);
            for Span { row, left, right } in &spans {
                (*left..*right).for_each(|column| counts.set(column, *row, counts.at(column, *row) + 1));
            }
        }
        counts
    }

    /// Adds the open seams of the scene, so that cracks at T-junctions and unwelded vertices are explained too.
    pub fn set_seams(&mut self, seams: Arc<Seams>) {
        self.seams = Some(seams);
    }

    /// Returns the open seams of the scene; `None` until they are known.
    pub(in crate::inspect) fn seams(&self) -> Option<&Seams> {
        self.seams.as_deref()
    }

    /// Returns the triangles that would cover a drawn pixel but were dropped before the rasterizer, and all triangles
    /// with a non-finite corner.
    pub(super) fn dropped_at(&self, scene: &Scene, recipe: &Recipe, frame: &Frame, pixel: (u32, u32)) -> Vec<Absent> {
        let absent = |triangle, instance: u32, cause, reason| Absent {
            triangle,
            instance: scene.instances[instance as usize].name.clone(),
            submission: None,
            cause,
            reason,
            corners_px: None,
            distance_px: None,
            edges: None,
        };
        let settings = &recipe.pipeline;
        let is_there = |piece: &&PlacedTriangle| piece.would_cover(settings, frame, pixel);
        let is_drawn =
            |piece: &&PlacedTriangle| frame.geometry().triangles.iter().any(|triangle| triangle.id == piece.id);
        // All rasterized triangles are drawn unless the frame's list was truncated.
        let is_whole = frame.geometry().triangles.len() >= self.triangles.rasterized.len();
        let later: &[PlacedTriangle] = if is_whole { &[] } else { &self.triangles.rasterized };
        let later = later.iter().filter(is_there).filter(|piece| !is_drawn(piece));
        let dropped = self.triangles.dropped.iter().filter(is_there).chain(later);
        let crossing =
            self.triangles.crossing.iter().filter_map(|t| Some((t, self.cut_away(scene, t, settings, pixel)?)));
        dropped
            .map(|piece| Absent {
                corners_px: Some(piece.corners_px),
                ..absent(piece.id, piece.instance, piece.cause, piece.reason(settings))
            })
            .chain(crossing.map(|(t, (cause, reason))| absent(t.id, t.instance, cause, reason)))
            .chain(self.triangles.not_finite.iter().map(|(id, instance)| {
                let reason = "has a NaN or infinite corner in clip space, so it is never drawn".to_owned();
                absent(*id, *instance, Cause::NotFinite, reason)
            }))
            .collect()
    }

    /// Returns the cause and its description if the near or far plane clips a triangle away at a pixel. Returns `None`
    /// if neither plane does, or if the triangle would be culled anyway.
    fn cut_away(
        &self,
        scene: &Scene,
        triangle: &CrossingTriangle,
        settings: &Settings,
        (x, y): (u32, u32),
    ) -> Option<(Cause, String)> {
        let share = |pixel: u32, size: u32| (f64::from(pixel) + 0.5) / f64::from(size);
        let ndc = DVec2::new(share(x, self.raster.width) * 2.0 - 1.0, 1.0 - share(y, self.raster.height) * 2.0);
        let met = meeting(triangle.corners, ndc)?;
        let side = if met.shows_front { Facing::Front } else { Facing::Back };
        let culling = culling(&scene.library, &scene.instances[triangle.instance as usize], settings);
        let is_culled = matches!((side, culling), (Facing::Front, Culling::Front) | (Facing::Back, Culling::Back));
        let is_before_zero = met.z < 0.0;
        if is_culled || (0.0..=met.w).contains(&met.z) {
            return None;
        }
        let is_near = is_before_zero != self.camera.has_zero_at_far(settings.depth_format.mapping());
        let (cause, name, plane, beyond) = if is_near {
            (Cause::NearPlane, "near", self.camera.near, "in front of")
        } else {
            (Cause::FarPlane, "far", self.camera.far, "beyond")
        };
        let distance = self.distance(met, settings);
        let reason = format!(
            "would cover it {distance:.4} units from the eye, {beyond} the {name} plane at {plane}, and is clipped \
             there: to show it, move the {name} plane"
        );
        Some((cause, reason))
    }

    /// Returns the distance from the eye to the intersection along the view axis, in world units.
    fn distance(&self, met: Meeting, settings: &Settings) -> f64 {
        let Camera { near, far, .. } = self.camera;
        let (near, far) = (f64::from(near), f64::from(far));
        match self.camera.projection {
            Projection::Perspective { .. } => met.w,
            Projection::Orthographic { .. } if settings.reversed() => far - met.z * (far - near),
            Projection::Orthographic { .. } => near + met.z * (far - near),
        }
    }
}

impl PlacedTriangle {
    /// Whether the triangle would cover the pixel with the recipe's rasterizer. For a triangle of zero area, whether it
    /// passes through the pixel's centre.
    fn would_cover(&self, settings: &Settings, frame: &Frame, (x, y): (u32, u32)) -> bool {
        let scissor = Scissor::pixel(x, y);
        if !scissor.may_overlap(self.corners_px) {
            return false;
        }
        if self.cause == Cause::ZeroArea {
            let corners = self.corners_px.map(|[x, y]| DVec2::new(x.into(), y.into()));
            return distance_px(corners, DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)) <= SNAPPED_BY_PX;
        }
        let mut spans: Vec<Span> = Vec::new();
        let area = SampleArea { grid: frame.drawn.grid, scissor };
        settings.coverage_rules().cover_within(self.corners_px, area, &mut spans);
        !spans.is_empty()
    }

    fn reason(&self, settings: &Settings) -> String {
        let (area, scale) = doubled_area(settings.arithmetic, self.corners_px);
        let area = area * scale;
        match facing(area) {
            _ if self.cause == Cause::NotDrawnYet => {
                "covers it, but comes after the last triangle drawn; move the triangle slider to show it".to_owned()
            }
            Facing::Front => format!(
                "covers it, but is front-facing, and culling is {}: to show it, set culling to none (doubled area \
                 {area} < 0)",
                settings.culling.id()
            ),
            Facing::Back => format!(
                "covers it, but is back-facing, and culling is {}: to show it, set culling to none (doubled area \
                 {area} > 0)",
                settings.culling.id()
            ),
            Facing::Edge => {
                "passes through it, but its snapped corners are collinear: it has no area to draw".to_owned()
            }
        }
    }
}

/// Whether a clip-space position lies inside the view frustum. A triangle of three such corners needs no clipping.
fn is_inside(position: Vec4) -> bool {
    position.is_finite() && ClipPlane::ALL.iter().all(|plane| plane.distance(position, 1.0) >= 0.0)
}

/// An observer that records triangles with a non-finite corner.
struct NotFinite<'a> {
    found: &'a mut Vec<(TriangleId, u32)>,
    instance: u32,
}

impl Observer for NotFinite<'_> {
    fn rejected(&mut self, id: TriangleId, fate: Fate) {
        if fate == Fate::NotFinite {
            self.found.push((id, self.instance));
        }
    }
}

#[cfg(test)]
mod tests;
