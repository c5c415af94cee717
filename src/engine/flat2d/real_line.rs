//! Lines between real points. For each integer coordinate along the longer axis, a line has one pixel: the nearest one.
//!
//! Rounding y = y₀ + m (x − x₀) fails where the line passes close to the midpoint between two pixels, and adding m step
//! by step also accumulates drift. This module uses the formula only for a first guess at the start of the line. The
//! coordinate along the shorter axis changes by at most one per step, so each pixel has only two candidates. An exact
//! test decides on which side of the midpoint between the candidates the line passes. A line through a midpoint takes
//! the pixel of the larger coordinate, whatever its direction.

use std::cmp::Ordering;

use glam::DVec2;

use super::side;
use crate::math::expansion::Expansion;

/// Maximum magnitude of an endpoint's coordinate, in pixels. From 2⁵² on, f64 cannot represent half pixels.
pub(crate) const MAX_COORDINATE_PX: f64 = (1_u64 << 50) as f64;

/// Iterator over the pixels of a line; see [`real_line`].
#[derive(Clone, Debug)]
pub(crate) struct RealLinePixels {
    /// Whether y is the longer axis. The fields below use the longer axis as x.
    steep: bool,
    /// Endpoint with the smaller x; `high` is the other endpoint.
    low: DVec2,
    high: DVec2,
    /// x of the next pixel; `end` is one step past the last pixel, and `step` is ±1.
    major: i64,
    end: i64,
    step: i64,
    /// y of the previous pixel, where the search for the next one starts.
    minor: i64,
}

/// Returns the pixels of the line from `p0` to `p1`. There are none if the line lies between two adjacent integer
/// coordinates of its longer axis.
///
/// Returns `None` if an endpoint is not finite or has a coordinate beyond [`MAX_COORDINATE_PX`].
pub(crate) fn real_line(p0: DVec2, p1: DVec2) -> Option<RealLinePixels> {
    if !(p0.abs().max_element() <= MAX_COORDINATE_PX && p1.abs().max_element() <= MAX_COORDINATE_PX) {
        return None;
    }
    let steep = is_steep(p0, p1);
    let along = |p: DVec2| if steep { DVec2::new(p.y, p.x) } else { p };
    let (from, to) = (along(p0), along(p1));
    let forward = from.x <= to.x;
    let (low, high) = if forward { (from, to) } else { (to, from) };
    let (first, last) = (low.x.ceil() as i64, high.x.floor() as i64);
    // A line between two adjacent integer coordinates has no pixels: `first` is then `last + 1`, so `end` is `major`.
    let (major, end, step) = if forward { (first, last + 1, 1) } else { (last, first - 1, -1) };
    // A line of length zero is extended along x so that its sides are defined. At an integer coordinate the sum is
    // exact.
    let high = if low == high { high + DVec2::X } else { high };
    let slope = (high.y - low.y) / (high.x - low.x);
    let minor = (low.y + (major as f64 - low.x) * slope).round() as i64;
    Some(RealLinePixels { steep, low, high, major, end, step, minor })
}

/// Whether |Δx| < |Δy|, decided exactly.
fn is_steep(p0: DVec2, p1: DVec2) -> bool {
    let (dx, dy) = (Expansion::difference(p1.x, p0.x), Expansion::difference(p1.y, p0.y));
    (&(&dx * &dx) - &(&dy * &dy)).sign() == Ordering::Less
}

impl RealLinePixels {
    /// Whether y is the longer axis, on which every integer coordinate gets a pixel.
    pub(crate) fn is_steep(&self) -> bool {
        self.steep
    }

    /// Returns the coordinate of the next pixel along the longer axis, or `None` after the last pixel.
    pub(crate) fn major(&self) -> Option<i64> {
        (self.major != self.end).then_some(self.major)
    }

    /// Returns the coordinate of the previous pixel along the shorter axis, where the search for the next pixel starts.
    pub(crate) fn minor(&self) -> i64 {
        self.minor
    }

    /// Whether the line's coordinate along the shorter axis is at least `minor` − ½ at the next step.
    fn reaches(&self, minor: i64) -> bool {
        side(self.low, self.high, DVec2::new(self.major as f64, minor as f64 - 0.5)) != Ordering::Greater
    }
}

impl Iterator for RealLinePixels {
    type Item = (i64, i64);

    fn next(&mut self) -> Option<(i64, i64)> {
        let major = self.major()?;
        while !self.reaches(self.minor) {
            self.minor -= 1;
        }
        while self.reaches(self.minor + 1) {
            self.minor += 1;
        }
        self.major += self.step;
        Some(if self.steep { (self.minor, major) } else { (major, self.minor) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(p0: (f64, f64), p1: (f64, f64)) -> Vec<(i64, i64)> {
        real_line(p0.into(), p1.into()).unwrap().collect()
    }

    /// Returns the pixels of a line, computed from the definition in integers. The endpoints are in units of 1/`unit`
    /// px.
    fn by_definition(p0: (i64, i64), p1: (i64, i64), unit: i64) -> Vec<(i64, i64)> {
        let steep = (p1.0 - p0.0).abs() < (p1.1 - p0.1).abs();
        let swap = |(x, y): (i64, i64)| if steep { (y, x) } else { (x, y) };
        let (from, to) = (swap(p0), swap(p1));
        let (dx, dy) = (i128::from(to.0 - from.0), i128::from(to.1 - from.1));
        let (least, greatest) = (from.0.min(to.0), from.0.max(to.0));
        let mut found: Vec<_> = (least.div_euclid(unit)..=greatest.div_euclid(unit))
            .filter(|x| (least..=greatest).contains(&(x * unit)))
            .map(|x| {
                // y = from.1 + (x·unit − from.0) dy/dx, rounded half up: ⌊(2y + unit) / 2·unit⌋.
                let (numerator, denominator) = match dx {
                    0 => (from.1.into(), 1),
                    _ => (i128::from(from.1) * dx + i128::from(x * unit - from.0) * dy, dx),
                };
                let (numerator, denominator) = (numerator * denominator.signum(), denominator.abs());
                let unit = i128::from(unit);
                let y = (2 * numerator + unit * denominator).div_euclid(2 * unit * denominator) as i64;
                swap((x, y))
            })
            .collect();
        if from.0 > to.0 {
            found.reverse();
        }
        found
    }

    #[test]
    fn every_pixel_is_the_nearest_one_decided_exactly() {
        let mut random = fastrand::Rng::with_seed(51);
        let mut ties = 0;
        for round in 0..20_000 {
            // Coarse units make ties frequent; fine ones make near ties frequent.
            let unit = [1, 2, 4, 1 << 10, 1 << 20][round % 5];
            let mut coordinate = || random.i64(-40 * unit..40 * unit);
            let (p0, p1) = ((coordinate(), coordinate()), (coordinate(), coordinate()));
            let real = |(x, y): (i64, i64)| (x as f64 / unit as f64, y as f64 / unit as f64);
            let found = pixels(real(p0), real(p1));
            assert_eq!(found, by_definition(p0, p1, unit), "{p0:?} {p1:?} in 1/{unit} px");
            let mirrored = pixels((-real(p0).0, -real(p0).1), (-real(p1).0, -real(p1).1));
            ties += usize::from(mirrored != found.iter().map(|(x, y)| (-x, -y)).collect::<Vec<_>>());
        }
        assert!(ties > 500, "only {ties} lines went through a midpoint");
    }

    #[test]
    fn a_point_is_a_pixel_if_it_lies_on_a_whole_coordinate() {
        assert_eq!(pixels((3.0, 2.4), (3.0, 2.4)), [(3, 2)]);
        assert_eq!(pixels((3.0, 2.5), (3.0, 2.5)), [(3, 3)]);
        assert_eq!(pixels((3.1, 2.0), (3.1, 2.0)), []);
        assert_eq!(pixels((3.2, 5.0), (3.4, 5.1)), [], "no whole x between the ends");
    }

    #[test]
    fn near_ties_are_decided_exactly() {
        let tiny = 2.0_f64.powi(-149);
        assert_eq!(pixels((0.0, 0.5 - f64::EPSILON / 4.0), (2.0, 0.5)), [(0, 0), (1, 0), (2, 1)]);
        assert_eq!(pixels((0.0, tiny), (0.0, tiny)), [(0, 0)]);
        // The line is longer in x than in y by only 10⁻⁴⁵ px.
        assert_eq!(pixels((-tiny, 0.0), (1.0, 1.0)), [(0, 0), (1, 1)]);
        assert!(!real_line(DVec2::new(-tiny, 0.0), DVec2::ONE).unwrap().is_steep());
        assert!(real_line(DVec2::new(tiny, 0.0), DVec2::ONE).unwrap().is_steep());
    }

    #[test]
    fn far_ends_are_supported_up_to_the_limit() {
        let far = MAX_COORDINATE_PX;
        let mut line = real_line(DVec2::new(-far, far), DVec2::new(far, -far)).unwrap();
        assert_eq!(line.nth(1), Some((1 - far as i64, far as i64 - 1)));
        assert!(real_line(DVec2::new(0.0, f64::NAN), DVec2::ONE).is_none());
        assert!(real_line(DVec2::ZERO, DVec2::new(2.0 * far, 0.0)).is_none());
    }

    #[test]
    fn the_state_runs_ahead_of_the_pixels() {
        let mut line = real_line(DVec2::new(0.25, 0.0), DVec2::new(3.0, 2.0)).unwrap();
        assert_eq!((line.is_steep(), line.major()), (false, Some(1)));
        assert_eq!(line.next(), Some((1, 1)));
        assert_eq!((line.major(), line.minor()), (Some(2), 1));
        assert_eq!(line.by_ref().last(), Some((3, 2)));
        assert_eq!(line.major(), None);
    }
}
