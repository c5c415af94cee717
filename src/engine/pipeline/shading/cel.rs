//! Cel shading: the light texture where N·L > 0.5 (an angle of less than 60°), and the dark one elsewhere.

use super::{Input, Inputs, Label, LightInputs, ShadingFacts};
use crate::math::real::{Real as _, dot};

/// Value of N·L above which cel shading uses the light texture; at or below it, the dark one.
pub(crate) const THRESHOLD: f32 = 0.5;

/// Factor of the light where N·L is at most [`THRESHOLD`], for materials without a dark texture.
pub(crate) const DARK_FACTOR: f32 = 0.45;

pub(super) const FACTS: ShadingFacts = ShadingFacts {
    label: Label {
        id: "cel",
        name: "Cel",
        help: "Two textures: the light one where N·L > 0.5, the dark one elsewhere.",
        synonyms: &[],
    },
    reads: Inputs::of(&[Input::Normal, Input::LightDirection, Input::DarkTexture]),
};

#[inline(always)]
pub(super) fn light<I: LightInputs>(at: &I) -> I::Number {
    let cosine = dot(&at.normal(), &at.light_direction());
    cosine.choose_above(&at.constant(THRESHOLD), at.constant(1.0), at.dark_factor())
}

/// Returns whether a fragment with this N·L is on the light side.
#[inline(always)]
pub(crate) fn is_lit(cosine: f32) -> bool {
    cosine > THRESHOLD
}
