//! `line`: computes the pixels of a line between two pixels.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Exactly, Unanswered, check_length};
use crate::flat2d::line::{direction_independent_line, midpoint_line};

/// Input of a `line` case: a line between two pixels.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Line {
    /// Column and row of the first pixel.
    pub(crate) p0: Exactly<i64, 2>,
    /// Column and row of the last pixel.
    pub(crate) p1: Exactly<i64, 2>,
    /// Whether the line includes its last pixel. If `false`, consecutive segments of a polyline share no pixel.
    pub(crate) last_pixel: bool,
    /// Whether the line from `p0` to `p1` covers the same pixels as the line from `p1` to `p0`. If `false`, ties depend
    /// on the direction.
    #[serde(default)]
    pub(crate) direction_independent: bool,
}

impl Check for Line {}

impl Line {
    pub(super) fn answer(&self, control: &Control<'_>) -> Result<LineAnswer, Unanswered> {
        let (Exactly([x0, y0]), Exactly([x1, y1])) = (self.p0, self.p1);
        let steps = x0.abs_diff(x1).max(y0.abs_diff(y1));
        check_length::<(i64, i64)>("pixels of the line", steps)?;
        let count = steps as usize + usize::from(self.last_pixel);
        let line = if self.direction_independent { direction_independent_line } else { midpoint_line };
        let pixels = line((x0, y0), (x1, y1)).take(count).map(Some);
        Ok(LineAnswer { pixels: control.collect("pixels of the line", (0, steps), pixels)? })
    }
}

/// Answer to a [`Line`] case: the pixels of the line.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LineAnswer {
    /// Column and row of each pixel of the line, starting at `p0`.
    pub pixels: Vec<(i64, i64)>,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the pixels of the line from `p0` to `p1`. `field` is appended to the fields of the case, as JSON.
    fn pixels([p0, p1]: [[i64; 2]; 2], field: &str) -> Vec<(i64, i64)> {
        let case = format!(r#"{{"p0": {p0:?}, "p1": {p1:?}, "last_pixel": true{field}}}"#);
        serde_json::from_str::<Line>(&case).unwrap().answer(&Control::default()).unwrap().pixels
    }

    #[test]
    fn both_directions_cover_the_same_nearest_pixels_if_the_case_asks_for_it() {
        let independent = r#", "direction_independent": true"#;
        let mut differing = 0;
        for (x, y) in (-7..=7).flat_map(|y| (-7..=7).map(move |x| (x, y))) {
            let ends = [[1, -2], [1 + x, -2 + y]];
            let [forth, back] = [ends, [ends[1], ends[0]]].map(|ends| pixels(ends, independent));
            assert!(forth.iter().eq(back.iter().rev()), "{ends:?}: {forth:?}, {back:?}");
            let longest = x.abs().max(y.abs());
            assert_eq!(forth.len() as i64, longest + 1);
            for (column, row) in &forth {
                // Distance along the minor axis, in units of 1 / `longest`.
                let distance = (y * (column - 1) - x * (row + 2)).abs();
                assert!(2 * distance <= longest, "{ends:?}: ({column}, {row}) is not nearest");
            }
            let [forth, back] = [ends, [ends[1], ends[0]]].map(|ends| pixels(ends, ""));
            differing += usize::from(!forth.iter().eq(back.iter().rev()));
        }
        assert!(differing > 0, "without the field, ties depend on the direction");
    }
}
