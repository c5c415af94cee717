//! Exact answers that the assertions compare with: whose a sample is, and how far away its surface.

use crate::pipeline::depth::DepthScale;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::raster::{AnyTriangle, Sample, Scissor, Span, cover_within};
use crate::pipeline::settings::{Arithmetic, FillRule, Rasterizer, Settings};
use crate::pipeline::viewport::ScreenTriangle;

/// The triangle that decides ownership exactly, set up once for all samples of one triangle.
pub(super) struct Owner {
    corners_px: [[f32; 2]; 3],
    rule: FillRule,
    exact: Option<AnyTriangle>,
}

impl Owner {
    /// Of a triangle on the corners that the settings decide by, and by their fill rule if it draws shared edges once.
    pub(super) fn of(triangle: &ScreenTriangle, settings: &Settings) -> Self {
        let corners_px = match settings.arithmetic {
            Arithmetic::Fixed => triangle.snapped_px(),
            Arithmetic::F32 | Arithmetic::F64 | Arithmetic::Exact => triangle.corners_px(),
        };
        let rule = if settings.fill_rule.is_sound() { settings.fill_rule } else { FillRule::TopLeft };
        Self { corners_px, rule, exact: AnyTriangle::new(Arithmetic::Exact, corners_px, rule) }
    }

    /// Whether the centre of a pixel is the triangle's; if not, the edge values that say so. Their signs are exact.
    pub(super) fn owns(&self, (x, y): (u32, u32)) -> Result<(), Option<[f64; 3]>> {
        let edges = self.exact.ok_or(None)?.sample((x, y)).edges;
        let is_owned = edges.iter().all(|edge| *edge >= 0.0)
            && (edges.iter().all(|edge| *edge > 0.0) || {
                let mut spans: Vec<Span> = Vec::new();
                let how = (Rasterizer::BoundingBox, Arithmetic::Exact, self.rule);
                cover_within(how, self.corners_px, (SampleGrid::FULL, Scissor::pixel(x, y)), &mut spans);
                !spans.is_empty()
            });
        if is_owned { Ok(()) } else { Err(Some(edges)) }
    }
}

/// Distance of a sample's surface along the line of sight, world units, in f64 throughout: from the distances of the corners
/// and the edge values, neither quantised nor rounded to f32.
pub(super) fn distance(triangle: &ScreenTriangle, sample: &Sample, scale: &DepthScale, is_perspective: bool) -> f64 {
    let corners = triangle.vertices.each_ref().map(|corner| scale.distance(corner));
    let sum: f64 = sample.edges.iter().sum();
    let mean = |of: fn(f64) -> f64| {
        let weighted = sample.edges.iter().zip(corners).map(|(edge, corner)| edge * of(corner));
        weighted.sum::<f64>() / sum
    };
    // Projection makes 1/distance, not the distance, linear on the screen.
    if is_perspective { 1.0 / mean(f64::recip) } else { mean(|distance| distance) }
}
