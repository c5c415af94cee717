//! Culling: which projected triangles are worth rasterizing.

use super::observe::Fate;
use super::settings::Culling;

/// Which side of a triangle is seen.
///
/// ```text
///      a                 On the screen y runs down. Seen counter-clockwise
///     / \                (a → b → c below), the doubled area
///    b───c               (b − a) × (c − a) is negative: that is the front.
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Facing {
    /// Counter-clockwise for the viewer.
    Front,
    /// Clockwise for the viewer.
    Back,
    /// No area: seen from neither side.
    Edge,
}

/// The side seen, from the doubled signed area as the arithmetic sees it (in fixed point, of the *snapped* corners): the
/// only place that decides it.
pub fn facing(doubled_area: f64) -> Facing {
    if doubled_area < 0.0 {
        Facing::Front
    } else if doubled_area > 0.0 {
        Facing::Back
    } else {
        Facing::Edge
    }
}

/// The fate of a triangle of this doubled area, or `None` if it is to be drawn.
pub fn cull(doubled_area: f64, culling: Culling) -> Option<Fate> {
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
        // a on top, b bottom left, c bottom right; y down.
        let (area, _) = doubled_area(Arithmetic::Fixed, [[1.0, 0.0], [0.0, 2.0], [2.0, 2.0]]);
        assert_eq!(facing(area), Facing::Front);
        assert_eq!(cull(area, Culling::Back), None);
        assert_eq!(cull(area, Culling::Front), Some(Fate::FrontFacing));
        assert_eq!(cull(-area, Culling::Back), Some(Fate::BackFacing));
        assert_eq!(cull(0.0, Culling::None), Some(Fate::ZeroArea));
    }
}
