//! Direction from an edge to the inside of its triangle, which decides the owner of pixel centres on the edge.

use super::fill_rule::{EdgeOwner, FillRule};

/// Direction from an edge to the inside of its triangle, as horizontal and vertical signs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Inward {
    /// Horizontal sign: −1 to the left (a right edge), 1 to the right (a left edge), 0 for a horizontal edge.
    pub(crate) right: i8,
    /// Vertical sign: −1 upwards (a bottom edge), 1 downwards (a top edge), 0 for a vertical edge.
    pub(crate) down: i8,
}

impl Inward {
    /// Creates the direction from the derivatives of the edge function with respect to x and y. Only their signs
    /// matter.
    pub(crate) fn new<T: PartialOrd + Default>(by_x: T, by_y: T) -> Self {
        let sign = |v: T| i8::from(v > T::default()) - i8::from(v < T::default());
        Self { right: sign(by_x), down: sign(by_y) }
    }

    /// Returns whether, under a fill rule, pixel centres exactly on an edge with this direction belong to the triangle.
    pub(crate) fn owned(self, rule: FillRule) -> bool {
        let Self { right, down } = self;
        match rule.facts().owner {
            EdgeOwner::Side { right: own, down: own_down } => right == own || (right == 0 && down == own_down),
            EdgeOwner::Both => true,
            EdgeOwner::Neither => false,
        }
    }

    /// Returns whether a pixel centre exactly on the edge counts as lying to the right of the edge. For a left edge,
    /// this is so if the triangle owns the edge; for a right edge, if the triangle does not own it.
    pub(crate) fn tie_is_beyond(self, owned: bool) -> bool {
        (self.right > 0) == owned
    }
}
