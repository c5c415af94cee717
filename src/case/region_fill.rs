//! `region_fill`: a region filled from a seed.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Exactly, Unanswered, json};
use crate::flat2d::seed_fill::{Connectivity, Region, seed_fill};
use crate::image::Image;

/// The case.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct RegionFill {
    /// The colours before.
    #[serde(deserialize_with = "json::rows")]
    pub grid: Image<i64>,
    /// Column and row of the pixel that the fill starts from.
    pub seed: Exactly<u32, 2>,
    /// How far it goes.
    pub mode: FillMode,
    /// 4: neighbours share a side. 8: a side or a corner.
    pub connectivity: u32,
    /// The colour filled with.
    pub new: i64,
    /// The colour that a boundary fill stops at.
    pub boundary: Option<i64>,
}

/// How far a fill goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FillMode {
    /// As far as the colour of the seed.
    Flood,
    /// Up to the colour of the boundary.
    Boundary,
}

impl Check for RegionFill {
    fn check(&self) -> Result<(), String> {
        let Exactly([x, y]) = self.seed;
        if self.grid.get(x, y).is_none() {
            let (width, height) = self.grid.size();
            return Err(format!("the seed ({x}, {y}) lies outside of the grid of {width} × {height}"));
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
            (FillMode::Boundary, Some(boundary)) => Region::Boundary(boundary),
            _ => Region::Flood,
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

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RegionFillAnswer {
    /// The colours after, row by row.
    pub grid: Vec<Vec<i64>>,
}
