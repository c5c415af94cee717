//! Barycentric weights as a colour.

use super::{Input, Inputs, Label, ShadingFacts, SurfaceInputs};

pub(super) const FACTS: ShadingFacts = ShadingFacts {
    label: Label {
        id: "barycentric",
        name: "Barycentric",
        help: "Barycentric weights λ0, λ1, λ2 as red, green, blue.",
        synonyms: &[],
    },
    reads: Inputs::of(&[Input::Weights]),
};

#[inline(always)]
pub(super) fn color<I: SurfaceInputs>(at: &I) -> [I::Number; 3] {
    at.weights()
}
