//! The unit normal as a colour.

use super::{Input, Inputs, Label, ShadingFacts, SurfaceInputs};

pub(super) const FACTS: ShadingFacts = ShadingFacts {
    label: Label {
        id: "normals",
        name: "Normals",
        help: "Unit normal as colour: x, y and z mapped from −1…1 to 0…255.",
        synonyms: &[],
    },
    reads: Inputs::of(&[Input::Normal]),
};

#[inline(always)]
pub(super) fn color<I: SurfaceInputs>(at: &I) -> [I::Number; 3] {
    at.normal().map(|component| component * at.constant(0.5) + at.constant(0.5))
}
