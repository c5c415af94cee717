//! `tri_area`: computes the area that a triangle covers in each pixel.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Exactly, Point, Unanswered, check_length, check_picture};
use crate::antialias::area::triangle_area;
use crate::pipeline::raster::cover;
use crate::pipeline::settings::{Arithmetic, FillRule, Rasterizer};
use crate::pipeline::viewport::Viewport;

/// Input of a `tri_area` case: a triangle and a picture size.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct TriArea {
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Corners in pixels, in either winding order.
    pub(crate) triangle: Exactly<Point, 3>,
}

impl Check for TriArea {
    fn check(&self) -> Result<(), String> {
        check_picture(self.width, self.height)
    }
}

impl TriArea {
    /// Returns the corners of the triangle, in pixels.
    pub(crate) fn outline(&self) -> Vec<[f64; 2]> {
        self.triangle.0.iter().map(|Point(p)| [p.x, p.y]).collect()
    }

    pub(super) fn answer(&self, control: &Control<'_>) -> Result<TriAreaAnswer, Unanswered> {
        let corners = self.triangle.0.map(|corner| corner.0);
        // The answer lists each pixel whose centre is covered, and further pixels at the border. The number of covered
        // centres is therefore a lower bound on the length of the answer.
        let viewport = Viewport { width: self.width, height: self.height };
        let corners_px = corners.map(|corner| corner.as_vec2().into());
        let centres = cover(Rasterizer::Scanline, Arithmetic::F64, corners_px, FillRule::Exclusive, viewport);
        let count = centres.iter().map(|span| u64::from(span.right - span.left)).sum();
        check_length::<(u32, u32, f64)>("pixels of the triangle", count)?;
        let mut area = triangle_area(corners, self.width, self.height);
        let probes = area.probes_left();
        let steps = std::iter::from_fn(|| area.step());
        Ok(TriAreaAnswer { area: control.collect("pixels of the triangle", (0, probes), steps)? })
    }
}

/// Answer to a [`TriArea`] case: the covered area of each pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TriAreaAnswer {
    /// Column, row and covered area in px² of each pixel that the triangle covers.
    pub area: Vec<(u32, u32, f64)>,
}
