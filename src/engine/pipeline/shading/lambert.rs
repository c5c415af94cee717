//! Lambert's law in every pixel: light is ambient + (1 − ambient)·max(0, N·L).

use super::{Input, Inputs, Label, LightInputs, ShadingFacts};
use crate::math::real::{Real, dot};

pub(super) const FACTS: ShadingFacts = ShadingFacts {
    label: Label {
        id: "lambert",
        name: "Lambert",
        help: "Diffuse lighting computed in every pixel, from the interpolated normal.",
        synonyms: &[],
    },
    reads: Inputs::of(&[Input::Normal, Input::LightDirection, Input::Ambient]),
};

#[inline(always)]
pub(super) fn light<I: LightInputs>(at: &I) -> I::Number {
    lambert(&at.normal(), &at.light_direction(), at.ambient())
}

/// Returns the light intensity on a surface by Lambert's law: ambient + (1 − ambient)·max(0, N·L). Both vectors must
/// have unit length.
#[inline(always)]
pub(crate) fn lambert<N: Real>(normal: &[N; 3], light_direction: &[N; 3], ambient: N) -> N {
    let (zero, one) = (ambient.constant(0.0), ambient.constant(1.0));
    ambient.clone() + (one - ambient) * dot(normal, light_direction).max(zero)
}
