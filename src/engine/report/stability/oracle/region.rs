//! Regions of the image bounded by lines, and the pixels whose centres they contain.

use num_bigint::BigInt;
use num_traits::{Euclid as _, Signed as _, ToPrimitive as _, Zero as _};

use super::number::{places, rounded, scaled};
use crate::pipeline::raster::Span;
use crate::pipeline::settings::FillRule;
use crate::pipeline::viewport::Viewport;

/// Vertex snapping applied before coverage is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Snap {
    /// Vertices used as given.
    Unsnapped,
    /// Vertices rounded to multiples of 1/256 px, ties to even.
    Grid256,
}

/// Number of fractional bits of [`Snap::Grid256`].
const GRID_PLACES: u32 = 8;

/// Reciprocal of the borderline distance, in 1/px. A pixel centre within the borderline distance of an edge may fall on
/// either side of the edge if vertices are snapped or rounded during projection.
const BORDERLINE: i32 = 128;

/// Half-plane of the pixels for which `by_column` · column + `by_row` · row + `origin` is positive. If `closed`, pixels
/// for which this value is 0 belong to the half-plane as well.
#[derive(Clone, Debug)]
pub(super) struct ExactHalfPlane {
    pub(super) by_column: BigInt,
    pub(super) by_row: BigInt,
    pub(super) origin: BigInt,
    pub(super) closed: bool,
}

impl ExactHalfPlane {
    /// Returns the value of the linear function at a pixel centre.
    pub(super) fn at(&self, column: u32, row: u32) -> BigInt {
        &self.by_column * column + &self.by_row * row + &self.origin
    }

    /// Returns the first and the last column of a row that lie in the half-plane, each `None` if unbounded. Returns
    /// `None` instead of the pair if no column of the row lies in the half-plane.
    fn columns(&self, row: u32) -> Option<(Option<BigInt>, Option<BigInt>)> {
        // Values are integers, so positive means at least 1.
        let value = &self.by_row * row + &self.origin - u8::from(!self.closed);
        if self.by_column.is_zero() {
            return (!value.is_negative()).then_some((None, None));
        }
        let steps = value.div_euclid(&self.by_column.abs());
        Some(if self.by_column.is_positive() { (Some(-steps), None) } else { (None, Some(steps)) })
    }

    /// Returns whether a pixel centre is within 1/[`BORDERLINE`] px of the line. The gradient is per pixel, so the
    /// distance is |value| / √(`by_column`² + `by_row`²).
    fn is_close(&self, column: u32, row: u32) -> bool {
        let value = self.at(column, row) * BORDERLINE;
        let squared_gradient = &self.by_column * &self.by_column + &self.by_row * &self.by_row;
        &value * &value <= squared_gradient
    }

    /// Returns whether the fill rule counts a pixel centre exactly on the line as inside. A rule named after a corner
    /// acts as if the centre were moved by a tiny distance horizontally and a far smaller one vertically.
    pub(super) fn owns_its_line(&self, rule: FillRule) -> bool {
        let (right, down) = match rule {
            FillRule::TopLeft => (1, 1),
            FillRule::TopRight => (-1, 1),
            FillRule::BottomLeft => (1, -1),
            FillRule::BottomRight => (-1, -1),
            FillRule::Inclusive => return true,
            FillRule::Exclusive => return false,
        };
        let sideways: BigInt = &self.by_column * right;
        if sideways.is_zero() { (&self.by_row * BigInt::from(down)).is_positive() } else { sideways.is_positive() }
    }
}

/// Intersection of half-planes; empty if there are no half-planes, as for a triangle without area.
#[derive(Clone, Debug, Default)]
pub(crate) struct ExactRegion {
    pub(super) bounds: Vec<ExactHalfPlane>,
    /// First and last rows that may be covered; `None` if unbounded.
    rows: Option<(u32, u32)>,
}

impl ExactRegion {
    /// Creates the intersection of half-planes.
    pub(super) fn new(bounds: Vec<ExactHalfPlane>) -> Self {
        Self { bounds, rows: None }
    }

    /// Creates the region of a screen-space triangle of either winding, with vertices in pixels. The region is empty if
    /// the triangle has no area or a coordinate is not finite.
    pub(crate) fn triangle(corners_px: [[f32; 2]; 3], snap: Snap, rule: FillRule) -> Self {
        if corners_px.iter().flatten().any(|c| !c.is_finite()) {
            return Self::default();
        }
        let (corners, scale) = integer_corners(corners_px, snap);
        let bounds = [(0, 1), (1, 2), (2, 0)].map(|(from, to)| line(&corners[from], &corners[to], scale));
        let [a, b, c] = &corners;
        let doubled_area = (&b[0] - &a[0]) * (&c[1] - &a[1]) - (&c[0] - &a[0]) * (&b[1] - &a[1]);
        if doubled_area.is_zero() {
            return Self::default();
        }
        let bounds = bounds.into_iter().map(|bound| {
            let inside = if doubled_area.is_negative() { negated(bound) } else { bound };
            ExactHalfPlane { closed: inside.owns_its_line(rule), ..inside }
        });
        Self { bounds: bounds.collect(), rows: Some(rows_around(corners_px)) }
    }

    /// Returns whether the region has no bounds and is therefore empty.
    pub(crate) fn is_empty(&self) -> bool {
        self.bounds.is_empty()
    }

    /// Returns the pixels whose centres lie in the region: at most one span per row, from top to bottom.
    pub(crate) fn spans(&self, viewport: Viewport) -> Vec<Span> {
        if self.is_empty() {
            return Vec::new();
        }
        let (first, last) = self.rows.unwrap_or((0, u32::MAX));
        (first..viewport.height.min(last.saturating_add(1))).filter_map(|row| self.span(row, viewport.width)).collect()
    }

    fn span(&self, row: u32, width: u32) -> Option<Span> {
        let (mut first, mut last): (BigInt, BigInt) = (BigInt::zero(), BigInt::from(width) - 1);
        for bound in &self.bounds {
            let (from, to) = bound.columns(row)?;
            first = from.into_iter().fold(first, BigInt::max);
            last = to.into_iter().fold(last, BigInt::min);
        }
        let end: BigInt = last + 1;
        let (left, right) = (first.to_u32()?, end.to_u32()?);
        (left < right).then_some(Span { row, left, right })
    }

    /// Returns whether the region contains a pixel centre.
    pub(crate) fn contains(&self, column: u32, row: u32) -> bool {
        let inside = |bound: &ExactHalfPlane| {
            let value = bound.at(column, row);
            value.is_positive() || (bound.closed && value.is_zero())
        };
        !self.is_empty() && self.bounds.iter().all(inside)
    }

    /// Returns whether a pixel centre is within 1/128 px of a line that bounds the region, and not more than 1/128 px
    /// outside any of these lines.
    pub(crate) fn is_borderline(&self, column: u32, row: u32) -> bool {
        let lines = || self.bounds.iter().filter(|b| !b.by_column.is_zero() || !b.by_row.is_zero());
        let clearly_outside =
            |bound: &ExactHalfPlane| bound.at(column, row).is_negative() && !bound.is_close(column, row);
        lines().any(|bound| bound.is_close(column, row)) && !lines().any(clearly_outside)
    }
}

/// Returns the vertices as integers in units of 2^−scale px, and the scale. The scale is at least 1, because pixel
/// centres are multiples of ½.
fn integer_corners(corners_px: [[f32; 2]; 3], snap: Snap) -> ([[BigInt; 2]; 3], u32) {
    match snap {
        Snap::Grid256 => (corners_px.map(|corner| corner.map(|c| rounded(c, GRID_PLACES))), GRID_PLACES),
        Snap::Unsnapped => {
            let scale = corners_px.iter().flatten().map(|c| places(*c)).fold(1, u32::max);
            (corners_px.map(|corner| corner.map(|c| scaled(c, scale))), scale)
        }
    }
}

/// Returns the half-plane clockwise of the line `from` → `to` (y down), where (to − from) × (p − from) is positive.
/// Coordinates are in units of 2^−`scale` px.
fn line(from: &[BigInt; 2], to: &[BigInt; 2], scale: u32) -> ExactHalfPlane {
    let (by_x, by_y) = (&from[1] - &to[1], &to[0] - &from[0]);
    let constant = -(&by_x * &from[0] + &by_y * &from[1]);
    // p = (pixel + 1/2) · 2^scale.
    let origin = constant + ((&by_x + &by_y) << (scale - 1));
    ExactHalfPlane { by_column: by_x << scale, by_row: by_y << scale, origin, closed: false }
}

fn negated(bound: ExactHalfPlane) -> ExactHalfPlane {
    let ExactHalfPlane { by_column, by_row, origin, closed } = bound;
    ExactHalfPlane { by_column: -by_column, by_row: -by_row, origin: -origin, closed }
}

/// Returns the first and last rows that the triangle may reach, with one row of margin for snapping.
fn rows_around(corners_px: [[f32; 2]; 3]) -> (u32, u32) {
    let ys = corners_px.map(|[_, y]| y);
    let (top, bottom) = (ys[0].min(ys[1]).min(ys[2]), ys[0].max(ys[1]).max(ys[2]));
    // Float-to-integer casts saturate.
    ((top.floor() as u32).saturating_sub(1), (bottom.ceil() as u32).saturating_add(1))
}

#[cfg(test)]
mod tests {
    use num_rational::BigRational;

    use super::*;
    use crate::pipeline::settings::Choice as _;
    use crate::report::stability::oracle::exact;

    const VIEW: Viewport = Viewport { width: 12, height: 10 };

    /// Returns whether a triangle covers a pixel centre, from the signs of three areas in rational arithmetic. On an
    /// edge, the direction in which the fill rule shifts the centre decides.
    fn covers(corners: &[[BigRational; 2]; 3], column: u32, row: u32, rule: FillRule) -> bool {
        let half = BigRational::new(1.into(), 2.into());
        let centre = [column, row].map(|pixel| BigRational::from_integer(pixel.into()) + &half);
        let (right, down) = match rule {
            FillRule::TopLeft => (1, 1),
            FillRule::TopRight => (-1, 1),
            FillRule::BottomLeft => (1, -1),
            FillRule::BottomRight => (-1, -1),
            FillRule::Inclusive | FillRule::Exclusive => (0, 0),
        };
        let sign = |value: &BigRational| i32::from(value.is_positive()) - i32::from(value.is_negative());
        let sides = [(0, 1), (1, 2), (2, 0)].map(|(from, to)| {
            let (a, b) = (&corners[from], &corners[to]);
            let [along_x, along_y] = [&b[0] - &a[0], &b[1] - &a[1]];
            let area = &along_x * (&centre[1] - &a[1]) - &along_y * (&centre[0] - &a[0]);
            (area, [-sign(&along_y) * right, sign(&along_x) * down])
        });
        let winding = sign(&sides.iter().map(|(area, _)| area).sum());
        let inside = |(area, [sideways, downwards]): &(BigRational, [i32; 2])| {
            let first_that_counts = [sign(area), *sideways, *downwards].into_iter().find(|s| *s != 0).unwrap_or(0);
            first_that_counts * winding > 0 || (rule == FillRule::Inclusive && area.is_zero())
        };
        winding != 0 && sides.iter().all(inside)
    }

    /// Returns a random coordinate of one of six kinds: arbitrary, at a pixel centre, on the snapping grid, halfway
    /// between grid steps, far away, or an integer plus a tiny number.
    fn coordinate(random: &mut fastrand::Rng, kind: u8) -> f32 {
        let anywhere = random.f32() * 20.0 - 4.0;
        match kind {
            0 => anywhere,
            1 => anywhere.floor() + 0.5,
            2 => (anywhere * 256.0).round() / 256.0,
            3 => ((anywhere * 256.0).round() + 0.5) / 256.0,
            4 => anywhere * 10.0_f32.powi(random.i32(0..38)),
            _ => anywhere.floor() + f32::from_bits(random.u32(..1 << 24)),
        }
    }

    #[test]
    fn spans_hold_exactly_the_centres_that_brute_force_finds_under_every_rule() {
        let mut random = fastrand::Rng::with_seed(21);
        let (mut inside, mut corners_on_centres) = (0, 0);
        for round in 0..60 {
            let kind = (round % 6) as u8;
            let corners = std::array::from_fn(|_| std::array::from_fn(|_| coordinate(&mut random, kind)));
            corners_on_centres += u32::from(kind == 1);
            let exact_corners = corners.map(|corner: [f32; 2]| corner.map(|c| exact(c).unwrap()));
            for rule in FillRule::ALL {
                let region = ExactRegion::triangle(corners, Snap::Unsnapped, *rule);
                let spans = region.spans(VIEW);
                for row in 0..VIEW.height {
                    for column in 0..VIEW.width {
                        let expected = covers(&exact_corners, column, row, *rule);
                        let found = spans.iter().any(|s| s.row == row && (s.left..s.right).contains(&column));
                        assert_eq!(found, expected, "{corners:?} {rule:?} {column},{row}");
                        assert_eq!(region.contains(column, row), expected);
                        inside += u32::from(expected);
                    }
                }
            }
        }
        assert!(inside > 5000 && corners_on_centres == 10, "{inside} inside, {corners_on_centres} on centres");
    }

    #[test]
    fn snapping_first_is_the_same_as_snapped_corners() {
        let mut random = fastrand::Rng::with_seed(22);
        let mut moved = 0;
        for round in 0..1000 {
            let corners: [[f32; 2]; 3] =
                std::array::from_fn(|_| std::array::from_fn(|_| coordinate(&mut random, round as u8 % 4)));
            let snapped = corners.map(|corner| corner.map(|c| (c * 256.0).round_ties_even() / 256.0));
            let rule = FillRule::TopLeft;
            let of_given = ExactRegion::triangle(corners, Snap::Grid256, rule).spans(VIEW);
            assert_eq!(of_given, ExactRegion::triangle(snapped, Snap::Unsnapped, rule).spans(VIEW), "{corners:?}");
            moved += u32::from(of_given != ExactRegion::triangle(corners, Snap::Unsnapped, rule).spans(VIEW));
        }
        assert!(moved > 5, "snapping changed only {moved} triangles");
    }

    #[test]
    fn triangles_without_area_or_number_cover_nothing() {
        let flat = [[1.0, 1.0], [5.0, 5.0], [9.0, 9.0]];
        let collapsed = [[1.0, 1.0], [9.0, 1.000_01], [5.0, 1.000_02]];
        let broken = [[1.0, 1.0], [f32::NAN, 5.0], [9.0, 2.0]];
        for (corners, snap) in
            [(flat, Snap::Unsnapped), (collapsed, Snap::Grid256), (broken, Snap::Unsnapped), (broken, Snap::Grid256)]
        {
            assert!(ExactRegion::triangle(corners, snap, FillRule::Inclusive).is_empty(), "{corners:?}");
        }
        assert!(!ExactRegion::triangle(collapsed, Snap::Unsnapped, FillRule::Inclusive).is_empty());
    }

    #[test]
    fn borderline_is_what_lies_within_a_128th_of_a_pixel_of_an_edge() {
        // A left edge at x = 3.5 + d, with the other edges far away.
        let at = |d: f32| {
            ExactRegion::triangle([[3.5 + d, -90.0], [90.0, 5.0], [3.5 + d, 90.0]], Snap::Unsnapped, FillRule::TopLeft)
        };
        for (distance, expected) in [(0.0, true), (0.0077, true), (-0.0077, true), (0.0079, false), (-0.0079, false)] {
            assert_eq!(at(distance).is_borderline(3, 4), expected, "{distance}");
        }
        assert!(!at(0.0).is_borderline(2, 4), "a whole pixel away");
        let corner = ExactRegion::triangle([[3.5, 4.0], [9.0, 4.0], [3.5, 9.0]], Snap::Unsnapped, FillRule::TopLeft);
        assert!(
            corner.is_borderline(3, 4) && !corner.is_borderline(3, 3),
            "on the line of one edge, outside of another"
        );
    }
}
