//! Points of a polygon on an integer grid, where orientation tests are exact.

use glam::DVec2;
use i_triangle::i_overlay::i_float::int::point::IntPoint;

/// Point of the grid. Coordinates are at most [`HALF_EXTENT`] in magnitude.
pub(super) type GridPoint = IntPoint<i32>;

/// Half of the longer side of a polygon's bounding box, in grid steps. The grid is finer than the corners' f32
/// precision.
const HALF_EXTENT: f64 = (1 << 29) as f64;

/// Returns the points rounded to a grid that spans their bounding box.
pub(super) fn to_grid(points: &[DVec2]) -> Vec<GridPoint> {
    let bounds = |pick: fn(DVec2, DVec2) -> DVec2| points.iter().copied().reduce(pick).unwrap_or(DVec2::ZERO);
    let (low, high) = (bounds(DVec2::min), bounds(DVec2::max));
    let center = (low + high) / 2.0;
    let scale = HALF_EXTENT / ((high - low) / 2.0).max_element();
    let round = |x: f64| (x * scale).round() as i32;
    points.iter().map(|point| *point - center).map(|point| GridPoint::new(round(point.x), round(point.y))).collect()
}

/// Returns twice the signed area of a triangle, positive if it is counter-clockwise. The result is exact: it is below
/// 2⁶² for grid points.
pub(super) fn orientation(a: GridPoint, b: GridPoint, c: GridPoint) -> i64 {
    let [ab, ac] = [b, c].map(|point| [point.x - a.x, point.y - a.y].map(i64::from));
    ab[0] * ac[1] - ab[1] * ac[0]
}

/// Returns the dot product of the vectors from `b` to `a` and from `b` to `c`.
pub(super) fn dot(a: GridPoint, b: GridPoint, c: GridPoint) -> i64 {
    let [ba, bc] = [a, c].map(|point| [point.x - b.x, point.y - b.y].map(i64::from));
    ba[0] * bc[0] + ba[1] * bc[1]
}

/// Whether two closed segments have a point in common.
pub(super) fn crosses([a, b]: [GridPoint; 2], [c, d]: [GridPoint; 2]) -> bool {
    let sides =
        [orientation(a, b, c), orientation(a, b, d), orientation(c, d, a), orientation(c, d, b)].map(i64::signum);
    if sides[0] * sides[1] < 0 && sides[2] * sides[3] < 0 {
        return true;
    }
    let is_between = |p: GridPoint, q: GridPoint, point: GridPoint| dot(p, point, q) <= 0;
    (sides[0] == 0 && is_between(a, b, c))
        || (sides[1] == 0 && is_between(a, b, d))
        || (sides[2] == 0 && is_between(c, d, a))
        || (sides[3] == 0 && is_between(c, d, b))
}
