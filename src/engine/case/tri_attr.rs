//! `tri_attr`: evaluates barycentric weights and attributes of a triangle at pixel centres, inside or outside the
//! triangle.

use glam::Vec2;
use serde::{Deserialize, Serialize, Serializer};

use super::{Check, Control, Exactly, Float, Refusal, Unanswered, check_length};
use crate::pipeline::clip_space::Varyings;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::interpolate::{AttributeSelection, affine_weights, interpolate};
use crate::pipeline::raster::{AnyTriangle, RasterSample};
use crate::pipeline::screen_triangle::{ScreenTriangle, TriangleOwner, depth_at};
use crate::pipeline::screen_vertex::ScreenVertex;
use crate::pipeline::settings::{Arithmetic, FillRule, Interpolation};
use crate::pipeline::viewport::MAX_SIDE_PX;

/// Input of a `tri_attr` case: a triangle and the pixels to evaluate.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct TriAttr {
    /// Screen-space corners of the triangle.
    pub(crate) vertices: Exactly<AttributeVertex, 3>,
    /// Column and row of each pixel to evaluate.
    pub(crate) eval: Vec<Exactly<i64, 2>>,
}

/// Corner of a triangle in screen space.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub(crate) struct AttributeVertex {
    /// Horizontal position in screen space, in pixels.
    pub(crate) x: Float,
    /// Vertical position in screen space, in pixels, increasing downwards.
    pub(crate) y: Float,
    /// Depth after the perspective division, z/w.
    pub(crate) z: Float,
    /// Clip-space w, > 0.
    pub(crate) w: Float,
    /// Horizontal texture coordinate; 0 to 1 spans the texture.
    pub(crate) u: Float,
    /// Vertical texture coordinate; 0 to 1 spans the texture.
    pub(crate) v: Float,
}

impl Check for TriAttr {
    fn check(&self) -> Result<(), String> {
        check_vertices(&self.vertices)?;
        check_pixels(&self.eval)
    }
}

/// Checks that the corners have screen positions: every w is positive and finite.
pub(super) fn check_vertices(vertices: &Exactly<AttributeVertex, 3>) -> Result<(), String> {
    if vertices.0.iter().any(|v| !(v.w.0 > 0.0 && v.w.0.is_finite())) {
        return Err("`w` must be positive and finite: other corners have no position on the screen".to_owned());
    }
    Ok(())
}

/// Checks that pixels lie within the largest supported picture.
pub(super) fn check_pixels(eval: &[Exactly<i64, 2>]) -> Result<(), String> {
    if eval.iter().any(|Exactly(pixel)| pixel.iter().any(|c| !(0..i64::from(MAX_SIDE_PX)).contains(c))) {
        return Err(format!("pixels to evaluate must have columns and rows from 0 to {}", MAX_SIDE_PX - 1));
    }
    Ok(())
}

impl TriAttr {
    /// Interpolates the attributes at the pixel centres, as the pipeline does. Outside the triangle, depth is
    /// extrapolated linearly.
    ///
    /// If snapping the corners makes the triangle degenerate, the corners are used as given.
    pub(super) fn answer(&self, arithmetic: Arithmetic, control: &Control<'_>) -> Result<TriAttrAnswer, Unanswered> {
        check_length::<SampleAttributes>("pixels", self.eval.len() as u64)?;
        let samples = TriangleSamples::new(&self.vertices, arithmetic)?;
        let pixels = self.eval.iter().map(|pixel| samples.at(*pixel));
        let pixels = control.collect("pixels", (0, self.eval.len() as u64), pixels)?;
        Ok(TriAttrAnswer { snap_bits: samples.snap_bits, pixels })
    }
}

/// Triangle set up for interpolating attributes at pixel centres.
pub(super) struct TriangleSamples {
    triangle: ScreenTriangle,
    edges: AnyTriangle,
    /// Number of fractional bits of the grid to which the corners are snapped; `None` if they are used as given.
    snap_bits: Option<u32>,
}

impl TriangleSamples {
    /// Sets up a triangle. Refuses a triangle of zero area.
    pub(super) fn new(vertices: &Exactly<AttributeVertex, 3>, arithmetic: Arithmetic) -> Result<Self, Refusal> {
        let vertices = vertices.0.map(AttributeVertex::on_screen);
        let corners_px = vertices.map(|v| v.position_px);
        let in_arithmetic = |arithmetic| AnyTriangle::new(arithmetic, corners_px, FillRule::TopLeft);
        let snapped = in_arithmetic(arithmetic);
        let snap_bits = snapped.as_ref().and_then(|_| super::snap_bits(arithmetic));
        let edges = snapped.or_else(|| in_arithmetic(Arithmetic::Exact));
        let edges = edges.ok_or_else(|| Refusal("a triangle without area has no barycentric weights".to_owned()))?;
        let triangle =
            ScreenTriangle::new(TriangleOwner::FIRST, vertices, edges.doubled_area(), &DepthScale::default(), true);
        Ok(Self { triangle, edges, snap_bits })
    }

    /// Returns the attributes at a pixel; `None` for a negative column or row.
    pub(super) fn at(&self, Exactly([x, y]): Exactly<i64, 2>) -> Option<SampleAttributes> {
        let pixel = (u32::try_from(x).ok()?, u32::try_from(y).ok()?);
        let sample = self.edges.sample(pixel);
        let fragment = interpolate(&self.triangle, sample, AttributeSelection::all(Interpolation::Perspective));
        Some(SampleAttributes {
            pixel: [x, y],
            affine_weights: affine_weights(&self.triangle, &sample).map(f64::from),
            perspective_weights: fragment.weights.map(f64::from),
            depth: depth(&self.triangle, &sample),
            uv: fragment.uv.as_dvec2().into(),
        })
    }
}

/// Returns the depth at a sample. Inside the triangle, it equals the depth that the pipeline computes; outside, it is
/// extrapolated without clamping.
fn depth(triangle: &ScreenTriangle, sample: &RasterSample) -> f64 {
    if sample.edges.iter().all(|edge| *edge >= 0.0) {
        return depth_at(triangle, sample).into();
    }
    let weighted = triangle.vertices.iter().zip(sample.edges).map(|(vertex, edge)| edge * vertex.depth);
    weighted.sum::<f64>() / triangle.doubled_area
}

impl AttributeVertex {
    fn on_screen(self) -> ScreenVertex {
        let [x, y, z, w, u, v] = [self.x, self.y, self.z, self.w, self.u, self.v].map(|number| number.0);
        let varyings = Varyings { uv: Vec2::new(u, v), ..Varyings::default() };
        ScreenVertex::at([x, y], z.into(), 1.0 / w, varyings)
    }
}

/// Answer to a [`TriAttr`] case: the attributes at the requested pixels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TriAttrAnswer {
    /// Number of fractional bits of the grid to which the corners were snapped; `None` if they were used as given.
    pub(crate) snap_bits: Option<u32>,
    /// Attributes at the requested pixels, in no particular order.
    pub pixels: Vec<SampleAttributes>,
}

/// Attributes at the centre of a pixel. Serialized as one flat list of numbers, in field order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleAttributes {
    /// Column and row of the pixel.
    pub pixel: [i64; 2],
    /// Barycentric weights of the corners, affine in screen space.
    pub affine_weights: [f64; 3],
    /// Perspective-correct barycentric weights of the corners.
    pub perspective_weights: [f64; 3],
    /// Depth z/w, interpolated with the affine weights.
    pub(crate) depth: f64,
    /// Perspective-correct texture coordinates u and v.
    pub(crate) uv: [f64; 2],
}

impl Serialize for SampleAttributes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { pixel: [x, y], affine_weights: [b0, b1, b2], perspective_weights: [p0, p1, p2], depth, uv: [u, v] } =
            self;
        (x, y, b0, b1, b2, p0, p1, p2, depth, u, v).serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_correct_beyond_the_range_of_fixed_point() {
        let vertex = |x, y| AttributeVertex {
            x: Float(x),
            y: Float(y),
            z: Float(0.5),
            w: Float(1.0),
            u: Float(0.0),
            v: Float(0.0),
        };
        // The triangle is so large that the pixel lies almost exactly at its centre.
        let vertices = Exactly([vertex(-1e30, -1e30), vertex(1e30, -1e30), vertex(0.0, 2e30)]);
        let case = TriAttr { vertices, eval: vec![Exactly([3, 4])] };
        for arithmetic in [Arithmetic::Fixed, Arithmetic::Exact] {
            let [sample] = &case.answer(arithmetic, &Control::default()).unwrap().pixels[..] else {
                panic!("the answer is not one pixel")
            };
            for weight in sample.affine_weights.into_iter().chain(sample.perspective_weights) {
                assert!((weight - 1.0 / 3.0).abs() < 1e-6, "{arithmetic:?}: {sample:?}");
            }
        }
    }

    /// Returns a case with corners [x, y, z, w] and u = v = 0.
    fn case(corners: [[f32; 4]; 3], eval: &[[i64; 2]]) -> TriAttr {
        let vertex = |[x, y, z, w]: [f32; 4]| {
            let [x, y, z, w, u, v] = [x, y, z, w, 0.0, 0.0].map(Float);
            AttributeVertex { x, y, z, w, u, v }
        };
        TriAttr { vertices: Exactly(corners.map(vertex)), eval: eval.iter().map(|pixel| Exactly(*pixel)).collect() }
    }

    #[test]
    fn depth_outside_of_the_triangle_follows_its_plane() {
        // z = (x − 10) / 10 + (y − 10) / 20: this plane is exact at these pixels, except for rounding.
        let corners = [[10.0, 10.0, 0.0, 1.0], [20.0, 10.0, 1.0, 2.0], [10.0, 20.0, 0.5, 4.0]];
        let pixels = [[12, 12], [2, 12], [30, 12], [18, 18], [0, 0], [40, 40]];
        for arithmetic in [Arithmetic::Fixed, Arithmetic::F32, Arithmetic::F64, Arithmetic::Exact] {
            let answer = case(corners, &pixels).answer(arithmetic, &Control::default()).unwrap();
            for SampleAttributes { pixel: [x, y], depth, .. } in answer.pixels {
                let [x, y] = [x, y].map(|at| at as f64 + 0.5 - 10.0);
                let plane = x / 10.0 + y / 20.0;
                assert!((depth - plane).abs() < 1e-6, "{arithmetic:?}: {depth}, not {plane}");
            }
        }
    }

    #[test]
    fn snap_bits_describe_the_corners_that_were_used() {
        let corners = [[1.0, 1.0, 0.0, 1.0], [9.0, 1.0, 0.0, 1.0], [1.0, 9.0, 0.0, 1.0]];
        // Snapping makes this triangle degenerate.
        let tiny = corners.map(|[x, y, z, w]| [1.0 + x * 1e-4, 1.0 + y * 1e-4, z, w]);
        let bits =
            |corners, arithmetic| case(corners, &[[0, 0]]).answer(arithmetic, &Control::default()).unwrap().snap_bits;
        assert_eq!(bits(corners, Arithmetic::Fixed), Some(8));
        assert_eq!(bits(tiny, Arithmetic::Fixed), None);
        assert_eq!(bits(corners, Arithmetic::Exact), None);
    }

    #[test]
    fn a_sample_is_written_as_one_list() {
        let sample = SampleAttributes {
            pixel: [-1, 2],
            affine_weights: [0.5, 0.25, 0.25],
            perspective_weights: [1.0, 0.0, 0.0],
            depth: 0.75,
            uv: [3.5, -4.5],
        };
        assert_eq!(serde_json::to_string(&sample).unwrap(), "[-1,2,0.5,0.25,0.25,1.0,0.0,0.0,0.75,3.5,-4.5]");
    }
}
