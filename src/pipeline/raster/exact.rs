//! Exact decisions on corners as they are, without snapping: Shewchuk, "Adaptive Precision Floating-Point Arithmetic and
//! Fast Robust Geometric Predicates" (1997), from the crate `robust`.
//!
//! Corners are f32, so neither an overflow nor an underflow touches the expansions, and every sign is right. A row's
//! crossing is found by an estimate in f64 that the exact sign then corrects, column by column.

use robust::{Coord, orient2d};

use super::float::{Floating, unit_scale};
use super::numbers::{Edge, Inward, Numbers, Walk};
use crate::pipeline::settings::FillRule;
use crate::pipeline::viewport::MAX_SIDE_PX;

/// Adaptive exact predicates on coordinates in px.
#[derive(Clone, Copy, Debug)]
pub struct Exact;

/// An edge by its ends.
#[derive(Clone, Copy, Debug)]
pub struct ExactEdge {
    from: [f64; 2],
    to: [f64; 2],
    sign: f64,
    scale: f64,
    owned: bool,
    inward: Inward,
}

impl Numbers for Exact {
    type Coordinate = f64;
    type Edge = ExactEdge;

    fn coordinate(px: f32) -> f64 {
        px.into()
    }

    fn doubled_area([a, b, c]: [[f64; 2]; 3]) -> (f64, f64) {
        let area = oriented(a, b, c);
        (area, unit_scale(area))
    }

    fn edge([from, to]: [[f64; 2]; 2], sign: f64, scale: f64, rule: FillRule) -> ExactEdge {
        let order = |a: f64, b: f64| i8::from(a < b) - i8::from(b < a);
        let flip = if sign < 0.0 { -1 } else { 1 };
        let inward = Inward { right: order(to[1], from[1]) * flip, down: order(from[0], to[0]) * flip };
        ExactEdge { from, to, sign, scale, owned: inward.owned(rule), inward }
    }

    fn first_centre(coordinate: f64) -> i64 {
        Floating::<f64>::first_centre(coordinate)
    }

    fn last_centre(coordinate: f64) -> i64 {
        Floating::<f64>::last_centre(coordinate)
    }
}

/// (b − a) × (c − a): the sign is exact; the magnitude has all digits of an f64 unless coordinates differ by more than 2²⁹
/// in size.
fn oriented(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let exact_sign = orient2d(coord(a), coord(b), coord(c));
    let magnitude = difference_of_products([b[0] - a[0], c[1] - a[1]], [c[0] - a[0], b[1] - a[1]]);
    if magnitude * exact_sign > 0.0 { magnitude } else { exact_sign }
}

/// p₀·p₁ − q₀·q₁ to within 1.5 ulp, by Kahan's algorithm (Jeannerod, Louvet and Muller, "Further analysis of Kahan's
/// algorithm for the accurate computation of 2×2 determinants", 2013).
fn difference_of_products(p: [f64; 2], q: [f64; 2]) -> f64 {
    let product = q[0] * q[1];
    let rounding = (-q[0]).mul_add(q[1], product);
    p[0].mul_add(p[1], -product) + rounding
}

fn coord([x, y]: [f64; 2]) -> Coord<f64> {
    Coord { x, y }
}

fn centre(column: i64, row: i64) -> [f64; 2] {
    [column as f64 + 0.5, row as f64 + 0.5]
}

impl ExactEdge {
    /// The exact sign of the value at a pixel's centre, as a number of unreliable magnitude.
    fn sign_at(&self, column: i64, row: i64) -> f64 {
        orient2d(coord(self.from), coord(self.to), coord(centre(column, row))) * self.sign
    }

    /// Whether a column lies beyond the edge on a row.
    fn is_beyond(&self, column: i64, row: i64) -> bool {
        self.contains(column, row) == (self.inward.right > 0)
    }

    /// About where a row crosses, in px.
    fn estimate(&self, row: i64) -> f64 {
        let t = (row as f64 + 0.5 - self.from[1]) / (self.to[1] - self.from[1]);
        self.from[0] * (1.0 - t) + self.to[0] * t
    }
}

impl Edge for ExactEdge {
    type Walk = ExactWalk;

    fn inward(&self) -> Inward {
        self.inward
    }

    fn owned(&self) -> bool {
        self.owned
    }

    fn value(&self, column: i64, row: i64) -> f64 {
        oriented(self.from, self.to, centre(column, row)) * self.sign * self.scale
    }

    fn contains(&self, column: i64, row: i64) -> bool {
        let sign = self.sign_at(column, row);
        sign > 0.0 || (sign == 0.0 && self.owned)
    }

    fn boundary(&self, row: i64) -> i64 {
        let last = i64::from(MAX_SIDE_PX);
        let estimate = (self.estimate(row).clamp(0.0, last as f64) as i64).clamp(0, last);
        // Columns below `outer` are not beyond, `inner` and all after it are; steps double until they enclose the boundary.
        let (mut before, mut beyond) = (estimate, estimate);
        let mut step = 1;
        if self.is_beyond(estimate, row) {
            while before >= 0 && self.is_beyond(before, row) {
                beyond = before;
                before -= step;
                step *= 2;
            }
            before = before.max(-1);
        } else {
            while beyond <= last && !self.is_beyond(beyond, row) {
                before = beyond;
                beyond += step;
                step *= 2;
            }
            beyond = beyond.min(last + 1);
        }
        while beyond - before > 1 {
            let middle = (before + beyond).div_euclid(2);
            if self.is_beyond(middle, row) {
                beyond = middle;
            } else {
                before = middle;
            }
        }
        beyond
    }

    fn walk(&self, row: i64) -> ExactWalk {
        ExactWalk { edge: *self, row }
    }
}

/// There is no exact step: every row is found anew.
#[derive(Clone, Copy, Debug)]
pub struct ExactWalk {
    edge: ExactEdge,
    row: i64,
}

impl Walk for ExactWalk {
    fn boundary(&self) -> i64 {
        self.edge.boundary(self.row)
    }

    fn step(&mut self) {
        self.row += 1;
    }
}
