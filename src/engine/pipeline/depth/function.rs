//! Depth as a function of the sample position, set up once per triangle.
//!
//! z/w is an affine function of the screen position, so it is interpolated with the edge values themselves, never with
//! perspective-correct weights. A depth that is linear in world space is interpolated with perspective-correct weights.
//! Both kinds of depth are computed in the same way: the smallest corner depth is subtracted from each corner depth,
//! the differences are multiplied by the weights of their corners, and the products are added to the smallest corner
//! depth. Neither weights nor differences are negative, so there is no cancellation. A constant depth is reproduced
//! exactly, and no sample inside the triangle leaves the range of the corner depths. A depth bias is added to the
//! smallest depth. Depth is computed in f64 and rounded once.

use crate::pipeline::depth_format::DepthEncoding;

/// Depth as a function over the samples of one triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthFunction {
    course: Interpolant,
    encoding: DepthEncoding,
    /// Smallest corner depth, including the depth bias.
    min_depth: f64,
    /// Difference of each corner's depth from the smallest corner depth. If depth is affine in screen space, the
    /// differences are divided by the triangle's doubled area, because edge values serve as weights.
    rises: [f64; 3],
}

/// Space in which depth is linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Interpolant {
    /// Screen space, as for z/w.
    Screen,
    /// World space, as for a w-buffer.
    Space,
}

impl DepthFunction {
    /// Returns a depth function that is affine in screen space, from the corner depths. `doubled_area` is in the unit
    /// of edge values.
    pub(crate) fn affine_on_screen(corners: [f64; 3], doubled_area: f64, encoding: DepthEncoding) -> Self {
        let (min_depth, rises) = rises(corners);
        Self { course: Interpolant::Screen, encoding, min_depth, rises: rises.map(|rise| rise / doubled_area) }
    }

    /// Returns a depth function that is linear in world space, from the corner depths.
    pub(crate) fn linear_in_space(corners: [f64; 3], encoding: DepthEncoding) -> Self {
        let (min_depth, rises) = rises(corners);
        Self { course: Interpolant::Space, encoding, min_depth, rises }
    }

    /// Returns the function with an offset added to all depths.
    #[inline(always)]
    pub(super) fn offset_by(self, offset: f64) -> Self {
        Self { min_depth: self.min_depth + offset, ..self }
    }

    /// Returns whether depth is linear in world space rather than in screen space.
    pub(crate) fn is_linear_in_space(&self) -> bool {
        self.course == Interpolant::Space
    }

    /// Returns the smallest depth, and one factor per corner. Each factor multiplies the corner's edge value or, if
    /// depth is linear in world space, its perspective-correct weight.
    #[inline(always)]
    pub(crate) fn terms(&self) -> (f64, [f64; 3]) {
        (self.min_depth, self.rises)
    }

    /// Returns the number format of stored depths.
    #[inline]
    pub(in crate::pipeline) fn encoding(&self) -> DepthEncoding {
        self.encoding
    }

    /// Returns the depth of a sample in [0, 1], before it is quantised. `inv_w` is the 1/w of each corner.
    #[inline]
    pub(in crate::pipeline) fn at(&self, edges: [f64; 3], inv_w: [f32; 3]) -> f64 {
        let Self { course, min_depth: least, rises, .. } = *self;
        let weighted = |[a, b, c]: [f64; 3]| a * rises[0] + b * rises[1] + c * rises[2];
        let rise = match course {
            Interpolant::Screen => weighted(edges),
            Interpolant::Space => {
                let [a, b, c] = inv_w.map(f64::from);
                // Inexact arithmetic may also cover samples slightly outside an edge, whose edge value is negative.
                // Such values are clamped to 0. Otherwise, the sum of the weights could be close to 0 and the depth far
                // out of range.
                let [e0, e1, e2] = edges.map(|edge| edge.max(0.0));
                let weights = [e0 * a, e1 * b, e2 * c];
                let sum = weights[0] + weights[1] + weights[2];
                // In float arithmetic, all clamped edge values may be 0.
                if sum > 0.0 { weighted(weights) / sum } else { 0.0 }
            }
        };
        (least + rise).clamp(0.0, 1.0)
    }
}

/// Returns the smallest corner depth, and the difference of each corner depth from it.
fn rises(corners: [f64; 3]) -> (f64, [f64; 3]) {
    let least = corners[0].min(corners[1]).min(corners[2]);
    (least, corners.map(|depth| depth - least))
}
