//! Discarded fragments and culled coverage at each pixel, by reason.
//!
//! Clipping is not counted: clipped parts have no coverage.

use super::sheet::{PixelKind, Sheet, SheetLegend, Total};
use super::{Overlay, OverlayContext};
use crate::image::Image;
use crate::inspect::history::Survey;

/// Reasons for discarding fragments. In a tie, the first reason is shown.
const REASONS: [PixelKind; 3] = [
    PixelKind { name: "depth test", color: [230, 60, 50, 255], striped: false },
    PixelKind { name: "alpha test", color: [250, 200, 40, 255], striped: false },
    PixelKind { name: "face culling", color: [60, 120, 235, 255], striped: false },
];

/// Colours each pixel by the most frequent reason for discarding fragments there.
pub(super) fn discarded(context: &OverlayContext<'_>) -> Sheet {
    let OverlayContext { scene, recipe, frame, .. } = context;
    let watched = context.stats();
    let culled = Survey::of(scene, recipe, frame).culled_coverage(&recipe.pipeline, frame);
    let counts = |column: u32, row: u32| {
        let lost_depth = watched.rasterized.at(column, row) - watched.passed.at(column, row);
        [lost_depth, watched.alpha_rejected.at(column, row), culled.at(column, row)]
    };
    let values = context.spread(|column, row| most_frequent(counts(column, row)).map_or(f32::NAN, |kind| kind as f32));
    let of_reasons = [0, 1, 2].map(|kind| context.spread(|column, row| counts(column, row)[kind] as f32));
    let totals = totals(&culled, counts);
    Sheet { counts: of_reasons.into(), ..Sheet::new(Overlay::Discarded, values, SheetLegend::Kinds(&REASONS), totals) }
}

/// Returns the index of the greatest count, the first one in a tie; `None` if all are zero.
fn most_frequent(counts: [u32; 3]) -> Option<usize> {
    let most = counts.into_iter().max().filter(|most| *most > 0)?;
    counts.iter().position(|count| *count == most)
}

/// Returns the number of discarded fragments for each reason and in total, and the number of affected pixels.
fn totals(packed: &Image<u32>, counts: impl Fn(u32, u32) -> [u32; 3]) -> Vec<Total> {
    let (width, height) = packed.size();
    let (mut sums, mut touched) = ([0_u64; 3], 0_u64);
    for (column, row) in (0..height).flat_map(|row| (0..width).map(move |column| (column, row))) {
        let counts = counts(column, row);
        sums.iter_mut().zip(counts).for_each(|(sum, count)| *sum += u64::from(count));
        touched += u64::from(counts != [0; 3]);
    }
    let reasons = REASONS.iter().zip(sums).map(|(reason, sum)| (reason.name, sum, "fragments"));
    let all = [("in all", sums.iter().sum(), "fragments"), ("pixels touched", touched, "px")];
    let total = |(name, number, unit): (&'static str, u64, &'static str)| Total { name, number: number as f64, unit };
    reasons.chain(all).map(total).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_frequent_reason_is_shown_or_the_first_in_a_tie() {
        assert_eq!(most_frequent([0; 3]), None);
        assert_eq!(most_frequent([1, 3, 2]), Some(1));
        assert_eq!(most_frequent([0, 2, 2]), Some(1));
        assert_eq!(most_frequent([2, 2, 2]), Some(0));
    }
}
