//! `tri_coverage`: which samples lie inside triangles, each asked for itself.

use serde::{Deserialize, Serialize};

use super::{Check, Exactly, Float, Options, check_picture, rule};
use crate::pipeline::raster::{Span, cover};
use crate::pipeline::settings::FillRule;
use crate::pipeline::viewport::Viewport;

/// The case.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct TriCoverage {
    /// Width of the picture, px.
    pub width: u32,
    /// Height of the picture, px.
    pub height: u32,
    /// Who owns samples on an edge.
    #[serde(with = "rule")]
    pub rule: FillRule,
    /// Corners in px, of either winding. A corner that is not finite covers nothing.
    pub triangles: Vec<Exactly<Exactly<Float, 2>, 3>>,
}

impl Check for TriCoverage {
    fn check(&self) -> Result<(), String> {
        check_picture(self.width, self.height)
    }
}

impl TriCoverage {
    /// Corners of one of the triangles, px.
    pub fn corners_px(&self, triangle: usize) -> Option<[[f32; 2]; 3]> {
        let Exactly(corners) = self.triangles.get(triangle)?;
        Some(corners.map(|Exactly(corner)| corner.map(|number| number.0)))
    }

    pub(super) fn answer(&self, options: Options) -> TriCoverageAnswer {
        let viewport = Viewport { width: self.width, height: self.height };
        let triangles = (0..self.triangles.len()).filter_map(|number| self.corners_px(number)).map(|corners_px| {
            Covered::new(&cover(options.rasterizer, options.arithmetic, corners_px, self.rule, viewport))
        });
        TriCoverageAnswer { snap_bits: options.snap_bits(), triangles: triangles.collect() }
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

impl Covered {
    /// Writes spans of a rasterizer.
    pub(super) fn new(spans: &[Span]) -> Self {
        Self { spans: spans.iter().map(|span| [span.row, span.left, span.right]).collect() }
    }
}
