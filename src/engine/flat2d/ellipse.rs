//! Axis-aligned ellipses, pixel by pixel, in integer arithmetic only (the midpoint form of Van Aken 1984).
//!
//! The algorithm walks one quadrant from its top. The next pixel is one of three: the one to the right, the one
//! diagonally below, or the one below. If the midpoint (x + 1, y − ½) lies inside the ellipse, the next pixel is to the
//! right. Otherwise the midpoint (x + ½, y − 1) decides between the diagonal pixel and the one below. The sign of F(x,
//! y) = b²x² + a²y² − a²b² shows on which side a midpoint lies. The textbook tests only one of the two midpoints,
//! depending on whether the ellipse is flatter than 45°, and cuts off the tips of thin ellipses. The other three
//! quadrants are reflections.

/// Iterator over the pixels of an ellipse; see [`midpoint_ellipse`].
#[derive(Clone, Debug)]
pub(crate) struct MidpointEllipse {
    center: (i32, i32),
    /// Semi-axes along x and y, in pixels.
    half: (i128, i128),
    /// Position in the quadrant, relative to the centre. The walk ends when y < 0 or x exceeds the semi-axis.
    x: i128,
    y: i128,
    /// Reflection of the next pixel: bit 0 mirrors x, bit 1 mirrors y.
    reflection: u8,
}

const REFLECTIONS: u8 = 4;

/// Returns the pixels of an ellipse with integer semi-axes, centred on a pixel, without duplicates.
///
/// The order follows the quadrant: first all reflections of the topmost pixel, and last those at the sides.
pub(crate) fn midpoint_ellipse(center: (i32, i32), half_width: u32, half_height: u32) -> MidpointEllipse {
    let half = (i128::from(half_width), i128::from(half_height));
    MidpointEllipse { center, half, x: 0, y: half.1, reflection: 0 }
}

impl MidpointEllipse {
    /// Returns the current position in the quadrant, relative to the centre, or `None` after the last position.
    pub(crate) fn quadrant(&self) -> Option<(i128, i128)> {
        (self.y >= 0 && self.x <= self.half.0).then_some((self.x, self.y))
    }

    /// Whether the ellipse is flatter than 45° at the next midpoint, so that x grows at every step.
    pub(crate) fn is_flat(&self) -> bool {
        let (a, b) = self.half;
        a * a * (2 * self.y - 1) > 2 * b * b * (self.x + 1)
    }

    /// Returns 4 · F(x + 1, y − ½) with F(x, y) = b²x² + a²y² − a²b²: it is negative if the midpoint between the pixel
    /// to the right and the diagonal pixel lies inside the ellipse.
    pub(crate) fn right_or_diagonal(&self) -> i128 {
        self.quadruple_at(2 * self.x + 2, 2 * self.y - 1)
    }

    /// Returns 4 · F(x + ½, y − 1) with F(x, y) = b²x² + a²y² − a²b²: it is negative if the midpoint between the
    /// diagonal pixel and the pixel below lies inside the ellipse.
    pub(crate) fn diagonal_or_down(&self) -> i128 {
        self.quadruple_at(2 * self.x + 1, 2 * self.y - 2)
    }

    fn quadruple_at(&self, doubled_x: i128, doubled_y: i128) -> i128 {
        let (a, b) = self.half;
        b * b * doubled_x * doubled_x + a * a * doubled_y * doubled_y - 4 * a * a * b * b
    }

    fn step(&mut self) {
        // A thin ellipse reaches its axis before its tip and continues along the axis.
        let on_axis = self.y == 0 && self.x < self.half.0;
        let (right, down) =
            if on_axis || self.right_or_diagonal() < 0 { (1, 0) } else { (i128::from(self.diagonal_or_down() < 0), 1) };
        self.x += right;
        self.y -= down;
        self.reflection = 0;
    }

    fn is_repeated(&self, reflection: u8) -> bool {
        reflection & 1 != 0 && self.x == 0 || reflection & 2 != 0 && self.y == 0
    }
}

impl Iterator for MidpointEllipse {
    type Item = (i64, i64);

    fn next(&mut self) -> Option<(i64, i64)> {
        loop {
            let (x, y) = self.quadrant()?;
            if self.reflection == REFLECTIONS {
                self.step();
                continue;
            }
            let reflection = self.reflection;
            self.reflection += 1;
            if !self.is_repeated(reflection) {
                let x = if reflection & 1 != 0 { -x } else { x } as i64;
                let y = if reflection & 2 != 0 { -y } else { y } as i64;
                return Some((i64::from(self.center.0) + x, i64::from(self.center.1) + y));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::flat2d::circle::midpoint_circle;

    fn ellipse(a: u32, b: u32) -> Vec<(i64, i64)> {
        midpoint_ellipse((0, 0), a, b).collect()
    }

    #[test]
    fn every_pixel_is_within_half_a_pixel_of_the_curve_along_a_row_or_a_column() {
        for (a, b) in (1..40).flat_map(|a| (1..40).map(move |b| (a, b))) {
            for (x, y) in ellipse(a, b) {
                let (a, b, x, y) = (f64::from(a), f64::from(b), x.abs() as f64, y.abs() as f64);
                let across = (b * (1.0 - (x / a).powi(2)).max(0.0).sqrt() - y).abs();
                let along = (a * (1.0 - (y / b).powi(2)).max(0.0).sqrt() - x).abs();
                assert!(across.min(along) <= 0.5 + 1e-9, "({x}, {y}) of {a} × {b}: {across}, {along}");
            }
        }
    }

    #[test]
    fn every_pixel_occurs_once_and_all_are_connected() {
        for (a, b) in (0..24).flat_map(|a| (0..24).map(move |b| (a, b))) {
            let pixels = ellipse(a, b);
            let set: HashSet<_> = pixels.iter().copied().collect();
            assert_eq!(set.len(), pixels.len(), "{a} × {b}");
            let (a, b) = (i64::from(a), i64::from(b));
            for tip in [(a, 0), (-a, 0), (0, b), (0, -b)] {
                assert!(set.contains(&tip), "{tip:?} of {a} × {b}");
            }
            let near = |p: &(i64, i64), q: &(i64, i64)| (p.0 - q.0).abs().max((p.1 - q.1).abs()) == 1;
            let connected = |p: &(i64, i64)| set.len() == 1 || set.iter().any(|q| near(p, q));
            assert!(set.iter().all(connected), "{a} × {b}");
        }
    }

    #[test]
    fn equal_axes_give_the_circle_but_for_the_corner_of_the_octants() {
        for radius in 0..200 {
            let circle: HashSet<_> = midpoint_circle((0, 0), radius).collect();
            let difference = ellipse(radius, radius).iter().filter(|p| !circle.contains(p)).count();
            assert!(difference <= 4, "radius {radius}: {difference}");
        }
    }
}
