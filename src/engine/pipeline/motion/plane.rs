//! Motion of the plane of one triangle between two frames.

use glam::{DMat3, DVec3};

/// Number of pixels of a row whose motion is computed from one exact position.
pub(crate) const BLOCK: usize = 16;

/// Corner of a triangle in homogeneous pixels: its position in pixels times w, and w.
pub(crate) type HomogeneousPx = DVec3;

/// Map from the pixels of a triangle's plane in the current frame to its positions in the preceding frame.
///
/// Each field is a linear form of (x, y, 1), with x and y in pixels of the current frame. Let C be the matrix whose
/// columns are the corners in homogeneous pixels. Then C⁻¹·(x, y, 1) holds the perspective-correct barycentric weight of
/// each corner, divided by w at the pixel (Olano and Greer, "Triangle Scan Conversion using 2D Homogeneous
/// Coordinates", 1997). Any quantity that is linear on the triangle is a linear form of these weights. The matrix needs
/// no clipping: corners behind the eye are valid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneMotion {
    /// Column in the preceding frame, in pixels, times `w`.
    pub(crate) column: DVec3,
    /// Row in the preceding frame, in pixels, times `w`.
    pub(crate) row: DVec3,
    /// Clip-space w in the preceding frame, times `inv_w`.
    pub(crate) w: DVec3,
    /// Distance in the preceding frame along its view axis, in world units, times `inv_w`.
    distance: DVec3,
    /// Reciprocal of the clip-space w in the current frame.
    inv_w: DVec3,
}

/// Corners of a triangle in two frames.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MovedTriangle {
    /// Corners in the current frame, in homogeneous pixels.
    pub(crate) now: [HomogeneousPx; 3],
    /// Corners in the preceding frame, in homogeneous pixels.
    pub(crate) before: [HomogeneousPx; 3],
    /// Distance of each corner in the preceding frame along its view axis, in world units.
    pub(crate) distances: [f64; 3],
}

impl PlaneMotion {
    /// Computes the map. If the triangle is seen exactly edge-on, the map gives NaN or infinite positions.
    pub(crate) fn new(triangle: &MovedTriangle) -> Self {
        let weights = DMat3::from_cols_array_2d(&triangle.now.map(|corner| corner.to_array())).inverse().transpose();
        let [a, b, c] = triangle.before;
        let of = |value: fn(DVec3) -> f64| weights * DVec3::new(value(a), value(b), value(c));
        Self {
            column: of(|corner| corner.x),
            row: of(|corner| corner.y),
            w: of(|corner| corner.z),
            distance: weights * DVec3::from_array(triangle.distances),
            inv_w: weights * DVec3::ONE,
        }
    }

    /// Prepares the motion of the [`BLOCK`] pixels of row `y` that start at column `first`.
    #[inline(always)]
    pub(super) fn block(&self, first: u32, y: u32) -> MotionBlock {
        let at = DVec3::new(f64::from(first) + 0.5, f64::from(y) + 0.5, 1.0);
        let w = self.w.dot(at);
        let (per_w, per_inv_w) = (1.0 / w, 1.0 / self.inv_w.dot(at));
        let across = [self.column.dot(at) - at.x * w, self.column.x - w - at.x * self.w.x, -self.w.x];
        let down = [self.row.dot(at) - at.y * w, self.row.x - at.y * self.w.x];
        MotionBlock {
            across: across.map(|number| (number * per_w) as f32),
            down: down.map(|number| (number * per_w) as f32),
            w: (self.w.x * per_w) as f32,
            distance: [self.distance.dot(at), self.distance.x].map(|number| (number * per_inv_w) as f32),
            inv_w: (self.inv_w.x * per_inv_w) as f32,
        }
    }
}

/// Motion of the pixels of a block, as polynomials of the column within the block.
///
/// The coefficients are computed in f64 at the first pixel of the block, as differences from that pixel. The motion of
/// the others needs only f32, with an error relative to the motion and not to the position.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotionBlock {
    across: [f32; 3],
    down: [f32; 2],
    w: f32,
    distance: [f32; 2],
    inv_w: f32,
}

impl MotionBlock {
    /// Returns the motion of pixel number `column` of the block, in [0, [`BLOCK`]).
    #[inline(always)]
    pub(super) fn at(&self, column: f32) -> PlaneMove {
        let Self { across: [a, b, c], down: [d, e], w, distance: [f, g], inv_w } = *self;
        let w = 1.0 + column * w;
        PlaneMove {
            across_px: ((c * column + b) * column + a) / w,
            down_px: (e * column + d) / w,
            distance: (g * column + f) / (1.0 + column * inv_w),
        }
    }
}

/// Motion of the surface in one pixel since the preceding frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlaneMove {
    /// Position in the preceding frame minus the position in the current one, in pixels to the right.
    pub(super) across_px: f32,
    /// Position in the preceding frame minus the position in the current one, in pixels downwards.
    pub(super) down_px: f32,
    /// Distance in the preceding frame along its view axis, in world units.
    pub(super) distance: f32,
}
