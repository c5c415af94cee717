//! Straight lines, pixel by pixel, and clipping of lines to a picture.
//!
//! [`midpoint_line`] connects two pixels in integer arithmetic only (Bresenham 1965, in the midpoint form of Pitteway
//! 1967). For each step along the longer axis, it takes the pixel nearest to the true line. The sign of the decision
//! variable, at first D = 2·minor − major, shows on which side of the line the midpoint between the two candidates
//! lies. If the line passes exactly through the midpoint, it stays on its row or column. Other octants differ only in
//! the axes and signs of the steps, so mirroring the endpoints mirrors the pixels.
//!
//! That tie rule depends on the direction: drawn from the other endpoint, the line stays on the other row or column.
//! [`direction_independent_line`] always decides ties as seen from the same endpoint, so both directions cover the same
//! pixels.
//!
//! [`clip_to`] clips a line with real endpoints to the picture first (Liang and Barsky 1984). The cost of walking the
//! line is then bounded by the size of the picture, however far away the endpoints are.

use std::cmp::Ordering;

/// Iterator over the pixels of a line; see [`midpoint_line`].
#[derive(Clone, Debug)]
pub struct MidpointLine {
    /// Next pixel to return, as (x, y); `None` after the last pixel.
    next: Option<(i64, i64)>,
    last: (i64, i64),
    /// Step that stays on the row or column. `slanted` is the step that leaves it.
    straight: (i64, i64),
    slanted: (i64, i64),
    /// Extent along the longer axis, in pixels; `minor` is the extent along the shorter axis. Twice the difference of
    /// any two i64 fits into i128.
    major: i128,
    minor: i128,
    decision: i128,
    /// Whether a line exactly through the midpoint leaves its row or column.
    slants_on_tie: bool,
}

/// Returns the pixels from `p0` to `p1`, both included, in that order: max(|Δx|, |Δy|) + 1 pixels. Accepts any
/// coordinates.
///
/// # Examples
/// ```
/// use rasterscope_engine::flat2d::line::midpoint_line;
///
/// let pixels: Vec<_> = midpoint_line((0, 0), (4, 2)).collect();
/// assert_eq!(pixels, [(0, 0), (1, 0), (2, 1), (3, 1), (4, 2)]);
/// ```
pub fn midpoint_line(p0: (i64, i64), p1: (i64, i64)) -> MidpointLine {
    let (width, height) = (p0.0.abs_diff(p1.0), p0.1.abs_diff(p1.1));
    let slanted = (step_towards(p0.0, p1.0), step_towards(p0.1, p1.1));
    let straight = if width >= height { (slanted.0, 0) } else { (0, slanted.1) };
    let (major, minor) = (i128::from(width.max(height)), i128::from(width.min(height)));
    let decision = 2 * minor - major;
    MidpointLine { next: Some(p0), last: p1, straight, slanted, major, minor, decision, slants_on_tie: false }
}

/// Returns the pixels of [`midpoint_line`] with a tie rule that does not depend on the direction.
///
/// A tie occurs where the line passes exactly between two pixels. It is resolved as in a [`midpoint_line`] that starts
/// at the endpoint with the smaller x, or with the smaller y if both x are equal. The line from `p1` to `p0` therefore
/// covers the same pixels in the opposite order.
pub(crate) fn direction_independent_line(p0: (i64, i64), p1: (i64, i64)) -> MidpointLine {
    MidpointLine { slants_on_tie: p1 < p0, ..midpoint_line(p0, p1) }
}

impl MidpointLine {
    /// Returns the decision variable for the step from the next pixel to the pixel after it.
    ///
    /// It is positive if the line passes beyond the midpoint between the two candidates, so that the step leaves the
    /// row or column.
    pub(crate) fn decision(&self) -> i128 {
        self.decision
    }

    /// Whether the step from the next pixel to the pixel after it leaves the row or column.
    pub(crate) fn slants(&self) -> bool {
        self.decision > 0 || self.slants_on_tie && self.decision == 0
    }
}

impl Iterator for MidpointLine {
    type Item = (i64, i64);

    fn next(&mut self) -> Option<(i64, i64)> {
        let pixel = self.next?;
        let (step, change) =
            if self.slants() { (self.slanted, 2 * (self.minor - self.major)) } else { (self.straight, 2 * self.minor) };
        if pixel == self.last {
            self.next = None;
        } else {
            self.next = Some((pixel.0 + step.0, pixel.1 + step.1));
            self.decision += change;
        }
        Some(pixel)
    }
}

fn step_towards(from: i64, to: i64) -> i64 {
    match to.cmp(&from) {
        Ordering::Less => -1,
        Ordering::Equal => 0,
        Ordering::Greater => 1,
    }
}

/// Clips the line from `p0` to `p1` to the closed rectangle [0, `width`] × [0, `height`], in pixels.
///
/// The direction is kept, and an endpoint inside the rectangle is returned unchanged. Returns `None` if the line misses
/// the rectangle or an endpoint is not finite. A returned coordinate may equal `width` or `height`, so a caller that
/// rounds down to a pixel must clamp to the last column and row.
pub(crate) fn clip_to(p0: (f64, f64), p1: (f64, f64), width: u32, height: u32) -> Option<((f64, f64), (f64, f64))> {
    let (enter, leave) = part_inside(p0, p1, width, height)?;
    let (width, height) = (f64::from(width), f64::from(height));
    // The weighted sum avoids a difference of huge coordinates, which would overflow. The clamp corrects the rounding
    // of t and of the products.
    let at = |t: f64| {
        let (x, y) = (p0.0 * (1.0 - t) + p1.0 * t, p0.1 * (1.0 - t) + p1.1 * t);
        (x.clamp(0.0, width), y.clamp(0.0, height))
    };
    Some((at(enter), at(leave)))
}

/// Returns the part of the line that [`clip_to`] keeps, as two line parameters in [0, 1], where 0 is `p0` and 1 is
/// `p1`. Returns `None` if it keeps nothing.
pub(crate) fn part_inside(p0: (f64, f64), p1: (f64, f64), width: u32, height: u32) -> Option<(f64, f64)> {
    if ![p0.0, p0.1, p1.0, p1.1].into_iter().all(f64::is_finite) {
        return None;
    }
    let (enter_x, leave_x) = stretch_inside(p0.0, p1.0, width.into())?;
    let (enter_y, leave_y) = stretch_inside(p0.1, p1.1, height.into())?;
    let (enter, leave) = (enter_x.max(enter_y), leave_x.min(leave_y));
    (enter <= leave).then_some((enter, leave))
}

/// Returns the parameters t in [0, 1] at which a point moving from `from` (t = 0) to `to` (t = 1) enters and leaves the
/// interval [0, `length`]. Returns `None` if the point stays outside.
fn stretch_inside(from: f64, to: f64, length: f64) -> Option<(f64, f64)> {
    // Halving both values prevents an overflow of the difference.
    let half_way = to / 2.0 - from / 2.0;
    if half_way == 0.0 {
        return (0.0..=length).contains(&from).then_some((0.0, 1.0));
    }
    let at_zero = -from / 2.0 / half_way;
    let at_length = (length / 2.0 - from / 2.0) / half_way;
    let (enter, leave) = (at_zero.min(at_length).max(0.0), at_zero.max(at_length).min(1.0));
    (enter <= leave).then_some((enter, leave))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns endpoints for lines from the origin in every direction.
    fn ends() -> impl Iterator<Item = (i64, i64)> {
        (-12..=12).flat_map(|x| (-12..=12).map(move |y| (x, y)))
    }

    fn line(p0: (i64, i64), p1: (i64, i64)) -> Vec<(i64, i64)> {
        midpoint_line(p0, p1).collect()
    }

    #[test]
    fn every_step_takes_the_pixel_nearest_to_the_true_line_and_stays_on_a_tie() {
        for (x1, y1) in ends() {
            let (width, height) = (x1.abs(), y1.abs());
            let (major, minor) = (width.max(height), width.min(height));
            let expected: Vec<_> = (0..=major)
                .map(|i| {
                    // The key is 2 · `major` times the distance from the true line. Of two equal keys, the first is
                    // nearer to p0.
                    let across = (0..=minor).min_by_key(|k| (2 * (k * major - i * minor)).abs()).unwrap_or(0);
                    let (x, y) = if width >= height { (i, across) } else { (across, i) };
                    (x * x1.signum(), y * y1.signum())
                })
                .collect();
            assert_eq!(line((0, 0), (x1, y1)), expected, "to ({x1}, {y1})");
        }
    }

    #[test]
    fn the_number_of_pixels_is_that_of_the_longer_axis_and_both_ends_are_there() {
        for (x1, y1) in ends() {
            let pixels = line((3, -5), (3 + x1, -5 + y1));
            assert_eq!(pixels.len() as i64, x1.abs().max(y1.abs()) + 1);
            assert_eq!((pixels.first(), pixels.last()), (Some(&(3, -5)), Some(&(3 + x1, -5 + y1))));
        }
    }

    #[test]
    fn a_mirrored_line_is_the_mirror_image() {
        type Mirror = fn((i64, i64)) -> (i64, i64);
        let mirrors: [Mirror; 3] = [|(x, y)| (-x, y), |(x, y)| (x, -y), |(x, y)| (y, x)];
        for end in ends() {
            for mirror in mirrors {
                let expected: Vec<_> = midpoint_line((0, 0), end).map(mirror).collect();
                assert_eq!(line((0, 0), mirror(end)), expected, "to {end:?}");
            }
        }
    }

    #[test]
    fn a_direction_independent_line_covers_the_same_pixels_from_either_end() {
        const SIDE: i64 = 14;
        let window = || (0..SIDE).flat_map(|x| (0..SIDE).map(move |y| (x, y)));
        let mut differing = 0;
        for (p0, p1) in window().flat_map(|p0| window().map(move |p1| (p0, p1))) {
            let forth: Vec<_> = direction_independent_line(p0, p1).collect();
            let mut back: Vec<_> = direction_independent_line(p1, p0).collect();
            back.reverse();
            assert_eq!(forth, back, "{p0:?} to {p1:?}");
            let plain = line(p0, p1);
            if p0 <= p1 {
                assert_eq!(forth, plain, "{p0:?} to {p1:?}: as from the lesser end");
            } else if forth != plain {
                differing += 1;
                // The two lines differ only at ties: their pixels lie on opposite sides of the true line, at equal
                // distances.
                let off = |(x, y): (i64, i64)| ((p1.0 - p0.0) * (y - p0.1) - (p1.1 - p0.1) * (x - p0.0)).abs();
                assert!(forth.iter().zip(&plain).all(|(a, b)| off(*a) == off(*b)), "{p0:?} to {p1:?}");
            }
        }
        assert!(differing > 1000, "{differing} lines had ties");
    }

    #[test]
    fn the_farthest_corners_can_be_joined() {
        let mut pixels = midpoint_line((i64::MIN, i64::MAX), (i64::MAX, i64::MIN));
        assert_eq!(pixels.nth(2), Some((i64::MIN + 2, i64::MAX - 2)));
        let end = (i64::MAX, i64::MIN);
        assert_eq!(line((i64::MAX - 2, i64::MIN), end), [(i64::MAX - 2, i64::MIN), (i64::MAX - 1, i64::MIN), end]);
    }

    #[test]
    fn a_line_inside_is_left_alone_and_one_outside_is_nothing() {
        let inside = ((0.1, 7.3), (9.7, 0.2));
        assert_eq!(clip_to(inside.0, inside.1, 10, 8), Some(inside));
        assert_eq!(clip_to((-5.0, 1.0), (-1.0, 7.0), 10, 8), None, "left of the picture");
        assert_eq!(clip_to((-3.0, 2.0), (3.0, -3.0), 10, 8), None, "past a corner");
        assert_eq!(clip_to((f64::NAN, 2.0), (3.0, 3.0), 10, 8), None);
        assert_eq!(clip_to((0.0, 2.0), (f64::INFINITY, 3.0), 10, 8), None);
    }

    #[test]
    fn a_line_is_cut_where_it_crosses_the_border() {
        assert_eq!(clip_to((-4.0, 2.0), (16.0, 2.0), 10, 8), Some(((0.0, 2.0), (10.0, 2.0))));
        assert_eq!(clip_to((5.0, 12.0), (5.0, -4.0), 10, 8), Some(((5.0, 8.0), (5.0, 0.0))), "direction is kept");
        assert_eq!(clip_to((-2.0, 0.0), (6.0, 8.0), 10, 8), Some(((0.0, 2.0), (6.0, 8.0))), "slanted");
        assert_eq!(clip_to((3.0, 8.0), (30.0, 8.0), 10, 8), Some(((3.0, 8.0), (10.0, 8.0))), "along the border");
        assert_eq!(clip_to((4.0, 4.0), (4.0, 4.0), 10, 8), Some(((4.0, 4.0), (4.0, 4.0))), "a point");
    }

    #[test]
    fn the_clipped_line_lies_in_the_rectangle_and_on_the_line() {
        let mut random = fastrand::Rng::with_seed(5);
        let mut kept = 0;
        for round in 0..20_000 {
            // Coordinates range from the size of the picture to magnitudes at which the difference of two coordinates
            // overflows.
            let reach = [20.0, 1e4, 1e9, 1e300, f64::MAX][round % 5];
            let mut coordinate = || (random.f64() * 2.0 - 1.0) * reach;
            let (p0, p1) = ((coordinate(), coordinate()), (coordinate(), coordinate()));
            let Some((a, b)) = clip_to(p0, p1, 13, 9) else { continue };
            kept += 1;
            for (x, y) in [a, b] {
                assert!((0.0..=13.0).contains(&x) && (0.0..=9.0).contains(&y), "{p0:?} {p1:?}: ({x}, {y})");
                let (dx, dy) = (p1.0 - p0.0, p1.1 - p0.1);
                let off = ((x - p0.0) * dy - (y - p0.1) * dx).abs() / dx.hypot(dy);
                assert!(reach > 1e9 || off <= 1e-15 * reach, "{p0:?} {p1:?}: ({x}, {y}) is {off} px off");
            }
        }
        assert!(kept > 500, "only {kept} lines met the picture");
    }

    #[test]
    fn a_clipped_line_walks_no_pixel_outside() {
        let mut random = fastrand::Rng::with_seed(6);
        let pixel = |(x, y): (f64, f64)| ((x as i64).min(12), (y as i64).min(8));
        for _ in 0..2_000 {
            let mut coordinate = || random.f64() * 60.0 - 25.0;
            let ends = ((coordinate(), coordinate()), (coordinate(), coordinate()));
            for (x, y) in
                clip_to(ends.0, ends.1, 13, 9).into_iter().flat_map(|(a, b)| midpoint_line(pixel(a), pixel(b)))
            {
                assert!((0..13).contains(&x) && (0..9).contains(&y), "{ends:?}: ({x}, {y})");
            }
        }
    }
}
