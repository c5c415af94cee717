//! Checkerboard in texture space.

use super::{CheckerInputs, Input, Inputs, Label, ShadingFacts, SurfaceInputs};
use crate::math::real::Real as _;

pub(super) const FACTS: ShadingFacts = ShadingFacts {
    label: Label {
        id: "checker",
        name: "Checker",
        help: "Checkerboard computed from the texture coordinates, without reading a texture.",
        synonyms: &[],
    },
    reads: Inputs::of(&[Input::Uv, Input::Checker]),
};

#[inline(always)]
pub(super) fn color<I: SurfaceInputs>(at: &I) -> [I::Number; 3] {
    let CheckerInputs { squares, even, odd } = at.checker();
    let half = at.constant(0.5);
    let [x, y] = at.uv().map(|coordinate| (coordinate * squares.clone()).floor());
    let halves = (x + y) * half.clone();
    // The fractional part is 0 or ½, without rounding.
    let fraction = halves.clone() - halves.floor();
    let [r, g, b] = even;
    let [odd_r, odd_g, odd_b] = odd;
    [(r, odd_r), (g, odd_g), (b, odd_b)].map(|(even, odd)| half.choose_above(&fraction, even, odd))
}
