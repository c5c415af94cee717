//! Exact coverage decisions on unsnapped vertices: Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast
//! Robust Geometric Predicates" (1997), from the crate `robust`.
//!
//! Vertices are f32, so expansions neither overflow nor underflow, and every sign is correct. Most signs are certain
//! without expansions: each edge stores a bound on the f64 rounding error that holds at every pixel of a picture (a
//! static filter, as in Shewchuk's chapter 4). The adaptive predicates decide only if an edge value lies within this
//! bound. The column at which an edge crosses a row is estimated in f64. Exact signs then correct the estimate, first
//! in doubling steps and then by bisection.

use robust::{Coord, orient2d};

use super::fill_rule::FillRule;
use super::float::{Floating, unit_scale};
use super::inward::Inward;
use super::numbers::{BoundaryWalk, Numbers, RasterEdge};
use super::steps::{EdgeNumbers, EdgeSteps, ExactSteps};
use crate::pipeline::viewport::MAX_SIDE_PX;

/// Arithmetic with exact decisions by adaptive predicates, on coordinates in pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exact;

/// Edge of a triangle in exact arithmetic, given by its endpoints in pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExactEdge {
    from: [f64; 2],
    to: [f64; 2],
    /// Vector from `from` to `to`, rounded.
    along: [f64; 2],
    /// Magnitude above which an edge value computed in f64 has the correct sign at every pixel of a picture.
    certain_beyond: f64,
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
        let along = [to[0] - from[0], to[1] - from[1]];
        let certain_beyond = rounding_bound(from, along);
        ExactEdge { from, to, along, certain_beyond, sign, scale, owned: inward.owned(rule), inward }
    }

    fn first_centre(coordinate: f64) -> i64 {
        Floating::<f64>::first_centre(coordinate)
    }

    fn last_centre(coordinate: f64) -> i64 {
        Floating::<f64>::last_centre(coordinate)
    }
}

/// Returns the doubled signed area (b − a) × (c − a). The sign is exact. The magnitude has full f64 precision unless
/// coordinates differ by more than a factor of 2²⁹ in magnitude.
fn oriented(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let exact_sign = orient2d(coord(a), coord(b), coord(c));
    let magnitude = difference_of_products([b[0] - a[0], c[1] - a[1]], [c[0] - a[0], b[1] - a[1]]);
    if magnitude * exact_sign > 0.0 { magnitude } else { exact_sign }
}

/// Returns a bound on the error of along × (p − from), computed in f64, for every pixel centre p in a picture. Both
/// factors of a product, the product itself and the difference of the products are rounded once each. The error is
/// therefore at most 4 · ε/2 times the sum of the products' magnitudes, where ε is [`f64::EPSILON`]. The bound is twice
/// that, for safety.
fn rounding_bound(from: [f64; 2], along: [f64; 2]) -> f64 {
    let farthest = from.map(|c| c.abs() + f64::from(MAX_SIDE_PX));
    4.0 * f64::EPSILON * (along[0].abs() * farthest[1] + along[1].abs() * farthest[0])
}

/// Returns p₀·p₁ − q₀·q₁ to within 1.5 ulp, by Kahan's algorithm (Jeannerod, Louvet and Muller, "Further analysis of
/// Kahan's algorithm for the accurate computation of 2×2 determinants", 2013).
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
    /// Returns a number with the exact sign of the edge function at a pixel's centre; its magnitude is unreliable.
    #[inline]
    fn sign_at(&self, column: i64, row: i64) -> f64 {
        let centre = centre(column, row);
        let value = self.along[0] * (centre[1] - self.from[1]) - self.along[1] * (centre[0] - self.from[0]);
        let sign = if value.abs() > self.certain_beyond { value } else { self.exact_sign(centre) };
        sign * self.sign
    }

    /// Returns a number with the exact sign of the edge function at a position in pixels, computed by adaptive
    /// predicates. This is the slow path.
    #[cold]
    #[inline(never)]
    fn exact_sign(&self, centre: [f64; 2]) -> f64 {
        orient2d(coord(self.from), coord(self.to), coord(centre))
    }

    /// Returns whether the centre of a pixel lies to the right of the edge. If it lies exactly on the edge, the fill rule
    /// decides.
    fn is_beyond(&self, column: i64, row: i64) -> bool {
        self.contains(column, row) == (self.inward.right > 0)
    }

    /// Returns the x coordinate, in pixels, at which the centre line of a row crosses the edge, with f64 rounding
    /// errors.
    fn estimate(&self, row: i64) -> f64 {
        let t = (row as f64 + 0.5 - self.from[1]) / (self.to[1] - self.from[1]);
        self.from[0] * (1.0 - t) + self.to[0] * t
    }
}

impl RasterEdge for ExactEdge {
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

    fn steps(&self, column: i64, row: i64) -> EdgeSteps {
        let Self { from, to, sign, scale, .. } = *self;
        let centre = centre(column, row);
        let value = oriented(from, to, centre) * sign;
        let numbers = EdgeNumbers::Exact(ExactSteps { from, to, centre, sign, value });
        EdgeSteps { inward: self.inward, owned: self.owned, contains: self.contains(column, row), scale, numbers }
    }

    fn boundary(&self, row: i64) -> i64 {
        let last = i64::from(MAX_SIDE_PX);
        let estimate = (self.estimate(row).clamp(0.0, last as f64) as i64).clamp(0, last);
        // Doubles the step until the boundary is enclosed: column `before` is not beyond the edge, and column `beyond`
        // is.
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

/// Row-by-row walk down an edge. It recomputes the boundary column for every row, because exact arithmetic has no
/// incremental step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExactWalk {
    edge: ExactEdge,
    row: i64,
}

impl BoundaryWalk for ExactWalk {
    fn boundary(&self) -> i64 {
        self.edge.boundary(self.row)
    }

    fn step(&mut self) {
        self.row += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_filter_is_never_wrong_and_leaves_little_to_decide() {
        let mut rng = fastrand::Rng::with_seed(17);
        let side = f64::from(MAX_SIDE_PX);
        let (mut filtered, mut tied, mut all) = (0, 0, 0);
        for round in 0..4000 {
            // Coordinates range from within the picture to the limits of f32.
            let reach = 10.0_f64.powf(rng.f64() * 38.0);
            let mut far = || (((rng.f64() - 0.5) * reach + side * 0.5) as f32).into();
            let (from, mut to): ([f64; 2], [f64; 2]) = ([far(), far()], [far(), far()]);
            if round % 4 == 0 {
                // The edge passes through pixel centres, where the value is zero.
                to = [from[0] + f64::from(rng.i32(-9..9)), from[1] + f64::from(rng.i32(-9..9))]
                    .map(|c| f64::from(c as f32));
            }
            let edge = Exact::edge([from, to], 1.0, 1.0, FillRule::TopLeft);
            for _ in 0..50 {
                // Pixel centres as close to the line as possible, or anywhere in the picture.
                let row = rng.i64(0..i64::from(MAX_SIDE_PX));
                let crossing = edge.estimate(row).clamp(0.0, side - 1.0) as i64 + rng.i64(-1..=1);
                let column = if rng.bool() { crossing } else { rng.i64(0..i64::from(MAX_SIDE_PX)) };
                let exact = edge.exact_sign(centre(column, row));
                let given = edge.sign_at(column, row);
                assert_eq!(given.partial_cmp(&0.0), exact.partial_cmp(&0.0), "{from:?} {to:?} {column} {row}");
                let value = edge.along[0] * (centre(column, row)[1] - from[1])
                    - edge.along[1] * (centre(column, row)[0] - from[0]);
                filtered += u32::from(value.abs() > edge.certain_beyond);
                tied += u32::from(exact == 0.0);
                all += 1;
            }
        }
        // Values on the line are zero, which no filter can decide. The filter must decide nearly all others.
        let decided = f64::from(filtered) / f64::from(all - tied);
        assert!(decided > 0.99 && tied > 1000, "{filtered} of {all}, {tied} on the line");
    }
}
