//! `distance_line`: computes the pixels at most half a pixel from a segment.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Point, Unanswered, check_picture};
use crate::flat2d::distance_line::distance_line;

/// Case of kind `distance_line`: a segment and a picture size.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct DistanceLine {
    /// Width of the picture, px.
    pub width: u32,
    /// Height of the picture, px.
    pub height: u32,
    /// First end, px.
    pub(crate) p0: Point,
    /// Second end, px.
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

/// Answer to a [`DistanceLine`] case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DistanceLineAnswer {
    /// Column and row of each pixel, row by row.
    pub pixels: Vec<(u32, u32)>,
}
