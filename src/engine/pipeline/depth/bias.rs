//! Depth bias: an offset added to all depths of a triangle, like Vulkan's `vkCmdSetDepthBias` and OpenGL's
//! `glPolygonOffset`.
//!
//! ```text
//! offset = m · slope + r · constant
//! m = max(|∂z/∂x|, |∂z/∂y|)   per px, of the plane through the corners on the screen
//! r = 1/(2ⁿ − 1)              if depths are n-bit codes
//! r = 2^(e − 23)              if depths are floats; e is the exponent of the greatest corner depth
//! ```
//!
//! The offset is added to the depth that the format stores: a positive offset moves a triangle away from the viewer, or
//! towards the viewer if depth is reversed. The sum is clamped to [0, 1], then quantised and tested. Each piece of a
//! clipped triangle has its own bias. A w-buffer uses the same slope m, although its depth has no constant slope on the
//! screen.

use crate::math::fixed::SUBPIXELS;
use crate::pipeline::depth_format::DepthEncoding;
use crate::pipeline::screen_vertex::ScreenVertex;
use crate::pipeline::settings::{Arithmetic, DepthBias, Settings};

/// Depth-bias settings of a view, which determine the bias of each triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BiasRule {
    factors: DepthBias,
    /// Whether slopes are computed from the snapped corners.
    is_snapped: bool,
}

/// Depth bias of one triangle, with its intermediate values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TriangleBias {
    /// Depth gradient ∂z/∂x and ∂z/∂y, per pixel; 0 if the corners are collinear.
    pub(crate) gradient: [f64; 2],
    /// Slope m: the larger magnitude of the two gradient components.
    pub(crate) slope: f64,
    /// Smallest depth difference r that the depth format resolves.
    pub(crate) step: f64,
    /// Offset added to every depth of the triangle.
    pub(crate) offset: f64,
}

impl BiasRule {
    /// Rule that adds no bias.
    pub(super) const OFF: Self = Self { factors: DepthBias { constant: 0.0, slope: 0.0 }, is_snapped: true };

    /// Returns the bias rule that the settings select.
    pub(super) fn new(settings: &Settings) -> Self {
        Self { factors: settings.depth_bias, is_snapped: settings.arithmetic == Arithmetic::Fixed }
    }

    /// Returns whether the bias is zero for every triangle.
    #[inline(always)]
    pub(super) fn is_off(&self) -> bool {
        self.factors.constant == 0.0 && self.factors.slope == 0.0
    }

    /// Returns the corner positions from which depth slopes are computed, in pixels.
    #[inline(always)]
    pub(super) fn positions_px(&self, corners: &[ScreenVertex; 3]) -> [[f64; 2]; 3] {
        corners.each_ref().map(|corner| {
            if self.is_snapped {
                [corner.x, corner.y].map(|steps| f64::from(steps) / SUBPIXELS as f64)
            } else {
                corner.position_px.map(f64::from)
            }
        })
    }

    /// Computes the bias of a triangle from the positions of its corners, in pixels, and from their depths.
    pub(super) fn of(&self, positions_px: [[f64; 2]; 3], depths: [f64; 3], encoding: DepthEncoding) -> TriangleBias {
        let gradient = gradient(positions_px, depths);
        let slope = gradient[0].abs().max(gradient[1].abs());
        let step = smallest_step(depths[0].max(depths[1]).max(depths[2]), encoding);
        let DepthBias { constant, slope: factor } = self.factors;
        TriangleBias { gradient, slope, step, offset: slope * f64::from(factor) + step * f64::from(constant) }
    }
}

/// Returns ∂z/∂x and ∂z/∂y, per pixel, of the plane through three corners. Both are 0 if the corners are collinear.
fn gradient([origin, first, second]: [[f64; 2]; 3], [z, z1, z2]: [f64; 3]) -> [f64; 2] {
    let [x1, y1] = [first[0] - origin[0], first[1] - origin[1]];
    let [x2, y2] = [second[0] - origin[0], second[1] - origin[1]];
    let (z1, z2, area) = (z1 - z, z2 - z, x1 * y2 - x2 * y1);
    if area == 0.0 { [0.0; 2] } else { [(z1 * y2 - z2 * y1) / area, (x1 * z2 - x2 * z1) / area] }
}

/// Returns the smallest depth difference that `encoding` resolves in a triangle. `greatest` is the largest corner
/// depth, in [0, 1].
fn smallest_step(greatest: f64, encoding: DepthEncoding) -> f64 {
    match encoding.largest_code() {
        Some(largest) => 1.0 / f64::from(largest),
        None => {
            let greatest = greatest as f32;
            f64::from(greatest.next_up()) - f64::from(greatest)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_step_is_the_last_place_of_the_greatest_depth() {
        for exponent in -126..=0 {
            let power = 2.0_f64.powi(exponent);
            for depth in [power, power * 1.5].into_iter().filter(|depth| *depth <= 1.0) {
                assert_eq!(smallest_step(depth, DepthEncoding::F32), 2.0_f64.powi(exponent - 23), "{depth:e}");
            }
        }
        assert_eq!(smallest_step(0.0, DepthEncoding::F32), 2.0_f64.powi(-149));
        for depth in [0.0, 1e-9, 1.0] {
            assert_eq!(smallest_step(depth, DepthEncoding::Unorm16), 1.0 / 65_535.0);
            assert_eq!(smallest_step(depth, DepthEncoding::Unorm24), 1.0 / 16_777_215.0);
        }
    }

    #[test]
    fn a_plane_has_its_gradient_whichever_corner_comes_first() {
        let plane = |[x, y]: [f64; 2]| 0.25 + x / 64.0 - y / 32.0;
        let corners = [[1.5, 2.0], [9.25, 3.0], [4.0, 7.75]];
        for turn in [[0, 1, 2], [1, 2, 0], [2, 1, 0]] {
            let corners = turn.map(|corner| corners[corner]);
            assert_eq!(gradient(corners, corners.map(plane)), [1.0 / 64.0, -1.0 / 32.0]);
        }
        assert_eq!(gradient([[0.0; 2], [1.0; 2], [2.0; 2]], [0.0, 0.5, 0.25]), [0.0; 2], "corners on a line");
    }
}
