//! Rendering pipeline: from a scene to drawn pixels, one stage after the other. Each stage is a function over plain
//! buffers in a file of its own.
//!
//! ```text
//! plan → transform → clip → project → cull │ rasterize → depth → interpolate → shade
//!            per draw, all triangles       │       per triangle, sample by sample
//! ```
//!
//! [`prepare`] runs the left half and returns [`Geometry`]; [`DrawCall`] runs the right half and fills a [`Framebuffer`].
//! This is the *classic* execution: triangle after triangle, plain scalar code, every stage visible. It is the
//! reference for every faster execution, which must give the same picture, bit for bit.
//!
//! Opaque and alpha-tested triangles come first, in submission order. Blended triangles follow, in the order of
//! [`settings::BlendingOrder`]. They are tested against the stored depths but store none themselves.

pub(crate) mod area;

pub mod background;

mod blending;

pub(crate) mod choice;

pub(crate) mod clip;

pub(crate) mod clip_space;

pub(crate) mod cull;

pub mod depth;

pub mod depth_format;

pub(crate) mod footprint;

pub(crate) mod formulas;

pub(crate) mod framebuffer;

mod geometry_stages;

pub(crate) mod gbuffer;

pub(crate) mod grid;

pub(crate) mod interpolate;

pub(crate) mod motion;

pub(crate) mod multisample;

pub mod observe;

pub mod partial;

pub(crate) mod pixel_box;

pub mod plan;

pub(crate) mod project;

pub(crate) mod raster;

pub(crate) mod sample;

mod samples;

pub mod screen_triangle;

pub mod screen_vertex;

pub mod settings;

pub(crate) mod shade;

pub(crate) mod shading;

pub mod tiled;

pub(crate) mod triangle_list;

pub(crate) mod vertex;

pub(crate) mod viewpoint;

pub mod viewport;

pub(crate) mod wireframe;

use std::ops::Range;
use std::time::Duration;

use blending::Sorting;
use depth::{DepthComparison, DepthScale};
use framebuffer::Framebuffer;
pub(crate) use geometry_stages::from_clip_space;
pub use geometry_stages::prepare;
use glam::DMat4;
use observe::Observer;
use plan::DrawPlan;
use raster::numbers::Numbers;
use raster::{RasterTriangle, SampleArea, Scissor, Span, cover_samples, with_arithmetic};
use samples::{RasterizedTriangle, SampleStages};
use screen_triangle::ScreenTriangle;
use settings::{Blending, BlendingOrder, Settings};
use shade::Shader;
use triangle_list::TriangleList;
use viewport::Viewport;

use crate::scene::{Camera, Scene, Transparency};

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

/// Last stage that [`DrawCall`] runs for each covered sample. Stopping early serves to time stages separately. `black_box`
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

/// Range of triangles, and rectangle of pixels, that [`DrawCall`] processes.
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

/// Draw of prepared triangles.
#[derive(Clone, Copy)]
pub(crate) struct DrawCall<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) geometry: &'a Geometry,
    pub(crate) settings: &'a Settings,
    pub(crate) extent: &'a Extent,
    /// Last stage that runs for each covered sample.
    pub(crate) until: LastStage,
}

impl<'a> DrawCall<'a> {
    /// Creates a draw that runs all stages.
    pub(crate) fn new(scene: &'a Scene, geometry: &'a Geometry, settings: &'a Settings, extent: &'a Extent) -> Self {
        Self { scene, geometry, settings, extent, until: LastStage::Shade }
    }

    /// Rasterizes, depth-tests, interpolates and shades the triangles.
    pub(crate) fn draw<O: Observer>(&self, frame: &mut Framebuffer, observer: &mut O) {
        with_arithmetic!(self.settings.arithmetic, N => self.draw_in::<N, O>(frame, observer));
    }

    /// Implements [`DrawCall::draw`] for the arithmetic `N`.
    fn draw_in<N: Numbers, O: Observer>(&self, frame: &mut Framebuffer, observer: &mut O) {
        let Self { geometry, settings, extent, until, .. } = *self;
        let stages = SampleStages { comparison: DepthComparison::of(settings), until };
        let shaders = self.shaders();
        let mut spans: Vec<Span> = Vec::new();
        let (in_order, to_sort) = self.split();
        for place in in_order {
            if !extent.scissor.may_overlap_box(geometry.triangles.box_of(place)) {
                continue;
            }
            let triangle = &geometry.triangles[place];
            let shader = &shaders[triangle.instance as usize];
            let corners_px = triangle.corners_px();
            let Some(edges) = RasterTriangle::<N>::new(corners_px, settings.fill_rule) else { continue };
            spans.clear();
            let area = SampleArea { grid: frame.grid, scissor: extent.scissor };
            let visited = match &geometry.partial {
                Some(samples) if place + 1 == geometry.triangles.len() => partial::within(samples, area, &mut spans),
                _ => cover_samples(settings.rasterizer, &edges, corners_px, area, &mut spans),
            };
            let rasterized = RasterizedTriangle { triangle, edges: &edges, spans: &spans };
            stages.draw(rasterized, shader, frame, observer);
            observer.visited(visited);
        }
        if !to_sort.is_empty() {
            let drawn = &Extent { triangles: to_sort, scissor: extent.scissor };
            Sorting { geometry, settings, shaders: &shaders }.draw::<N, O>(drawn, frame, observer);
        }
    }

    /// Draws only the given samples of the first triangle of the extent.
    pub(crate) fn draw_samples(&self, spans: &[Span], frame: &mut Framebuffer) {
        let Self { scene, geometry, settings, extent, until } = *self;
        let triangle = &geometry.triangles[extent.triangles.start];
        let instance = triangle.instance as usize;
        let shader = &Shader::new(settings, &scene.library, &scene.instances[instance], &geometry.plans[instance]);
        let stages = SampleStages { comparison: DepthComparison::of(settings), until };
        with_arithmetic!(settings.arithmetic, N => {
            if let Some(edges) = RasterTriangle::<N>::new(triangle.corners_px(), settings.fill_rule) {
                stages.draw(RasterizedTriangle { triangle, edges: &edges, spans }, shader, frame, &mut ());
            }
        });
    }

    /// Returns the shader of each instance.
    pub(crate) fn shaders(&self) -> Vec<Shader<'a>> {
        let draws = self.scene.instances.iter().zip(&self.geometry.plans);
        draws.map(|(instance, plan)| Shader::new(self.settings, &self.scene.library, instance, plan)).collect()
    }

    /// Returns the range of triangles that are drawn in order, and the range of those whose fragments are sorted by
    /// depth.
    fn split(&self) -> (Range<usize>, Range<usize>) {
        let triangles = &self.extent.triangles;
        let sorts = self.until == LastStage::Shade;
        let first = if sorts { self.geometry.sorted_from(self.settings) } else { triangles.end };
        let first = first.clamp(triangles.start, triangles.end.max(triangles.start));
        (triangles.start..first, first..triangles.end)
    }
}
