//! Blinn–Phong shading: Lambert's law, and a highlight that [`crate::pipeline::shade::Highlight`] adds.

pub(super) use super::lambert::light;
use super::{Input, Inputs, Label, ShadingFacts};

pub(super) const FACTS: ShadingFacts = ShadingFacts {
    label: Label {
        id: "blinn-phong",
        name: "Blinn–Phong",
        help: "Lambert plus a highlight: Ks·max(0, N·H)^Ns, with H halfway between the directions to the light and to \
               the eye.",
        synonyms: &[],
    },
    reads: Inputs::of(&[Input::Normal, Input::LightDirection, Input::Ambient, Input::Specular]),
};
