//! Texture coordinates as a colour.

use super::{Input, Inputs, Label, ShadingFacts, SurfaceInputs};
use crate::math::real::Real as _;

pub(super) const FACTS: ShadingFacts = ShadingFacts {
    label: Label {
        id: "uv",
        name: "Texture coordinates",
        help: "Fractional part of u as red, of v as green.",
        synonyms: &[],
    },
    reads: Inputs::of(&[Input::Uv]),
};

#[inline(always)]
pub(super) fn color<I: SurfaceInputs>(at: &I) -> [I::Number; 3] {
    let [u, v] = at.uv().map(|coordinate| coordinate.clone() - coordinate.floor());
    [u, v, at.constant(0.0)]
}
