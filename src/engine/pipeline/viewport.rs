//! Projection to the screen: divide by w, scale to the picture, snap to the 1/256 px grid.
//!
//! From here on a triangle's shape is stored in integers. Depth and 1/w stay floats, because they are attributes.

use glam::Vec3;

use super::clip::ClippedTriangle;
use super::depth::{DepthFunction, DepthScale};
use super::settings::Arithmetic;
use super::vertex::{ClipVertex, Varyings};
use crate::math::fixed::{snap, to_pixels};
use crate::scene::{SubView, TriangleId};

/// Corner of a triangle on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenVertex {
    /// Position in pixels, before snapping.
    pub(crate) position_px: [f32; 2],
    /// Snapped x coordinate in pixels, to the right, in 24.8 fixed point.
    pub x: i32,
    /// Snapped y coordinate in pixels, downwards, in 24.8 fixed point.
    pub y: i32,
    /// Depth in [0, 1], before it is quantised.
    pub depth: f64,
    /// Reciprocal of the clip-space w, greater than 0.
    pub inv_w: f32,
    /// Attributes to be interpolated.
    pub varyings: Varyings,
}

impl ScreenVertex {
    /// Creates a vertex at an unsnapped position in pixels, and snaps that position as well. `inv_w` is 1/w, which must
    /// be positive.
    #[inline]
    pub(crate) fn at([x, y]: [f32; 2], depth: f64, inv_w: f32, varyings: Varyings) -> Self {
        Self { position_px: [x, y], x: snap(x) as i32, y: snap(y) as i32, depth, inv_w, varyings }
    }
}

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

/// Size of a picture in pixels, which defines the transform from clip space to its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Viewport {
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
}

/// Maximum side length of a picture, in pixels. It keeps coordinates well within the range of the rasterizer's fixed
/// point.
pub const MAX_SIDE_PX: u32 = 16_384;

/// Maximum number of pixels of a picture: enough for 8K (7680 × 4320). A picture of this size takes about 2 GB of
/// memory if every buffer is kept.
pub(crate) const MAX_PIXELS: u64 = 1 << 25;

impl Viewport {
    /// Checks that a picture of this size is supported. Returns an error message if it is not.
    pub fn check(self) -> Result<(), String> {
        let sides = 1..=MAX_SIDE_PX;
        if !sides.contains(&self.width) || !sides.contains(&self.height) {
            return Err(format!("each side must be 1 to {MAX_SIDE_PX} pixels long"));
        }
        if u64::from(self.width) * u64::from(self.height) > MAX_PIXELS {
            return Err(format!("at most {MAX_PIXELS} pixels are supported"));
        }
        Ok(())
    }

    /// Returns the aspect ratio: width divided by height.
    pub fn aspect(self) -> f32 {
        self.width as f32 / self.height as f32
    }

    /// Returns the part of a view that a picture of this size shows. The whole view has the size `full`, in pixels. The
    /// centre of pixel (i, j) of the picture lies at (i + ½, j + ½) · `step_px` + `origin_px`, in pixels of the view.
    /// The right and lower borders of the picture may lie outside or inside the view.
    pub(crate) fn window(self, full: Self, step_px: f64, origin_px: [f64; 2]) -> SubView {
        let axis = |full: u32, own: u32, origin: f64| {
            let (full, own) = (f64::from(full), step_px * f64::from(own));
            // Solves (ndc + 1) / 2 · full = (ndc' + 1) / 2 · own + origin for ndc'. Both sides are x in pixels of the
            // view; ndc belongs to the view, ndc' to the picture.
            ((full / own) as f32, ((full - 2.0 * origin) / own - 1.0) as f32)
        };
        let (scale_x, shift_x) = axis(full.width, self.width, origin_px[0]);
        let (scale_y, shift_down) = axis(full.height, self.height, origin_px[1]);
        SubView { aspect: full.aspect(), scale: [scale_x, scale_y], shift: [shift_x, -shift_down] }
    }

    /// Returns the pixel position, before snapping, of a point in normalised device coordinates (y up).
    pub(crate) fn pixels_from_ndc(self, ndc: Vec3) -> (f32, f32) {
        ((ndc.x * 0.5 + 0.5) * self.width as f32, (0.5 - ndc.y * 0.5) * self.height as f32)
    }

    /// Projects the corners of a clipped triangle; `scale` determines their depths.
    pub(crate) fn project(self, triangle: &ClippedTriangle, scale: &DepthScale) -> [ScreenVertex; 3] {
        let [a, b, c] = &triangle.vertices;
        // Projected one by one: mapping an array of items this large copies each of them four times.
        [self.project_vertex(a, scale), self.project_vertex(b, scale), self.project_vertex(c, scale)]
    }

    /// Projects one corner, whose w must be positive.
    #[inline]
    pub(crate) fn project_vertex(self, vertex: &ClipVertex, scale: &DepthScale) -> ScreenVertex {
        let (inv_w, ndc) = divided(vertex);
        let position_px = self.pixels_from_ndc(ndc);
        ScreenVertex::at(position_px.into(), scale.of_vertex(vertex), inv_w, vertex.varyings)
    }
}

/// Returns 1/w of a vertex, and its position divided by w: normalised device coordinates, y up.
#[inline]
pub(crate) fn divided(vertex: &ClipVertex) -> (f32, Vec3) {
    let inv_w = 1.0 / vertex.position.w;
    (inv_w, vertex.position.truncate() * inv_w)
}

/// Returns the 1/w of each corner divided by the largest 1/w, in (0, 1]; all 1 if w is equal at all corners. No result
/// is 0, so the sum of the weights stays positive even on the far edge of a triangle whose near corner is 10⁴⁰ times
/// nearer.
pub(crate) fn relative_inv_w(vertices: &[ScreenVertex; 3]) -> [f32; 3] {
    let inv_w = vertices.map(|v| v.inv_w);
    let largest = inv_w[0].max(inv_w[1]).max(inv_w[2]);
    inv_w.map(|i| (i / largest).max(f32::MIN_POSITIVE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_puts_pixels_where_they_are_seen_in_the_view() {
        let (full, small) = (Viewport { width: 37, height: 20 }, Viewport { width: 13, height: 7 });
        for (step, origin) in [(3.0, [0.0, 0.0]), (3.0, [-1.0, -1.0]), (1.5, [0.25, -0.4])] {
            let window = small.window(full, step, origin);
            for (x, y) in [(0.0, 0.0), (0.5, -0.75), (-1.0, 1.0)] {
                let (full_x, full_y) = full.pixels_from_ndc(Vec3::new(x, y, 0.0));
                let own = Vec3::new(x * window.scale[0] + window.shift[0], y * window.scale[1] + window.shift[1], 0.0);
                let (own_x, own_y) = small.pixels_from_ndc(own);
                for (full, own, origin) in [(full_x, own_x, origin[0]), (full_y, own_y, origin[1])] {
                    let seen_at = f64::from(own) * step + origin;
                    assert!((seen_at - f64::from(full)).abs() < 1e-4, "{step} {origin}: {seen_at}, not {full}");
                }
            }
        }
    }

    #[test]
    fn relative_inv_w_is_one_at_equal_w_and_never_zero() {
        let at_w = |w: [f32; 3]| w.map(|w| ScreenVertex::at([0.0; 2], 0.0, 1.0 / w, Varyings::default()));
        assert_eq!(relative_inv_w(&at_w([7.3; 3])), [1.0; 3]);
        assert!(relative_inv_w(&at_w([1e-30, 1e30, 1e30])).iter().all(|r| *r > 0.0));
    }
}
