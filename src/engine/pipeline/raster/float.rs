//! Floating point, f32 or f64, on unsnapped vertices: the arithmetic of most tutorials, made as robust as possible.
//!
//! Both triangles that share an edge evaluate it from its upper endpoint. They therefore get exactly opposite values,
//! and agree on which side a pixel centre lies, even where rounding makes the result wrong. The position at which an
//! edge crosses a row is a weighted mean of the edge's endpoints, so it stays between them even if the edge is almost
//! horizontal. Rounding errors remain: a pixel centre closer to an edge than the floats resolve may fall on the wrong
//! side. A walk that adds the slope row by row accumulates error (drift).

use num_traits::Float;

use super::fill_rule::FillRule;
use super::inward::Inward;
use super::numbers::{BoundaryWalk, Numbers, RasterEdge};
use super::steps::{EdgeNumbers, EdgeSteps, FloatSteps};

/// Rasterization arithmetic in IEEE 754 floats of type `F`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Floating<F>(std::marker::PhantomData<F>);

/// Triangle edge in float arithmetic, given by its endpoints in pixels. Of two endpoints at equal height, the left one
/// is `upper`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FloatEdge<F> {
    upper: [F; 2],
    lower: [F; 2],
    /// Whether the cross product (lower − upper) × (p − upper) is negative for points p inside the triangle.
    negated: bool,
    owned: bool,
    scale: f64,
}

/// Float type for which [`EdgeNumbers`] has a variant.
pub(crate) trait Explained: Sized {
    /// Wraps the intermediate values of an edge function in the variant of this type.
    fn numbers(steps: FloatSteps<Self>) -> EdgeNumbers;
}

impl Explained for f32 {
    fn numbers(steps: FloatSteps<Self>) -> EdgeNumbers {
        EdgeNumbers::F32(steps)
    }
}

impl Explained for f64 {
    fn numbers(steps: FloatSteps<Self>) -> EdgeNumbers {
        EdgeNumbers::F64(steps)
    }
}

impl<F: Float + Default + Into<f64> + Explained> Numbers for Floating<F> {
    type Coordinate = F;
    type Edge = FloatEdge<F>;

    fn coordinate(px: f32) -> F {
        // Every f32 converts to f32 and f64 without rounding.
        F::from(px).unwrap_or_else(F::nan)
    }

    fn doubled_area([a, b, c]: [[F; 2]; 3]) -> (f64, f64) {
        let area: f64 = ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])).into();
        (area, unit_scale(area))
    }

    fn edge([from, to]: [[F; 2]; 2], sign: f64, scale: f64, rule: FillRule) -> FloatEdge<F> {
        let downwards = (from[1], from[0]) <= (to[1], to[0]);
        let (upper, lower) = if downwards { (from, to) } else { (to, from) };
        let edge = FloatEdge { upper, lower, negated: downwards != (sign > 0.0), owned: false, scale };
        FloatEdge { owned: edge.inward().owned(rule), ..edge }
    }

    fn first_centre(coordinate: F) -> i64 {
        to_pixel((coordinate - half()).ceil())
    }

    fn last_centre(coordinate: F) -> i64 {
        to_pixel((coordinate - half()).floor())
    }
}

/// Returns the power of two that scales the magnitude of `area` into [1, 2). Weights scaled by it neither overflow nor
/// underflow in f32.
pub(super) fn unit_scale(area: f64) -> f64 {
    if area.is_normal() { 2.0_f64.powi(-(area.abs().log2().floor() as i32)) } else { 1.0 }
}

/// Magnitude to which pixel coordinates are clamped: outside any picture, and far from overflow when a pixel is added
/// or subtracted.
const FARTHEST_PIXEL: f64 = 1e9;

fn to_pixel<F: Into<f64>>(whole: F) -> i64 {
    whole.into().clamp(-FARTHEST_PIXEL, FARTHEST_PIXEL) as i64
}

fn half<F: Float>() -> F {
    F::one() / (F::one() + F::one())
}

/// Returns the coordinate of a pixel's centre along one axis, in pixels. Exact, because pixel coordinates of pictures
/// are small integers.
#[inline]
fn centre<F: Float>(pixel: i64) -> F {
    F::from(pixel).unwrap_or_else(F::nan) + half()
}

impl<F: Float + Default + Into<f64> + Explained> FloatEdge<F> {
    #[inline]
    fn at(&self, column: i64, row: i64) -> F {
        self.float_steps(column, row).value
    }

    #[inline(always)]
    fn float_steps(&self, column: i64, row: i64) -> FloatSteps<F> {
        let Self { upper, lower, negated, .. } = *self;
        let along = [lower[0] - upper[0], lower[1] - upper[1]];
        let centre = [centre::<F>(column), centre::<F>(row)];
        let to_centre = [centre[0] - upper[0], centre[1] - upper[1]];
        let products = [along[0] * to_centre[1], along[1] * to_centre[0]];
        let value = products[0] - products[1];
        let value = if negated { -value } else { value };
        FloatSteps { upper, lower, centre, along, to_centre, products, negated, value }
    }

    /// Returns the x, in pixels, at which the centre line of a row crosses the edge.
    fn crossing(&self, row: i64) -> F {
        let t = (centre::<F>(row) - self.upper[1]) / (self.lower[1] - self.upper[1]);
        self.upper[0] * (F::one() - t) + self.lower[0] * t
    }

    /// Returns the first column whose centre lies to the right of `x`, which is in pixels. The fill rule decides for a
    /// centre exactly at `x`.
    fn column_beyond(&self, x: F) -> i64 {
        let before = x - half();
        if self.inward().tie_is_beyond(self.owned) { to_pixel(before.ceil()) } else { to_pixel(before.floor()) + 1 }
    }
}

impl<F: Float + Default + Into<f64> + Explained> RasterEdge for FloatEdge<F> {
    type Walk = FloatWalk<F>;

    fn inward(&self) -> Inward {
        // Compared, not subtracted, because a difference may overflow.
        let order = |a: F, b: F| i8::from(a < b) - i8::from(b < a);
        let along = order(self.upper[0], self.lower[0]);
        let down = order(self.upper[1], self.lower[1]);
        let flip = if self.negated { -1 } else { 1 };
        Inward { right: -down * flip, down: along * flip }
    }

    fn owned(&self) -> bool {
        self.owned
    }

    fn value(&self, column: i64, row: i64) -> f64 {
        self.at(column, row).into() * self.scale
    }

    #[inline]
    fn contains(&self, column: i64, row: i64) -> bool {
        let value = self.at(column, row);
        value > F::zero() || (value == F::zero() && self.owned)
    }

    fn steps(&self, column: i64, row: i64) -> EdgeSteps {
        EdgeSteps {
            inward: self.inward(),
            owned: self.owned,
            contains: self.contains(column, row),
            scale: self.scale,
            numbers: F::numbers(self.float_steps(column, row)),
        }
    }

    fn boundary(&self, row: i64) -> i64 {
        self.column_beyond(self.crossing(row))
    }

    /// Starts a walk down the edge at `row`. The walk computes the crossing at the edge's first row within the picture
    /// and adds the slope for every row from there, even if `row` lies further down. The result for a row therefore
    /// does not depend on which rows are visited.
    fn walk(&self, row: i64) -> FloatWalk<F> {
        let first = Floating::<F>::first_centre(self.upper[1]).max(0).min(row);
        let slope = (self.lower[0] - self.upper[0]) / (self.lower[1] - self.upper[1]);
        let mut walk = FloatWalk { edge: *self, x: self.crossing(first), slope };
        for _ in first..row {
            walk.step();
        }
        walk
    }
}

/// Row-by-row walk down an edge by the textbook method: x += dx/dy for every row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FloatWalk<F> {
    edge: FloatEdge<F>,
    x: F,
    slope: F,
}

impl<F: Float + Default + Into<f64> + Explained> BoundaryWalk for FloatWalk<F> {
    fn boundary(&self) -> i64 {
        self.edge.column_beyond(self.x)
    }

    fn step(&mut self) {
        self.x = self.x + self.slope;
    }
}
