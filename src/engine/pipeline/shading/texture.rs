//! The unlit colour of the material and its texture.

use super::{Inputs, Label, LightInputs, ShadingFacts};

pub(super) const FACTS: ShadingFacts = ShadingFacts {
    label: Label { id: "texture", name: "Texture, unlit", help: "Texture × material colour, unlit.", synonyms: &[] },
    reads: Inputs::of(&[]),
};

#[inline(always)]
pub(super) fn light<I: LightInputs>(at: &I) -> I::Number {
    at.constant(1.0)
}
