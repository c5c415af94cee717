//! Depth mappings, shared by the projection and the depth buffer.

use crate::math::real::Real;

/// Mapping from the distance along the line of sight, between the near and the far plane, to a depth in [0, 1].
///
/// It consists of two coefficients: the curve, and the plane where depth is 0. w is the distance of a point, n that of
/// the near plane, f that of the far plane, and z and o the distances of the planes where depth is 0 and 1. Then depth is
///
/// ```text
/// hyperbolic   (w − z)/w · o/(o − z)     affine in screen space
/// linear       (w − z) / (o − z)         affine in world space
/// ```
///
/// with the limit of f → ∞ where there is no far plane. In an orthographic view, every mapping is linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DepthMapping {
    /// Curve of depth over distance in perspective.
    pub curve: DepthCurve,
    /// Whether depth is 1 at the near plane and 0 at the far plane, instead of 0 at the near plane and 1 at the far
    /// plane.
    pub reversed: bool,
}

/// Curve of depth over distance in perspective.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthCurve {
    /// Linear in the reciprocal of the distance, as z/w of the usual matrix.
    Hyperbolic,
    /// Linear in the reciprocal of the distance, with the far plane at infinity. An orthographic view requires a far
    /// plane.
    HyperbolicInfinite,
    /// Linear in the distance: equal depth steps are equal distances, but the depth is not affine in screen space.
    Linear,
}

impl DepthMapping {
    /// Standard depth f·(w − n) / (w·(f − n)), which is z/w of the usual matrix: 0 at the near plane, 1 at the far
    /// plane.
    pub const STANDARD: Self = Self { curve: DepthCurve::Hyperbolic, reversed: false };

    /// Reversed depth n·(f − w) / (w·(f − n)): 1 at the near plane, 0 at the far plane.
    pub const REVERSED: Self = Self { curve: DepthCurve::Hyperbolic, reversed: true };

    /// Reversed depth n/w without a far plane: 1 at the near plane, 0 at infinity.
    pub const REVERSED_INFINITE: Self = Self { curve: DepthCurve::HyperbolicInfinite, reversed: true };

    /// Linear depth (w − n) / (f − n): 0 at the near plane, 1 at the far plane.
    pub const LINEAR: Self = Self { curve: DepthCurve::Linear, reversed: false };

    /// All mappings, also those that no depth format has.
    #[cfg(test)]
    pub(crate) const ALL: [Self; 6] = [
        Self::STANDARD,
        Self::REVERSED,
        Self { curve: DepthCurve::HyperbolicInfinite, reversed: false },
        Self::REVERSED_INFINITE,
        Self::LINEAR,
        Self { curve: DepthCurve::Linear, reversed: true },
    ];

    /// Whether smaller distances have larger depths.
    pub(crate) fn is_reversed(self) -> bool {
        self.reversed
    }

    /// Whether the mapping has a far plane in perspective.
    pub fn has_far_plane(self) -> bool {
        self.curve != DepthCurve::HyperbolicInfinite
    }

    /// Returns the mapping of an orthographic view.
    pub(crate) fn in_orthographic_view(self) -> Self {
        Self { curve: DepthCurve::Linear, ..self }
    }

    /// Returns the mapping whose depth is z/w of clip space in perspective. It differs from `self` where no matrix gives
    /// the depth as z/w, or where the standard z would round to w at most distances, so that the far plane is lost.
    /// Clip-space z is then used only for clipping, and reversed: f32 represents it well at both planes.
    pub(crate) fn in_clip_space(self) -> Self {
        match self.curve {
            DepthCurve::Hyperbolic => self,
            DepthCurve::HyperbolicInfinite => Self::REVERSED_INFINITE,
            DepthCurve::Linear => Self::REVERSED,
        }
    }

    /// Returns the distances of the planes where depth is 0 and 1, if there is a far plane.
    pub(crate) fn zero_and_one(self, [near, far]: [f64; 2]) -> [f64; 2] {
        if self.reversed { [far, near] } else { [near, far] }
    }

    /// Returns the constant factor in the formula of [`DepthMapping::depth`].
    pub(crate) fn factor(self, planes: [f64; 2]) -> f64 {
        let [near, far] = planes;
        let [_, one] = self.zero_and_one(planes);
        match self.curve {
            DepthCurve::Hyperbolic => one / (far - near),
            DepthCurve::HyperbolicInfinite if self.reversed => near,
            DepthCurve::HyperbolicInfinite => 1.0,
            DepthCurve::Linear => 1.0 / (far - near),
        }
    }

    /// Returns the depth at a distance. `zero` is the distance of the plane where depth is 0, which is not read if it is
    /// infinite. The depth lies outside [0, 1] for distances in front of the near plane or beyond the far plane.
    #[inline(always)]
    pub(crate) fn depth<N: Real>(self, distance: N, zero: N, factor: N) -> N {
        if self == Self::REVERSED_INFINITE {
            return factor / distance;
        }
        let from_zero = if self.reversed { zero - distance.clone() } else { distance.clone() - zero };
        match self.curve {
            DepthCurve::Hyperbolic | DepthCurve::HyperbolicInfinite => from_zero / distance * factor,
            DepthCurve::Linear => from_zero * factor,
        }
    }

    /// Returns the distance of a depth: the inverse of [`DepthMapping::depth`].
    #[inline(always)]
    pub(crate) fn distance<N: Real>(self, depth: N, zero: N, factor: N) -> N {
        match (self.curve, self.reversed) {
            (DepthCurve::HyperbolicInfinite, true) => factor / depth,
            (DepthCurve::Hyperbolic, true) => zero * factor.clone() / (depth + factor),
            (DepthCurve::Hyperbolic | DepthCurve::HyperbolicInfinite, false) => {
                let one = depth.constant(1.0);
                zero / (one - depth / factor)
            }
            (DepthCurve::Linear, false) => zero + depth / factor,
            (DepthCurve::Linear, true) => zero - depth / factor,
        }
    }
}
