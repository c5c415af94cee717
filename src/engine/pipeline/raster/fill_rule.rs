//! Fill rules. Each declares its names, and the triangle that owns the pixel centres on an edge.

use crate::pipeline::choice::{Label, registry};

registry! {
    /// Fill rule: decides whether a triangle owns a pixel centre that lies exactly on one of its edges.
    pub FillRule: FillRuleFacts {
        TopLeft = TOP_LEFT;
        TopRight = TOP_RIGHT;
        BottomLeft = BOTTOM_LEFT;
        BottomRight = BOTTOM_RIGHT;
        Inclusive = INCLUSIVE;
        Exclusive = EXCLUSIVE;
    }
}

/// Facts that a fill rule declares about itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FillRuleFacts {
    pub(crate) label: Label,
    pub(crate) owner: EdgeOwner,
}

/// Owner of the pixel centres that lie exactly on the edge between two triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EdgeOwner {
    /// The triangle that lies on one side of the edge.
    Side {
        /// Side of an edge that is not horizontal: 1 if the triangle to the right owns it, −1 if the one to the left.
        right: i8,
        /// Side of a horizontal edge: 1 if the triangle below owns it, −1 if the one above.
        down: i8,
    },
    /// Both triangles.
    Both,
    /// Neither triangle.
    Neither,
}

impl FillRule {
    /// Returns whether exactly one of two triangles that share an edge owns a pixel centre on that edge.
    pub(crate) fn draws_shared_edges_once(self) -> bool {
        matches!(self.facts().owner, EdgeOwner::Side { .. })
    }
}

const TOP_LEFT: FillRuleFacts = FillRuleFacts {
    label: Label {
        id: "top-left",
        name: "Top-left",
        help: "A pixel centre on an edge belongs to the triangle for which it is a top or left edge. Shared edges are \
               drawn exactly once.",
        synonyms: &[],
    },
    owner: EdgeOwner::Side { right: 1, down: 1 },
};

const TOP_RIGHT: FillRuleFacts = FillRuleFacts {
    label: Label {
        id: "top-right",
        name: "Top-right",
        help: "The top-left rule mirrored in x. Also draws shared edges exactly once.",
        synonyms: &[],
    },
    owner: EdgeOwner::Side { right: -1, down: 1 },
};

const BOTTOM_LEFT: FillRuleFacts = FillRuleFacts {
    label: Label {
        id: "bottom-left",
        name: "Bottom-left",
        help: "The top-left rule mirrored in y, as in APIs whose y axis points up. Also draws shared edges exactly \
               once.",
        synonyms: &[],
    },
    owner: EdgeOwner::Side { right: 1, down: -1 },
};

const BOTTOM_RIGHT: FillRuleFacts = FillRuleFacts {
    label: Label {
        id: "bottom-right",
        name: "Bottom-right",
        help: "The top-left rule mirrored in x and y. Also draws shared edges exactly once.",
        synonyms: &[],
    },
    owner: EdgeOwner::Side { right: -1, down: -1 },
};

const INCLUSIVE: FillRuleFacts = FillRuleFacts {
    label: Label {
        id: "inclusive",
        name: "Inclusive",
        help: "Every pixel centre on an edge is drawn. Wrong on purpose: shared edges are drawn twice.",
        synonyms: &[],
    },
    owner: EdgeOwner::Both,
};

const EXCLUSIVE: FillRuleFacts = FillRuleFacts {
    label: Label {
        id: "exclusive",
        name: "Exclusive",
        help: "No pixel centre on an edge is drawn. Wrong on purpose: shared edges leave cracks.",
        synonyms: &[],
    },
    owner: EdgeOwner::Neither,
};
