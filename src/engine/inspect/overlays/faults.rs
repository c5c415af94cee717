//! Cracks and double hits along shared edges and open seams.

use super::sheet::{PixelKind, Sheet, SheetLegend, Total};
use super::{Overlay, OverlayContext};
use crate::image::Image;
use crate::inspect::hits::{FaultKind, Hits};
use crate::inspect::view::{CRACK, DOUBLE_HIT};
use crate::scene::seams::JunctionKind;

const FAULTS: [PixelKind; 2] = [
    PixelKind { name: "crack", color: CRACK, striped: false },
    PixelKind { name: "double hit", color: DOUBLE_HIT, striped: false },
];

/// Marks the cracks and double hits of a frame.
pub(super) fn faults(context: &OverlayContext<'_>) -> Sheet {
    let (width, height) = context.frame.image().size();
    let OverlayContext { scene, recipe, frame, .. } = context;
    let hits = Hits::of(frame, &recipe.pipeline);
    let hits = match context.seams {
        Some(seams) => hits.with_seams(scene, recipe, frame, seams),
        None => hits,
    };
    let mut values = Image::filled(width, height, f32::NAN);
    for fault in hits.faults.iter().filter(|fault| fault.x < width && fault.y < height) {
        values.set(fault.x, fault.y, if fault.kind == FaultKind::Crack { 0.0 } else { 1.0 });
    }
    let totals = vec![
        Total { name: "crack", number: hits.count(FaultKind::Crack) as f64, unit: "px" },
        Total { name: "double hit", number: hits.count(FaultKind::DoubleHit) as f64, unit: "px" },
        Total { name: "at T-junctions", number: hits.count_at(JunctionKind::TJunction) as f64, unit: "px" },
        Total { name: "at unwelded vertices", number: hits.count_at(JunctionKind::Unwelded) as f64, unit: "px" },
        Total { name: "wrong elsewhere", number: hits.elsewhere as f64, unit: "px" },
    ];
    Sheet::new(Overlay::Faults, values, SheetLegend::Kinds(&FAULTS), totals)
}
