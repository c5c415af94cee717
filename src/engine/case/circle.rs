//! `circle`: computes the pixels of a circle.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Exactly, Unanswered, check_length};
use crate::flat2d::circle::midpoint_circle;

/// Input of a `circle` case: a circle around a pixel.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Circle {
    /// Column and row of the centre pixel.
    pub(crate) c: Exactly<i32, 2>,
    /// Radius of the circle, in pixels.
    pub(crate) r: u32,
}

impl Check for Circle {}

impl Circle {
    pub(super) fn answer(&self, control: &Control<'_>) -> Result<CircleAnswer, Unanswered> {
        // Each octant has about r / √2 pixels, and 5/7 approximates 1/√2.
        let count = u64::from(self.r) * 8 * 5 / 7;
        check_length::<(i64, i64)>("pixels of the circle", count)?;
        let Exactly([x, y]) = self.c;
        let pixels = midpoint_circle((x, y), self.r).map(Some);
        Ok(CircleAnswer { pixels: control.collect("pixels of the circle", (0, count), pixels)? })
    }
}

/// Answer to a [`Circle`] case: the pixels of the circle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CircleAnswer {
    /// Column and row of each pixel of the circle, without duplicates.
    pub pixels: Vec<(i64, i64)>,
}
