//! Invalid values of the displayed quantity: NaN, infinite, negative, or outside the range.

use super::sheet::{PixelKind, Sheet, SheetLegend, Total};
use super::{Overlay, OverlayContext};
use crate::image::Image;
use crate::inspect::display::{NOT_A_NUMBER, beyond};
use crate::inspect::range::channels;
use crate::inspect::view::Value;

const BAD: [PixelKind; 3] = [
    PixelKind { name: "not a number", color: NOT_A_NUMBER, striped: false },
    PixelKind { name: "infinite", color: [255, 230, 0, 255], striped: false },
    PixelKind { name: "negative", color: [0, 190, 255, 255], striped: true },
];

const CLIPPED: [PixelKind; 3] = [
    PixelKind { name: "below", color: [30, 110, 255, 255], striped: true },
    PixelKind { name: "above", color: [255, 80, 30, 255], striped: true },
    PixelKind { name: "below and above", color: [210, 60, 220, 255], striped: true },
];

/// Returns the index in [`BAD`] of the most severe defect among the channels: NaN, then infinite, then negative.
/// Returns `None` without a defect.
fn badness(value: Value) -> Option<usize> {
    let tests: [fn(f32) -> bool; 3] = [f32::is_nan, f32::is_infinite, |number| number < 0.0];
    tests.iter().position(|test| channels(value).any(test))
}

/// Marks the pixels at which the displayed quantity is NaN, infinite or negative.
pub(super) fn bad_numbers(context: &OverlayContext<'_>) -> Sheet {
    sheet(Overlay::BadNumbers, context, &BAD, badness)
}

/// Marks the pixels at which the displayed quantity lies outside its range.
pub(super) fn clipped(context: &OverlayContext<'_>) -> Sheet {
    let Some(range) = context.range else {
        return Sheet::absent(Overlay::Clipped, context.frame.image().size(), "the displayed quantity has no range");
    };
    sheet(Overlay::Clipped, context, &CLIPPED, |value| match beyond(value, range) {
        (false, false) => None,
        (true, false) => Some(0),
        (false, true) => Some(1),
        (true, true) => Some(2),
    })
}

fn sheet(
    overlay: Overlay,
    context: &OverlayContext<'_>,
    kinds: &'static [PixelKind; 3],
    kind: impl Fn(Value) -> Option<usize>,
) -> Sheet {
    let (width, height) = context.frame.image().size();
    let mut counts = [0_u64; 3];
    let values = Image::from_fn(width, height, |x, y| match kind((context.shown)(x, y)) {
        Some(kind) => {
            counts[kind] += 1;
            kind as f32
        }
        None => f32::NAN,
    });
    let totals = kinds.iter().zip(counts).map(|(kind, n)| Total { name: kind.name, number: n as f64, unit: "px" });
    Sheet::new(overlay, values, SheetLegend::Kinds(kinds), totals.collect())
}
