//! `poly_fill`: which samples lie inside a polygon of any number of contours.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Options, Point, Real, Unanswered, check_length, check_picture};
use crate::flat2d::polygon::{Corners, Filling, InsideRule, SamplePoint, fill};

/// Most corners of a polygon; contours without corners count as one.
const MAX_CORNERS: usize = 1 << 20;

/// The case.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct PolyFill {
    /// Width of the picture, px.
    pub width: u32,
    /// Height of the picture, px.
    pub height: u32,
    /// What is inside.
    pub rule: PolygonRule,
    /// Where samples lie: 0.5 in the middle of pixels, 0 on whole coordinates.
    #[serde(default = "middle")]
    pub center: Real,
    /// Corners in px; contours close by themselves.
    pub contours: Vec<Vec<Point>>,
}

fn middle() -> Real {
    Real(0.5)
}

/// What is inside of contours that may overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PolygonRule {
    /// Where the winding number is odd.
    EvenOdd,
    /// Where it differs from 0.
    Nonzero,
}

impl Check for PolyFill {
    fn check(&self) -> Result<(), String> {
        if self.sample_point().is_none() {
            return Err(format!("`center` must be 0.5 or 0, not {}", self.center.0));
        }
        let corners = self.contours.iter().map(|contour| contour.len().max(1)).sum::<usize>();
        if corners > MAX_CORNERS {
            return Err(format!("the contours have more than {MAX_CORNERS} corners, the most that are filled"));
        }
        check_picture(self.width, self.height)
    }
}

impl PolyFill {
    /// Corners of the contours, px.
    pub fn outlines(&self) -> Vec<Vec<[f64; 2]>> {
        self.contours.iter().map(|contour| contour.iter().map(|Point(p)| [p.x, p.y]).collect()).collect()
    }

    fn sample_point(&self) -> Option<SamplePoint> {
        match self.center.0 {
            0.5 => Some(SamplePoint::Center),
            0.0 => Some(SamplePoint::Lattice),
            _ => None,
        }
    }

    /// Fills the polygon. Where edges and samples meet is decided exactly either way; there is no variant that rounds.
    pub(super) fn answer(&self, options: Options, control: &Control<'_>) -> Result<PolyFillAnswer, Unanswered> {
        let snap_bits = options.snap_bits();
        let corners = if snap_bits.is_some() { Corners::Snapped } else { Corners::AsGiven };
        let rule = match self.rule {
            PolygonRule::EvenOdd => InsideRule::EvenOdd,
            PolygonRule::Nonzero => InsideRule::NonZero,
        };
        let sample = self.sample_point().unwrap_or(SamplePoint::Center);
        let contours: Vec<Vec<_>> = self.contours.iter().map(|c| c.iter().map(|point| point.0).collect()).collect();
        let filling = Filling { rule, corners, sample, width: self.width, height: self.height };
        let mut walk = fill(&contours, filling);
        let mut spans = Vec::new();
        // A row costs its crossing edges, up to a million.
        while let Some(span) = walk.step() {
            spans.extend(span.map(|span| [span.y, span.x0, span.x1]));
            check_length::<[u32; 3]>("spans", spans.len() as u64)?;
            control.step(f64::from(walk.row()) / f64::from(self.height))?;
        }
        Ok(PolyFillAnswer { snap_bits, spans })
    }
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PolyFillAnswer {
    /// Fraction bits of the grid that corners were snapped to; `None` if they were used as given.
    pub snap_bits: Option<u32>,
    /// [row, first column, one past the last column] of each run.
    pub spans: Vec<[u32; 3]>,
}
