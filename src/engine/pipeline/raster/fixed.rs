//! 24.8 fixed point: vertices are snapped to 1/256 px, and all later arithmetic is in exact integers.
//!
//! The edge functions follow Pineda, "A Parallel Algorithm for Polygon Rasterization" (SIGGRAPH 1988): e(p) = (b − a) ×
//! (p − a) for the edge a → b. The sign is chosen so that the inside is positive for either winding. The two triangles
//! that share an edge compute exactly opposite values, so no cracks appear.
//!
//! ```text
//!   A > 0  the inside lies to the right: a left edge        e(x, y) = A·x + B·y + C
//!   A = 0, B > 0  the inside lies below: a top edge
//! ```
//!
//! Range: with coordinates within ±2²⁸ grid steps ([`LIMIT_PX`]) differences need 30 bits, products 59, sums 61. In the
//! pipeline's guard band (±2²⁴ grid steps) values stay below 2⁵³, so they are exact as f64 as well.

use super::fill_rule::FillRule;
use super::inward::Inward;
use super::numbers::{BoundaryWalk, Numbers, RasterEdge};
use super::steps::{EdgeNumbers, EdgeSteps, FixedSteps};
use crate::math::fixed::{HALF_PIXEL, SUBPIXELS, snap};

/// Largest magnitude of a coordinate, in pixels, for which all intermediate integers fit into 64 bits.
pub(super) const LIMIT_PX: f32 = 1_048_576.0;

/// Fixed-point arithmetic in grid steps of 1/256 px.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fixed;

/// Triangle edge in fixed point: the edge function a·x + b·y + c, with x and y in grid steps of 1/256 px.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FixedEdge {
    a: i64,
    b: i64,
    c: i64,
    owned: bool,
}

impl Numbers for Fixed {
    type Coordinate = i64;
    type Edge = FixedEdge;

    fn coordinate(px: f32) -> i64 {
        snap(px)
    }

    fn doubled_area([a, b, c]: [[i64; 2]; 3]) -> (f64, f64) {
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        (area as f64, 1.0)
    }

    fn edge([from, to]: [[i64; 2]; 2], sign: f64, _scale: f64, rule: FillRule) -> FixedEdge {
        let sign = sign as i64;
        let a = (from[1] - to[1]) * sign;
        let b = (to[0] - from[0]) * sign;
        let owned = Inward::new(a, b).owned(rule);
        FixedEdge { a, b, c: -(a * from[0] + b * from[1]), owned }
    }

    fn first_centre(coordinate: i64) -> i64 {
        (coordinate - HALF_PIXEL + SUBPIXELS - 1).div_euclid(SUBPIXELS)
    }

    fn last_centre(coordinate: i64) -> i64 {
        (coordinate - HALF_PIXEL).div_euclid(SUBPIXELS)
    }
}

impl FixedEdge {
    #[inline]
    fn at(&self, column: i64, row: i64) -> i64 {
        self.a * centre(column) + self.b * centre(row) + self.c
    }

    /// Returns the fractional column at which the centre line of a row crosses the edge. If a pixel centre exactly on
    /// the edge does not count as right of the edge, the numerator is increased by 1. The ceiling of the fraction is
    /// therefore always [`RasterEdge::boundary`].
    fn crossing(&self, row: i64) -> Ratio {
        let tie = i64::from(!self.inward().tie_is_beyond(self.owned));
        let numerator = -(self.b * centre(row) + self.c) * self.a.signum() + tie - HALF_PIXEL * self.a.abs();
        Ratio { numerator, denominator: SUBPIXELS * self.a.abs() }
    }
}

/// Returns the coordinate of a pixel's centre along one axis, in grid steps of 1/256 px.
#[inline]
fn centre(pixel: i64) -> i64 {
    pixel * SUBPIXELS + HALF_PIXEL
}

/// Fraction with a positive denominator.
#[derive(Clone, Copy, Debug)]
struct Ratio {
    numerator: i64,
    denominator: i64,
}

impl RasterEdge for FixedEdge {
    type Walk = FixedWalk;

    fn inward(&self) -> Inward {
        Inward::new(self.a, self.b)
    }

    fn owned(&self) -> bool {
        self.owned
    }

    #[inline]
    fn value(&self, column: i64, row: i64) -> f64 {
        self.at(column, row) as f64
    }

    #[inline]
    fn contains(&self, column: i64, row: i64) -> bool {
        self.at(column, row) >= i64::from(!self.owned)
    }

    fn steps(&self, column: i64, row: i64) -> EdgeSteps {
        let Self { a, b, c, owned } = *self;
        let centre = [centre(column), centre(row)];
        let numbers = EdgeNumbers::Fixed(FixedSteps { a, b, c, centre, value: self.at(column, row) });
        EdgeSteps { inward: self.inward(), owned, contains: self.contains(column, row), scale: 1.0, numbers }
    }

    fn boundary(&self, row: i64) -> i64 {
        let Ratio { numerator, denominator } = self.crossing(row);
        -(-numerator).div_euclid(denominator)
    }

    fn walk(&self, row: i64) -> FixedWalk {
        let Ratio { numerator, denominator } = self.crossing(row);
        let per_row = -self.b * SUBPIXELS * self.a.signum();
        FixedWalk {
            boundary: -(-numerator).div_euclid(denominator),
            shortfall: (-numerator).rem_euclid(denominator),
            denominator,
            whole_step: per_row.div_euclid(denominator),
            rest_step: per_row.rem_euclid(denominator),
        }
    }
}

/// Row-by-row walk down an edge by Bresenham's algorithm: an integer column and an exact remainder, so no error
/// accumulates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FixedWalk {
    boundary: i64,
    /// Distance from the fractional crossing to the boundary column, in units of 1/`denominator` of a column: 0 ≤
    /// shortfall < denominator.
    shortfall: i64,
    denominator: i64,
    whole_step: i64,
    rest_step: i64,
}

impl BoundaryWalk for FixedWalk {
    fn boundary(&self) -> i64 {
        self.boundary
    }

    fn step(&mut self) {
        self.boundary += self.whole_step;
        self.shortfall -= self.rest_step;
        if self.shortfall < 0 {
            self.boundary += 1;
            self.shortfall += self.denominator;
        }
    }
}
