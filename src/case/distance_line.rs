//! `distance_line`: the pixels at most half a pixel beside a segment.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Point, Unanswered, check_picture};
use crate::flat2d::distance_line::distance_line;

/// The case.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct DistanceLine {
    /// Width of the picture, px.
    pub width: u32,
    /// Height of the picture, px.
    pub height: u32,
    /// One end, px.
    pub p0: Point,
    /// The other end, px.
    pub p1: Point,
}

impl Check for DistanceLine {
    fn check(&self) -> Result<(), String> {
        check_picture(self.width, self.height)
    }
}

impl DistanceLine {
    pub(super) fn answer(&self, control: &Control<'_>) -> Result<DistanceLineAnswer, Unanswered> {
        let mut line = distance_line(self.p0.0, self.p1.0, self.width, self.height);
        let probes = line.probes_left();
        let steps = std::iter::from_fn(|| line.step());
        Ok(DistanceLineAnswer { pixels: control.collect("pixels of the line", (0, probes), steps)? })
    }
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DistanceLineAnswer {
    /// Columns and rows, row by row.
    pub pixels: Vec<(u32, u32)>,
}
