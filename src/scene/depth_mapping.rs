//! Depth mappings, shared by the projection and the depth buffer.

/// Mapping from the distance along the line of sight, between the near and the far plane, to a depth in [0, 1].
///
/// The formulas hold for perspective, with w for the distance and n and f for the near and far planes. In an
/// orthographic view every mapping is linear, from 0 to 1, or from 1 to 0 if reversed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthMapping {
    /// f·(w − n) / (w·(f − n)): 0 at the near plane, 1 at the far plane; z/w of the usual matrix.
    Standard,
    /// n·(f − w) / (w·(f − n)): 1 at the near plane, 0 at the far plane.
    Reversed,
    /// n/w: 1 at the near plane, 0 at infinity. There is no far plane in perspective. An orthographic view requires one
    /// and uses that of [`Self::Reversed`].
    ReversedInfinite,
    /// (w − n) / (f − n): 0 at the near plane, 1 at the far plane. Uniform steps of distance; not affine in screen
    /// space.
    Linear,
}

impl DepthMapping {
    /// Whether smaller distances have larger depths.
    pub fn is_reversed(self) -> bool {
        matches!(self, Self::Reversed | Self::ReversedInfinite)
    }
}
