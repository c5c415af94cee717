//! What is judged: every question that the report asks the engine, and nothing else of it.
//!
//! Answers are numbers of the report's own kinds. Whether they are right is decided elsewhere.

use glam::{Mat4, Vec3, Vec4};

use super::oracle::{DepthMapping, DepthStorage, ScreenCorner, Snap};
use super::spans::Span;
use crate::math::fixed::{SUBPIXELS, snap};
use crate::pipeline::clip::{GUARD_BAND_PX, clip, guard_band_widening};
use crate::pipeline::depth::depth_at;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::interpolate::{Attributes, affine_weights, attribute_weights, interpolate};
use crate::pipeline::raster::{EdgeFunctions, Sample, Scissor, doubled_area, rasterize};
use crate::pipeline::settings::{Choice, DepthFormat, FillRule, Interpolation, Rasterizer, choice};
use crate::pipeline::vertex::{ClipVertex, Varyings};
use crate::pipeline::viewport::{ScreenTriangle, ScreenVertex, Viewport, relative_inv_w};
use crate::scene::{Camera, TriangleId};

choice! {
    /// The numbers that coverage is decided in.
    Arithmetic {
        Fixed = "fixed", "24.8 fixed point", "Corners are snapped to 1/256 px; from there on everything is exact integers.";
    }
}

/// A way to find the pixels of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
pub struct Configuration {
    /// The algorithm.
    pub rasterizer: Rasterizer,
    /// The numbers that it computes in.
    pub arithmetic: Arithmetic,
}

impl Configuration {
    /// All that there are, arithmetic by arithmetic.
    pub fn all() -> Vec<Self> {
        let of = |arithmetic: Arithmetic| {
            Rasterizer::ALL.iter().map(move |rasterizer| Self { rasterizer: *rasterizer, arithmetic })
        };
        Arithmetic::ALL.iter().copied().flat_map(of).collect()
    }

    /// Where it takes corners to be, as it declares.
    pub fn declared_snap(self) -> Snap {
        match self.arithmetic {
            Arithmetic::Fixed => Snap::Grid256,
        }
    }
}

/// A way to compute weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
pub struct Weighting {
    /// The formula.
    pub interpolation: Interpolation,
    /// The numbers that edges are evaluated in.
    pub arithmetic: Arithmetic,
}

impl Weighting {
    /// All that there are, formula by formula.
    pub fn all() -> Vec<Self> {
        let of = |interpolation: Interpolation| {
            Arithmetic::ALL.iter().map(move |arithmetic| Self { interpolation, arithmetic: *arithmetic })
        };
        Interpolation::ALL.iter().copied().flat_map(of).collect()
    }
}

/// The pixels that a triangle covers, corners in px. `None` if the engine does not take such a triangle.
pub fn cover(by: Configuration, corners_px: [[f32; 2]; 3], rule: FillRule, viewport: Viewport) -> Option<Vec<Span>> {
    if corners_px.iter().flatten().any(|c| c.abs() > GUARD_BAND_PX + viewport.width as f32) {
        return None;
    }
    let corner = |[x, y]: [f32; 2]| screen_vertex(x, y, 0.0, 1.0, Varyings::default());
    let mut spans = Vec::new();
    if let Some(triangle) = screen_triangle(corners_px.map(corner), rule, Interpolation::Perspective) {
        each_sample(by, &triangle, viewport, |s| spans.push(Span { row: s.row, left: s.column, right: s.column + 1 }));
    }
    Some(spans)
}

/// Everything that is interpolated at one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampled {
    /// Weights of the corners on the screen.
    pub affine: [f64; 3],
    /// Weights of the corners for attributes.
    pub weights: [f64; 3],
    /// Depth.
    pub depth: f64,
    /// Texture coordinates.
    pub uv: [f64; 2],
}

impl Sampled {
    /// Every number in it.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        self.affine.into_iter().chain(self.weights).chain([self.depth]).chain(self.uv)
    }
}

/// A triangle to be asked at many pixels.
#[derive(Clone, Copy, Debug)]
pub struct Interpolator {
    triangle: ScreenTriangle,
}

impl Interpolator {
    /// From its corners; `None` if the engine sees no area.
    pub fn new(by: Weighting, corners: &[ScreenCorner; 3]) -> Option<Self> {
        let vertices = corners
            .map(|c| screen_vertex(c.x, c.y, c.z, 1.0 / c.w, Varyings { uv: c.uv.into(), ..Varyings::default() }));
        Some(Self { triangle: screen_triangle(vertices, FillRule::TopLeft, by.interpolation)? })
    }

    /// What the engine has at the centre of a pixel.
    pub fn at(&self, column: u32, row: u32) -> Sampled {
        let edges = self.triangle.edges.at(SampleGrid::FULL.position(column, row));
        let sample = Sample { column, row, edges };
        let fragment = interpolate(&self.triangle, sample, Attributes::ALL);
        Sampled {
            affine: affine_weights(&self.triangle, &sample).map(f64::from),
            weights: attribute_weights(&self.triangle, &sample).map(f64::from),
            depth: depth_at(&self.triangle, &sample).into(),
            uv: fragment.uv.to_array().map(f64::from),
        }
    }
}

/// A covered pixel of a triangle in clip space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipFragment {
    /// Column and row.
    pub pixel: [u32; 2],
    /// Weights of the triangle's own corners, before clipping.
    pub weights: [f64; 3],
    /// Depth.
    pub depth: f64,
}

/// Clips, projects and rasterizes a triangle in clip space.
pub fn draw(by: Configuration, corners: [[f32; 4]; 3], viewport: Viewport) -> Vec<ClipFragment> {
    let vertices = corners.map(|c| ClipVertex { position: Vec4::from_array(c), varyings: Varyings::default() });
    let widening = guard_band_widening(viewport.width, viewport.height);
    let mut fragments = Vec::new();
    for piece in clip(&vertices, &[[0, 1, 2]], TriangleId(0), true, widening, &mut ()) {
        let projected = viewport.project(&piece);
        let Some(triangle) = screen_triangle(projected, FillRule::TopLeft, Interpolation::Perspective) else {
            continue;
        };
        each_sample(by, &triangle, viewport, |sample| {
            let fragment = interpolate(&triangle, sample, Attributes::ALL);
            fragments.push(ClipFragment {
                pixel: [sample.column, sample.row],
                weights: fragment.source_weights.to_array().map(f64::from),
                depth: depth_at(&triangle, &sample).into(),
            });
        });
    }
    fragments
}

/// All formats of the depth buffer.
pub fn depth_formats() -> &'static [DepthFormat] {
    DepthFormat::ALL
}

/// What a depth format means: how a distance becomes a number, and in what that is stored.
pub fn meaning(format: DepthFormat) -> (DepthMapping, DepthStorage) {
    match format {
        DepthFormat::F32 => (DepthMapping::Standard, DepthStorage::F32),
        DepthFormat::ReversedF32 => (DepthMapping::Reversed, DepthStorage::F32),
    }
}

/// What depth buffers of one view store.
#[derive(Clone, Copy, Debug)]
pub struct DepthBuffer {
    clip_from_view: Mat4,
}

impl DepthBuffer {
    /// For a perspective view with these planes.
    pub fn new(format: DepthFormat, near: f32, far: f32) -> Self {
        let camera = Camera { near, far, ..Camera::look_at(Vec3::ZERO, Vec3::NEG_Z) };
        Self { clip_from_view: camera.clip_from_view(1.0, format == DepthFormat::ReversedF32) }
    }

    /// What is stored for a point at this distance.
    pub fn stored(&self, distance: f32) -> f64 {
        let clip = self.clip_from_view * Vec4::new(0.0, 0.0, -distance, 1.0);
        (clip.z * (1.0 / clip.w)).clamp(0.0, 1.0).into()
    }
}

/// The distance of a point in the world along a line of sight, by the matrix row that makes w.
pub fn distance(w_from_world: [f32; 4], point: [f32; 3]) -> f32 {
    let mut clip_from_world = Mat4::IDENTITY;
    for (axis, factor) in w_from_world.into_iter().enumerate() {
        clip_from_world.col_mut(axis).w = factor;
    }
    (clip_from_world * Vec3::from_array(point).extend(1.0)).w
}

fn screen_vertex(x: f32, y: f32, depth: f32, inv_w: f32, varyings: Varyings) -> ScreenVertex {
    debug_assert!(x.abs() * (SUBPIXELS as f32) < i32::MAX as f32, "within the guard band");
    ScreenVertex { x: snap(x) as i32, y: snap(y) as i32, depth, inv_w, varyings }
}

fn screen_triangle(
    vertices: [ScreenVertex; 3],
    rule: FillRule,
    interpolation: Interpolation,
) -> Option<ScreenTriangle> {
    let area = doubled_area(vertices.each_ref().map(|v| (v.x, v.y)));
    let inv_w = if interpolation == Interpolation::Perspective { relative_inv_w(&vertices) } else { [1.0; 3] };
    (area != 0).then(|| ScreenTriangle {
        id: TriangleId(0),
        instance: 0,
        edges: EdgeFunctions::new(&vertices, area, rule),
        relative_inv_w: inv_w,
        vertices,
    })
}

fn each_sample(by: Configuration, triangle: &ScreenTriangle, viewport: Viewport, sink: impl FnMut(Sample)) {
    let scissor = Scissor::full(viewport.width, viewport.height);
    rasterize(by.rasterizer, &triangle.edges, SampleGrid::FULL, scissor, sink);
}
