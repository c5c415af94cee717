//! One colour per triangle.

use super::{FlatInputs, Inputs, Label, ShadingFacts};
use crate::image::Rgba8;
use crate::scene::TriangleId;

pub(super) const FACTS: ShadingFacts = ShadingFacts {
    label: Label {
        id: "triangle-id",
        name: "Triangle id",
        help: "One colour per triangle, from a hash of its id.",
        synonyms: &[],
    },
    reads: Inputs::of(&[]),
};

#[inline(always)]
pub(super) fn color(at: &FlatInputs) -> Rgba8 {
    if at.exact_ids { at.triangle.0.to_le_bytes() } else { id_color(at.triangle) }
}

/// Returns a colour that represents an identifier. Consecutive identifiers get visibly different colours, and no
/// channel is below 64.
pub(crate) fn id_color(id: TriangleId) -> Rgba8 {
    // Fibonacci hashing (Knuth, The Art of Computer Programming 3, 6.4) spreads consecutive numbers far apart.
    let hash = id.0.wrapping_add(1).wrapping_mul(0x9E37_79B9);
    let [a, b, c, _] = (hash ^ hash >> 15).to_be_bytes();
    let visible = |byte: u8| 64 + (u16::from(byte) * 191 / 255) as u8;
    [visible(a), visible(b), visible(c), 255]
}
