//! Faults of blending: opacity, premultiplied colours, order.

use crate::fault::{Change, Fault, Slot};
use crate::geometry;

pub(super) const FAULTS: &[Fault] = &[
    Fault::error(
        "opacity-ignored",
        "opacity is ignored: all surfaces are opaque",
        Slot::Opacity,
        Change::Setup(|setup| geometry::change_opacity(setup, |_| (1.0, 1.0))),
    ),
    Fault::error(
        "alpha-multiplied-twice",
        "colours are multiplied by alpha twice (premultiplied, but blended as straight)",
        Slot::Opacity,
        Change::Setup(|setup| geometry::change_opacity(setup, |alpha| (alpha, alpha))),
    ),
    Fault::error(
        "alpha-not-multiplied",
        "colours are not multiplied by alpha (straight, but blended as premultiplied)",
        Slot::Opacity,
        Change::Setup(|setup| geometry::change_opacity(setup, |alpha| (alpha, 1.0 / alpha))),
    ),
    Fault::convention(
        "blended-as-submitted",
        "translucent surfaces are blended in the order of the file",
        Slot::BlendingOrder,
        Change::Settings(&["blending.order=objects"]),
    ),
    Fault::convention(
        "blended-by-triangle",
        "translucent triangles are sorted by their mean distance",
        Slot::BlendingOrder,
        Change::Settings(&["blending.order=triangles"]),
    ),
    Fault::convention(
        "blended-exactly",
        "translucent fragments are sorted per pixel",
        Slot::BlendingOrder,
        Change::Settings(&["blending.order=exact"]),
    ),
];
