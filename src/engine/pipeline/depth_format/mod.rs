//! Formats of the stored depths. Each is a mapping from distance to depth and a number format, with its names; the
//! matrices of the camera, the depth test, the trace and the stability report follow from them.

mod encoding;

pub use encoding::DepthEncoding;

use super::choice::{Label, registry};
use crate::scene::DepthMapping;

registry! {
    /// Format of the stored depths.
    pub DepthFormat: FormatFacts {
        F32 = F32;
        ReversedF32 = REVERSED_F32;
        ReversedInfinite = REVERSED_INFINITE;
        Unorm24 = UNORM24;
        Unorm16 = UNORM16;
        WBuffer = W_BUFFER;
    }
}

/// Facts that a depth format declares about itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FormatFacts {
    pub(crate) label: Label,
    mapping: DepthMapping,
    encoding: DepthEncoding,
}

const F32: FormatFacts = FormatFacts {
    label: Label {
        id: "f32",
        name: "f32",
        help: "z/w as a float, 0 at the near plane and 1 at the far plane. Most of its precision lies close to the \
               near plane.",
        synonyms: &[],
    },
    mapping: DepthMapping::STANDARD,
    encoding: DepthEncoding::F32,
};

const REVERSED_F32: FormatFacts = FormatFacts {
    label: Label {
        id: "reversed-f32",
        name: "Reversed f32",
        help: "z/w as a float, 1 near and 0 far: floats are finest where perspective is coarsest, so distant surfaces \
               z-fight less.",
        synonyms: &[],
    },
    mapping: DepthMapping::REVERSED,
    encoding: DepthEncoding::F32,
};

const REVERSED_INFINITE: FormatFacts = FormatFacts {
    label: Label {
        id: "reversed-infinite",
        name: "Reversed, infinite far",
        help: "Reversed f32 with an infinite far plane: nothing is too far to be drawn. In orthographic views it is \
               the same as reversed f32.",
        synonyms: &[],
    },
    mapping: DepthMapping::REVERSED_INFINITE,
    encoding: DepthEncoding::F32,
};

const UNORM24: FormatFacts = FormatFacts {
    label: Label {
        id: "unorm24",
        name: "unorm24",
        help: "z/w in 24-bit steps, 0 near and 1 far, as on GPUs: in perspective nearly all steps lie close to the \
               near plane.",
        synonyms: &[],
    },
    mapping: DepthMapping::STANDARD,
    encoding: DepthEncoding::Unorm24,
};

const UNORM16: FormatFacts = FormatFacts {
    label: Label {
        id: "unorm16",
        name: "unorm16",
        help: "z/w in 16-bit steps, 0 near and 1 far: surfaces z-fight wherever they are close together.",
        synonyms: &[],
    },
    mapping: DepthMapping::STANDARD,
    encoding: DepthEncoding::Unorm16,
};

const W_BUFFER: FormatFacts = FormatFacts {
    label: Label {
        id: "w-buffer",
        name: "w-buffer",
        help: "Linear distance as a float, 0 at the near plane and 1 at the far plane: its steps are finest at the \
               near plane and at most 2⁻²³ of the distance from it.",
        synonyms: &[],
    },
    mapping: DepthMapping::LINEAR,
    encoding: DepthEncoding::F32,
};

impl DepthFormat {
    /// Returns the mapping from distance along the view direction to stored depth.
    pub const fn mapping(self) -> DepthMapping {
        self.facts().mapping
    }

    /// Returns the number format of stored depths.
    pub const fn encoding(self) -> DepthEncoding {
        self.facts().encoding
    }
}
