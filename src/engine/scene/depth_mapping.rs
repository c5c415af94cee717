//! Depth mappings, shared by the projection and the depth buffer.

/// Mapping from the distance along the line of sight, between the near and the far plane, to a depth in [0, 1].
///
/// The formulas hold for perspective: w is the distance of a point, n the distance of the near plane, and f the
/// distance of the far plane. In an orthographic view, every mapping is linear, from 0 to 1, or from 1 to 0 if
/// reversed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthMapping {
    /// Standard depth f·(w − n) / (w·(f − n)), which is z/w of the usual matrix: 0 at the near plane, 1 at the far
    /// plane.
    Standard,
    /// Reversed depth n·(f − w) / (w·(f − n)): 1 at the near plane, 0 at the far plane.
    Reversed,
    /// Reversed depth n/w without a far plane: 1 at the near plane, 0 at infinity. An orthographic view requires a far
    /// plane and uses [`Self::Reversed`] instead.
    ReversedInfinite,
    /// Linear depth (w − n) / (f − n): 0 at the near plane, 1 at the far plane. Equal depth steps are equal distances,
    /// but the depth is not affine in screen space.
    Linear,
}

impl DepthMapping {
    /// Whether smaller distances have larger depths.
    pub(crate) fn is_reversed(self) -> bool {
        matches!(self, Self::Reversed | Self::ReversedInfinite)
    }
}
