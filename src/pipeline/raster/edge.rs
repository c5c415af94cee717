//! Edge functions: Pineda, "A Parallel Algorithm for Polygon Rasterization" (SIGGRAPH 1988), in 24.8 integers.
//!
//! eᵢ(p) = (b − a) × (p − a) for the edge a → b opposite to vertex i, with the sign chosen so that the inside is
//! positive whichever way the triangle winds. On the grid these are integers, so a sample's side is never in doubt, and
//! the two triangles of a shared edge compute exactly opposite values.
//!
//! ```text
//!   A > 0  the inside lies to the right: a left edge        eᵢ(x, y) = A·x + B·y + C
//!   A = 0, B > 0  the inside lies below: a top edge
//! ```
//!
//! Range: with coordinates within ±2²⁴ grid steps (the guard band) differences need 25 bits, products 50, sums 52.

use crate::pipeline::settings::FillRule;
use crate::pipeline::viewport::ScreenVertex;

/// One edge as an affine function of the position in grid steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Edge {
    a: i64,
    b: i64,
    c: i64,
    /// The least value that counts as inside: 0 if samples on the edge belong to the triangle, else 1.
    least: i64,
}

/// The three edges of a triangle, and the box around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeFunctions {
    edges: [Edge; 3],
    /// Doubled area, > 0, in units of 1/2¹⁶ px².
    doubled_area: i64,
    /// Smallest and largest snapped x and y.
    bounds: [(i32, i32); 2],
}

/// Doubled signed area of a triangle on the grid: positive if clockwise for the viewer (y down).
pub fn doubled_area([a, b, c]: [(i32, i32); 3]) -> i64 {
    let (abx, aby) = (i64::from(b.0) - i64::from(a.0), i64::from(b.1) - i64::from(a.1));
    let (acx, acy) = (i64::from(c.0) - i64::from(a.0), i64::from(c.1) - i64::from(a.1));
    abx * acy - acx * aby
}

impl EdgeFunctions {
    /// Sets up the edges of a triangle with this doubled signed area, which must not be zero.
    pub fn new(vertices: &[ScreenVertex; 3], doubled_area: i64, rule: FillRule) -> Self {
        debug_assert!(doubled_area != 0, "a triangle without area has no inside");
        let corners = vertices.each_ref().map(|v| (i64::from(v.x), i64::from(v.y)));
        let sign = doubled_area.signum();
        let edges = [(1, 2), (2, 0), (0, 1)].map(|(from, to)| Edge::new(corners[from], corners[to], sign, rule));
        let range = |coordinate: fn(&ScreenVertex) -> i32| {
            let values = vertices.each_ref().map(coordinate);
            (values[0].min(values[1]).min(values[2]), values[0].max(values[1]).max(values[2]))
        };
        Self { edges, doubled_area: doubled_area.abs(), bounds: [range(|v| v.x), range(|v| v.y)] }
    }

    /// The three edge values at a position in grid steps.
    #[inline]
    pub fn at(&self, (x, y): (i64, i64)) -> [i64; 3] {
        self.edges.map(|e| e.a * x + e.b * y + e.c)
    }

    /// Whether a sample with these edge values belongs to the triangle.
    #[inline]
    pub fn contains(&self, values: [i64; 3]) -> bool {
        let [e0, e1, e2] = &self.edges;
        values[0] >= e0.least && values[1] >= e1.least && values[2] >= e2.least
    }

    /// The x in grid steps, first and last, between which a row at height `y` belongs to the triangle; `None` if it
    /// belongs nowhere.
    pub fn span(&self, y: i64) -> Option<(i64, i64)> {
        let (mut first, mut last) = (i64::MIN, i64::MAX);
        for edge in &self.edges {
            // A·x ≥ need
            let need = edge.least - (edge.b * y + edge.c);
            match edge.a {
                1.. => first = first.max(-(-need).div_euclid(edge.a)),
                0 if need > 0 => return None,
                0 => {}
                _ => last = last.min((-need).div_euclid(-edge.a)),
            }
        }
        (first <= last).then_some((first, last))
    }

    /// Doubled area, > 0, in units of 1/2¹⁶ px².
    pub fn doubled_area(&self) -> i64 {
        self.doubled_area
    }

    /// Smallest and largest x, in grid steps.
    pub fn x_range(&self) -> (i64, i64) {
        let (least, greatest) = self.bounds[0];
        (least.into(), greatest.into())
    }

    /// Smallest and largest y, in grid steps.
    pub fn y_range(&self) -> (i64, i64) {
        let (least, greatest) = self.bounds[1];
        (least.into(), greatest.into())
    }
}

impl Edge {
    fn new(from: (i64, i64), to: (i64, i64), sign: i64, rule: FillRule) -> Self {
        let a = (from.1 - to.1) * sign;
        let b = (to.0 - from.0) * sign;
        let c = -(a * from.0 + b * from.1);
        Self { a, b, c, least: i64::from(!owned(a, b, rule)) }
    }
}

/// Whether an edge whose inside lies in direction (a, b) owns the samples on it.
fn owned(a: i64, b: i64, rule: FillRule) -> bool {
    match rule {
        FillRule::TopLeft => a > 0 || (a == 0 && b > 0),
        FillRule::TopRight => a < 0 || (a == 0 && b > 0),
        FillRule::BottomLeft => a > 0 || (a == 0 && b < 0),
        FillRule::BottomRight => a < 0 || (a == 0 && b < 0),
        FillRule::Inclusive => true,
        FillRule::Exclusive => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::settings::Choice as _;
    use crate::pipeline::vertex::Varyings;

    fn corner(x: i32, y: i32) -> ScreenVertex {
        ScreenVertex { x, y, depth: 0.0, inv_w: 1.0, varyings: Varyings::default() }
    }

    fn edges(corners: [(i32, i32); 3], rule: FillRule) -> EdgeFunctions {
        EdgeFunctions::new(&corners.map(|(x, y)| corner(x, y)), doubled_area(corners), rule)
    }

    #[test]
    fn edge_values_sum_to_the_doubled_area_everywhere() {
        let e = edges([(0, 0), (1000, 37), (411, 999)], FillRule::TopLeft);
        for position in [(0, 0), (-5000, 123), (128, 128)] {
            assert_eq!(e.at(position).iter().sum::<i64>(), e.doubled_area());
        }
    }

    #[test]
    fn every_rule_but_the_two_wrong_ones_gives_a_point_on_a_shared_edge_to_exactly_one() {
        // Corners and edge midpoints of a square cut by its diagonal, surrounded by nothing: interior points only.
        let (a, b, c, d) = ((0, 0), (512, 0), (512, 512), (0, 512));
        for rule in FillRule::ALL {
            let owners = |p: (i64, i64)| {
                [[a, b, c], [a, c, d]]
                    .iter()
                    .filter(|t| {
                        let e = edges(**t, *rule);
                        e.contains(e.at(p))
                    })
                    .count()
            };
            let expected = match rule {
                FillRule::Inclusive => 2,
                FillRule::Exclusive => 0,
                _ => 1,
            };
            assert_eq!(owners((256, 256)), expected, "{rule:?}");
        }
    }

    #[test]
    fn winding_does_not_change_coverage() {
        let (clockwise, counter) = (
            edges([(0, 0), (900, 100), (300, 700)], FillRule::TopLeft),
            edges([(0, 0), (300, 700), (900, 100)], FillRule::TopLeft),
        );
        for x in 0..30 {
            for y in 0..30 {
                let p = (x * 30, y * 30);
                assert_eq!(clockwise.contains(clockwise.at(p)), counter.contains(counter.at(p)), "{p:?}");
            }
        }
    }

    #[test]
    fn a_span_holds_exactly_the_positions_inside() {
        let mut random = fastrand::Rng::with_seed(11);
        for _ in 0..300 {
            let corners = std::array::from_fn(|_| (random.i32(-20..60), random.i32(-20..60)));
            if doubled_area(corners) == 0 {
                continue;
            }
            for rule in FillRule::ALL {
                let e = edges(corners, *rule);
                for y in -25..65 {
                    let inside: Vec<i64> = (-30..70).filter(|x| e.contains(e.at((*x, y)))).collect();
                    let span = e.span(y).map_or_else(Vec::new, |(first, last)| (first..=last).collect());
                    assert_eq!(span, inside, "{corners:?} {rule:?} row {y}");
                }
            }
        }
    }

    #[test]
    fn the_guard_band_does_not_overflow() {
        let far = 1_i32 << 24;
        let e = edges([(-far, -far), (far, -far), (-far, far)], FillRule::TopLeft);
        assert_eq!(e.at((-i64::from(far), -i64::from(far))), [e.doubled_area(), 0, 0]);
    }
}
