//! Lines by distance: all pixels at most half a pixel away from a segment, except those beyond its endpoints.
//!
//! The scan tests every pixel of the bounding box of the segment. Let d be the vector from the first to the second
//! endpoint, and v the vector from the first endpoint to the pixel. The distance is |d × v| / |d|. Comparing it with ½
//! needs no root: 4 (d × v)² ≤ |d|². The limits at the endpoints are d · v ≥ 0 and d · (v − d) ≤ 0. All three
//! conditions include equality: a point exactly on the border belongs to the line. Floats decide pixels whose distance
//! from the border exceeds the error bound, and exact arithmetic decides the rest.
//!
//! Such a line is one pixel wide, measured at a right angle, whatever its slope. Slanted lines may therefore have gaps.

use std::cmp::Ordering;
use std::ops::Range;

use glam::DVec2;

use super::whole_numbers_within;
use crate::math::expansion::Expansion;

/// Scan of the bounding box of a segment; see [`distance_line`].
#[derive(Clone, Debug)]
pub(crate) struct DistanceLineScan {
    band: SegmentBand,
    columns: Range<u32>,
    rows: Range<u32>,
    /// Column and row of the next pixel to test.
    probe: (u32, u32),
}

/// Returns the pixels of the line from `p0` to `p1` in a picture of this size, row by row from the top.
///
/// Pixels lie at integer coordinates. A segment of length zero has no pixels.
pub(crate) fn distance_line(p0: DVec2, p1: DVec2, width: u32, height: u32) -> DistanceLineScan {
    let (least, greatest) = (p0.min(p1) - 0.5, p0.max(p1) + 0.5);
    let columns = whole_numbers_within(least.x, greatest.x, width);
    let rows = if p0 == p1 { 0..0 } else { whole_numbers_within(least.y, greatest.y, height) };
    let probe = (columns.start, rows.start);
    DistanceLineScan { band: SegmentBand { p0, p1 }, columns, rows, probe }
}

impl DistanceLineScan {
    /// Returns column and row of the next pixel to test, or `None` after the last pixel.
    pub(crate) fn probe(&self) -> Option<(u32, u32)> {
        (self.columns.contains(&self.probe.0) && self.rows.contains(&self.probe.1)).then_some(self.probe)
    }

    /// Returns an upper bound on the number of pixels left to test. The bound is exact at the start of a row.
    pub(crate) fn probes_left(&self) -> u64 {
        self.columns.len() as u64 * u64::from(self.rows.end.saturating_sub(self.probe.1))
    }

    /// Tests the next pixel. Returns its column and row, `Some(None)` if the pixel does not belong to the line, or
    /// `None` after the last pixel.
    pub(crate) fn step(&mut self) -> Option<Option<(u32, u32)>> {
        let (x, y) = self.probe()?;
        self.probe = if x + 1 < self.columns.end { (x + 1, y) } else { (self.columns.start, y + 1) };
        Some(self.band.contains(x, y).then_some((x, y)))
    }
}

impl Iterator for DistanceLineScan {
    type Item = (u32, u32);

    fn next(&mut self) -> Option<(u32, u32)> {
        loop {
            if let Some(pixel) = self.step()? {
                return Some(pixel);
            }
        }
    }
}

/// Set of the points at most half a pixel away from a segment, except those beyond its endpoints.
#[derive(Clone, Copy, Debug)]
struct SegmentBand {
    p0: DVec2,
    p1: DVec2,
}

impl SegmentBand {
    fn contains(self, x: u32, y: u32) -> bool {
        let point = DVec2::new(x.into(), y.into());
        self.along(point, self.p0) != Ordering::Less
            && self.along(point, self.p1) != Ordering::Greater
            && self.is_near(point)
    }

    /// Returns the sign of d · (`point` − `end`), where d is the vector from `p0` to `p1`.
    fn along(self, point: DVec2, end: DVec2) -> Ordering {
        let products = (self.p1 - self.p0) * (point - end);
        let error = 4.0 * f64::EPSILON * products.abs().element_sum();
        certain_sign(products.element_sum(), error).unwrap_or_else(|| {
            let [dx, dy] = difference(self.p1, self.p0);
            let [vx, vy] = difference(point, end);
            (&(&dx * &vx) + &(&dy * &vy)).sign()
        })
    }

    /// Whether the point is at most half a pixel away from the infinite line through both endpoints.
    fn is_near(self, point: DVec2) -> bool {
        let (d, v) = (self.p1 - self.p0, point - self.p0);
        let length_squared = d.length_squared();
        let cross = d.perp_dot(v);
        // The error of the cross product is below e = 4 ε · `magnitude`. The error of its square is below 2 |cross| e +
        // e².
        let magnitude = (d.x * v.y).abs() + (d.y * v.x).abs();
        let error =
            64.0 * f64::EPSILON * (cross.abs() * magnitude + f64::EPSILON * magnitude * magnitude + length_squared);
        let sign = certain_sign(4.0 * cross * cross - length_squared, error).unwrap_or_else(|| {
            let [dx, dy] = difference(self.p1, self.p0);
            let [vx, vy] = difference(point, self.p0);
            let cross = &(&dx * &vy) - &(&dy * &vx);
            let doubled = &cross + &cross;
            (&(&doubled * &doubled) - &(&(&dx * &dx) + &(&dy * &dy))).sign()
        });
        sign != Ordering::Greater
    }
}

/// Returns the exact sign of a quantity from its float approximation `value`, which is off by at most `error`. Returns
/// `None` if the error bound leaves the sign undecided.
fn certain_sign(value: f64, error: f64) -> Option<Ordering> {
    (value.abs() > error).then(|| value.total_cmp(&0.0))
}

fn difference(a: DVec2, b: DVec2) -> [Expansion; 2] {
    [Expansion::difference(a.x, b.x), Expansion::difference(a.y, b.y)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: u32 = 24;

    fn pixels(p0: DVec2, p1: DVec2) -> Vec<(u32, u32)> {
        distance_line(p0, p1, SIZE, SIZE).collect()
    }

    /// Returns the pixels of a line, computed from the definition in integers. The endpoints are in units of 1/`unit`
    /// px.
    fn by_definition(p0: (i128, i128), p1: (i128, i128), unit: i128) -> Vec<(u32, u32)> {
        let (dx, dy) = (p1.0 - p0.0, p1.1 - p0.1);
        let square = dx * dx + dy * dy;
        let all = (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y)));
        all.filter(|(x, y)| {
            let (vx, vy) = (i128::from(*x) * unit - p0.0, i128::from(*y) * unit - p0.1);
            let (dot, cross) = (dx * vx + dy * vy, dx * vy - dy * vx);
            square > 0 && (0..=square).contains(&dot) && 4 * cross * cross <= square * unit * unit
        })
        .collect()
    }

    #[test]
    fn pixels_are_those_at_most_half_a_pixel_away() {
        let mut random = fastrand::Rng::with_seed(52);
        for round in 0..3_000 {
            let unit = [1, 2, 4, 1 << 10, 1 << 18][round % 5];
            // Endpoints far outside the picture produce slopes with near ties.
            let reach = if round % 3 == 0 { 2_000 * unit } else { 30 * unit };
            let mut coordinate = || random.i128(-reach..reach);
            let (p0, p1) = ((coordinate(), coordinate()), (coordinate(), coordinate()));
            let real = |(x, y): (i128, i128)| DVec2::new(x as f64, y as f64) / unit as f64;
            assert_eq!(pixels(real(p0), real(p1)), by_definition(p0, p1, unit), "{p0:?} {p1:?} in 1/{unit} px");
        }
    }

    #[test]
    fn the_border_belongs_to_the_line_exactly() {
        let from = |y: f64| pixels(DVec2::new(0.0, y), DVec2::new(5.0, y)).len();
        assert_eq!(from(1.0), 6);
        assert_eq!(from(1.5), 12, "both rows are half a pixel away");
        let hair = 2.0_f64.powi(-52);
        assert_eq!(from(1.5 + hair), 6);
        let tiny = 2.0_f64.powi(-149);
        assert_eq!(pixels(DVec2::new(tiny, 0.0), DVec2::new(5.0, 0.0)).len(), 5, "starts just behind the first pixel");
        assert_eq!(pixels(DVec2::new(0.0, 0.5), DVec2::new(1e-3, 0.5)), [(0, 0), (0, 1)]);
        let rising = pixels(DVec2::new(0.0, 0.5), DVec2::new(3e38, 0.5 + hair));
        assert_eq!(rising, (0..SIZE).map(|x| (x, 1)).collect::<Vec<_>>(), "row 0 is farther by 10⁻⁵⁴ px");
    }

    #[test]
    fn a_segment_without_length_and_one_outside_have_no_pixels() {
        assert_eq!(pixels(DVec2::splat(3.0), DVec2::splat(3.0)), []);
        assert_eq!(pixels(DVec2::splat(-3.0), DVec2::new(9.0, -3.0)), []);
        assert_eq!(pixels(DVec2::splat(-3e38), DVec2::splat(-1e38)), []);
    }

    #[test]
    fn the_probe_visits_the_box_and_no_more() {
        let mut line = distance_line(DVec2::new(2.0, 3.0), DVec2::new(6.0, 4.0), SIZE, SIZE);
        assert_eq!(line.probe(), Some((2, 3)));
        line.by_ref().for_each(drop);
        assert_eq!(line.probe(), None);
        assert_eq!(line.probe, (2, 5));
    }
}
