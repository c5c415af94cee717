//! Depth as grey.

use super::{Input, Inputs, Label, ShadingFacts, SurfaceInputs};

pub(super) const FACTS: ShadingFacts = ShadingFacts {
    label: Label {
        id: "depth",
        name: "Depth",
        help: "Value that the depth buffer would store, as grey.",
        synonyms: &[],
    },
    reads: Inputs::of(&[Input::Depth]),
};

#[inline(always)]
pub(super) fn color<I: SurfaceInputs>(at: &I) -> [I::Number; 3] {
    let depth = at.depth();
    [depth.clone(), depth.clone(), depth]
}
