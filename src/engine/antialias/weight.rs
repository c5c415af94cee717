//! Weighted area sampling: the fraction of a pixel's filter kernel that a convex shape covers.
//!
//! A box filter of one pixel weights all covered parts equally, so the position of a thin shape within the pixel does
//! not matter. A pyramid or a cone two pixels wide gives parts near the centre more weight, and lets a shape contribute
//! a little to neighbouring pixels. Slow movements then change the picture smoothly.
//!
//! The integral is exact along each row and approximated by a sum over [`ROWS`] rows. A shape that covers the whole
//! kernel has a weight of exactly 1.

use glam::DVec2;

/// Number of rows into which a filter kernel is divided for integration.
pub(crate) const ROWS: u32 = 64;

/// Filter kernel: the weight of a point, as a function of its position relative to the pixel's centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Weight {
    /// Box filter: a constant weight over the pixel.
    Box,
    /// Pyramid filter: a weight that falls linearly from 1 at the centre to 0 at the sides of a square of 2 × 2 px.
    Pyramid,
    /// Cone filter: a weight that falls linearly from 1 at the centre to 0 at a distance of 1 px.
    Cone,
}

impl Weight {
    /// Returns the distance from the centre to the border of the kernel along an axis, in pixels.
    pub(crate) fn radius_px(self) -> f64 {
        match self {
            Self::Box => 0.5,
            Self::Pyramid | Self::Cone => 1.0,
        }
    }

    /// Returns the weight at a position relative to the centre, in pixels; it is 1 at the centre.
    pub(crate) fn at(self, place: DVec2) -> f64 {
        match self {
            Self::Box => f64::from(place.abs().max_element() <= 0.5),
            Self::Pyramid => (1.0 - place.abs().max_element()).max(0.0),
            Self::Cone => (1.0 - place.length()).max(0.0),
        }
    }

    /// Returns the integral of the weight along the row at `y`, from 0 to `x`, both in pixels relative to the centre.
    fn integral(self, x: f64, y: f64) -> f64 {
        let (length, d) = (x.abs(), y.abs());
        let positive = match self {
            Self::Box => length.min(0.5),
            Self::Pyramid => {
                let length = length.min(1.0);
                let slope = |x: f64| x - x * x / 2.0;
                (1.0 - d) * length.min(d) + if length > d { slope(length) - slope(d) } else { 0.0 }
            }
            Self::Cone => {
                let length = length.min((1.0 - d * d).max(0.0).sqrt());
                length - (length * length.hypot(d) + d * d * (length / d).asinh()) / 2.0
            }
        };
        positive.copysign(x)
    }
}

/// Returns the fraction of a pixel's filter kernel that a convex polygon covers, in [0, 1]. Corners and `center` are in
/// pixels; corners may be in either winding order.
pub(crate) fn weighted_coverage(polygon: &[DVec2], center: DVec2, weight: Weight) -> f64 {
    let height = 2.0 * weight.radius_px() / f64::from(ROWS);
    let (mut covered, mut whole) = (0.0, 0.0);
    for row in 0..ROWS {
        let y = (f64::from(row) + 0.5) * height - weight.radius_px();
        whole += 2.0 * weight.integral(weight.radius_px(), y);
        if let Some((left, right)) = stretch(polygon, center.y + y) {
            covered += weight.integral(right - center.x, y) - weight.integral(left - center.x, y);
        }
    }
    (covered / whole).clamp(0.0, 1.0)
}

/// Intersects the horizontal line at `y` with a convex polygon. Returns the minimum and maximum x of the intersection,
/// or `None` if the line misses the polygon.
fn stretch(polygon: &[DVec2], y: f64) -> Option<(f64, f64)> {
    let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let crossings =
        sides.filter(|(a, b)| (a.y <= y) != (b.y <= y)).map(|(a, b)| a.x + (y - a.y) * (b.x - a.x) / (b.y - a.y));
    let (least, greatest) = crossings.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, g), x| (l.min(x), g.max(x)));
    (least < greatest).then_some((least, greatest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::antialias::area::triangle_area;

    const ALL: [Weight; 3] = [Weight::Box, Weight::Pyramid, Weight::Cone];

    #[test]
    fn full_coverage_counts_one_and_half_coverage_a_half() {
        let square = |left: f64| [(left, -9.0), (9.0, -9.0), (9.0, 9.0), (left, 9.0)].map(DVec2::from);
        for weight in ALL {
            assert!((weighted_coverage(&square(-9.0), DVec2::ZERO, weight) - 1.0).abs() < 1e-12, "{weight:?}");
            assert!((weighted_coverage(&square(0.0), DVec2::ZERO, weight) - 0.5).abs() < 1e-12, "{weight:?}");
            assert_eq!(weighted_coverage(&square(1.0), DVec2::ZERO, weight), 0.0, "{weight:?}");
        }
    }

    #[test]
    fn the_box_gives_the_exact_area() {
        let mut random = fastrand::Rng::with_seed(91);
        for _ in 0..200 {
            let corners: [DVec2; 3] = std::array::from_fn(|_| DVec2::new(random.f64() * 8.0, random.f64() * 8.0));
            for (x, y, area) in triangle_area(corners, 8, 8) {
                let center = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let found = weighted_coverage(&corners, center, Weight::Box);
                // The coverage of a row is evaluated only on its middle line, even if the triangle ends within the row.
                assert!((found - area).abs() < 1.5 / f64::from(ROWS), "({x}, {y}) of {corners:?}: {found}, not {area}");
            }
        }
    }

    #[test]
    fn all_filters_agree_with_a_sum_over_many_points() {
        const POINTS: u32 = 400;
        let triangle = [(-0.9, -0.3), (0.7, -0.6), (0.2, 0.8)].map(DVec2::from);
        let inside = |p: DVec2| (0..3).all(|i| (triangle[(i + 1) % 3] - triangle[i]).perp_dot(p - triangle[i]) >= 0.0);
        for weight in ALL {
            let at = |i: u32| (f64::from(i) + 0.5) / f64::from(POINTS) * 2.0 - 1.0;
            let points = || (0..POINTS).flat_map(|i| (0..POINTS).map(move |j| DVec2::new(at(i), at(j))));
            let whole: f64 = points().map(|p| weight.at(p)).sum();
            let covered: f64 = points().filter(|p| inside(*p)).map(|p| weight.at(p)).sum();
            let found = weighted_coverage(&triangle, DVec2::ZERO, weight);
            assert!((found - covered / whole).abs() < 3e-3, "{weight:?}: {found}, not {}", covered / whole);
        }
    }
}
