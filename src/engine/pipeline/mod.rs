//! Rendering pipeline: from a scene to drawn pixels, one stage after the other. Each stage is a function over plain
//! buffers in a file of its own.
//!
//! ```text
//! plan → transform → clip → project → cull │ rasterize → depth → interpolate → shade
//!            per draw, all triangles       │       per triangle, sample by sample
//! ```
//!
//! [`prepare`] runs the left half and returns [`Geometry`]; [`draw`] runs the right half and fills a [`Framebuffer`].
//! This is the *classic* execution: triangle after triangle, plain scalar code, every stage visible. It is the
//! reference for every faster execution, which must give the same picture, bit for bit.
//!
//! Opaque and alpha-tested triangles come first, in submission order. Blended triangles follow, in the order of
//! [`settings::BlendingOrder`]. They are tested against the stored depths but store none themselves.

pub mod background;

mod blending;

pub(crate) mod choice;

pub(crate) mod clip;

pub(crate) mod cull;

pub mod depth;

pub(crate) mod footprint;

pub(crate) mod framebuffer;

pub(crate) mod gbuffer;

pub(crate) mod grid;

pub(crate) mod interpolate;

pub(crate) mod motion;

pub(crate) mod multisample;

pub mod observe;

pub mod partial;

pub mod plan;

pub(crate) mod raster;

pub(crate) mod sample;

mod samples;

pub mod settings;

pub(crate) mod shade;

pub(crate) mod shading;

pub mod tiled;

pub(crate) mod triangle_list;

pub(crate) mod vertex;

pub mod viewport;

pub(crate) mod wireframe;

use std::ops::Range;
use std::time::{Duration, Instant};

use glam::{DMat4, Vec3};

use blending::Sorting;
use depth::{DepthComparison, DepthScale};
use framebuffer::Framebuffer;
use observe::{Fate, Observer};
use plan::{DrawPlan, PipelinePart};
use raster::numbers::Numbers;
use raster::{RasterTriangle, Scissor, Span, cover_samples, doubled_area, with_arithmetic};
use settings::{Arithmetic, Blending, BlendingOrder, Culling, Settings};
use shade::Shader;
use triangle_list::TriangleList;
use vertex::{ClipVertex, DrawMatrices, containment, transform};
use viewport::{ScreenTriangle, ScreenVertex, Viewport};

use crate::scene::{Camera, Scene, Transparency, TriangleId};

/// View to draw: a scene and its camera, with the settings and the size of the picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrawnView<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) camera: &'a Camera,
    pub(crate) settings: &'a Settings,
    pub(crate) viewport: Viewport,
}

impl DrawnView<'_> {
    /// Returns the matrix from world space to clip space.
    fn clip_from_world(&self) -> DMat4 {
        self.camera.clip_from_world_f64(self.viewport.aspect(), self.settings.depth_format.mapping())
    }
}

/// Output of the geometry stages, and input of the rasterizer.
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    /// Triangles to rasterize, in drawing order: first the opaque and the alpha-tested triangles, in submission order,
    /// then the blended triangles. If [`Geometry::blending`] selects it, the blended triangles are sorted by distance;
    /// otherwise, they are in submission order as well.
    pub triangles: TriangleList,
    /// Blending settings, which determine the order of the blended triangles.
    pub blending: Blending,
    /// Samples of the last triangle that are to be drawn; `None` to draw all of them.
    pub partial: Option<Vec<Span>>,
    /// Mapping between distances and the depths of the triangles.
    pub(crate) depth_scale: DepthScale,
    /// Draw plans, one per instance.
    pub plans: Vec<DrawPlan>,
    /// Time spent in each geometry stage, summed over all draws.
    pub(crate) times: GeometryTimes,
    /// Number of transformed vertices.
    pub vertices: usize,
    /// Number of triangles of all instances, before culling and clipping.
    pub(crate) triangles_in: usize,
    /// Number of triangles after clipping.
    pub triangles_clipped: usize,
}

impl Geometry {
    /// Returns the index of the first blended triangle, or the number of triangles if there is none.
    pub(crate) fn blended_from(&self) -> usize {
        self.triangles.partition_point(|triangle| !self.is_blended(triangle))
    }

    /// Returns the index of the first triangle whose fragments are sorted together with those of other triangles. Such
    /// a triangle cannot be drawn alone. Returns the number of triangles if there is none.
    pub(crate) fn sorted_from(&self, settings: &Settings) -> usize {
        let sorts = settings.blending.order == BlendingOrder::Exact;
        if sorts { self.blended_from() } else { self.triangles.len() }
    }

    /// Returns whether a triangle is blended, rather than opaque or alpha-tested.
    pub(crate) fn is_blended(&self, triangle: &ScreenTriangle) -> bool {
        let plan = self.plans.get(triangle.instance as usize);
        plan.is_some_and(|plan| plan.transparency() == Transparency::Blended)
    }

    /// Returns the index of `triangle` in [`Geometry::triangles`], which must contain it.
    pub(crate) fn index_of(&self, triangle: &ScreenTriangle) -> usize {
        let (others, blended) = self.triangles.split_at(self.blended_from());
        // The search starts at the first triangle with the same identifier or, if blended triangles are sorted by
        // distance, at the same distance. Triangles that agree in this sort key are adjacent.
        let first = match (self.is_blended(triangle), self.blending.order) {
            (true, BlendingOrder::Triangles) => {
                let distance = self.mean_distance(triangle);
                others.len() + blended.partition_point(|t| self.mean_distance(t) > distance)
            }
            (true, BlendingOrder::Objects | BlendingOrder::Exact) => {
                others.len() + blended.partition_point(|t| t.id < triangle.id)
            }
            (false, _) => others.partition_point(|t| t.id < triangle.id),
        };
        self.triangles[first..].iter().position(|t| t == triangle).map_or(first, |offset| first + offset)
    }

    /// Moves blended triangles, if there are any, to the end of the list. [`BlendingOrder::Triangles`] sorts them by
    /// the mean distance of their corners, farthest first; triangles at equal distance stay in submission order.
    fn draw_blended_last(&mut self) {
        if self.plans.iter().all(|plan| plan.transparency() != Transparency::Blended) {
            return;
        }
        let triangles = std::mem::take(&mut self.triangles);
        let (mut blended, mut others): (Vec<_>, Vec<_>) =
            triangles.into_vec().into_iter().partition(|t| self.is_blended(t));
        if self.blending.order == BlendingOrder::Triangles {
            blended.sort_by(|a, b| self.mean_distance(b).total_cmp(&self.mean_distance(a)));
        }
        others.append(&mut blended);
        self.triangles = others.into();
    }

    fn mean_distance(&self, triangle: &ScreenTriangle) -> f64 {
        mean_distance(&self.depth_scale, triangle)
    }
}

/// Returns the mean distance of a triangle's corners from the eye, by which [`BlendingOrder::Triangles`] sorts blended
/// triangles.
fn mean_distance(depth_scale: &DepthScale, triangle: &ScreenTriangle) -> f64 {
    let [a, b, c] = triangle.vertices.each_ref().map(|corner| depth_scale.distance(corner));
    (a + b + c) / 3.0
}

/// Wall-clock time per geometry stage.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct GeometryTimes {
    /// Time to plan draws and to transform vertices.
    pub(crate) transform: Duration,
    /// Time to clip triangles.
    pub(crate) clip: Duration,
    /// Time to project and snap vertices.
    pub(crate) project: Duration,
    /// Time to cull triangles and to set up their edges.
    pub(crate) cull: Duration,
}

/// Last stage that [`draw`] runs for each covered sample. Stopping early serves to time stages separately. `black_box`
/// then prevents the result from being eliminated as dead code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LastStage {
    /// Stops after coverage is determined.
    Coverage,
    /// Stops after the depth test and the depth write.
    Depth,
    /// Stops after the interpolation of attributes.
    Interpolate,
    /// Runs all stages, including shading.
    Shade,
}

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
    for (index, first) in scene.first_triangles().into_iter().enumerate() {
        prepare_draw(&view, clip_from_world, (index, first), &mut geometry, observer);
    }
    geometry.draw_blended_last();
    geometry.triangles.find_boxes();
    geometry
}

/// Runs the geometry stages of the instance with index `index`. `first` is the identifier of its first triangle.
fn prepare_draw<O: Observer>(
    view: &DrawnView<'_>,
    clip_from_world: DMat4,
    (index, first): (usize, TriangleId),
    out: &mut Geometry,
    observer: &mut O,
) {
    let DrawnView { scene, camera, settings, viewport } = *view;
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
    finish_draw(&draw, settings, viewport, out, observer);
}

/// Triangles of one draw after the vertex transform.
#[derive(Clone, Copy, Debug)]
struct ClipSpaceDraw<'a> {
    /// Index of the instance in the scene.
    instance: u32,
    /// Vertices in clip space.
    vertices: &'a [ClipVertex],
    /// Vertex indices of each triangle.
    triangles: &'a [[u32; 3]],
    /// Identifier of the draw's first triangle.
    first: TriangleId,
    /// Whether triangles may cross a plane of the frustum; if `false`, no triangle is tested for clipping.
    may_cross: bool,
    /// Whether attributes are interpolated perspective-correctly.
    divides_by_w: bool,
    /// Culling of the triangles by their facing.
    culling: Culling,
}

/// Number of triangles that pass through the geometry stages together. The results of each stage then stay in the
/// processor's cache until the next stage reads them.
const BATCH: usize = 256;

/// Runs the geometry stages of one draw, from clipping to culling.
fn finish_draw<O: Observer>(
    draw: &ClipSpaceDraw<'_>,
    settings: &Settings,
    viewport: Viewport,
    out: &mut Geometry,
    observer: &mut O,
) {
    if !draw.may_cross {
        return finish_unclipped(draw, settings, viewport, out, observer);
    }
    let widening = clip::guard_band_widening(viewport.width, viewport.height);
    let depth_scale = out.depth_scale;
    let mut triangles = std::mem::take(&mut out.triangles).into_vec();
    triangles.reserve(draw.triangles.len());
    let firsts = (draw.first.0..).step_by(BATCH).map(TriangleId);
    for (batch, first) in draw.triangles.chunks(BATCH).zip(firsts) {
        let transformed = Instant::now();
        let clipped = clip::clip(draw.vertices, batch, first, widening, observer);
        out.triangles_clipped += clipped.len();
        let clipping_done = Instant::now();

        let projected: Vec<(TriangleId, [ScreenVertex; 3])> =
            clipped.iter().map(|t| (t.id, viewport.project(t, &depth_scale))).collect();
        let projected_at = Instant::now();

        // Pieces of one triangle are adjacent.
        for pieces in projected.chunk_by(|a, b| a.0 == b.0) {
            set_up(pieces, draw, settings, &depth_scale, &mut triangles, observer);
        }
        out.times.clip += clipping_done - transformed;
        out.times.project += projected_at - clipping_done;
        out.times.cull += projected_at.elapsed();
    }
    out.triangles = triangles.into();
}

/// Runs the geometry stages of a draw that no plane cuts. Each vertex is projected once, not once per triangle, and
/// only the corners of triangles that are kept are copied.
fn finish_unclipped<O: Observer>(
    draw: &ClipSpaceDraw<'_>,
    settings: &Settings,
    viewport: Viewport,
    out: &mut Geometry,
    observer: &mut O,
) {
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
        let owner = (id, draw.instance);
        let area = (area * scale).abs();
        triangles.push(ScreenTriangle::new(owner, vertices, area, &depth_scale, draw.divides_by_w));
    }
    out.triangles_clipped += draw.triangles.len();
    out.times.project += projected_at - begun;
    out.times.cull += projected_at.elapsed();
    out.triangles = triangles.into();
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
    finish_draw(&draw, &settings, viewport, &mut geometry, observer);
    geometry.triangles.into_vec()
}

/// Culls the pieces of one triangle and sets up the edges of those kept. If none is kept, reports one fate for the
/// whole triangle.
fn set_up<O: Observer>(
    pieces: &[(TriangleId, [ScreenVertex; 3])],
    draw: &ClipSpaceDraw<'_>,
    settings: &Settings,
    depth_scale: &DepthScale,
    out: &mut Vec<ScreenTriangle>,
    observer: &mut O,
) {
    let kept_before = out.len();
    let mut rejected = None;
    for (id, corners) in pieces {
        let positions_px = corners.each_ref().map(|v| v.position_px);
        let (area, scale) = doubled_area(settings.arithmetic, positions_px);
        match cull::cull(area, draw.culling) {
            // A piece of zero area does not determine whether the triangle is front-facing or back-facing.
            Some(Fate::ZeroArea) => rejected = rejected.or(Some((*id, Fate::ZeroArea))),
            Some(facing) => rejected = Some((*id, facing)),
            None => {
                let area = (area * scale).abs();
                let owner = (*id, draw.instance);
                out.push(ScreenTriangle::new(owner, *corners, area, depth_scale, draw.divides_by_w));
            }
        }
    }
    if let Some((id, fate)) = rejected.filter(|_| out.len() == kept_before) {
        observer.rejected(id, fate);
    }
}

/// Range of triangles, and rectangle of pixels, that [`draw`] processes.
#[derive(Clone, Debug)]
pub(crate) struct Extent {
    /// Range of indices into [`Geometry::triangles`].
    pub(crate) triangles: Range<usize>,
    /// Rectangle of pixels to draw.
    pub(crate) scissor: Scissor,
}

impl Extent {
    /// Returns the extent that includes every triangle and the whole picture.
    pub(crate) fn all(geometry: &Geometry, viewport: Viewport) -> Self {
        Self { triangles: 0..geometry.triangles.len(), scissor: Scissor::full(viewport.width, viewport.height) }
    }
}

/// Rasterizes, depth-tests, interpolates and shades the triangles of `extent`, up to the stage `until`.
pub(crate) fn draw<O: Observer>(
    scene: &Scene,
    geometry: &Geometry,
    settings: &Settings,
    extent: &Extent,
    until: LastStage,
    frame: &mut Framebuffer,
    observer: &mut O,
) {
    with_arithmetic!(settings.arithmetic, N => draw_in::<N, O>(scene, geometry, settings, extent, until, frame, observer));
}

/// Implements [`draw`] for the arithmetic `N`.
fn draw_in<N: Numbers, O: Observer>(
    scene: &Scene,
    geometry: &Geometry,
    settings: &Settings,
    extent: &Extent,
    until: LastStage,
    frame: &mut Framebuffer,
    observer: &mut O,
) {
    let comparison = DepthComparison::of(settings);
    let shaders: Vec<Shader<'_>> = scene
        .instances
        .iter()
        .zip(&geometry.plans)
        .map(|(instance, plan)| Shader::new(settings, &scene.library, instance, plan))
        .collect();
    let mut spans: Vec<Span> = Vec::new();
    let (in_order, to_sort) = blending::split(geometry, settings, &extent.triangles, until);
    for place in in_order {
        if !extent.scissor.may_overlap_box(geometry.triangles.box_of(place)) {
            continue;
        }
        let triangle = &geometry.triangles[place];
        let shader = &shaders[triangle.instance as usize];
        let corners_px = triangle.corners_px();
        let Some(edges) = RasterTriangle::<N>::new(corners_px, settings.fill_rule) else { continue };
        spans.clear();
        let area = (frame.grid, extent.scissor);
        let visited = match &geometry.partial {
            Some(samples) if place + 1 == geometry.triangles.len() => partial::within(samples, area, &mut spans),
            _ => cover_samples(settings.rasterizer, &edges, corners_px, area, &mut spans),
        };
        samples::draw((triangle, &edges), &spans, shader, (comparison, until), frame, observer);
        observer.visited(visited);
    }
    if !to_sort.is_empty() {
        let drawn = &Extent { triangles: to_sort, scissor: extent.scissor };
        Sorting { geometry, settings, shaders: &shaders }.draw::<N, O>(drawn, frame, observer);
    }
}

/// Draws only the given samples of one triangle; see [`draw`]. `place` is the triangle's index in
/// [`Geometry::triangles`].
pub(crate) fn draw_samples(
    scene: &Scene,
    geometry: &Geometry,
    settings: &Settings,
    (place, samples): (usize, &[Span]),
    frame: &mut Framebuffer,
) {
    let triangle = &geometry.triangles[place];
    let instance = triangle.instance as usize;
    let shader = Shader::new(settings, &scene.library, &scene.instances[instance], &geometry.plans[instance]);
    with_arithmetic!(settings.arithmetic, N => {
        if let Some(edges) = RasterTriangle::<N>::new(triangle.corners_px(), settings.fill_rule) {
            let how = (DepthComparison::of(settings), LastStage::Shade);
            samples::draw((triangle, &edges), samples, &shader, how, frame, &mut ());
        }
    });
}
