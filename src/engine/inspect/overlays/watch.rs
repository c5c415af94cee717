//! Fragment counts and the visible triangle of every sample, recorded while drawing the frame again.

use crate::chain::{Frame, Recipe, redraw};
use crate::image::{Image, Rgba8};
use crate::pipeline::LastStage;
use crate::pipeline::cull::{Facing, facing};
use crate::pipeline::interpolate::{Fragment, uv_gradient};
use crate::pipeline::observe::{DepthOutcome, Observer};
use crate::pipeline::raster::{RasterSample, doubled_area};
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::Arithmetic;
use crate::pipeline::shade::Shader;
use crate::scene::{Scene, TriangleId};

/// Fragment counts and visible triangles of all samples, in the packed layout of the framebuffer.
#[derive(Clone, Debug)]
pub struct FragmentStats {
    /// Number of fragments that the rasterizer generated at each sample.
    pub(crate) rasterized: Image<u32>,
    /// Number of fragments that passed the depth test at each sample when they were drawn. Without a depth test, all
    /// fragments count.
    pub(crate) passed: Image<u32>,
    /// Number of fragments at each sample that passed the depth test but were discarded by the alpha test.
    pub(crate) alpha_rejected: Image<u32>,
    /// Number of fragments at each sample that are visible in the finished frame.
    pub(crate) visible: Image<u32>,
    /// Triangle written last at each sample, or [`TriangleId::NONE`]. Among blended triangles, this is normally the
    /// nearest.
    pub(crate) owner: Image<TriangleId>,
    /// Properties of the triangle written last at each sample.
    pub(crate) surface: Image<VisibleSurface>,
}

/// Properties of the visible triangle at a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct VisibleSurface {
    /// Area of the triangle as rasterized, in px²; for a clipped triangle, the area of the visible piece.
    pub(crate) area_px2: f32,
    /// Minimum height of the triangle in px: twice its area divided by its longest side.
    pub(crate) height_px: f32,
    /// Whether the triangle is front-facing.
    pub(crate) is_front: bool,
    /// Texel density at the sample, in texels per pixel along one axis; NaN without a texture.
    pub(crate) texels_per_px: f32,
}

impl VisibleSurface {
    /// Placeholder for samples without a visible triangle.
    pub(crate) const NONE: Self =
        Self { area_px2: f32::NAN, height_px: f32::NAN, is_front: false, texels_per_px: f32::NAN };
}

/// Draws a frame again and records fragment counts and the visible triangle of each sample.
pub(crate) fn watch(scene: &Scene, recipe: &Recipe, frame: &Frame) -> FragmentStats {
    let (width, height) = frame.drawn.color.size();
    let mut watcher = FragmentStatsRecorder {
        scene,
        recipe,
        frame,
        current: None,
        has_depth: frame.drawn.depth.is_some(),
        shaders: (scene.instances.iter().zip(frame.plans.iter()))
            .map(|(instance, plan)| Shader::new(&recipe.pipeline, &scene.library, instance, plan))
            .collect(),
        stats: FragmentStats {
            rasterized: Image::filled(width, height, 0),
            passed: Image::filled(width, height, 0),
            alpha_rejected: Image::filled(width, height, 0),
            visible: Image::filled(width, height, 0),
            owner: Image::filled(width, height, TriangleId::NONE),
            surface: Image::filled(width, height, VisibleSurface::NONE),
        },
    };
    redraw(scene, recipe, frame, LastStage::Shade, &mut watcher);
    watcher.stats
}

struct FragmentStatsRecorder<'a> {
    scene: &'a Scene,
    recipe: &'a Recipe,
    frame: &'a Frame,
    /// Address and constant properties of the triangle that produced the previous fragment, cached for the next
    /// fragment.
    current: Option<(*const ScreenTriangle, TriangleProperties)>,
    has_depth: bool,
    /// Shaders, one for each instance.
    shaders: Vec<Shader<'a>>,
    stats: FragmentStats,
}

/// Properties that are constant over a triangle.
#[derive(Clone, Copy)]
struct TriangleProperties {
    surface: VisibleSurface,
    /// Number of texels of the triangle's texture, width times height; 0 without a texture.
    texels: f32,
    is_blended: bool,
}

impl FragmentStatsRecorder<'_> {
    fn triangle_properties(&mut self, triangle: &ScreenTriangle) -> TriangleProperties {
        let address = std::ptr::from_ref(triangle);
        match self.current {
            Some((of, whole)) if of == address => whole,
            _ => {
                let whole = self.find(triangle);
                self.current = Some((address, whole));
                whole
            }
        }
    }

    fn find(&self, triangle: &ScreenTriangle) -> TriangleProperties {
        let arithmetic = self.recipe.pipeline.arithmetic;
        let (signed_area, _) = doubled_area(arithmetic, triangle.corners_px());
        let [area_px2, height_px] = area_and_height(&corners_px(triangle, arithmetic));
        let texture = self.scene.instances.get(triangle.instance as usize).and_then(|instance| {
            let library = &self.scene.library;
            Some(library.texture(library.material(instance.material).texture?).image().size())
        });
        TriangleProperties {
            surface: VisibleSurface {
                area_px2: area_px2 as f32,
                height_px: height_px as f32,
                is_front: facing(signed_area) == Facing::Front,
                texels_per_px: f32::NAN,
            },
            texels: texture.map_or(0.0, |(width, height)| width as f32 * height as f32),
            is_blended: self.frame.geometry().is_blended(triangle),
        }
    }

    /// Whether the surfaces behind a blended fragment remain visible.
    fn is_blended_over(&self, triangle: &ScreenTriangle, fragment: &Fragment) -> bool {
        let shader = self.shaders.get(triangle.instance as usize);
        self.recipe.pipeline.shading.reads_material() && shader.is_some_and(|shader| shader.alpha(fragment) < 1.0)
    }

    /// Returns the texel density in texels per pixel along one axis: the square root of the area that a pixel covers on
    /// the texture, in texels.
    fn texels_per_px(&self, triangle: &ScreenTriangle, sample: RasterSample, texels: f32) -> f32 {
        if texels == 0.0 {
            return f32::NAN;
        }
        let [right, down] = uv_gradient(triangle, &sample, self.recipe.pipeline.arithmetic);
        let density = (right.perp_dot(down).abs() * texels).sqrt();
        // Omitted texture coordinates are constant, so their density is 0.
        if density > 0.0 { density } else { f32::NAN }
    }
}

impl Observer for FragmentStatsRecorder<'_> {
    fn covered(&mut self, _triangle: &ScreenTriangle, sample: &RasterSample) {
        increase(&mut self.stats.rasterized, sample);
        if !self.has_depth {
            increase(&mut self.stats.passed, sample);
        }
    }

    fn depth_tested(&mut self, _triangle: &ScreenTriangle, sample: &RasterSample, outcome: DepthOutcome) {
        if outcome.passed {
            increase(&mut self.stats.passed, sample);
        }
    }

    fn alpha_rejected(&mut self, _triangle: &ScreenTriangle, fragment: &Fragment) {
        increase(&mut self.stats.alpha_rejected, &fragment.sample);
    }

    fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, _color: Rgba8) {
        let whole = self.triangle_properties(triangle);
        let texels_per_px = self.texels_per_px(triangle, fragment.sample, whole.texels);
        let (column, row) = (fragment.sample.column, fragment.sample.row);
        let is_seen_through = whole.is_blended && self.is_blended_over(triangle, fragment);
        let below = if is_seen_through { self.stats.visible.at(column, row) } else { 0 };
        self.stats.visible.set(column, row, below + 1);
        self.stats.owner.set(column, row, triangle.id);
        self.stats.surface.set(column, row, VisibleSurface { texels_per_px, ..whole.surface });
    }
}

fn increase(counts: &mut Image<u32>, sample: &RasterSample) {
    counts.set(sample.column, sample.row, counts.at(sample.column, sample.row) + 1);
}

/// Returns the corners with which a triangle is rasterized, in px: snapped to the subpixel grid in fixed point,
/// otherwise unsnapped.
pub(crate) fn corners_px(triangle: &ScreenTriangle, arithmetic: Arithmetic) -> [[f32; 2]; 3] {
    match arithmetic {
        Arithmetic::Fixed => triangle.snapped_px(),
        Arithmetic::F32 | Arithmetic::F64 | Arithmetic::Exact => triangle.corners_px(),
    }
}

/// Returns the area of a triangle in px² and its minimum height in px.
pub(crate) fn area_and_height(corners_px: &[[f32; 2]; 3]) -> [f64; 2] {
    let [a, b, c] = corners_px.map(|[x, y]| [f64::from(x), f64::from(y)]);
    let doubled = ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])).abs();
    let length = |a: [f64; 2], b: [f64; 2]| (b[0] - a[0]).hypot(b[1] - a[1]);
    let longest = length(a, b).max(length(b, c)).max(length(c, a));
    [doubled / 2.0, if longest > 0.0 { doubled / longest } else { 0.0 }]
}
