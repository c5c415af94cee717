//! `ellipse`: computes the pixels of an axis-aligned ellipse.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Exactly, Unanswered, check_length};
use crate::flat2d::ellipse::midpoint_ellipse;

/// Input of an `ellipse` case: an axis-aligned ellipse around a pixel.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Ellipse {
    /// Column and row of the centre pixel.
    pub(crate) c: Exactly<i32, 2>,
    /// Horizontal semi-axis in pixels.
    pub(crate) a: u32,
    /// Vertical semi-axis in pixels.
    pub(crate) b: u32,
}

impl Check for Ellipse {}

impl Ellipse {
    pub(super) fn answer(&self, control: &Control<'_>) -> Result<EllipseAnswer, Unanswered> {
        // A quadrant has a² / √(a² + b²) pixels where the slope is below 45° and b² / √(a² + b²) where it is above.
        let count = (4.0 * f64::from(self.a).hypot(f64::from(self.b))) as u64;
        check_length::<(i64, i64)>("pixels of the ellipse", count)?;
        let Exactly([x, y]) = self.c;
        let pixels = midpoint_ellipse((x, y), self.a, self.b).map(Some);
        Ok(EllipseAnswer { pixels: control.collect("pixels of the ellipse", (0, count), pixels)? })
    }
}

/// Answer to an [`Ellipse`] case: the pixels of the ellipse.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EllipseAnswer {
    /// Column and row of each pixel of the ellipse, without duplicates.
    pub(crate) pixels: Vec<(i64, i64)>,
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::case::Circle;

    fn pixels(a: u32, b: u32) -> HashSet<(i64, i64)> {
        let list = Ellipse { c: Exactly([3, -5]), a, b }.answer(&Control::default()).unwrap().pixels;
        let set: HashSet<_> = list.iter().map(|(x, y)| (x - 3, y + 5)).collect();
        assert_eq!(set.len(), list.len(), "{a} {b}: a pixel occurs twice");
        set
    }

    #[test]
    fn equal_axes_give_the_circle() {
        for r in 0..60 {
            let circle = Circle { c: Exactly([0, 0]), r }.answer(&Control::default()).unwrap();
            assert_eq!(pixels(r, r), circle.pixels.into_iter().collect(), "{r}");
        }
    }

    #[test]
    fn the_curve_passes_within_half_a_pixel_of_every_pixel_and_no_row_or_column_is_left_out() {
        for (a, b) in (1..24).flat_map(|a| (1..24).map(move |b| (a, b))) {
            let pixels = pixels(a, b);
            let [a, b] = [a, b].map(i64::from);
            // Four times the implicit form at a position in half pixels; negative inside.
            let form = |x: i64, y: i64| b * b * x * x + a * a * y * y - 4 * a * a * b * b;
            let crosses = |from: (i64, i64), to: (i64, i64)| form(from.0, from.1) <= 0 && form(to.0, to.1) >= 0;
            for (x, y) in pixels.iter().map(|(x, y)| (2 * x.abs(), 2 * y.abs())) {
                let beside = crosses((x, y - 1), (x, y + 1)) || crosses((x - 1, y), (x + 1, y));
                // Pixels on the axes are exempt: near the tips of a thin ellipse, the curve passes on both sides of
                // such a pixel.
                assert!(beside || x == 0 || y == 0, "{a} {b}: {x}/2 {y}/2");
            }
            assert!((-a..=a).all(|x| pixels.iter().any(|pixel| pixel.0 == x)), "{a} {b}: columns");
            assert!((-b..=b).all(|y| pixels.iter().any(|pixel| pixel.1 == y)), "{a} {b}: rows");
        }
    }

    #[test]
    fn too_long_an_ellipse_is_refused() {
        let ellipse = Ellipse { c: Exactly([0, 0]), a: u32::MAX, b: 1 };
        let refusal = ellipse.answer(&Control::default()).unwrap_err().to_string();
        assert!(refusal.contains(" pixels of the ellipse, the limit"), "{refusal}");
    }
}
