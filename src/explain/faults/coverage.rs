//! Faults in coverage: fill rules, algorithms as published, culling.

use crate::fault::{Change, Fault, Slot};

pub(super) const FAULTS: &[Fault] = &[
    Fault::error(
        "culling-front",
        "front faces are culled instead of back faces (other winding)",
        Slot::Culling,
        Change::Settings(&["culling=front"]),
    ),
    Fault::error("culling-none", "back faces are not culled", Slot::Culling, Change::Settings(&["culling=none"])),
    Fault::error("culling-back", "back faces are culled", Slot::Culling, Change::Settings(&["culling=back"])),
    Fault::error(
        "fill-inclusive",
        "pixels on an edge belong to both triangles (double edges)",
        Slot::Coverage,
        Change::Settings(&["fill-rule=inclusive"]),
    ),
    Fault::error(
        "fill-exclusive",
        "pixels on an edge belong to no triangle (cracks)",
        Slot::Coverage,
        Change::Settings(&["fill-rule=exclusive"]),
    ),
    Fault::convention(
        "fill-top-right",
        "the fill rule is top-right instead of top-left",
        Slot::Coverage,
        Change::Settings(&["fill-rule=top-right"]),
    ),
    Fault::convention(
        "fill-bottom-left",
        "the fill rule is bottom-left instead of top-left",
        Slot::Coverage,
        Change::Settings(&["fill-rule=bottom-left"]),
    ),
    Fault::convention(
        "fill-bottom-right",
        "the fill rule is bottom-right instead of top-left",
        Slot::Coverage,
        Change::Settings(&["fill-rule=bottom-right"]),
    ),
    Fault::error(
        "rasterizer-bounding-box-published",
        "the rasterizer is the commonly published bounding box loop, with its faults",
        Slot::Coverage,
        Change::Settings(&["rasterizer=bounding-box-published"]),
    ),
    Fault::error(
        "rasterizer-scanline-published",
        "the rasterizer is the commonly published scanline loop, with its faults",
        Slot::Coverage,
        Change::Settings(&["rasterizer=scanline-published"]),
    ),
];
