//! Interpolation of vertex attributes at a sample, by affine or perspective-correct weights.
//!
//! Screen-space (affine) weights are the edge values over the doubled area. Perspective-correct weights are (λᵢ/wᵢ) /
//! Σ(λⱼ/wⱼ) (Low, "Perspective-Correct Interpolation", 2002). They are computed as eᵢ·rᵢ / Σ eⱼ·rⱼ, where eᵢ is an edge
//! value and rᵢ is 1/wᵢ divided by the largest 1/w of the three corners. If w is equal at all corners, every rᵢ is
//! exactly 1, so skipping the division changes no bit.
//!
//! Each of the three weights is computed from its own edge and divided by the *sum* of the three, so no weight absorbs
//! the errors of the others. Attributes take the form a₀ + p₁·(a₁ − a₀) + p₂·(a₂ − a₀), which reproduces a constant
//! exactly. An attribute that the vertex stage skipped is equal at all corners, so it need not be interpolated: the
//! result is the first corner's value.

use glam::{Vec2, Vec3};

use super::formulas::{change, differences, interpolated, sum_of_three, weight_products};
use super::plan::{DrawPlan, PipelinePart};
use super::raster::RasterSample;
use super::screen_triangle::ScreenTriangle;
use super::settings::{Arithmetic, Interpolation, Settings};
use super::shading::Input;
use crate::scene::TriangleId;

/// Returns the screen-space weights λ at a sample: each corner's edge value times the rounded reciprocal of the doubled
/// area.
#[inline]
pub(crate) fn affine_weights(triangle: &ScreenTriangle, sample: &RasterSample) -> [f32; 3] {
    let inverse_area = inverse_area(triangle);
    sample.edges.map(|e| e as f32 * inverse_area)
}

/// Returns the factor that converts edge values to screen-space weights.
#[inline]
pub(crate) fn inverse_area(triangle: &ScreenTriangle) -> f32 {
    1.0 / triangle.doubled_area as f32
}

/// Returns the weights of the three corners for interpolating attributes at a sample. The weights are divided by their
/// sum, except for [`Interpolation::Published`].
#[inline]
pub(crate) fn attribute_weights(
    triangle: &ScreenTriangle,
    sample: &RasterSample,
    interpolation: Interpolation,
) -> [f32; 3] {
    if interpolation == Interpolation::Published {
        return published_weights(triangle, sample);
    }
    let WeightTerms { q, inverse_sum, .. } = weight_terms(triangle, sample);
    q.map(|q| q * inverse_sum)
}

/// Terms of the attribute weights: the weight of corner i is `q[i]` · `inverse_sum`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WeightTerms {
    /// Edge values, each multiplied by the [`ScreenTriangle::relative_inv_w`] of its corner.
    pub(crate) q: [f32; 3],
    /// Sum of `q`.
    pub(crate) sum: f32,
    /// Reciprocal of `sum`.
    pub(crate) inverse_sum: f32,
}

/// Returns the terms of the attribute weights, for any interpolation except [`Interpolation::Published`].
#[inline(always)]
pub(crate) fn weight_terms(triangle: &ScreenTriangle, sample: &RasterSample) -> WeightTerms {
    let q = weight_products(sample.edges.map(|edge| edge as f32), triangle.relative_inv_w);
    let sum = sum_of_three(q);
    WeightTerms { q, sum, inverse_sum: 1.0 / sum }
}

/// Returns the weights computed by a commonly published formula. With positions relative to the first corner, it solves
/// P = a·v02 + b·v01. First, b is computed by determinants. Then, a is computed from the x coordinates alone, by a
/// division by v02.x. The result is therefore NaN or infinite if corners 0 and 2 have equal x.
fn published_weights(triangle: &ScreenTriangle, sample: &RasterSample) -> [f32; 3] {
    let [v0, v1, v2] = triangle.corners_px();
    let [v01, v02] = [[v1[0] - v0[0], v1[1] - v0[1]], [v2[0] - v0[0], v2[1] - v0[1]]];
    let p = [sample.x as f32 + 0.5 - v0[0], sample.y as f32 + 0.5 - v0[1]];
    let b = (p[1] * v02[0] - p[0] * v02[1]) / (v01[1] * v02[0] - v01[0] * v02[1]);
    let a = (p[0] - v01[0] * b) / v02[0];
    [1.0 - a - b, b, a]
}

/// Attributes that a draw interpolates, and the interpolation method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct AttributeSelection {
    /// Method by which the weights are computed.
    pub(crate) interpolation: Interpolation,
    /// Whether [`Fragment::normal`] is interpolated.
    pub(crate) normal: bool,
    /// Whether [`Fragment::uv`] is interpolated.
    pub(crate) uv: bool,
    /// Whether [`Fragment::color`] is interpolated.
    pub(crate) color: bool,
    /// Whether [`Fragment::light`] is interpolated.
    pub(crate) light: bool,
    /// Whether [`Fragment::source_weights`] is interpolated.
    pub(crate) source_weights: bool,
    /// Arithmetic of the edge functions from which [`Fragment::uv_gradient`] is computed; `None` if it is not computed.
    pub(crate) uv_gradient: Option<Arithmetic>,
}

impl AttributeSelection {
    /// Returns a selection of all attributes except [`Fragment::uv_gradient`].
    pub(crate) const fn all(interpolation: Interpolation) -> Self {
        Self {
            interpolation,
            normal: true,
            uv: true,
            color: true,
            light: true,
            source_weights: true,
            uv_gradient: None,
        }
    }

    /// Returns the attributes that a draw reads.
    pub(crate) fn read_by(plan: &DrawPlan, settings: &Settings) -> Self {
        let reads = |input| settings.shading.reads(input);
        Self {
            interpolation: settings.interpolation,
            normal: plan.runs(PipelinePart::Normals),
            uv: plan.runs(PipelinePart::TextureCoordinates),
            color: plan.runs(PipelinePart::VertexColors),
            light: reads(Input::VertexLight),
            source_weights: reads(Input::Weights) || reads(Input::EyeDirection) || plan.runs(PipelinePart::Highlight),
            uv_gradient: (settings.filter.reads_mip_levels() && plan.runs(PipelinePart::Texels))
                .then_some(settings.arithmetic),
        }
    }
}

/// Inputs of shading at a sample. Attributes that the draw does not interpolate have the value of the first corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fragment {
    /// Covered sample that is to be shaded.
    pub sample: RasterSample,
    /// Identifier of the scene triangle that covers the sample.
    pub triangle: TriangleId,
    /// Weights of the three corners for interpolating attributes.
    pub weights: [f32; 3],
    /// Interpolated world-space normal, not normalised.
    pub normal: Vec3,
    /// Interpolated texture coordinates, with v pointing down.
    pub uv: Vec2,
    /// Interpolated vertex colour, in the working colour space.
    pub color: Vec3,
    /// Light factor interpolated from the vertices, for shadings that read it.
    pub light: f32,
    /// Barycentric weights of the corners of the triangle before clipping.
    pub source_weights: Vec3,
    /// Gradients of the texture coordinates, ∂(u, v)/∂x and ∂(u, v)/∂y, per pixel; zero unless the draw reads them.
    pub uv_gradient: [Vec2; 2],
}

/// Interpolates the `attributes` of a covered sample.
#[inline]
pub(crate) fn interpolate(triangle: &ScreenTriangle, sample: RasterSample, attributes: AttributeSelection) -> Fragment {
    let weights = attribute_weights(triangle, &sample, attributes.interpolation);
    let [_, p1, p2] = weights;
    let [a, b, c] = triangle.vertices.each_ref().map(|v| &v.varyings);
    let mut fragment = Fragment {
        sample,
        triangle: triangle.id,
        weights,
        normal: a.normal,
        uv: a.uv,
        color: a.color,
        light: a.light,
        source_weights: a.source_weights,
        uv_gradient: [Vec2::ZERO; 2],
    };
    if attributes.normal {
        fragment.normal = interpolated([a.normal, b.normal, c.normal], [p1, p2]);
    }
    if attributes.uv {
        fragment.uv = interpolated([a.uv, b.uv, c.uv], [p1, p2]);
    }
    if attributes.color {
        fragment.color = interpolated([a.color, b.color, c.color], [p1, p2]);
    }
    if attributes.light {
        fragment.light = interpolated([a.light, b.light, c.light], [p1, p2]);
    }
    if attributes.source_weights {
        fragment.source_weights = interpolated([a, b, c].map(|v| v.source_weights), [p1, p2]);
    }
    if let Some(arithmetic) = attributes.uv_gradient {
        fragment.uv_gradient = uv_gradient(triangle, &sample, arithmetic);
    }
    fragment
}

/// Returns the gradients of the three edge functions: the changes per pixel in x and in y.
pub(crate) fn edge_slopes(triangle: &ScreenTriangle, arithmetic: Arithmetic) -> [[f32; 3]; 2] {
    let [[x0, y0], [x1, y1], [x2, y2]] = triangle.corners_in(arithmetic);
    let side = |x: f32, y: f32| [f64::from(x) - f64::from(x0), f64::from(y) - f64::from(y0)];
    let (to_1, to_2) = (side(x1, y1), side(x2, y2));
    // Factor that converts px² to edge values. Its sign makes edge values positive inside the triangle. In fixed point
    // it is exactly 2¹⁶ or −2¹⁶.
    let unit = (triangle.doubled_area / (to_1[0] * to_2[1] - to_2[0] * to_1[1])) as f32;
    [[(y1 - y2) * unit, (y2 - y0) * unit, (y0 - y1) * unit], [(x2 - x1) * unit, (x0 - x2) * unit, (x1 - x0) * unit]]
}

/// Returns the gradients, per pixel in x and in y, of two perspective-correct weights: those of the second and the
/// third corner. The weights are pᵢ = qᵢ / Σ qⱼ, where qᵢ = eᵢ·rᵢ is affine in screen space. The gradients are
/// therefore pᵢ' = (qᵢ' − pᵢ·Σ qⱼ') / Σ qⱼ.
pub(crate) fn weight_gradient(
    triangle: &ScreenTriangle,
    sample: &RasterSample,
    arithmetic: Arithmetic,
) -> [[f32; 2]; 2] {
    let WeightTerms { q: [_, q1, q2], inverse_sum, .. } = weight_terms(triangle, sample);
    let (p1, p2) = (q1 * inverse_sum, q2 * inverse_sum);
    edge_slopes(triangle, arithmetic).map(|slopes| {
        let q = weight_products(slopes, triangle.relative_inv_w);
        let sum = sum_of_three(q);
        [(q[1] - p1 * sum) * inverse_sum, (q[2] - p2 * sum) * inverse_sum]
    })
}

/// Returns the perspective-correct gradients of the texture coordinates at a sample: ∂(u, v)/∂x and ∂(u, v)/∂y, per
/// pixel.
pub(crate) fn uv_gradient(triangle: &ScreenTriangle, sample: &RasterSample, arithmetic: Arithmetic) -> [Vec2; 2] {
    let of_corners = differences(triangle.vertices.each_ref().map(|v| v.varyings.uv));
    weight_gradient(triangle, sample, arithmetic).map(|weights| change(of_corners, weights))
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::pipeline::clip_space::Varyings;
    use crate::pipeline::depth::DepthScale;
    use crate::pipeline::raster::{AnyTriangle, doubled_area};
    use crate::pipeline::screen_triangle::TriangleOwner;
    use crate::pipeline::screen_vertex::ScreenVertex;
    use crate::pipeline::settings::FillRule;

    /// Returns the texture coordinates of a triangle at a position in pixels, computed in f64 from its snapped corners.
    fn true_uv(corners: &[ScreenVertex; 3], [x, y]: [f64; 2]) -> DVec2 {
        let at = corners.map(|corner| [corner.x, corner.y].map(|step| f64::from(step) / 256.0));
        let (mut total, mut sum) = (0.0, DVec2::ZERO);
        for i in 0..3 {
            let ([ax, ay], [bx, by]) = (at[(i + 1) % 3], at[(i + 2) % 3]);
            let weight = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) * f64::from(corners[i].inv_w);
            total += weight;
            sum += corners[i].varyings.uv.as_dvec2() * weight;
        }
        sum / total
    }

    #[test]
    fn gradients_are_the_differences_between_places_nearby() {
        const STEP_PX: f64 = 1e-4;
        let mut random = fastrand::Rng::with_seed(11);
        let mut compared = 0;
        for _ in 0..4000 {
            let vertices = [(); 3].map(|()| {
                let uv = Vec2::new(random.f32() * 8.0 - 4.0, random.f32() * 8.0 - 4.0);
                let inv_w = 10.0_f32.powf(-2.0 * random.f32());
                let position = [random.f32() * 1000.0, random.f32() * 1000.0];
                ScreenVertex::at(position, 0.5, inv_w, Varyings { uv, ..Varyings::default() })
            });
            let positions = vertices.each_ref().map(|v| v.position_px);
            let (area, _) = doubled_area(Arithmetic::Fixed, positions);
            let edges = AnyTriangle::new(Arithmetic::Fixed, positions, FillRule::TopLeft).unwrap();
            let triangle =
                ScreenTriangle::new(TriangleOwner::FIRST, vertices, area.abs(), &DepthScale::default(), true);
            let [across, down] = [0, 1].map(|axis| (positions.iter().map(|p| p[axis]).sum::<f32>() / 3.0) as u32);
            let sample = edges.sample((across, down));
            if sample.edges.iter().any(|edge| *edge < 0.0) {
                continue;
            }
            compared += 1;
            let place = |dx: f64, dy: f64| [f64::from(across) + 0.5 + dx, f64::from(down) + 0.5 + dy];
            let between = |dx: f64, dy: f64| {
                let [a, b] = [place(-dx, -dy), place(dx, dy)].map(|place| true_uv(&vertices, place));
                (b - a) / (2.0 * STEP_PX)
            };
            let expected = [between(STEP_PX, 0.0), between(0.0, STEP_PX)];
            let longest = expected[0].length().max(expected[1].length());
            for (found, expected) in uv_gradient(&triangle, &sample, Arithmetic::Fixed).into_iter().zip(expected) {
                assert!((found.as_dvec2() - expected).length() < 1e-4 * longest, "{found} {expected} {vertices:?}");
            }
        }
        assert!(compared > 3000, "{compared}");
    }
}
