//! Pixels whose blended fragments were drawn in the wrong order.

use super::sheet::{PixelKind, Sheet, SheetLegend, Total};
use super::{Overlay, OverlayContext};
use crate::inspect::blending::{Misordered, misordered};

const KINDS: [PixelKind; 2] = [
    PixelKind { name: "different colour", color: [255, 0, 190, 255], striped: false },
    PixelKind { name: "same colour", color: [48, 132, 255, 255], striped: false },
];

/// Marks the pixels at whose centres a fragment was blended over a nearer one.
pub(super) fn blend_order(context: &OverlayContext<'_>) -> Sheet {
    let wrong = misordered(context.scene, context.recipe, context.frame);
    let kinds = [Misordered::Visible, Misordered::Harmless];
    let number = |column, row| {
        let kind = kinds.iter().position(|kind| wrong.at(column, row) == Some(*kind));
        kind.map_or(f32::NAN, |kind| kind as f32)
    };
    let count = |kind| wrong.pixels().iter().filter(|found| **found == Some(kind)).count() as f64;
    let totals = KINDS.iter().zip(kinds).map(|(key, kind)| Total { name: key.name, number: count(kind), unit: "px" });
    Sheet::new(Overlay::BlendOrder, context.spread(number), SheetLegend::Kinds(&KINDS), totals.collect())
}
