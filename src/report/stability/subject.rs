//! What is judged: every question that the report asks the engine, and nothing else of it.
//!
//! Answers are numbers of the report's own kinds. Whether they are right is decided elsewhere.

use glam::{Mat4, Vec3};
use serde::Serialize;

use super::oracle::{DepthMapping, DepthStorage, ScreenCorner, Snap};
use crate::pipeline::depth::{DepthScale, depth_at};
use crate::pipeline::from_clip_space;
use crate::pipeline::interpolate::{Attributes, affine_weights, attribute_weights, interpolate};
use crate::pipeline::raster::{self, AnyTriangle, Span};
use crate::pipeline::settings::{Arithmetic, Choice as _, DepthFormat, FillRule, Interpolation, Rasterizer};
use crate::pipeline::vertex::{ClipVertex, Varyings};
use crate::pipeline::viewport::{ScreenTriangle, ScreenVertex, Viewport};
use crate::scene::TriangleId;

/// The rule that decides about centres on edges where a case does not say.
const RULE: FillRule = FillRule::TopLeft;

/// A way to find the pixels of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub struct Configuration {
    /// The algorithm.
    pub rasterizer: Rasterizer,
    /// The numbers that it computes in.
    pub arithmetic: Arithmetic,
}

impl Configuration {
    /// All that there are, arithmetic by arithmetic. The published rasterizers have one of their own and stand at the end.
    pub fn all() -> Vec<Self> {
        let of = |arithmetic: Arithmetic| Rasterizer::sound().map(move |rasterizer| Self { rasterizer, arithmetic });
        let sound = Arithmetic::ALL.iter().copied().flat_map(of);
        let published = Rasterizer::ALL.iter().filter(|rasterizer| rasterizer.is_published());
        sound.chain(published.map(|rasterizer| Self { rasterizer: *rasterizer, arithmetic: Arithmetic::F64 })).collect()
    }

    /// Where it takes corners to be, as it declares.
    pub fn declared_snap(self) -> Snap {
        if self.arithmetic == Arithmetic::Fixed { Snap::Grid256 } else { Snap::Unsnapped }
    }
}

/// A way to compute weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub struct Weighting {
    /// The formula.
    pub interpolation: Interpolation,
    /// The numbers that edges are evaluated in.
    pub arithmetic: Arithmetic,
}

impl Weighting {
    /// All that there are, formula by formula. The published one computes in f32 and does not look at edges at all.
    pub fn all() -> Vec<Self> {
        let of = |interpolation: Interpolation| {
            let arithmetics = Arithmetic::ALL.iter().copied();
            let arithmetics = arithmetics.filter(move |a| !is_published(interpolation) || *a == Arithmetic::F32);
            arithmetics.map(move |arithmetic| Self { interpolation, arithmetic })
        };
        Interpolation::ALL.iter().copied().flat_map(of).collect()
    }
}

/// Whether a formula for weights is commonly published with faults, and kept so.
pub fn is_published(interpolation: Interpolation) -> bool {
    interpolation == Interpolation::Published
}

/// The pixels that a triangle covers, corners in px.
pub fn cover(by: Configuration, corners_px: [[f32; 2]; 3], rule: FillRule, viewport: Viewport) -> Vec<Span> {
    raster::cover(by.rasterizer, by.arithmetic, corners_px, rule, viewport)
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
    edges: AnyTriangle,
    interpolation: Interpolation,
}

impl Interpolator {
    /// From its corners on the screen; `None` if the engine sees no area.
    pub fn new(by: Weighting, corners: &[ScreenCorner; 3]) -> Option<Self> {
        let vertices = corners.map(|c| {
            let varyings = Varyings { uv: c.uv.into(), ..Varyings::default() };
            ScreenVertex::at([c.x, c.y], c.z.into(), 1.0 / c.w, varyings)
        });
        let edges = AnyTriangle::new(by.arithmetic, vertices.map(|v| v.position_px), RULE)?;
        let in_space = by.interpolation == Interpolation::Perspective;
        let scale = DepthScale::default();
        let triangle = ScreenTriangle::new((TriangleId(0), 0), vertices, edges.doubled_area(), &scale, in_space);
        Some(Self { triangle, edges, interpolation: by.interpolation })
    }

    /// The weights for attributes at the centre of a pixel: what is timed.
    pub fn weights(&self, column: u32, row: u32) -> [f32; 3] {
        attribute_weights(&self.triangle, &self.edges.sample((column, row)), self.interpolation)
    }

    /// What the engine has at the centre of a pixel.
    pub fn at(&self, column: u32, row: u32) -> Sampled {
        let sample = self.edges.sample((column, row));
        let fragment = interpolate(&self.triangle, sample, Attributes::all(self.interpolation));
        Sampled {
            affine: affine_weights(&self.triangle, &sample).map(f64::from),
            weights: fragment.weights.map(f64::from),
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

/// Clips, projects and rasterizes a triangle in clip space, and interpolates at every pixel covered.
pub fn draw(by: Configuration, corners: [[f32; 4]; 3], viewport: Viewport) -> Vec<ClipFragment> {
    let vertices = corners.map(|position| ClipVertex::at(position.into()));
    let interpolation = Interpolation::Perspective;
    let mut fragments = Vec::new();
    for piece in from_clip_space(&vertices, &[[0, 1, 2]], by.arithmetic, viewport, &mut ()) {
        let Some(edges) = AnyTriangle::new(by.arithmetic, piece.corners_px(), RULE) else { continue };
        let drawn = Interpolator { triangle: piece, edges, interpolation };
        for span in cover(by, piece.corners_px(), RULE, viewport) {
            fragments.extend((span.left..span.right).map(|column| drawn.clip_fragment(column, span.row)));
        }
    }
    fragments
}

impl Interpolator {
    fn clip_fragment(&self, column: u32, row: u32) -> ClipFragment {
        let sample = self.edges.sample((column, row));
        let fragment = interpolate(&self.triangle, sample, Attributes::all(self.interpolation));
        ClipFragment {
            pixel: [column, row],
            weights: fragment.source_weights.to_array().map(f64::from),
            depth: depth_at(&self.triangle, &sample).into(),
        }
    }
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
        DepthFormat::ReversedInfinite => (DepthMapping::ReversedInf, DepthStorage::F32),
        DepthFormat::Unorm24 => (DepthMapping::Standard, DepthStorage::Unorm24),
        DepthFormat::Unorm16 => (DepthMapping::Standard, DepthStorage::Unorm16),
        DepthFormat::WBuffer => (DepthMapping::Linear, DepthStorage::F32),
    }
}

/// What depth buffers of one view store.
#[derive(Clone, Copy, Debug)]
pub struct DepthBuffer {
    scale: DepthScale,
}

impl DepthBuffer {
    /// For a perspective view with these planes.
    pub fn new(format: DepthFormat, near: f32, far: f32) -> Self {
        Self { scale: DepthScale::perspective(format.mapping(), format.encoding(), near, far) }
    }

    /// What is stored for a point at this distance.
    pub fn stored(&self, distance: f32) -> f64 {
        self.scale.stored(distance).into()
    }
}

/// The distance of a point in the world along the line of sight, by the matrix row that makes w.
pub fn distance(w_from_world: [f32; 4], point: [f32; 3]) -> f32 {
    let mut clip_from_world = Mat4::IDENTITY;
    for (axis, factor) in w_from_world.into_iter().enumerate() {
        clip_from_world.col_mut(axis).w = factor;
    }
    (clip_from_world * Vec3::from_array(point).extend(1.0)).w
}
