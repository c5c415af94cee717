//! `real_line`: computes the pixels nearest to a line between two points with real coordinates.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Point, Refusal, Unanswered, check_length};
use crate::flat2d::real_line::{MAX_COORDINATE_PX, real_line};

/// Input of a `real_line` case: a line between two points with real coordinates.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct RealLine {
    /// Start point of the line, in pixels.
    pub(crate) p0: Point,
    /// End point of the line, in pixels.
    pub(crate) p1: Point,
}

impl Check for RealLine {}

impl RealLine {
    pub(super) fn answer(&self, control: &Control<'_>) -> Result<RealLineAnswer, Unanswered> {
        let (Point(p0), Point(p1)) = (self.p0, self.p1);
        let line = real_line(p0, p1).ok_or_else(|| {
            Refusal(format!("an end lies beyond {MAX_COORDINATE_PX:e} px, where floats no longer resolve half pixels"))
        })?;
        // Float-to-integer casts saturate.
        let count = (p1 - p0).abs().max_element() as u64;
        check_length::<(i64, i64)>("pixels of the line", count)?;
        Ok(RealLineAnswer { pixels: control.collect("pixels of the line", (0, count), line.map(Some))? })
    }
}

/// Answer to a [`RealLine`] case: the pixels of the line.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RealLineAnswer {
    /// Column and row of each pixel of the line, starting at `p0`.
    pub pixels: Vec<(i64, i64)>,
}
