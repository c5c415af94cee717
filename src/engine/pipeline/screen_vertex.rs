//! Corners of triangles on the screen, snapped to the 1/256 px grid.
//!
//! From here on a triangle's shape is stored in integers. Depth and 1/w stay floats, because they are attributes.

use super::clip_space::Varyings;
use crate::math::fixed::snap;

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
    fn relative_inv_w_is_one_at_equal_w_and_never_zero() {
        let at_w = |w: [f32; 3]| w.map(|w| ScreenVertex::at([0.0; 2], 0.0, 1.0 / w, Varyings::default()));
        assert_eq!(relative_inv_w(&at_w([7.3; 3])), [1.0; 3]);
        assert!(relative_inv_w(&at_w([1e-30, 1e30, 1e30])).iter().all(|r| *r > 0.0));
    }
}
