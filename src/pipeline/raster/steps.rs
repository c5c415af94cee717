//! How an edge comes to its value at one pixel's centre, number by number: for whoever explains it. The value of a step is
//! the one that coverage was decided by.

use super::numbers::Inward;

/// An edge at one pixel's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeSteps {
    /// Direction from the edge to the inside.
    pub inward: Inward,
    /// Whether centres on the line belong to the triangle.
    pub owned: bool,
    /// Whether this centre does.
    pub contains: bool,
    /// What each edge value is scaled by at last.
    pub scale: f64,
    /// The numbers.
    pub numbers: EdgeNumbers,
}

/// The numbers of an edge in its arithmetic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EdgeNumbers {
    /// In fixed point: A·x + B·y + C in grid steps.
    Fixed {
        /// Factor of x.
        a: i64,
        /// Factor of y.
        b: i64,
        /// What is added.
        c: i64,
        /// The pixel's centre.
        centre: [i64; 2],
        /// The value.
        value: i64,
    },
    /// In single precision.
    F32(FloatSteps<f32>),
    /// In double precision.
    F64(FloatSteps<f64>),
    /// By the exact predicate.
    Exact {
        /// Where the edge starts, px.
        from: [f64; 2],
        /// Where it ends.
        to: [f64; 2],
        /// The pixel's centre.
        centre: [f64; 2],
        /// 1 or −1: the sign of the triangle's area.
        sign: f64,
        /// The value before it is scaled. Its sign is exact.
        value: f64,
    },
}

/// The numbers of a float edge: `along` × (`centre` − `upper`), negated where the inside lies on the other side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloatSteps<F> {
    /// The upper end, px.
    pub upper: [F; 2],
    /// The lower end.
    pub lower: [F; 2],
    /// The pixel's centre.
    pub centre: [F; 2],
    /// From the upper end to the lower.
    pub along: [F; 2],
    /// From the upper end to the centre.
    pub to_centre: [F; 2],
    /// The two products whose difference the value is.
    pub products: [F; 2],
    /// Whether that difference is negated.
    pub negated: bool,
    /// The value before it is scaled.
    pub value: F,
}
