//! Exact reference values for the assertions: ownership of a sample, and surface depth in f64.

use crate::pipeline::depth::DepthScale;
use crate::pipeline::raster::{AnyTriangle, CoverageRules, RasterSample, SampleArea, Span};
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::{Arithmetic, FillRule, Rasterizer, Settings};

/// Exact test of whether a triangle owns a sample, set up once for all samples of the triangle.
pub(super) struct Owner {
    corners_px: [[f32; 2]; 3],
    rule: FillRule,
    exact: Option<AnyTriangle>,
}

impl Owner {
    /// Creates the ownership test for a triangle. The test uses the corner positions that determine coverage, and the
    /// recipe's fill rule. If that rule does not draw shared edges exactly once, the test uses top-left instead.
    pub(super) fn of(triangle: &ScreenTriangle, settings: &Settings) -> Self {
        let corners_px = match settings.arithmetic {
            Arithmetic::Fixed => triangle.snapped_px(),
            Arithmetic::F32 | Arithmetic::F64 | Arithmetic::Exact => triangle.corners_px(),
        };
        let rule = if settings.fill_rule.draws_shared_edges_once() { settings.fill_rule } else { FillRule::TopLeft };
        Self { corners_px, rule, exact: AnyTriangle::new(Arithmetic::Exact, corners_px, rule) }
    }

    /// Returns `Ok` if the triangle owns the centre of a pixel. The error contains the values of the edge functions
    /// there, with exact signs, or `None` if the triangle has no area.
    pub(super) fn owns(&self, (x, y): (u32, u32)) -> Result<(), Option<[f64; 3]>> {
        let edges = self.exact.ok_or(None)?.sample((x, y)).edges;
        let is_owned = edges.iter().all(|edge| *edge >= 0.0)
            && (edges.iter().all(|edge| *edge > 0.0) || {
                let mut spans: Vec<Span> = Vec::new();
                let (rasterizer, arithmetic) = (Rasterizer::BoundingBox, Arithmetic::Exact);
                let rules = CoverageRules { rasterizer, arithmetic, fill_rule: self.rule };
                rules.cover_within(self.corners_px, SampleArea::pixel((x, y)), &mut spans);
                !spans.is_empty()
            });
        if is_owned { Ok(()) } else { Err(Some(edges)) }
    }
}

/// Returns the depths of a triangle's corners, including the depth bias but without clamping.
pub(super) fn corner_depths(triangle: &ScreenTriangle, scale: &DepthScale) -> [f64; 3] {
    let offset = scale.bias_of(&triangle.vertices).map_or(0.0, |bias| bias.offset);
    triangle.vertices.each_ref().map(|corner| corner.depth + offset)
}

/// Returns the depth of a sample before quantisation, in [0, 1], and its uncertainty. The computation is independent of
/// the pipeline's: it interpolates the corner depths in f64, weighted by edge values. If the depth is linear in space,
/// the weights are also multiplied by 1/w.
pub(super) fn depth(triangle: &ScreenTriangle, sample: &RasterSample, scale: &DepthScale) -> (f64, f64) {
    let depths = corner_depths(triangle, scale);
    if !scale.is_linear_in_space() {
        return (weighted_mean(sample.edges, depths).clamp(0.0, 1.0), 0.0);
    }
    let weights = [0, 1, 2].map(|i| sample.edges[i] * f64::from(triangle.vertices[i].inv_w));
    let range = depths.into_iter().fold(f64::NEG_INFINITY, f64::max) - depths.into_iter().fold(f64::INFINITY, f64::min);
    // The corners' 1/w has only f32 precision.
    (weighted_mean(weights, depths).clamp(0.0, 1.0), range * f64::from(f32::EPSILON))
}

fn weighted_mean(weights: [f64; 3], values: [f64; 3]) -> f64 {
    let weighted: f64 = weights.iter().zip(values).map(|(weight, value)| weight * value).sum();
    weighted / weights.iter().sum::<f64>()
}
