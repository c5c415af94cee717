//! `line`: the pixels of a line between two pixels.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Exactly, Unanswered, check_length};
use crate::flat2d::line::{direction_independent_line, midpoint_line};

/// The case.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Line {
    /// The first pixel.
    pub p0: Exactly<i64, 2>,
    /// The last pixel.
    pub p1: Exactly<i64, 2>,
    /// Whether the last pixel belongs to the line; without it, lines in a row share no pixel.
    pub last_pixel: bool,
    /// Whether the line from `p1` to `p0` covers the same pixels; without it, ties depend on the direction.
    #[serde(default)]
    pub direction_independent: bool,
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

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LineAnswer {
    /// Columns and rows, from the first pixel on.
    pub pixels: Vec<(i64, i64)>,
}
