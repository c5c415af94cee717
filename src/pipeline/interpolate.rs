//! Weights of the three vertices at a sample, and attributes from them.
//!
//! Screen-space (affine) weights are the edge values over the doubled area. Perspective-correct weights are
//! (λᵢ/wᵢ) / Σ(λⱼ/wⱼ) (Low, "Perspective-Correct Interpolation", 2002); here eᵢ·rᵢ / Σ eⱼ·rⱼ, where rᵢ is 1/wᵢ relative
//! to the largest. With equal w every rᵢ is exactly 1, so leaving the division out changes no bit.
//!
//! All three weights are computed from their own edge and divided by their *sum*: none absorbs the error of the others.
//! Attributes take the form a₀ + p₁·(a₁ − a₀) + p₂·(a₂ − a₀), which returns a constant exactly. So an attribute that the
//! vertex stage left out, the same at all corners, need not be interpolated: the result is the first corner's value.

use glam::{Vec2, Vec3};

use super::plan::{DrawPlan, Part};
use super::raster::Sample;
use super::settings::{Filter, Interpolation, Settings, Shading};
use super::viewport::ScreenTriangle;

/// Screen-space weights λ at a sample: areas over the whole area. Each is correctly rounded but for the division.
#[inline]
pub fn affine_weights(triangle: &ScreenTriangle, sample: &Sample) -> [f32; 3] {
    let inverse_area = inverse_area(triangle);
    sample.edges.map(|e| e as f32 * inverse_area)
}

/// What edge values are multiplied with to become screen-space weights.
#[inline]
pub(crate) fn inverse_area(triangle: &ScreenTriangle) -> f32 {
    1.0 / triangle.doubled_area as f32
}

/// Weights for attributes at a sample. But for the published ones they are divided by their sum.
#[inline]
pub fn attribute_weights(triangle: &ScreenTriangle, sample: &Sample, interpolation: Interpolation) -> [f32; 3] {
    if interpolation == Interpolation::Published {
        return published_weights(triangle, sample);
    }
    let WeightTerms { q, inverse_sum, .. } = weight_terms(triangle, sample);
    q.map(|q| q * inverse_sum)
}

/// What weights for attributes are the products of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WeightTerms {
    /// Edge values, each times the relative 1/w of its corner.
    pub(crate) q: [f32; 3],
    /// Their sum.
    pub(crate) sum: f32,
    /// 1 over that.
    pub(crate) inverse_sum: f32,
}

/// The terms of all weights but the published ones.
#[inline(always)]
pub(crate) fn weight_terms(triangle: &ScreenTriangle, sample: &Sample) -> WeightTerms {
    let [r0, r1, r2] = triangle.relative_inv_w;
    let q = [sample.edges[0] as f32 * r0, sample.edges[1] as f32 * r1, sample.edges[2] as f32 * r2];
    let sum = q[0] + q[1] + q[2];
    WeightTerms { q, sum, inverse_sum: 1.0 / sum }
}

/// Weights as an article prints them: from P = a·v02 + b·v01 in the coordinates of the first corner, b by the determinant,
/// and then a by the x coordinates alone, which divides by v02.x. NaN or infinite where corners 0 and 2 stand above each other.
fn published_weights(triangle: &ScreenTriangle, sample: &Sample) -> [f32; 3] {
    let [v0, v1, v2] = triangle.corners_px();
    let [v01, v02] = [[v1[0] - v0[0], v1[1] - v0[1]], [v2[0] - v0[0], v2[1] - v0[1]]];
    let p = [sample.x as f32 + 0.5 - v0[0], sample.y as f32 + 0.5 - v0[1]];
    let b = (p[1] * v02[0] - p[0] * v02[1]) / (v01[1] * v02[0] - v01[0] * v02[1]);
    let a = (p[0] - v01[0] * b) / v02[0];
    [1.0 - a - b, b, a]
}

/// Which attributes a draw interpolates, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Attributes {
    /// How weights are computed.
    pub interpolation: Interpolation,
    /// [`Fragment::normal`].
    pub normal: bool,
    /// [`Fragment::uv`].
    pub uv: bool,
    /// [`Fragment::color`].
    pub color: bool,
    /// [`Fragment::light`].
    pub light: bool,
    /// [`Fragment::source_weights`].
    pub source_weights: bool,
    /// [`Fragment::uv_gradient`].
    pub uv_gradient: bool,
}

impl Attributes {
    /// All of them but for gradients.
    pub const fn all(interpolation: Interpolation) -> Self {
        Self {
            interpolation,
            normal: true,
            uv: true,
            color: true,
            light: true,
            source_weights: true,
            uv_gradient: false,
        }
    }

    /// What a draw reads.
    pub fn read_by(plan: &DrawPlan, settings: &Settings) -> Self {
        Self {
            interpolation: settings.interpolation,
            normal: plan.runs(Part::Normals),
            uv: plan.runs(Part::TextureCoordinates),
            color: plan.runs(Part::VertexColors),
            light: settings.shading == Shading::Gouraud,
            source_weights: settings.shading == Shading::Barycentric,
            uv_gradient: settings.filter == Filter::Trilinear && plan.runs(Part::Texels),
        }
    }
}

/// Everything that shading reads at a sample. Attributes that the draw does not interpolate have the first corner's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fragment {
    /// The sample.
    pub sample: Sample,
    /// Weights of the three corners for attributes.
    pub weights: [f32; 3],
    /// World-space normal, not normalised.
    pub normal: Vec3,
    /// Texture coordinates, v down.
    pub uv: Vec2,
    /// Vertex colour, in the numbers that light is computed in.
    pub color: Vec3,
    /// Light interpolated from the vertices (Gouraud only).
    pub light: f32,
    /// Weights of the corners of the triangle before clipping.
    pub source_weights: Vec3,
    /// What texture coordinates change by in a pixel to the right, and in one downwards; zero unless the draw reads it.
    pub uv_gradient: [Vec2; 2],
}

/// Interpolates the `attributes` of a covered sample.
#[inline]
pub fn interpolate(triangle: &ScreenTriangle, sample: Sample, attributes: Attributes) -> Fragment {
    let weights = attribute_weights(triangle, &sample, attributes.interpolation);
    let [_, p1, p2] = weights;
    let [a, b, c] = triangle.vertices.each_ref().map(|v| &v.varyings);
    let mut fragment = Fragment {
        sample,
        weights,
        normal: a.normal,
        uv: a.uv,
        color: a.color,
        light: a.light,
        source_weights: a.source_weights,
        uv_gradient: [Vec2::ZERO; 2],
    };
    if attributes.normal {
        fragment.normal = a.normal + (b.normal - a.normal) * p1 + (c.normal - a.normal) * p2;
    }
    if attributes.uv {
        fragment.uv = a.uv + (b.uv - a.uv) * p1 + (c.uv - a.uv) * p2;
    }
    if attributes.color {
        fragment.color = a.color + (b.color - a.color) * p1 + (c.color - a.color) * p2;
    }
    if attributes.light {
        fragment.light = a.light + (b.light - a.light) * p1 + (c.light - a.light) * p2;
    }
    if attributes.source_weights {
        let [wa, wb, wc] = [a, b, c].map(|v| v.source_weights);
        fragment.source_weights = wa + (wb - wa) * p1 + (wc - wa) * p2;
    }
    if attributes.uv_gradient {
        fragment.uv_gradient = uv_gradient(triangle, &fragment);
    }
    fragment
}

/// Exact derivatives of the texture coordinates at a sample by the screen. u is N / D with N = Σ uᵢ·rᵢ·λᵢ and D = Σ rᵢ·λᵢ,
/// both affine on the screen, so du = (dN − u·dD) / D.
pub(crate) fn uv_gradient(triangle: &ScreenTriangle, fragment: &Fragment) -> [Vec2; 2] {
    let [v0, v1, v2] = triangle.corners_px().map(Vec2::from);
    let doubled_area = (v1 - v0).perp_dot(v2 - v0);
    // What each λ changes by to the right and downwards.
    let by_screen = [(v1, v2), (v2, v0), (v0, v1)].map(|(a, b)| Vec2::new(a.y - b.y, b.x - a.x) / doubled_area);
    let edges = fragment.sample.edges.map(|edge| edge as f32);
    let sum = edges[0] + edges[1] + edges[2];
    let (mut divisor, mut change, mut numerator_change) = (0.0, Vec2::ZERO, [Vec2::ZERO; 2]);
    for corner in 0..3 {
        let r = triangle.relative_inv_w[corner];
        divisor += r * edges[corner] / sum;
        change += r * by_screen[corner];
        let uv = triangle.vertices[corner].varyings.uv;
        numerator_change[0] += uv * (r * by_screen[corner].x);
        numerator_change[1] += uv * (r * by_screen[corner].y);
    }
    [(numerator_change[0] - fragment.uv * change.x) / divisor, (numerator_change[1] - fragment.uv * change.y) / divisor]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::depth::DepthScale;
    use crate::pipeline::raster::{AnyTriangle, doubled_area};
    use crate::pipeline::settings::{Arithmetic, FillRule};
    use crate::pipeline::vertex::Varyings;
    use crate::pipeline::viewport::ScreenVertex;
    use crate::scene::TriangleId;

    #[test]
    fn gradients_are_the_differences_between_neighbours() {
        let corner = |at: [f32; 2], w: f32, uv: [f32; 2]| {
            ScreenVertex::at(at, 0.5, 1.0 / w, Varyings { uv: uv.into(), ..Varyings::default() })
        };
        let vertices = [
            corner([10.0, 900.0], 1.0, [0.0, 0.0]),
            corner([500.0, 20.0], 6.0, [0.3, 5.0]),
            corner([990.0, 800.0], 2.0, [4.0, 1.0]),
        ];
        let positions = vertices.each_ref().map(|v| v.position_px);
        let (area, _) = doubled_area(Arithmetic::Fixed, positions);
        let triangle = ScreenTriangle::new((TriangleId(0), 0), vertices, area.abs(), &DepthScale::default(), true);
        let edges = AnyTriangle::new(Arithmetic::Fixed, positions, FillRule::TopLeft).unwrap();
        let mut attributes = Attributes::all(Interpolation::Perspective);
        attributes.uv_gradient = true;
        let at = |x, y| interpolate(&triangle, edges.sample((x, y)), attributes);
        for (x, y) in [(500, 200), (400, 600), (700, 500), (100, 860)] {
            let here = at(x, y);
            // Central differences: their error is of second order.
            for (gradient, difference) in here
                .uv_gradient
                .into_iter()
                .zip([(at(x + 1, y).uv - at(x - 1, y).uv) / 2.0, (at(x, y + 1).uv - at(x, y - 1).uv) / 2.0])
            {
                assert!((gradient - difference).length() < 2e-2 * difference.length(), "{gradient} {difference}");
            }
        }
    }
}
