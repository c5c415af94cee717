//! Intermediate values of an edge function at one pixel's centre, for explaining the coverage of a pixel. The sign of
//! the final value decides coverage.

use super::inward::Inward;

/// Edge function evaluated at one pixel's centre, with its intermediate values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EdgeSteps {
    /// Direction from the edge to the inside of the triangle.
    pub(crate) inward: Inward,
    /// Whether pixel centres exactly on the edge belong to the triangle, according to the fill rule.
    pub(crate) owned: bool,
    /// Whether this pixel centre lies on the inner side of the edge, or exactly on the edge if the triangle owns it.
    pub(crate) contains: bool,
    /// Factor by which the computed value is multiplied to give the edge value.
    pub(crate) scale: f64,
    /// Intermediate values, in the arithmetic that was used.
    pub(crate) numbers: EdgeNumbers,
}

/// Intermediate values of an edge function, with one variant per arithmetic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum EdgeNumbers {
    /// Intermediate values in fixed point.
    Fixed(FixedSteps),
    /// Intermediate values in single precision.
    F32(FloatSteps<f32>),
    /// Intermediate values in double precision.
    F64(FloatSteps<f64>),
    /// Intermediate values of an exact predicate.
    Exact(ExactSteps),
}

/// Intermediate values in fixed point: the terms of A·x + B·y + C, with x and y in grid steps of 1/256 px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FixedSteps {
    /// Coefficient A of x, in grid steps of 1/256 px.
    pub(crate) a: i64,
    /// Coefficient B of y, in grid steps of 1/256 px.
    pub(crate) b: i64,
    /// Constant term C, in units of 1/2¹⁶ px².
    pub(crate) c: i64,
    /// Position of the pixel's centre, in grid steps of 1/256 px.
    pub(crate) centre: [i64; 2],
    /// Edge value in units of 1/2¹⁶ px².
    pub(crate) value: i64,
}

/// Intermediate values of an exact predicate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ExactSteps {
    /// Start point of the edge, in pixels.
    pub(crate) from: [f64; 2],
    /// End point of the edge, in pixels.
    pub(crate) to: [f64; 2],
    /// Position of the pixel's centre, in pixels.
    pub(crate) centre: [f64; 2],
    /// Sign of the triangle's area: 1 or −1.
    pub(crate) sign: f64,
    /// Edge value before scaling, in px². Its sign is exact.
    pub(crate) value: f64,
}

/// Intermediate values of an edge function in float arithmetic: the cross product `along` × `to_centre`, negated if it
/// would otherwise be negative inside the triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FloatSteps<F> {
    /// Upper endpoint of the edge, in pixels.
    pub(crate) upper: [F; 2],
    /// Lower endpoint of the edge, in pixels.
    pub(crate) lower: [F; 2],
    /// Position of the pixel's centre, in pixels.
    pub(crate) centre: [F; 2],
    /// Vector from the upper to the lower endpoint, in pixels.
    pub(crate) along: [F; 2],
    /// Vector from the upper endpoint to the pixel's centre, in pixels.
    pub(crate) to_centre: [F; 2],
    /// Two products whose difference is the edge value, in px².
    pub(crate) products: [F; 2],
    /// Whether the difference of the products is negated to make it positive inside the triangle.
    pub(crate) negated: bool,
    /// Edge value before scaling, in px².
    pub(crate) value: F,
}
