//! `region_fill`: fills a region from a seed pixel.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Exactly, Unanswered, json};
use crate::flat2d::seed_fill::{Connectivity, FillCriterion, seed_fill};
use crate::image::Image;

/// Input of a `region_fill` case: a grid of colours and a seed pixel.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct RegionFill {
    /// Colours before the fill, row by row from the top.
    #[serde(deserialize_with = "json::rows")]
    pub(crate) grid: Image<i64>,
    /// Column and row of the seed pixel.
    pub(crate) seed: Exactly<u32, 2>,
    /// Criterion that bounds the filled region.
    pub(crate) mode: FillMode,
    /// Connectivity: 4 if neighbours share a side, 8 if they share a side or a corner.
    pub(crate) connectivity: u32,
    /// Fill colour.
    pub(crate) new: i64,
    /// Colour that bounds the region of a boundary fill; required in the mode [`FillMode::Boundary`].
    pub(crate) boundary: Option<i64>,
}

/// Criterion that bounds a filled region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum FillMode {
    /// Fills the connected region that has the colour of the seed.
    Flood,
    /// Fills the region enclosed by the boundary colour.
    Boundary,
}

impl Check for RegionFill {
    fn check(&self) -> Result<(), String> {
        let Exactly([x, y]) = self.seed;
        if self.grid.get(x, y).is_none() {
            let (width, height) = self.grid.size();
            return Err(format!("the seed ({x}, {y}) lies outside the grid of {width} × {height}"));
        }
        if ![4, 8].contains(&self.connectivity) {
            return Err(format!("`connectivity` must be 4 or 8, not {}", self.connectivity));
        }
        if self.mode == FillMode::Boundary && self.boundary.is_none() {
            return Err("a boundary fill needs a `boundary`".to_owned());
        }
        Ok(())
    }
}

impl RegionFill {
    pub(super) fn answer(&self, control: &Control<'_>) -> Result<RegionFillAnswer, Unanswered> {
        let Exactly([x, y]) = self.seed;
        let region = match (self.mode, self.boundary) {
            (FillMode::Boundary, Some(boundary)) => FillCriterion::Boundary(boundary),
            _ => FillCriterion::Flood,
        };
        let connectivity = if self.connectivity == 8 { Connectivity::Eight } else { Connectivity::Four };
        let mut grid = self.grid.clone();
        let (mut filled, of) = (0.0, self.grid.pixels().len() as f64);
        for span in seed_fill(&mut grid, (x, y), region, connectivity, self.new) {
            filled += f64::from(span.x1 - span.x0);
            control.step(filled / of)?;
        }
        Ok(RegionFillAnswer { grid: (0..grid.height()).map(|y| grid.row(y).to_vec()).collect() })
    }
}

/// Answer to a [`RegionFill`] case: the grid of colours after the fill.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RegionFillAnswer {
    /// Colours after the fill, row by row from the top.
    pub grid: Vec<Vec<i64>>,
}
