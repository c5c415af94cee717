//! `circle`: the pixels of a circle.

use serde::{Deserialize, Serialize};

use super::{Check, Exactly, Refusal, check_length};
use crate::flat2d::circle::midpoint_circle;

/// The case.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Circle {
    /// The pixel in the middle.
    pub c: Exactly<i32, 2>,
    /// Radius, px.
    pub r: u32,
}

impl Check for Circle {}

impl Circle {
    pub(super) fn answer(&self) -> Result<CircleAnswer, Refusal> {
        // Each octant has r / √2 pixels.
        check_length("circle", u64::from(self.r) * 8 * 5 / 7)?;
        let Exactly([x, y]) = self.c;
        Ok(CircleAnswer { pixels: midpoint_circle((x, y), self.r).collect() })
    }
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CircleAnswer {
    /// Columns and rows, each pixel once.
    pub pixels: Vec<(i64, i64)>,
}
