//! `tri_area`: what area of each pixel a triangle covers.

use serde::{Deserialize, Serialize};

use super::{Check, Exactly, Point, check_picture};
use crate::antialias::area::triangle_area;

/// The case.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct TriArea {
    /// Width of the picture, px.
    pub width: u32,
    /// Height of the picture, px.
    pub height: u32,
    /// Corners in px, of either winding.
    pub triangle: Exactly<Point, 3>,
}

impl Check for TriArea {
    fn check(&self) -> Result<(), String> {
        check_picture(self.width, self.height)
    }
}

impl TriArea {
    /// Corners, px.
    pub fn outline(&self) -> Vec<[f64; 2]> {
        self.triangle.0.iter().map(|Point(p)| [p.x, p.y]).collect()
    }

    pub(super) fn answer(&self) -> TriAreaAnswer {
        let corners = self.triangle.0.map(|corner| corner.0);
        TriAreaAnswer { area: triangle_area(corners, self.width, self.height).collect() }
    }
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TriAreaAnswer {
    /// Column, row and covered area of each pixel that is covered at all.
    pub area: Vec<(u32, u32, f64)>,
}
