//! Intermediate values of an edge function at one pixel's centre, for explanations. The final value is the one that
//! decides coverage.

use super::numbers::Inward;

/// An edge function evaluated at one pixel's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeSteps {
    /// Direction from the edge to the inside.
    pub(crate) inward: Inward,
    /// Whether pixel centres on the line belong to the triangle.
    pub(crate) owned: bool,
    /// Whether this pixel centre is inside, or on the line and owned.
    pub(crate) contains: bool,
    /// Factor that turns the value into an edge value.
    pub(crate) scale: f64,
    /// Intermediate values in the edge's arithmetic.
    pub(crate) numbers: EdgeNumbers,
}

/// Intermediate values of an edge function, by arithmetic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EdgeNumbers {
    /// Fixed point: A·x + B·y + C in grid steps.
    Fixed {
        /// Coefficient A of x.
        a: i64,
        /// Coefficient B of y.
        b: i64,
        /// Constant term C.
        c: i64,
        /// Pixel centre in grid steps.
        centre: [i64; 2],
        /// Edge value in units of 1/2¹⁶ px².
        value: i64,
    },
    /// Single precision.
    F32(FloatSteps<f32>),
    /// Double precision.
    F64(FloatSteps<f64>),
    /// Exact predicate.
    Exact {
        /// Start of the edge, px.
        from: [f64; 2],
        /// End of the edge, px.
        to: [f64; 2],
        /// Pixel centre, px.
        centre: [f64; 2],
        /// Sign of the triangle's area: 1 or −1.
        sign: f64,
        /// Value before scaling, px². Its sign is exact.
        value: f64,
    },
}

/// Intermediate values of a float edge: `along` × (`centre` − `upper`), negated where the inside lies on the other
/// side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloatSteps<F> {
    /// Upper end, px.
    pub(crate) upper: [F; 2],
    /// Lower end, px.
    pub(crate) lower: [F; 2],
    /// Pixel centre, px.
    pub(crate) centre: [F; 2],
    /// Vector from the upper end to the lower, px.
    pub(crate) along: [F; 2],
    /// Vector from the upper end to the centre, px.
    pub(crate) to_centre: [F; 2],
    /// The two products whose difference is the value, px².
    pub(crate) products: [F; 2],
    /// Whether the difference is negated.
    pub(crate) negated: bool,
    /// Value before scaling, px².
    pub(crate) value: F,
}
