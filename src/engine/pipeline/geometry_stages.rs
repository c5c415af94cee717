//! Geometry stages of the classic execution: plan, transform, clip, project and cull.

use std::time::Instant;

use glam::{DMat4, Vec3};

use super::clip_space::ClipVertex;
use super::depth::DepthScale;
use super::observe::{Fate, Observer};
use super::plan::{DrawPlan, PipelinePart};
use super::raster::doubled_area;
use super::screen_triangle::{ScreenTriangle, TriangleOwner};
use super::screen_vertex::ScreenVertex;
use super::settings::{Arithmetic, Culling, Settings};
use super::vertex::{DrawMatrices, containment, transform};
use super::viewport::Viewport;
use super::{DrawnView, Geometry, clip, cull};
use crate::scene::{Camera, Scene, TriangleId};

/// Runs the geometry stages over all instances of a scene, for a picture of the viewport's size.
pub fn prepare<O: Observer>(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    viewport: Viewport,
    observer: &mut O,
) -> Geometry {
    let mut geometry =
        Geometry { depth_scale: DepthScale::of(settings, camera), blending: settings.blending, ..Geometry::default() };
    let view = DrawnView { scene, camera, settings, viewport };
    let clip_from_world = view.clip_from_world();
    let mut stages = GeometryStages { settings, viewport, out: &mut geometry, observer };
    for (index, first) in scene.first_triangles().into_iter().enumerate() {
        stages.prepare_draw(&view, clip_from_world, index, first);
    }
    geometry.draw_blended_last();
    geometry.triangles.find_boxes();
    geometry
}

/// Triangles of one draw after the vertex transform.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClipSpaceDraw<'a> {
    /// Index of the instance in the scene.
    pub(super) instance: u32,
    /// Vertices in clip space.
    pub(super) vertices: &'a [ClipVertex],
    /// Vertex indices of each triangle.
    pub(super) triangles: &'a [[u32; 3]],
    /// Identifier of the draw's first triangle.
    pub(super) first: TriangleId,
    /// Whether triangles may cross a plane of the frustum; if `false`, no triangle is tested for clipping.
    pub(super) may_cross: bool,
    /// Whether attributes are interpolated perspective-correctly.
    pub(super) divides_by_w: bool,
    /// Culling of the triangles by their facing.
    pub(super) culling: Culling,
}

/// Number of triangles that pass through the geometry stages together. The results of each stage then stay in the
/// processor's cache until the next stage reads them.
const BATCH: usize = 256;

/// Geometry stages of a draw: their inputs that all draws share, and their outputs.
pub(super) struct GeometryStages<'a, O> {
    pub(super) settings: &'a Settings,
    pub(super) viewport: Viewport,
    pub(super) out: &'a mut Geometry,
    pub(super) observer: &'a mut O,
}

impl<O: Observer> GeometryStages<'_, O> {
    /// Runs the stages of the instance with index `index`. `first` is the identifier of its first triangle.
    fn prepare_draw(&mut self, view: &DrawnView<'_>, clip_from_world: DMat4, index: usize, first: TriangleId) {
        let Self { ref mut out, ref mut observer, .. } = *self;
        let DrawnView { scene, camera, settings, .. } = *view;
        let instance = &scene.instances[index];
        let mesh = scene.library.mesh(instance.mesh);
        out.triangles_in += mesh.triangles.len();

        let start = Instant::now();
        let matrices = DrawMatrices::new(instance, clip_from_world);
        let inside = containment(mesh.visible_bounds(), matrices.clip_from_model);
        let plan = DrawPlan::new(&scene.library, instance, camera, settings, inside).starting_at(first);
        out.plans.push(plan);
        if !plan.runs(PipelinePart::Vertices) {
            for offset in 0..mesh.triangles.len() as u32 {
                observer.rejected(TriangleId(first.0 + offset), Fate::Outside);
            }
            out.times.transform += start.elapsed();
            return;
        }
        let vertices = transform(mesh, &matrices, settings, &plan);
        out.vertices += vertices.len();
        out.times.transform += start.elapsed();
        let draw = ClipSpaceDraw {
            instance: index as u32,
            vertices: &vertices,
            triangles: &mesh.triangles,
            first,
            may_cross: plan.runs(PipelinePart::Clipping),
            divides_by_w: plan.runs(PipelinePart::PerspectiveDivision),
            culling: plan.culling(),
        };
        self.finish_draw(&draw);
    }

    /// Runs the stages of one draw, from clipping to culling.
    pub(super) fn finish_draw(&mut self, draw: &ClipSpaceDraw<'_>) {
        if !draw.may_cross {
            return self.finish_unclipped(draw);
        }
        let viewport = self.viewport;
        let widening = clip::guard_band_widening(viewport.width, viewport.height);
        let depth_scale = self.out.depth_scale;
        let mut triangles = std::mem::take(&mut self.out.triangles).into_vec();
        triangles.reserve(draw.triangles.len());
        let firsts = (draw.first.0..).step_by(BATCH).map(TriangleId);
        for (batch, first) in draw.triangles.chunks(BATCH).zip(firsts) {
            let transformed = Instant::now();
            let clipped = clip::clip(draw.vertices, batch, first, widening, self.observer);
            self.out.triangles_clipped += clipped.len();
            let clipping_done = Instant::now();

            let projected: Vec<(TriangleId, [ScreenVertex; 3])> =
                clipped.iter().map(|t| (t.id, viewport.project(t, &depth_scale))).collect();
            let projected_at = Instant::now();

            // Pieces of one triangle are adjacent.
            for pieces in projected.chunk_by(|a, b| a.0 == b.0) {
                self.set_up(pieces, draw, &mut triangles);
            }
            self.out.times.clip += clipping_done - transformed;
            self.out.times.project += projected_at - clipping_done;
            self.out.times.cull += projected_at.elapsed();
        }
        self.out.triangles = triangles.into();
    }

    /// Runs the stages of a draw that no plane cuts. Each vertex is projected once, not once per triangle, and only the
    /// corners of triangles that are kept are copied.
    fn finish_unclipped(&mut self, draw: &ClipSpaceDraw<'_>) {
        let Self { settings, viewport, ref mut out, ref mut observer } = *self;
        let begun = Instant::now();
        let depth_scale = out.depth_scale;
        let projected: Vec<ScreenVertex> =
            draw.vertices.iter().map(|vertex| viewport.project_vertex(vertex, &depth_scale)).collect();
        let projected_at = Instant::now();
        let mut triangles = std::mem::take(&mut out.triangles).into_vec();
        triangles.reserve(draw.triangles.len());
        for (id, corners) in (draw.first.0..).map(TriangleId).zip(draw.triangles) {
            let corners = corners.map(|corner| &projected[corner as usize]);
            let (area, scale) = doubled_area(settings.arithmetic, corners.map(|corner| corner.position_px));
            if let Some(fate) = cull::cull(area, draw.culling) {
                observer.rejected(id, fate);
                continue;
            }
            let mut vertices = corners.map(|corner| *corner);
            for (vertex, own) in vertices.iter_mut().zip(Vec3::AXES) {
                vertex.varyings.source_weights = own;
            }
            let owner = TriangleOwner { id, instance: draw.instance };
            let area = (area * scale).abs();
            triangles.push(ScreenTriangle::new(owner, vertices, area, &depth_scale, draw.divides_by_w));
        }
        out.triangles_clipped += draw.triangles.len();
        out.times.project += projected_at - begun;
        out.times.cull += projected_at.elapsed();
        out.triangles = triangles.into();
    }

    /// Culls the pieces of one triangle and sets up the edges of those kept. If none is kept, reports one fate for the whole
    /// triangle.
    fn set_up(
        &mut self,
        pieces: &[(TriangleId, [ScreenVertex; 3])],
        draw: &ClipSpaceDraw<'_>,
        out: &mut Vec<ScreenTriangle>,
    ) {
        let kept_before = out.len();
        let mut rejected = None;
        for (id, corners) in pieces {
            let positions_px = corners.each_ref().map(|v| v.position_px);
            let (area, scale) = doubled_area(self.settings.arithmetic, positions_px);
            match cull::cull(area, draw.culling) {
                // A piece of zero area does not determine whether the triangle is front-facing or back-facing.
                Some(Fate::ZeroArea) => rejected = rejected.or(Some((*id, Fate::ZeroArea))),
                Some(facing) => rejected = Some((*id, facing)),
                None => {
                    let area = (area * scale).abs();
                    let owner = TriangleOwner { id: *id, instance: draw.instance };
                    out.push(ScreenTriangle::new(owner, *corners, area, &self.out.depth_scale, draw.divides_by_w));
                }
            }
        }
        if let Some((id, fate)) = rejected.filter(|_| out.len() == kept_before) {
            self.observer.rejected(id, fate);
        }
    }
}

/// Clips, projects and sets up triangles that are given in clip space, without a camera. Draws both front-facing and
/// back-facing triangles.
pub(crate) fn from_clip_space<O: Observer>(
    vertices: &[ClipVertex],
    triangles: &[[u32; 3]],
    arithmetic: Arithmetic,
    viewport: Viewport,
    observer: &mut O,
) -> Vec<ScreenTriangle> {
    let draw = ClipSpaceDraw {
        instance: 0,
        vertices,
        triangles,
        first: TriangleId(0),
        may_cross: true,
        divides_by_w: true,
        culling: Culling::None,
    };
    let settings = Settings { arithmetic, ..Settings::default() };
    let mut geometry = Geometry::default();
    GeometryStages { settings: &settings, viewport, out: &mut geometry, observer }.finish_draw(&draw);
    geometry.triangles.into_vec()
}
