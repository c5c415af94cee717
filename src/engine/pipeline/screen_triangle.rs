//! Triangles on the screen, ready to be rasterized, and the depths of their samples.

use super::depth::{DepthFunction, DepthScale};
use super::raster::RasterSample;
use super::screen_vertex::{ScreenVertex, relative_inv_w};
use super::settings::Arithmetic;
use crate::math::fixed::to_pixels;
use crate::scene::TriangleId;

/// Triangle on the screen, ready to be rasterized.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenTriangle {
    /// Identifier of the scene triangle, which all pieces made from it by clipping share.
    pub id: TriangleId,
    /// Index of the instance that the triangle belongs to.
    pub instance: u32,
    /// Corners in the order of the mesh.
    pub vertices: [ScreenVertex; 3],
    /// Doubled area of the triangle, which is positive, in the unit of its edge values.
    pub doubled_area: f64,
    /// Function that gives the depth at each sample of the triangle.
    pub depth: DepthFunction,
    /// 1/w of each corner, divided by the largest 1/w of the three; all 1 if the perspective division is skipped.
    pub relative_inv_w: [f32; 3],
}

/// Triangle and instance of the scene to which a triangle on the screen belongs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleOwner {
    pub(crate) id: TriangleId,
    /// Index of the instance.
    pub(crate) instance: u32,
}

impl TriangleOwner {
    /// First triangle of the first instance, for triangles that belong to no scene.
    pub(crate) const FIRST: Self = Self { id: TriangleId(0), instance: 0 };
}

impl ScreenTriangle {
    /// Creates a triangle and sets up the interpolation of its depth and attributes. `doubled_area` is positive and in
    /// the unit of edge values. If `divides_by_w` is false, attributes are affine on the screen.
    pub(crate) fn new(
        TriangleOwner { id, instance }: TriangleOwner,
        vertices: [ScreenVertex; 3],
        doubled_area: f64,
        scale: &DepthScale,
        divides_by_w: bool,
    ) -> Self {
        let depth = scale.over(&vertices, doubled_area);
        let relative_inv_w = if divides_by_w { relative_inv_w(&vertices) } else { [1.0; 3] };
        Self { id, instance, vertices, doubled_area, depth, relative_inv_w }
    }

    /// Returns the corners in pixels, before snapping.
    pub(crate) fn corners_px(&self) -> [[f32; 2]; 3] {
        self.vertices.each_ref().map(|v| v.position_px)
    }

    /// Returns the corners, in pixels, from which `arithmetic` computes the edges: snapped corners in fixed point,
    /// unsnapped corners in any other arithmetic.
    pub(crate) fn corners_in(&self, arithmetic: Arithmetic) -> [[f32; 2]; 3] {
        if arithmetic == Arithmetic::Fixed { self.snapped_px() } else { self.corners_px() }
    }

    /// Returns the snapped corners in pixels.
    pub(crate) fn snapped_px(&self) -> [[f32; 2]; 3] {
        self.vertices.each_ref().map(|v| [to_pixels(v.x.into()), to_pixels(v.y.into())])
    }
}

/// Returns the depth of a covered sample as the depth buffer stores it.
#[inline]
pub(crate) fn depth_at(triangle: &ScreenTriangle, sample: &RasterSample) -> f32 {
    triangle.depth.encoding().quantize(unquantised_depth_at(triangle, sample))
}

/// Returns the depth of a covered sample in [0, 1], before it is quantised.
#[inline]
pub(crate) fn unquantised_depth_at(triangle: &ScreenTriangle, sample: &RasterSample) -> f64 {
    triangle.depth.at(sample.edges, triangle.vertices.each_ref().map(|v| v.inv_w))
}
