//! Back-facing test of clusters.
//!
//! A cluster is back-facing if, for each of its triangles, the doubled area of the snapped vertices has the sign of the
//! culled side, or is zero. In a picture of W × H px, the exact doubled area on the screen, before snapping, is
//! S = −(W·H/4) · D / (w₀ w₁ w₂). D is the determinant of the clip-space x, y and w of the three vertices. By the
//! Cauchy–Binet formula, D = 2A · (n·e + d·f) for a triangle of area A in the plane n·p = d. (e, f) are the minors of
//! the three rows of the matrix: the homogeneous position of the eye, if there is one. Bounds of n and d give a lower
//! bound of |n·e + d·f| over a cluster.
//!
//! Snapped vertices differ from the exact ones by at most δ on each axis: half a step of 1/256 px plus
//! rounding. This changes S by at most √2 δ times the perimeter plus 8δ². An edge of length ℓ is at most κℓ/w px long
//! on the screen. With the longest edge ℓ and the altitude h = 2A/ℓ, the sign is certain if
//!
//! ```text
//! (W·H/4) · h · |n·e + d·f| / w_max³  >  3 √2 δ κ / w_min + 8δ² / h
//! ```
//!
//! The condition can only hold for triangles whose altitude on the screen is at least about a hundredth of a pixel. The
//! triangles must not be clipped, because the pieces are snapped again: the box must lie between the depth planes and
//! within the guard band.

use glam::{Mat4, Vec4Swizzles};

use super::super::super::clip::GUARD_BAND_PX;
use super::super::super::viewport::{MAX_SIDE_PX, Viewport};
use super::affine::{Affine, EightBoxes, PLANES};
use crate::math::fixed::SUBPIXELS;
use crate::math::lanes::*;
use crate::scene::clusters::ClusterPlanes;

/// Factor by which the side planes are moved outward for the back-facing test. The moved planes lie within the guard
/// band for every picture size.
const BAND: f32 = 2.0;
const _: () = assert!(BAND * MAX_SIDE_PX as f32 <= 2.0 * GUARD_BAND_PX);

/// Conservative bound on the rounding error of an affine function computed in doubles, relative to its magnitude.
const DOUBLE_ROUNDING: f64 = 1e-12;

/// Back-facing test of the clusters of one mesh in one view.
#[derive(Clone, Debug)]
pub(super) struct BackFacingTest {
    /// Signed distances from the clip planes, with the side planes moved outward. Triangles inside all of these planes
    /// are never clipped.
    distances: [Affine; PLANES.len()],
    x: Affine,
    y: Affine,
    w: Affine,
    /// Coefficients of D / 2A as a linear function of n and d, which the module documentation defines. The function is
    /// positive for culled triangles. The second array has, for each coefficient, the sum of the magnitudes of its
    /// terms.
    seen_from: ([f64; 4], [f64; 4]),
    /// Factor κ: an edge of model-space length ℓ is at most κℓ/w px long on the screen.
    stretch: f64,
    /// Length of the longer side of the picture, in pixels.
    longer_px: f64,
    /// A quarter of the picture's area W·H, in px².
    quarter: f64,
}

impl BackFacingTest {
    /// Creates the back-facing test of a mesh in one view. `sign` is the sign of the determinant D (see the module
    /// documentation) for culled triangles.
    pub(super) fn new(clip_from_model: Mat4, Viewport { width, height }: Viewport, sign: f64) -> Self {
        let (width, height) = (f64::from(width), f64::from(height));
        let rows = [0, 1, 3].map(|row| clip_from_model.row(row).as_dvec4().to_array());
        // Determinant of all columns except `without`, and the sum of the magnitudes of its terms.
        let minor = |without: usize| {
            let [i, j, k] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]][without];
            let [x, y, w] = &rows;
            let products = [
                x[i] * y[j] * w[k],
                x[j] * y[k] * w[i],
                x[k] * y[i] * w[j],
                -x[k] * y[j] * w[i],
                -x[j] * y[i] * w[k],
                -x[i] * y[k] * w[j],
            ];
            (products.iter().sum::<f64>(), products.iter().map(|product| product.abs()).sum::<f64>())
        };
        let [x, y, z, one] = [0, 1, 2, 3].map(minor);
        // `along` bounds the length, along one screen axis, of an edge with ℓ = 1 at w = 1. The term with row 3
        // accounts for the change of w along the edge.
        let length = |row: usize| clip_from_model.row(row).xyz().as_dvec3().length();
        let along = |row: usize, size: f64| 0.5 * size * (length(row) + f64::from(BAND) * length(3));
        Self {
            distances: PLANES.map(|plane| Affine::distance(plane, clip_from_model, BAND)),
            x: Affine::component(0, clip_from_model),
            y: Affine::component(1, clip_from_model),
            w: Affine::component(3, clip_from_model),
            seen_from: ([sign * x.0, -sign * y.0, sign * z.0, sign * one.0], [x.1, y.1, z.1, one.1]),
            stretch: along(0, width).hypot(along(1, height)),
            longer_px: width.max(height),
            quarter: width * height / 4.0,
        }
    }

    /// Returns the bit mask that selects, among eight clusters, those whose triangles are all removed by face culling.
    #[inline(always)]
    pub(super) fn back_facing<S: Simd>(
        &self,
        simd: S,
        boxes: &EightBoxes<S>,
        planes: &ClusterPlanes,
        may_be_cut: bool,
    ) -> u64 {
        let normals = each!(end in [0, 1] => {
            each!(axis in [0, 1, 2] => widen(simd, F32::load_array(simd, planes.normals[end][axis])))
        });
        let offsets = each!(end in [0, 1] => widen(simd, F32::load_array(simd, planes.offsets[end])));
        let (coefficients, magnitudes) = self.seen_from;
        let offset = if coefficients[3] > 0.0 { offsets[0] } else { offsets[1] };
        let mut least = offset * coefficients[3];
        let mut magnitude = offsets[0].abs().max(offsets[1].abs()) * magnitudes[3];
        for axis in 0..3 {
            let normal = if coefficients[axis] > 0.0 { normals[0][axis] } else { normals[1][axis] };
            least += normal * coefficients[axis];
            magnitude += magnitudes[axis];
        }
        let least = least - magnitude * DOUBLE_ROUNDING;
        let mut bits = least.simd_gt(0.0).to_bitmask();
        if bits == 0 {
            return 0;
        }
        for distance in self.distances.iter().filter(|_| may_be_cut) {
            bits &= distance.least(simd, boxes).simd_gt(distance.slack(simd, boxes)).to_bitmask();
        }
        let slack = self.w.slack(simd, boxes);
        let (w_min, w_max) = (self.w.least(simd, boxes) - slack, self.w.greatest(simd, boxes) + slack);
        // Within these limits, floats neither underflow nor overflow.
        bits &= (w_min.simd_gt(MIN_W) & w_max.simd_lt(MAX_W)).to_bitmask();
        if bits == 0 {
            return 0;
        }
        // x/w ± 1 is off by 4u (M_x + 2 M_w) / w. The quotient and later steps are off by less than 6u.
        let of_x = self.x.magnitude(simd, boxes).max(self.y.magnitude(simd, boxes));
        let relative = (of_x + self.w.magnitude(simd, boxes) * 2.0) / w_min + 1.0;
        let off_px = relative * (SCREEN_ROUNDING * self.longer_px) + 0.5 / SUBPIXELS as f64;
        let altitude = widen(simd, F32::load_array(simd, planes.altitudes));
        let area = altitude * least * self.quarter / (w_max * w_max * w_max);
        let changed =
            off_px * (3.0 * std::f64::consts::SQRT_2 * self.stretch) / w_min + off_px * off_px * 8.0 / altitude;
        bits & (area.simd_gt(changed) & altitude.simd_gt(0.0)).to_bitmask()
    }
}

/// Lower limit of clip-space w for clusters that the back-facing test may cull.
const MIN_W: f64 = 1e-20;

/// Upper limit of clip-space w for clusters that the back-facing test may cull.
const MAX_W: f64 = 1e20;

/// Bound on the rounding error of a screen position, relative to the longer side of the picture and to the magnitudes
/// of its terms: 8u with u = 2⁻²⁴.
const SCREEN_ROUNDING: f64 = 4.0 * f32::EPSILON as f64;
