//! Interpolation of corner values inside a triangle, in f32, by two methods whose results differ only by rounding.
//!
//! One method weights the corners by the areas of the three triangles that the point forms with the sides. The other
//! interpolates along two sides up to the row of the point, and then along that row.

use glam::Vec2;

/// Returns the barycentric weights α, β, γ of a point.
///
/// The weight of a corner is the area of the triangle that the point forms with the opposite side, divided by the area
/// of the whole triangle. The weights sum to 1 up to rounding. Inside the triangle, each lies in [0, 1]. For a triangle
/// of zero area, they are not finite.
pub(crate) fn weights_by_area([a, b, c]: [Vec2; 3], point: Vec2) -> [f32; 3] {
    let doubled = |p: Vec2, q: Vec2, r: Vec2| (q - p).perp_dot(r - p);
    let whole = doubled(a, b, c);
    [doubled(point, b, c) / whole, doubled(point, c, a) / whole, doubled(point, a, b) / whole]
}

/// Intermediate values and result of [`along_sides_then_row`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RowInterpolation {
    /// Intersection of the row with the side from the top to the bottom corner: x coordinate and interpolated value.
    pub(crate) long: (f32, f32),
    /// Intersection of the row with one of the other two sides: x coordinate and interpolated value.
    pub(crate) short: (f32, f32),
    /// Interpolated value at the point.
    pub(crate) value: f32,
}

/// Interpolates corner values at a point: linearly along the two sides that the row of the point crosses, then linearly
/// between them.
///
/// Returns `None` if the point lies above or below the triangle, and for a triangle of zero height.
pub(crate) fn along_sides_then_row(corners: [Vec2; 3], values: [f32; 3], point: Vec2) -> Option<RowInterpolation> {
    let mut order = [0, 1, 2];
    order.sort_by(|i, j| corners[*i].y.total_cmp(&corners[*j].y));
    let [top, middle, bottom] = order;
    let crosses = |i: usize, j: usize| corners[i].y < corners[j].y && (corners[i].y..=corners[j].y).contains(&point.y);
    let at_row = |i: usize, j: usize| {
        let t = (point.y - corners[i].y) / (corners[j].y - corners[i].y);
        (corners[i].x + t * (corners[j].x - corners[i].x), values[i] + t * (values[j] - values[i]))
    };
    if !crosses(top, bottom) {
        return None;
    }
    let long = at_row(top, bottom);
    let short = if crosses(top, middle) { at_row(top, middle) } else { at_row(middle, bottom) };
    let width = short.0 - long.0;
    let value = if width == 0.0 { long.1 } else { long.1 + (point.x - long.0) / width * (short.1 - long.1) };
    Some(RowInterpolation { long, short, value })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ways_give_the_plane_through_the_corners() {
        let mut random = fastrand::Rng::with_seed(66);
        let mut inside = 0;
        for _ in 0..5_000 {
            let corners: [Vec2; 3] = std::array::from_fn(|_| Vec2::new(random.f32(), random.f32()) * 30.0);
            if (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]).abs() < 5.0 {
                continue;
            }
            let plane = |p: Vec2| 0.3 * p.x - 0.2 * p.y + 1.0;
            let point = Vec2::new(random.f32(), random.f32()) * 30.0;
            let weights = weights_by_area(corners, point);
            if weights.iter().any(|w| *w < 0.01) {
                continue;
            }
            inside += 1;
            let by_area: f32 = weights.iter().zip(corners).map(|(w, corner)| w * plane(corner)).sum();
            let by_row = along_sides_then_row(corners, corners.map(plane), point).unwrap().value;
            assert!(
                (by_area - plane(point)).abs() < 1e-3 && (by_row - plane(point)).abs() < 1e-3,
                "{corners:?} {point}"
            );
        }
        assert!(inside > 300);
    }

    #[test]
    fn corners_have_their_own_values_and_nothing_is_outside() {
        let corners = [Vec2::new(2.0, 1.0), Vec2::new(9.0, 4.0), Vec2::new(3.0, 8.0)];
        for (i, corner) in corners.into_iter().enumerate() {
            let mut expected = [0.0; 3];
            expected[i] = 1.0;
            assert_eq!(weights_by_area(corners, corner), expected);
            assert_eq!(along_sides_then_row(corners, expected, corner).unwrap().value, 1.0);
        }
        assert_eq!(along_sides_then_row(corners, [0.0; 3], Vec2::new(3.0, 0.9)), None);
        assert_eq!(along_sides_then_row([Vec2::ZERO, Vec2::X, Vec2::X * 2.0], [0.0; 3], Vec2::ZERO), None);
    }
}
