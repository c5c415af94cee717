//! `tri_coverage`: which samples lie inside triangles, each asked for itself.

use serde::{Deserialize, Serialize};

use super::{Check, Exactly, Point, check_picture};

/// The case.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct TriCoverage {
    /// Width of the picture, px.
    pub width: u32,
    /// Height of the picture, px.
    pub height: u32,
    /// Who owns samples on an edge.
    pub rule: CoverageRule,
    /// Corners in px, of either winding.
    pub triangles: Vec<Exactly<Point, 3>>,
}

/// Who owns a sample that lies exactly on an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CoverageRule {
    /// The triangle whose left edge or horizontal top edge it is.
    TopLeft,
    /// Every triangle whose edge it is.
    Inclusive,
}

impl Check for TriCoverage {
    fn check(&self) -> Result<(), String> {
        check_picture(self.width, self.height)
    }
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TriCoverageAnswer {
    /// Fraction bits of the grid that corners were snapped to; `None` if they were used as given.
    pub snap_bits: Option<u32>,
    /// One for each triangle.
    pub triangles: Vec<Covered>,
}

/// What one triangle covers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Covered {
    /// [row, first column, one past the last column] of each run.
    pub spans: Vec<[u32; 3]>,
}
