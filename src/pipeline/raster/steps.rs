//! Intermediate values of an edge function at one pixel's centre, for explanations. The final value decides coverage.

use super::numbers::Inward;

/// Edge function evaluated at one pixel's centre, with its intermediate values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EdgeSteps {
    /// Direction from the edge to the inside.
    pub(crate) inward: Inward,
    /// Whether pixel centres on the line belong to the triangle.
    pub(crate) owned: bool,
    /// Whether this pixel centre is inside, or on the line and owned.
    pub(crate) contains: bool,
    /// Factor that converts the computed value to an edge value.
    pub(crate) scale: f64,
    /// Intermediate values in the edge's arithmetic.
    pub(crate) numbers: EdgeNumbers,
}

/// Intermediate values of an edge function, by arithmetic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum EdgeNumbers {
    /// Fixed point: A·x + B·y + C in grid steps.
    Fixed {
        /// Coefficient A of x.
        a: i64,
        /// Coefficient B of y.
        b: i64,
        /// Constant term C.
        c: i64,
        /// Position of the pixel's centre, in grid steps.
        centre: [i64; 2],
        /// Edge value in units of 1/2¹⁶ px².
        value: i64,
    },
    /// Intermediate values in single precision.
    F32(FloatSteps<f32>),
    /// Intermediate values in double precision.
    F64(FloatSteps<f64>),
    /// Intermediate values of an exact predicate.
    Exact {
        /// Start of the edge, in pixels.
        from: [f64; 2],
        /// End of the edge, in pixels.
        to: [f64; 2],
        /// Position of the pixel's centre, in pixels.
        centre: [f64; 2],
        /// Sign of the triangle's area: 1 or −1.
        sign: f64,
        /// Value before scaling, in px². Its sign is exact.
        value: f64,
    },
}

/// Intermediate values of a float edge: `along` × (`centre` − `upper`), negated where the inside lies on the other
/// side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FloatSteps<F> {
    /// Upper end of the edge, in pixels.
    pub(crate) upper: [F; 2],
    /// Lower end of the edge, in pixels.
    pub(crate) lower: [F; 2],
    /// Position of the pixel's centre, in pixels.
    pub(crate) centre: [F; 2],
    /// Vector from the upper to the lower end, in pixels.
    pub(crate) along: [F; 2],
    /// Vector from the upper end to the pixel's centre, in pixels.
    pub(crate) to_centre: [F; 2],
    /// The two products whose difference is the value, in px².
    pub(crate) products: [F; 2],
    /// Whether the difference is negated, because the inside lies on the other side.
    pub(crate) negated: bool,
    /// Value before scaling, in px².
    pub(crate) value: F,
}
