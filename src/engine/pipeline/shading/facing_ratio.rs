//! Facing ratio: the cosine of the angle between the normal and the direction towards the eye, as grey.

use super::{Input, Inputs, Label, ShadingFacts, SurfaceInputs};
use crate::math::real::dot;

pub(super) const FACTS: ShadingFacts = ShadingFacts {
    label: Label {
        id: "facing-ratio",
        name: "Facing ratio",
        help: "N·V as grey, with V towards the eye: white where the surface faces the viewer, black where it is seen \
               edge-on or from behind.",
        synonyms: &["fresnel", "rim"],
    },
    reads: Inputs::of(&[Input::Normal, Input::EyeDirection]),
};

#[inline(always)]
pub(super) fn color<I: SurfaceInputs>(at: &I) -> [I::Number; 3] {
    let ratio = dot(&at.normal(), &at.eye_direction());
    [ratio.clone(), ratio.clone(), ratio]
}
