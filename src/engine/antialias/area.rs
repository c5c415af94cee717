//! Area coverage: the fraction of each pixel that a triangle covers, as used by area sampling with a box filter. It is
//! accurate to the last bits of an `f64`.
//!
//! The pixel, a square, is clipped by the half-plane of each edge that passes through it (Sutherland and Hodgman 1974).
//! The shoelace formula gives the area of the clipped polygon. In plain floats, the area of a sliver would be lost to
//! cancellation, because it is the small difference of two large numbers. The edge functions and everything computed
//! from them therefore have 106 bits of precision, in coordinates relative to the pixel. The result is rounded once.
//!
//! The cost is a few float operations for each pixel of the triangle's bounding box within the picture, plus a few
//! microseconds for each pixel that an edge passes through.

use std::cmp::Ordering;
use std::ops::Range;

use glam::DVec2;

use crate::flat2d::{side, whole_numbers_within};
use crate::math::double_double::DoubleDouble;

/// Position relative to a pixel's top left corner, in pixels.
type PixelPoint = [DoubleDouble; 2];

/// Iterator over the pixels that a triangle covers, created by [`triangle_area`].
#[derive(Clone, Debug)]
pub(crate) struct TriangleArea {
    edges: [HalfPlane; 3],
    columns: Range<u32>,
    rows: Range<u32>,
    /// Next pixel of the bounding box to examine, as (column, row).
    probe: (u32, u32),
}

/// Returns an iterator over the pixels that a triangle covers, row by row from the top. Each item is (column, row,
/// covered area in px²), with an area in (0, 1]. Corners are in pixels, in either winding order, within the limits
/// given in [`crate::flat2d`]. A degenerate triangle covers no pixel. A pixel touched only at its border may be
/// reported with an area of up to 10⁻³⁰ px².
pub(crate) fn triangle_area(corners: [DVec2; 3], width: u32, height: u32) -> TriangleArea {
    let [a, b, c] = corners;
    let edges = [(a, b), (b, c), (c, a)].map(|(from, to)| HalfPlane::right_of(from, to, width, height));
    let winding = side(a, b, c);
    let edges = if winding == Ordering::Less { edges.map(HalfPlane::turned) } else { edges };
    let (least, greatest) = (a.min(b).min(c), a.max(b).max(c));
    let columns = whole_numbers_within(least.x.floor(), greatest.x, width);
    let rows =
        if winding == Ordering::Equal { 0..0 } else { whole_numbers_within(least.y.floor(), greatest.y, height) };
    let probe = (columns.start, rows.start);
    TriangleArea { edges, columns, rows, probe }
}

impl TriangleArea {
    /// Returns the column and row of the next pixel of the bounding box to examine, or `None` after the last pixel.
    pub(crate) fn probe(&self) -> Option<(u32, u32)> {
        (self.columns.contains(&self.probe.0) && self.rows.contains(&self.probe.1)).then_some(self.probe)
    }

    /// Returns an upper bound on the number of pixels left to examine. The bound is exact at the start of a row.
    pub(crate) fn probes_left(&self) -> u64 {
        self.columns.len() as u64 * u64::from(self.rows.end.saturating_sub(self.probe.1))
    }

    /// Examines the next pixel of the bounding box. Returns its column, row and covered area in px², `Some(None)` if
    /// the triangle does not cover the pixel, or `None` after the last pixel.
    pub(crate) fn step(&mut self) -> Option<Option<(u32, u32, f64)>> {
        let (x, y) = self.probe()?;
        self.probe = if x + 1 < self.columns.end { (x + 1, y) } else { (self.columns.start, y + 1) };
        let area = self.area(x, y);
        Some((area > 0.0).then_some((x, y, area)))
    }

    /// Returns the area, in px², that the triangle covers in a pixel.
    fn area(&self, x: u32, y: u32) -> f64 {
        let sides = self.edges.each_ref().map(|edge| edge.side_of_pixel(x, y));
        if sides.contains(&Some(Ordering::Less)) {
            return 0.0;
        }
        let passing = self.edges.iter().zip(sides).filter(|(_, side)| side.is_none());
        let mut left = UNIT_SQUARE.to_vec();
        for (edge, _) in passing {
            left = cut(&left, edge, edge.at_pixel(x, y));
        }
        area(&left)
    }
}

impl Iterator for TriangleArea {
    type Item = (u32, u32, f64);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(pixel) = self.step()? {
                return Some(pixel);
            }
        }
    }
}

/// Half-plane of the points p with slope · p + constant ≥ 0.
#[derive(Clone, Copy, Debug)]
struct HalfPlane {
    slope: PixelPoint,
    constant: DoubleDouble,
    /// Upper bound on the rounding error of the edge function when evaluated in `f64` at points within the picture.
    error: f64,
}

impl HalfPlane {
    /// Returns the half-plane to the right of the directed line from `from` to `to`, with y pointing down: (to − from)
    /// × (p − from) ≥ 0.
    fn right_of(from: DVec2, to: DVec2, width: u32, height: u32) -> Self {
        let slope = [DoubleDouble::difference(from.y, to.y), DoubleDouble::difference(to.x, from.x)];
        let constant = DoubleDouble::product(from.x, to.y) - DoubleDouble::product(to.x, from.y);
        let [x, y, c] = [slope[0], slope[1], constant].map(|term| term.rounded().abs());
        let greatest = x * f64::from(width) + y * f64::from(height) + c;
        Self { slope, constant, error: 8.0 * f64::EPSILON * greatest }
    }

    /// Returns the half-plane on the opposite side of the same line.
    fn turned(self) -> Self {
        Self { slope: self.slope.map(|s| -s), constant: -self.constant, error: self.error }
    }

    /// Classifies a pixel: `Greater` if all of it is inside the half-plane, `Less` if all of it is outside, `None` if
    /// the edge passes through the pixel or very close to it.
    fn side_of_pixel(&self, x: u32, y: u32) -> Option<Ordering> {
        let [slope_x, slope_y] = self.slope.map(DoubleDouble::rounded);
        let corner = slope_x * f64::from(x) + slope_y * f64::from(y) + self.constant.rounded();
        if corner + slope_x.min(0.0) + slope_y.min(0.0) > self.error {
            Some(Ordering::Greater)
        } else if corner + slope_x.max(0.0) + slope_y.max(0.0) < -self.error {
            Some(Ordering::Less)
        } else {
            None
        }
    }

    /// Returns the value of the edge function, slope · p + constant, at a pixel's top left corner.
    fn at_pixel(&self, x: u32, y: u32) -> DoubleDouble {
        let [x, y] = [x, y].map(|place| DoubleDouble::from(f64::from(place)));
        self.slope[0] * x + self.slope[1] * y + self.constant
    }

    /// Returns the value of the edge function at `place`, a position relative to a pixel's top left corner. `at_corner`
    /// is the function's value at that corner.
    fn at(&self, place: PixelPoint, at_corner: DoubleDouble) -> DoubleDouble {
        self.slope[0] * place[0] + self.slope[1] * place[1] + at_corner
    }
}

/// Corners of a pixel relative to its top left corner, clockwise on the screen.
const UNIT_SQUARE: [PixelPoint; 4] = {
    const O: DoubleDouble = DoubleDouble::ZERO;
    const I: DoubleDouble = DoubleDouble::ONE;
    [[O, O], [I, O], [I, I], [O, I]]
};

/// Clips a convex polygon within a pixel to a half-plane. `at_corner` is the value of the half-plane's edge function at
/// the pixel's top left corner.
fn cut(polygon: &[PixelPoint], edge: &HalfPlane, at_corner: DoubleDouble) -> Vec<PixelPoint> {
    let mut inside = Vec::with_capacity(polygon.len() + 1);
    for (from, to) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let [value_from, value_to] = [*from, *to].map(|place| edge.at(place, at_corner));
        let [from_inside, to_inside] = [value_from, value_to].map(|value| value.rounded() >= 0.0);
        if from_inside {
            inside.push(*from);
        }
        if from_inside != to_inside {
            let [from, to] = [(from, value_from), (to, value_to)]
                .map(|(place, value)| PointOffEdge { place: *place, magnitude: value.abs() });
            inside.push(crossing(from, to));
        }
    }
    inside
}

/// Position in a pixel, with the magnitude of an edge function there.
#[derive(Clone, Copy)]
struct PointOffEdge {
    place: PixelPoint,
    magnitude: DoubleDouble,
}

/// Returns the zero of an edge function on the segment between two positions, where it has opposite signs.
/// Interpolation starts at the position with the smaller magnitude, so a zero close to either position keeps all its
/// digits.
fn crossing(a: PointOffEdge, b: PointOffEdge) -> PixelPoint {
    let (near, far) = if a.magnitude.rounded() <= b.magnitude.rounded() { (a, b) } else { (b, a) };
    let share = near.magnitude / (near.magnitude + far.magnitude);
    std::array::from_fn(|axis| near.place[axis] + share * (far.place[axis] - near.place[axis]))
}

/// Returns the area of a polygon in px², by the shoelace formula relative to its first corner.
fn area(polygon: &[PixelPoint]) -> f64 {
    let Some((first, rest)) = polygon.split_first() else { return 0.0 };
    let from_first = |place: &PixelPoint| [place[0] - first[0], place[1] - first[1]];
    let doubled = rest.windows(2).fold(DoubleDouble::ZERO, |sum, two| {
        let [a, b] = [from_first(&two[0]), from_first(&two[1])];
        sum + (a[0] * b[1] - a[1] * b[0])
    });
    doubled.rounded() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: u32 = 12;

    fn areas(corners: [(f64, f64); 3]) -> Vec<(u32, u32, f64)> {
        triangle_area(corners.map(DVec2::from), SIZE, SIZE).collect()
    }

    /// Returns the area, inside a pixel, between a segment and the pixel's bottom side. The area is an integral over x:
    /// where the segment lies at height h above the bottom side, a width of dx adds min(max(h, 0), 1) dx. The area is
    /// negative if the segment runs to the left.
    fn under_segment(from: (f64, f64), to: (f64, f64), column: u32, row: u32) -> f64 {
        let (x0, bottom) = (f64::from(column), f64::from(row) + 1.0);
        let [a, b] = [from.0, to.0].map(|x| x.clamp(x0, x0 + 1.0));
        if a == b {
            return 0.0;
        }
        let height = |x: f64| bottom - (from.1 + (to.1 - from.1) * (x - from.0) / (to.0 - from.0));
        // The integrand is linear between the values of x at which `height` is 0 or 1.
        let mut stops = vec![a, b];
        for level in [0.0, 1.0] {
            let x = from.0 + (bottom - level - from.1) * (to.0 - from.0) / (to.1 - from.1);
            if a.min(b) < x && x < a.max(b) {
                stops.push(x);
            }
        }
        stops.sort_by(f64::total_cmp);
        if a > b {
            stops.reverse();
        }
        stops.windows(2).map(|s| height(f64::midpoint(s[0], s[1])).clamp(0.0, 1.0) * (s[1] - s[0])).sum()
    }

    fn by_integration(corners: [(f64, f64); 3], column: u32, row: u32) -> f64 {
        let [a, b, c] = corners;
        [(a, b), (b, c), (c, a)].into_iter().map(|(from, to)| under_segment(from, to, column, row)).sum::<f64>().abs()
    }

    fn doubled_area([a, b, c]: [(f64, f64); 3]) -> f64 {
        ((b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0)).abs()
    }

    #[test]
    fn every_pixel_has_the_area_found_by_integration() {
        let mut random = fastrand::Rng::with_seed(81);
        for round in 0..3_000 {
            // Integer and half-integer coordinates put corners and edges on pixel borders and centres.
            let unit = [1.0, 2.0, 256.0, 1e6][round % 4];
            let mut coordinate = || ((random.f64() * 18.0 - 3.0) * unit).round() / unit;
            let corners = std::array::from_fn(|_| (coordinate(), coordinate()));
            let found = areas(corners);
            for (row, column) in (0..SIZE).flat_map(|row| (0..SIZE).map(move |column| (row, column))) {
                let area = found.iter().find(|(x, y, _)| (*x, *y) == (column, row)).map_or(0.0, |(_, _, area)| *area);
                let expected = by_integration(corners, column, row);
                assert!((area - expected).abs() < 1e-13, "({column}, {row}) of {corners:?}: {area}, not {expected}");
            }
        }
    }

    #[test]
    fn areas_of_a_triangle_inside_the_picture_sum_to_its_own() {
        let mut random = fastrand::Rng::with_seed(82);
        for _ in 0..2_000 {
            let mut coordinate = || f64::from(random.u16(..) >> 1) / 2048.0 * 0.7;
            let corners = std::array::from_fn(|_| (coordinate(), coordinate()));
            let sum: f64 = areas(corners).iter().map(|(_, _, area)| area).sum();
            let exact = doubled_area(corners) / 2.0;
            assert!((sum - exact).abs() <= 4e-16 * exact.max(1.0) * 12.0, "{corners:?}: {sum}, not {exact}");
        }
    }

    #[test]
    fn slivers_keep_all_digits() {
        // Between y = 8.5 and a line that rises by `height` over 12 px, pixel i has the area height · (i + ½) / 12.
        for exponent in [10, 24, 40] {
            let height = 2.0_f64.powi(-exponent);
            let found = areas([(0.0, 8.5), (12.0, 8.5), (12.0, 8.5 + height)]);
            assert_eq!(found.len(), 12);
            for (x, y, area) in found {
                let exact = height * (f64::from(x) + 0.5) / 12.0;
                assert_eq!(y, 8);
                assert!((area / exact - 1.0).abs() <= f64::EPSILON, "{x}: {area}, not {exact}");
            }
        }
        // Slanted sliver: a diagonal at 45°, and the same diagonal rotated minimally about its upper end.
        let hair = 2.0_f64.powi(-45);
        for (x, y, area) in areas([(0.0, 0.0), (8.0, 8.0), (8.0, 8.0 + hair)]) {
            if x == y {
                let exact = hair * (f64::from(x) + 0.5) / 8.0;
                assert!((area / exact - 1.0).abs() < 1e-13, "{x}: {area}, not {exact}");
            } else {
                assert!(area < hair * hair, "only the tips overlap pixel ({x}, {y}): {area}");
            }
        }
    }

    #[test]
    fn triangles_of_any_size_are_measured() {
        let far: f64 = f32::MAX.into();
        assert!(areas([(-far, -far), (far, -far), (0.0, far)]).iter().all(|(_, _, area)| *area == 1.0));
        let half_plane = areas([(-far, -far), (far, far), (-far, far)]);
        let diagonal = half_plane.iter().filter(|(x, y, area)| x == y && *area == 0.5).count();
        assert_eq!((diagonal, half_plane.len()), (12, 12 * 13 / 2), "the diagonal is halved");
        let tiny = 2.0_f64.powi(-149);
        let [found] = areas([(0.0, 0.0), (3.0 * tiny, 0.0), (0.0, 5.0 * tiny)])[..] else { panic!("not one pixel") };
        assert_eq!(found, (0, 0, 7.5 * tiny * tiny));
        let upright = areas([(3.0, -tiny), (3.0, tiny), (4.0, 0.0)]);
        assert_eq!(upright, [(3, 0, tiny / 2.0)], "half of it lies above the picture");
    }

    #[test]
    fn winding_does_not_matter_and_degenerate_triangles_cover_nothing() {
        let (a, b, c) = ((1.25, 2.5), (9.125, 3.75), (4.5, 10.0));
        assert_eq!(areas([a, b, c]), areas([a, c, b]));
        for degenerate in [[a, a, a], [a, b, a], [(0.0, 0.0), (3.0, 3.0), (7.0, 7.0)]] {
            assert_eq!(areas(degenerate), []);
        }
        // Collinear except for the last bit of an f32.
        assert!(!areas([(0.0, 0.0), (3.0, 3.0), (7.0, f64::from(7.0_f32.next_up()))]).is_empty());
    }
}
