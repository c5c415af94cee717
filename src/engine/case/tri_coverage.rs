//! `tri_coverage`: finds the samples inside triangles, each triangle independently of the others.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Exactly, Float, Options, Unanswered, check_length, check_picture, rule};
use crate::pipeline::pixel_box::box_around;
use crate::pipeline::raster::Span;
use crate::pipeline::settings::FillRule;
use crate::pipeline::viewport::Viewport;

/// Input of a `tri_coverage` case: triangles and a picture size.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct TriCoverage {
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Fill rule, which decides whether a sample on an edge is covered.
    #[serde(with = "rule")]
    pub(crate) rule: FillRule,
    /// Corners of each triangle in pixels, in either winding order. A triangle with a non-finite corner covers nothing.
    pub(crate) triangles: Vec<Exactly<Exactly<Float, 2>, 3>>,
}

impl Check for TriCoverage {
    fn check(&self) -> Result<(), String> {
        check_picture(self.width, self.height)
    }
}

impl TriCoverage {
    /// Returns the corners of one triangle, in pixels; `None` if `triangle` is out of range.
    pub(crate) fn corners_px(&self, triangle: usize) -> Option<[[f32; 2]; 3]> {
        let Exactly(corners) = self.triangles.get(triangle)?;
        Some(corners.map(|Exactly(corner)| corner.map(|number| number.0)))
    }

    /// Returns the size of the picture, in pixels.
    pub(crate) fn viewport(&self) -> Viewport {
        Viewport { width: self.width, height: self.height }
    }

    /// Rasterizes one triangle in bands of rows from the top. `take` receives the spans of each band and the index of
    /// the first row below the band.
    pub(crate) fn rasterize(
        &self,
        triangle: usize,
        options: Options,
        take: impl FnMut(&[Span], u32) -> Result<(), Unanswered>,
    ) -> Result<(), Unanswered> {
        let Some(corners_px) = self.corners_px(triangle) else { return Ok(()) };
        options.coverage(self.rule).cover_in_bands(corners_px, self.viewport(), take)
    }

    pub(super) fn answer(&self, options: Options, control: &Control<'_>) -> Result<TriCoverageAnswer, Unanswered> {
        let corners = (0..self.triangles.len()).filter_map(|number| self.corners_px(number));
        check_length::<[u32; 3]>("rows of triangles", corners.map(|corners| self.rows_around(corners)).sum())?;
        let (mut listed, mut triangles) = (0, Vec::with_capacity(self.triangles.len()));
        for number in 0..self.triangles.len() {
            let mut covered = TriangleSpans::default();
            self.rasterize(number, options, |spans, row| {
                listed += spans.len() as u64;
                check_length::<[u32; 3]>("spans", listed)?;
                covered.add(spans);
                control.step((number as f64 + f64::from(row) / f64::from(self.height)) / self.triangles.len() as f64)
            })?;
            control.check()?;
            triangles.push(covered);
        }
        Ok(TriCoverageAnswer { snap_bits: options.snap_bits(), triangles })
    }

    /// Returns the number of picture rows that the bounding box of a triangle overlaps.
    fn rows_around(&self, corners_px: [[f32; 2]; 3]) -> u64 {
        let [.., top, bottom] = box_around(corners_px);
        // Casts saturate, so a non-finite box counts as the whole picture or as empty.
        let row = |px: f32| (px.max(0.0) as u64).min(self.height.into());
        row(bottom.ceil()).saturating_sub(row(top.floor()))
    }
}

/// Answer to a [`TriCoverage`] case: the covered samples of each triangle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TriCoverageAnswer {
    /// Number of fractional bits of the grid to which corners were snapped; `None` if they were used as given.
    pub snap_bits: Option<u32>,
    /// Covered samples of each triangle, in input order.
    pub triangles: Vec<TriangleSpans>,
}

/// Covered samples of one triangle.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TriangleSpans {
    /// Runs of covered samples, each as [row, first column, one past the last column].
    pub spans: Vec<[u32; 3]>,
}

impl TriangleSpans {
    /// Appends the spans that a rasterizer found.
    pub(super) fn add(&mut self, spans: &[Span]) {
        self.spans.extend(spans.iter().map(|span| [span.row, span.left, span.right]));
    }
}
