//! Which depth a distance has: what the projection and the depth buffer agree on.

/// How the distance along the line of sight, from the near to the far plane, becomes a depth in [0, 1].
///
/// The formulas hold in perspective, with n and f for the planes. Without perspective every mapping is linear, from 0 to 1
/// or, if it is reversed, from 1 to 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthMapping {
    /// f·(w − n) / (w·(f − n)): 0 near, 1 far. z/w of the usual matrix.
    Standard,
    /// n·(f − w) / (w·(f − n)): 1 near, 0 far.
    Reversed,
    /// n/w: 1 near, 0 at infinity. There is no far plane; a view without perspective, which cannot do without, has the one
    /// of [`Self::Reversed`].
    ReversedInfinite,
    /// (w − n) / (f − n): 0 near, 1 far. Even steps of distance, and not affine on the screen.
    Linear,
}

impl DepthMapping {
    /// Whether nearer is larger.
    pub fn is_reversed(self) -> bool {
        matches!(self, Self::Reversed | Self::ReversedInfinite)
    }
}
