//! System under test: all calls from the stability report into the engine.
//!
//! Results use the report's own types; other modules decide whether they are correct.

use glam::{Mat4, Vec3};
use serde::Serialize;

use super::oracle::{DepthMapping, DepthStorage, ScreenCorner, Snap};
use crate::pipeline::clip_space::{ClipVertex, Varyings};
use crate::pipeline::depth::DepthScale;
use crate::pipeline::depth_format::DepthEncoding;
use crate::pipeline::from_clip_space;
use crate::pipeline::interpolate::{AttributeSelection, affine_weights, attribute_weights, interpolate};
use crate::pipeline::raster::{self, AnyTriangle, Span};
use crate::pipeline::screen_triangle::{ScreenTriangle, TriangleOwner, depth_at};
use crate::pipeline::screen_vertex::ScreenVertex;
use crate::pipeline::settings::{Arithmetic, Choice as _, DepthFormat, FillRule, Interpolation, Rasterizer};
use crate::pipeline::viewport::Viewport;
use crate::scene::{self, DepthCurve};

/// Fill rule for pixel centres on edges, where a case does not specify one.
const RULE: FillRule = FillRule::TopLeft;

/// Configuration of triangle rasterization.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub struct Configuration {
    /// Algorithm that finds the covered pixels.
    pub rasterizer: Rasterizer,
    /// Number type of the rasterizer's arithmetic.
    pub arithmetic: Arithmetic,
}

impl Configuration {
    /// Returns all configurations, grouped by arithmetic. The published rasterizers, which always compute in f64, come
    /// last.
    pub(crate) fn all() -> Vec<Self> {
        let of = |arithmetic: Arithmetic| Rasterizer::correct().map(move |rasterizer| Self { rasterizer, arithmetic });
        let sound = Arithmetic::ALL.iter().copied().flat_map(of);
        let published = Rasterizer::ALL.iter().filter(|rasterizer| rasterizer.is_published());
        sound.chain(published.map(|rasterizer| Self { rasterizer: *rasterizer, arithmetic: Arithmetic::F64 })).collect()
    }

    /// Returns the vertex snapping of the configuration: to the 1/256 px grid in fixed point, otherwise none.
    pub(crate) fn declared_snap(self) -> Snap {
        if self.arithmetic == Arithmetic::Fixed { Snap::Grid256 } else { Snap::Unsnapped }
    }
}

/// Configuration of attribute interpolation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub struct Weighting {
    /// Formula that computes the weights of the vertices.
    pub(crate) interpolation: Interpolation,
    /// Number type in which edge functions are evaluated.
    pub arithmetic: Arithmetic,
}

impl Weighting {
    /// Returns all configurations, grouped by formula. The published formula computes in f32 and does not use edge
    /// functions.
    pub(crate) fn all() -> Vec<Self> {
        let of = |interpolation: Interpolation| {
            let arithmetics = Arithmetic::ALL.iter().copied();
            let arithmetics = arithmetics.filter(move |a| !is_published(interpolation) || *a == Arithmetic::F32);
            arithmetics.map(move |arithmetic| Self { interpolation, arithmetic })
        };
        Interpolation::ALL.iter().copied().flat_map(of).collect()
    }
}

/// Returns whether a formula is implemented as commonly published, with its faults.
pub(crate) fn is_published(interpolation: Interpolation) -> bool {
    interpolation == Interpolation::Published
}

/// Returns the pixels covered by a screen-space triangle with vertices in pixels.
pub(crate) fn cover(by: Configuration, corners_px: [[f32; 2]; 3], rule: FillRule, viewport: Viewport) -> Vec<Span> {
    raster::cover(by.rasterizer, by.arithmetic, corners_px, rule, viewport)
}

/// Values that the engine interpolates at one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sampled {
    /// Screen-space (affine) weights of the vertices.
    pub(crate) affine: [f64; 3],
    /// Weights of the vertices for attribute interpolation.
    pub(crate) weights: [f64; 3],
    /// Interpolated depth.
    pub(crate) depth: f64,
    /// Interpolated texture coordinates.
    pub(crate) uv: [f64; 2],
}

impl Sampled {
    /// Returns all interpolated values, in field order.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> {
        self.affine.into_iter().chain(self.weights).chain([self.depth]).chain(self.uv)
    }
}

/// A triangle prepared for interpolation at many pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interpolator {
    triangle: ScreenTriangle,
    edges: AnyTriangle,
    interpolation: Interpolation,
}

impl Interpolator {
    /// Prepares a screen-space triangle. Returns `None` if the triangle has no area in the engine's arithmetic.
    pub(crate) fn new(by: Weighting, corners: &[ScreenCorner; 3]) -> Option<Self> {
        let vertices = corners.map(|c| {
            let varyings = Varyings { uv: c.uv.into(), ..Varyings::default() };
            ScreenVertex::at([c.x, c.y], c.z.into(), 1.0 / c.w, varyings)
        });
        let edges = AnyTriangle::new(by.arithmetic, vertices.map(|v| v.position_px), RULE)?;
        let in_space = by.interpolation == Interpolation::Perspective;
        let scale = DepthScale::default();
        let triangle = ScreenTriangle::new(TriangleOwner::FIRST, vertices, edges.doubled_area(), &scale, in_space);
        Some(Self { triangle, edges, interpolation: by.interpolation })
    }

    /// Returns the attribute weights at a pixel centre; this is the timed operation.
    pub(crate) fn weights(&self, column: u32, row: u32) -> [f32; 3] {
        attribute_weights(&self.triangle, &self.edges.sample((column, row)), self.interpolation)
    }

    /// Returns all values that the engine interpolates at a pixel centre.
    pub(crate) fn at(&self, column: u32, row: u32) -> Sampled {
        let sample = self.edges.sample((column, row));
        let fragment = interpolate(&self.triangle, sample, AttributeSelection::all(self.interpolation));
        Sampled {
            affine: affine_weights(&self.triangle, &sample).map(f64::from),
            weights: fragment.weights.map(f64::from),
            depth: depth_at(&self.triangle, &sample).into(),
            uv: fragment.uv.to_array().map(f64::from),
        }
    }
}

/// A covered pixel of a clip-space triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ClipFragment {
    /// Column and row of the pixel.
    pub(crate) pixel: [u32; 2],
    /// Weights of the original vertices, before clipping.
    pub(crate) weights: [f64; 3],
    /// Interpolated depth at the pixel.
    pub(crate) depth: f64,
}

/// Clips, projects and rasterizes a clip-space triangle, and interpolates at every covered pixel.
pub(crate) fn draw(by: Configuration, corners: [[f32; 4]; 3], viewport: Viewport) -> Vec<ClipFragment> {
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
        let fragment = interpolate(&self.triangle, sample, AttributeSelection::all(self.interpolation));
        ClipFragment {
            pixel: [column, row],
            weights: fragment.source_weights.to_array().map(f64::from),
            depth: depth_at(&self.triangle, &sample).into(),
        }
    }
}

/// Returns all depth buffer formats.
pub(crate) fn depth_formats() -> &'static [DepthFormat] {
    DepthFormat::ALL
}

/// Returns the depth mapping and storage that a format declares, in the terms of the oracle.
pub(crate) fn meaning(format: DepthFormat) -> (DepthMapping, DepthStorage) {
    let scene::DepthMapping { curve, reversed } = format.mapping();
    let mapping = match (curve, reversed) {
        (DepthCurve::Hyperbolic, false) => DepthMapping::Standard,
        (DepthCurve::Hyperbolic, true) => DepthMapping::Reversed,
        (DepthCurve::HyperbolicInfinite, false) => DepthMapping::StandardInf,
        (DepthCurve::HyperbolicInfinite, true) => DepthMapping::ReversedInf,
        (DepthCurve::Linear, false) => DepthMapping::Linear,
        (DepthCurve::Linear, true) => DepthMapping::ReversedLinear,
    };
    let storage = match format.encoding() {
        DepthEncoding::F32 => DepthStorage::F32,
        DepthEncoding::Unorm24 => DepthStorage::Unorm24,
        DepthEncoding::Unorm16 => DepthStorage::Unorm16,
    };
    (mapping, storage)
}

/// Depth buffer encoding of one view.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DepthBuffer {
    scale: DepthScale,
}

impl DepthBuffer {
    /// Creates the encoding for a perspective view with these near and far planes.
    pub(crate) fn new(format: DepthFormat, near: f32, far: f32) -> Self {
        Self { scale: DepthScale::perspective(format.mapping(), format.encoding(), near, far) }
    }

    /// Returns the stored depth of a point at this distance.
    pub(crate) fn stored(&self, distance: f32) -> f64 {
        self.scale.stored(distance).into()
    }
}

/// Computes the distance of a world-space point from the eye along the view axis; `w_from_world` is the matrix row that
/// yields w.
pub(crate) fn distance(w_from_world: [f32; 4], point: [f32; 3]) -> f32 {
    let mut clip_from_world = Mat4::IDENTITY;
    for (axis, factor) in w_from_world.into_iter().enumerate() {
        clip_from_world.col_mut(axis).w = factor;
    }
    (clip_from_world * Vec3::from_array(point).extend(1.0)).w
}
