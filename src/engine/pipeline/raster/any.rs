//! Triangle set up in an arithmetic that is chosen at run time, for callers that examine a few of its pixels.

use super::numbers::RasterEdge;
use super::steps::EdgeSteps;
use super::{Arithmetic, FillRule};
use super::{Exact, Fixed, Floating, RasterSample, RasterTriangle, within_fixed_point};

/// [`RasterTriangle`] in an arithmetic that is chosen at run time. Its edge values agree with the coverage that
/// [`super::cover`] returns.
#[derive(Clone, Copy, Debug)]
pub(crate) enum AnyTriangle {
    /// Triangle in fixed point.
    Fixed(RasterTriangle<Fixed>),
    /// Triangle in single precision.
    F32(RasterTriangle<Floating<f32>>),
    /// Triangle in double precision.
    F64(RasterTriangle<Floating<f64>>),
    /// Triangle in exact arithmetic. Also used for snapped vertices beyond the range of fixed point.
    Exact(RasterTriangle<Exact>),
}

/// Evaluates `$body`, in which `$triangle` is the `RasterTriangle` that the variant holds.
macro_rules! each {
    ($any:expr, $triangle:ident => $body:expr) => {
        match $any {
            AnyTriangle::Fixed($triangle) => $body,
            AnyTriangle::F32($triangle) => $body,
            AnyTriangle::F64($triangle) => $body,
            AnyTriangle::Exact($triangle) => $body,
        }
    };
}

impl AnyTriangle {
    /// Sets up the edges of a triangle. Its vertices are given in pixels and may lie anywhere. Returns `None` if a
    /// coordinate is not finite or if the triangle has no area.
    pub(crate) fn new(arithmetic: Arithmetic, corners_px: [[f32; 2]; 3], rule: FillRule) -> Option<Self> {
        let (corners_px, arithmetic) = within_fixed_point(corners_px, arithmetic);
        Some(match arithmetic {
            Arithmetic::Fixed => Self::Fixed(RasterTriangle::new(corners_px, rule)?),
            Arithmetic::F32 => Self::F32(RasterTriangle::new(corners_px, rule)?),
            Arithmetic::F64 => Self::F64(RasterTriangle::new(corners_px, rule)?),
            Arithmetic::Exact => Self::Exact(RasterTriangle::new(corners_px, rule)?),
        })
    }

    /// Returns the sample at a pixel's centre with its edge values, whether or not it lies inside the triangle.
    pub(crate) fn sample(&self, pixel: (u32, u32)) -> RasterSample {
        each!(self, triangle => triangle.sample(pixel, pixel))
    }

    /// Returns the intermediate values of each edge function at a pixel's centre.
    pub(crate) fn steps(&self, (column, row): (u32, u32)) -> [EdgeSteps; 3] {
        each!(self, triangle => triangle.edges().each_ref().map(|edge| edge.steps(column.into(), row.into())))
    }

    /// Returns, for each edge, whether samples exactly on the edge belong to the triangle. The edges are in the order
    /// of the vertices opposite them.
    pub(crate) fn owned(&self) -> [bool; 3] {
        each!(self, triangle => triangle.edges().each_ref().map(RasterEdge::owned))
    }

    /// Returns the doubled area, > 0, in the unit of edge values.
    pub(crate) fn doubled_area(&self) -> f64 {
        each!(self, triangle => triangle.doubled_area())
    }
}
