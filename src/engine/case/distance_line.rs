//! `distance_line`: computes the pixels at most half a pixel away from a segment.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Point, Unanswered, check_picture};
use crate::flat2d::distance_line::distance_line;

/// Input of a `distance_line` case: a segment and a picture size.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct DistanceLine {
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Start point of the segment, in pixels.
    pub(crate) p0: Point,
    /// End point of the segment, in pixels.
    pub(crate) p1: Point,
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

/// Answer to a [`DistanceLine`] case: the pixels of the line.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DistanceLineAnswer {
    /// Column and row of each pixel of the line, row by row.
    pub pixels: Vec<(u32, u32)>,
}
