//! A triangle in an arithmetic that is chosen when the program runs: for whoever asks a few of its pixels.

use super::numbers::Edge;
use super::steps::EdgeSteps;
use super::{Exact, Fixed, Floating, Sample, Triangle, within_fixed_point};
use crate::pipeline::settings::{Arithmetic, FillRule};

/// A [`Triangle`] in any arithmetic. What [`super::cover`] covers has its edge values.
#[derive(Clone, Copy, Debug)]
pub enum AnyTriangle {
    /// In fixed point.
    Fixed(Triangle<Fixed>),
    /// In single precision.
    F32(Triangle<Floating<f32>>),
    /// In double precision.
    F64(Triangle<Floating<f64>>),
    /// In exact arithmetic; also what lies beyond the reach of fixed point, on its snapped corners.
    Exact(Triangle<Exact>),
}

/// Calls `$body` with `$triangle` standing for the triangle in its arithmetic.
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
    /// Sets up the edges of a triangle by its corners in px, which may lie anywhere; `None` if a coordinate is not finite or
    /// there is no area.
    pub fn new(arithmetic: Arithmetic, corners_px: [[f32; 2]; 3], rule: FillRule) -> Option<Self> {
        let (corners_px, arithmetic) = within_fixed_point(corners_px, arithmetic);
        Some(match arithmetic {
            Arithmetic::Fixed => Self::Fixed(Triangle::new(corners_px, rule)?),
            Arithmetic::F32 => Self::F32(Triangle::new(corners_px, rule)?),
            Arithmetic::F64 => Self::F64(Triangle::new(corners_px, rule)?),
            Arithmetic::Exact => Self::Exact(Triangle::new(corners_px, rule)?),
        })
    }

    /// Edge values at a pixel's centre, inside the triangle or not.
    pub fn sample(&self, pixel: (u32, u32)) -> Sample {
        each!(self, triangle => triangle.sample(pixel, pixel))
    }

    /// How each edge comes to its value at a pixel's centre.
    pub fn steps(&self, (column, row): (u32, u32)) -> [EdgeSteps; 3] {
        each!(self, triangle => triangle.edges().each_ref().map(|edge| edge.steps(column.into(), row.into())))
    }

    /// For each edge, opposite to the corner of the same number, whether samples exactly on it belong to the triangle.
    pub fn owned(&self) -> [bool; 3] {
        each!(self, triangle => triangle.edges().each_ref().map(Edge::owned))
    }

    /// Doubled area, > 0, in the unit of edge values.
    pub fn doubled_area(&self) -> f64 {
        each!(self, triangle => triangle.doubled_area())
    }
}
