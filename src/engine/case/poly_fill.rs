//! `poly_fill`: finds the samples inside a polygon of any number of contours.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Options, Point, Real, Unanswered, check_length, check_picture};
use crate::flat2d::polygon::{Corners, FillParameters, InsideRule, SamplePoint, fill};

/// Maximum number of corners of a polygon. An empty contour counts as one corner.
const MAX_CORNERS: usize = 1 << 20;

/// Input of a `poly_fill` case: a polygon and a picture size.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct PolyFill {
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Rule that decides which points are inside the polygon.
    pub(crate) rule: PolygonRule,
    /// Position of the sample within its pixel on both axes: 0.5 at the pixel centre, 0 at integer coordinates.
    #[serde(default = "middle")]
    pub(crate) center: Real,
    /// Corners of each contour, in pixels. Contours are closed implicitly.
    pub(crate) contours: Vec<Vec<Point>>,
}

fn middle() -> Real {
    Real(0.5)
}

/// Inside rule for contours that may overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum PolygonRule {
    /// Points with an odd winding number are inside.
    EvenOdd,
    /// Points with a non-zero winding number are inside.
    Nonzero,
}

impl Check for PolyFill {
    fn check(&self) -> Result<(), String> {
        if self.sample_point().is_none() {
            return Err(format!("`center` must be 0.5 or 0, not {}", self.center.0));
        }
        let corners = self.contours.iter().map(|contour| contour.len().max(1)).sum::<usize>();
        if corners > MAX_CORNERS {
            return Err(format!("the contours have more than {MAX_CORNERS} corners, the maximum"));
        }
        check_picture(self.width, self.height)
    }
}

impl PolyFill {
    /// Returns the corners of each contour, in pixels.
    pub(crate) fn outlines(&self) -> Vec<Vec<[f64; 2]>> {
        self.contours.iter().map(|contour| contour.iter().map(|Point(p)| [p.x, p.y]).collect()).collect()
    }

    fn sample_point(&self) -> Option<SamplePoint> {
        match self.center.0 {
            0.5 => Some(SamplePoint::Center),
            0.0 => Some(SamplePoint::Lattice),
            _ => None,
        }
    }

    /// Fills the polygon. Whether a sample is inside is decided exactly; no option rounds the edge crossings.
    pub(super) fn answer(&self, options: Options, control: &Control<'_>) -> Result<PolyFillAnswer, Unanswered> {
        let snap_bits = options.snap_bits();
        let corners = if snap_bits.is_some() { Corners::Snapped } else { Corners::AsGiven };
        let rule = match self.rule {
            PolygonRule::EvenOdd => InsideRule::EvenOdd,
            PolygonRule::Nonzero => InsideRule::NonZero,
        };
        let sample = self.sample_point().unwrap_or(SamplePoint::Center);
        let contours: Vec<Vec<_>> = self.contours.iter().map(|c| c.iter().map(|point| point.0).collect()).collect();
        let filling = FillParameters { rule, corners, sample, width: self.width, height: self.height };
        let mut walk = fill(&contours, filling);
        let mut spans = Vec::new();
        // The time for a row grows with the number of edges that cross it, which may be a million.
        while let Some(span) = walk.step() {
            spans.extend(span.map(|span| [span.y, span.x0, span.x1]));
            check_length::<[u32; 3]>("spans", spans.len() as u64)?;
            control.step(f64::from(walk.row()) / f64::from(self.height))?;
        }
        Ok(PolyFillAnswer { snap_bits, spans })
    }
}

/// Answer to a [`PolyFill`] case: the samples inside the polygon.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PolyFillAnswer {
    /// Number of fractional bits of the grid to which corners were snapped; `None` if they were used as given.
    pub snap_bits: Option<u32>,
    /// Runs of samples inside the polygon, each as [row, first column, one past the last column].
    pub spans: Vec<[u32; 3]>,
}
