//! Gouraud shading (Gouraud, "Continuous Shading of Curved Surfaces", 1971): the light of the vertices, interpolated.

use super::{Input, Inputs, Label, LightInputs, ShadingFacts};

pub(super) const FACTS: ShadingFacts = ShadingFacts {
    label: Label {
        id: "gouraud",
        name: "Gouraud",
        help: "Diffuse lighting computed at the vertices and interpolated: depends on the tessellation.",
        synonyms: &[],
    },
    reads: Inputs::of(&[Input::VertexLight]),
};

#[inline(always)]
pub(super) fn light<I: LightInputs>(at: &I) -> I::Number {
    at.vertex_light()
}
