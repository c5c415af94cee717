//! Interpolated vertex colours.

use super::{Input, Inputs, Label, ShadingFacts, SurfaceInputs};

pub(super) const FACTS: ShadingFacts = ShadingFacts {
    label: Label {
        id: "vertex-color",
        name: "Vertex colour",
        help: "Interpolated vertex colours, unlit.",
        synonyms: &[],
    },
    reads: Inputs::of(&[Input::VertexColor]),
};

#[inline(always)]
pub(super) fn color<I: SurfaceInputs>(at: &I) -> [I::Number; 3] {
    at.vertex_color()
}
