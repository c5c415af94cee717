//! T-junctions and unwelded vertices at their positions in the picture.

use super::sheet::{PixelKind, Sheet, SheetLegend, Total};
use super::{Overlay, OverlayContext};
use crate::image::Image;
use crate::inspect::hits::junction_pixels;
use crate::inspect::view::DOUBLE_HIT;
use crate::scene::seams::{JunctionKind, Seams};

const KINDS: [PixelKind; 2] = [
    PixelKind { name: "T-junction", color: [255, 0, 190, 255], striped: false },
    PixelKind { name: "unwelded vertex", color: DOUBLE_HIT, striped: false },
];

/// Marks the pixels of T-junctions and unwelded vertices whose triangle was rasterized, even if occluded.
pub(super) fn junctions(context: &OverlayContext<'_>) -> Sheet {
    let OverlayContext { scene, recipe, frame, .. } = context;
    let (width, height) = frame.image().size();
    let none = Seams::default();
    let seams = context.seams.unwrap_or(&none);
    let mut values = Image::filled(width, height, f32::NAN);
    let mut counts = [0; 2];
    for (junction, pixel) in seams.junctions().iter().zip(junction_pixels(scene, recipe, frame, seams)) {
        let kind = usize::from(junction.kind == JunctionKind::Unwelded);
        if let Some((x, y)) = pixel {
            counts[kind] += 1;
            values.set(x, y, kind as f32);
        }
    }
    let totals = KINDS.iter().zip(counts).map(|(kind, count)| Total {
        name: kind.name,
        number: f64::from(count),
        unit: "in the picture",
    });
    let counts = seams.counts();
    let whole = [("T-junctions of the scene", counts.t_junctions), ("unwelded vertices of the scene", counts.unwelded)];
    let whole = whole.map(|(name, count)| Total { name, number: count as f64, unit: "" });
    Sheet::new(Overlay::Junctions, values, SheetLegend::Kinds(&KINDS), totals.chain(whole).collect())
}
