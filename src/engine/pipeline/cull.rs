//! Culling: rejects projected triangles that need no rasterization.

use super::observe::Fate;
use super::settings::Culling;

/// Side of a triangle that faces the viewer.
///
/// ```text
///      a                 On the screen, y points down. If a → b → c is
///     / \                counter-clockwise, as in this figure, the doubled
///    b───c               area (b − a) × (c − a) is negative: front-facing.
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Facing {
    /// Front-facing: counter-clockwise for the viewer.
    Front,
    /// Back-facing: clockwise for the viewer.
    Back,
    /// Zero area: neither side faces the viewer.
    Edge,
}

/// Returns the side that faces the viewer, from the signed doubled area of a screen triangle. In fixed point, this is
/// the area of the *snapped* corners. No other code decides facing.
pub(crate) fn facing(doubled_area: f64) -> Facing {
    if doubled_area < 0.0 {
        Facing::Front
    } else if doubled_area > 0.0 {
        Facing::Back
    } else {
        Facing::Edge
    }
}

/// Returns the reason why a triangle with this signed doubled area is culled, or `None` if it is drawn.
pub(crate) fn cull(doubled_area: f64, culling: Culling) -> Option<Fate> {
    match (facing(doubled_area), culling) {
        (Facing::Edge, _) => Some(Fate::ZeroArea),
        (Facing::Back, Culling::Back) => Some(Fate::BackFacing),
        (Facing::Front, Culling::Front) => Some(Fate::FrontFacing),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::raster::doubled_area;
    use crate::pipeline::settings::Arithmetic;

    #[test]
    fn counter_clockwise_on_screen_is_the_front() {
        // a is at the top, b at the bottom left, c at the bottom right; y points down.
        let (area, _) = doubled_area(Arithmetic::Fixed, [[1.0, 0.0], [0.0, 2.0], [2.0, 2.0]]);
        assert_eq!(facing(area), Facing::Front);
        assert_eq!(cull(area, Culling::Back), None);
        assert_eq!(cull(area, Culling::Front), Some(Fate::FrontFacing));
        assert_eq!(cull(-area, Culling::Back), Some(Fate::BackFacing));
        assert_eq!(cull(0.0, Culling::None), Some(Fate::ZeroArea));
    }
}
