//! One colour per object.

use super::{FlatInputs, Inputs, Label, ShadingFacts, id_color};
use crate::image::Rgba8;
use crate::scene::TriangleId;

pub(super) const FACTS: ShadingFacts = ShadingFacts {
    label: Label {
        id: "object-id",
        name: "Object id",
        help: "One colour per object, from a hash of its id.",
        synonyms: &[],
    },
    reads: Inputs::of(&[]),
};

#[inline(always)]
pub(super) fn color(at: &FlatInputs) -> Rgba8 {
    id_color(TriangleId(at.instance))
}
