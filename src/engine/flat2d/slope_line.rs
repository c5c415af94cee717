//! Lines by their slope, in f32: one rounded pixel per step of the longer axis.
//!
//! The simplest method computes y = m (x − x₀) + y₀ at every step and rounds it. The *digital differential analyser*
//! (DDA) saves the multiplication and adds m to the previous y. Each addition rounds, the errors accumulate, and a long
//! line drifts. [`super::line`] needs no floats, and [`super::real_line`] decides exactly.

use glam::DVec2;

/// Method that computes the coordinate along the shorter axis at each step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stepping {
    /// Evaluates y = m (x − x₀) + y₀ at every step.
    Intersection,
    /// Adds the slope to the previous value, y ← y + m.
    Addition,
}

/// Iterator over the pixels of a line; see [`slope_line`].
#[derive(Clone, Debug)]
pub(crate) struct SlopeLine {
    stepping: Stepping,
    /// Whether y is the longer axis. The fields below use the longer axis as x.
    steep: bool,
    from: DVec2,
    to: DVec2,
    /// Change of y per step of +1 in x.
    slope: f32,
    /// x of the next pixel; `end` is one step past the last pixel, and `step` is ±1.
    major: i64,
    end: i64,
    step: i64,
    /// y at the next pixel, before rounding.
    minor: f32,
}

/// Returns the pixels of the line from `p0` to `p1`, one per step along the longer axis, including the pixel nearest to
/// each endpoint.
///
/// The endpoints are rounded to f32. Returns `None` if a coordinate exceeds 2²⁴, beyond which f32 cannot represent
/// every integer.
pub(crate) fn slope_line(p0: DVec2, p1: DVec2, stepping: Stepping) -> Option<SlopeLine> {
    const MAX_COORDINATE_PX: f64 = (1 << 24) as f64;
    if !(p0.abs().max_element() <= MAX_COORDINATE_PX && p1.abs().max_element() <= MAX_COORDINATE_PX) {
        return None;
    }
    let extent = (p1 - p0).abs();
    let steep = extent.y > extent.x;
    let along = |p: DVec2| if steep { DVec2::new(p.y, p.x) } else { p };
    let (from, to) = (along(p0), along(p1));
    let slope = if from.x == to.x { 0.0 } else { (to.y as f32 - from.y as f32) / (to.x as f32 - from.x as f32) };
    let (first, last) = (round(from.x as f32), round(to.x as f32));
    let step = if first <= last { 1 } else { -1 };
    let mut line = SlopeLine { stepping, steep, from, to, slope, major: first, end: last + step, step, minor: 0.0 };
    line.minor = line.intersection();
    Some(line)
}

fn round(value: f32) -> i64 {
    (value + 0.5).floor() as i64
}

impl SlopeLine {
    /// Whether y is the longer axis, along which the line steps.
    pub(crate) fn is_steep(&self) -> bool {
        self.steep
    }

    /// Returns the coordinate of the next pixel along the shorter axis, before rounding, or `None` after the last
    /// pixel.
    pub(crate) fn value(&self) -> Option<f32> {
        (self.major != self.end).then_some(self.minor)
    }

    /// Returns [`value`](Self::value) computed in f64 from the endpoints as given, not rounded to f32.
    pub(crate) fn exact_value(&self) -> f64 {
        if self.from.x == self.to.x {
            return self.from.y;
        }
        self.from.y + (self.major as f64 - self.from.x) * ((self.to.y - self.from.y) / (self.to.x - self.from.x))
    }

    fn intersection(&self) -> f32 {
        self.slope * (self.major as f32 - self.from.x as f32) + self.from.y as f32
    }
}

impl Iterator for SlopeLine {
    type Item = (i64, i64);

    fn next(&mut self) -> Option<(i64, i64)> {
        let minor = round(self.value()?);
        let major = self.major;
        self.major += self.step;
        self.minor = match self.stepping {
            Stepping::Intersection => self.intersection(),
            Stepping::Addition => self.minor + self.slope * self.step as f32,
        };
        Some(if self.steep { (minor, major) } else { (major, minor) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flat2d::real_line::real_line;

    fn pixels(p0: DVec2, p1: DVec2, stepping: Stepping) -> Vec<(i64, i64)> {
        slope_line(p0, p1, stepping).unwrap().collect()
    }

    #[test]
    fn short_lines_between_lattice_points_are_the_exact_ones() {
        for (x, y) in (-12..=12).flat_map(|x| (-12..=12).map(move |y| (x, y))) {
            let (from, to) = (DVec2::new(3.0, -5.0), DVec2::new(3.0 + f64::from(x), -5.0 + f64::from(y)));
            let exact: Vec<_> = real_line(from, to).unwrap().collect();
            for stepping in [Stepping::Intersection, Stepping::Addition] {
                let found = pixels(from, to, stepping);
                assert_eq!(found.len(), exact.len());
                for (a, b) in found.iter().zip(&exact) {
                    // Rounding in floats may decide ties either way.
                    assert!((a.0 - b.0).abs() + (a.1 - b.1).abs() <= 1, "{x} {y} {stepping:?}: {a:?}, not {b:?}");
                }
            }
        }
    }

    #[test]
    fn addition_drifts_on_a_long_line_and_multiplication_does_not() {
        let (from, to) = (DVec2::ZERO, DVec2::new(10_000.0, 1_111.0));
        let exact: Vec<_> = real_line(from, to).unwrap().collect();
        let wrong = |stepping| pixels(from, to, stepping).iter().zip(&exact).filter(|(a, b)| a != b).count();
        assert!(wrong(Stepping::Addition) > 50, "{} wrong", wrong(Stepping::Addition));
        assert!(wrong(Stepping::Intersection) < 10, "{} wrong", wrong(Stepping::Intersection));
        let mut line = slope_line(from, to, Stepping::Addition).unwrap();
        line.by_ref().take(9_000).for_each(drop);
        let drift = f64::from(line.value().unwrap()) - line.exact_value();
        assert!(drift.abs() > 1e-3, "{drift}");
    }

    #[test]
    fn a_point_is_one_pixel_and_far_ends_are_refused() {
        assert_eq!(pixels(DVec2::splat(2.4), DVec2::splat(2.4), Stepping::Addition), [(2, 2)]);
        assert!(slope_line(DVec2::ZERO, DVec2::splat(1e9), Stepping::Addition).is_none());
        assert!(slope_line(DVec2::NAN, DVec2::ZERO, Stepping::Intersection).is_none());
    }
}
