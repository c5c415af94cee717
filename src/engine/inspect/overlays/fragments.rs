//! Fragment counts of each pixel (rasterized, passed, visible), and outcomes of its depth tests.

use super::sheet::{ColorScale, PixelKind, Sheet, SheetLegend, Total};
use super::{Overlay, OverlayContext};
use crate::image::Image;
use crate::inspect::display::ColorMap;
use crate::inspect::view::Range;

/// Combined outcomes of a pixel's depth tests.
const OUTCOMES: [PixelKind; 3] = [
    PixelKind { name: "all passed", color: [40, 120, 230, 255], striped: false },
    PixelKind { name: "some rejected", color: [240, 150, 20, 255], striped: false },
    PixelKind { name: "all rejected", color: [200, 40, 40, 255], striped: false },
];

/// Shows the number of rasterized, passed or visible fragments at each pixel.
pub(super) fn count(overlay: Overlay, context: &OverlayContext<'_>) -> Sheet {
    let watched = context.stats();
    let counts = match overlay {
        Overlay::Passed => &watched.passed,
        Overlay::Visible => &watched.visible,
        _ => &watched.rasterized,
    };
    let values = context.spread(|column, row| positive(counts.at(column, row)));
    let most = counts.pixels().iter().copied().max().unwrap_or(0);
    let range = Range { low: 0.0, high: most.max(1) as f32 };
    let scale = ColorScale { range, logarithmic: false, map: ColorMap::Viridis, reversed: false, unit: "fragments" };
    Sheet::new(overlay, values, SheetLegend::Scale(scale), totals_of(counts))
}

/// Converts a count to an overlay value; zero becomes NaN, which is not drawn.
fn positive(count: u32) -> f32 {
    if count > 0 { count as f32 } else { f32::NAN }
}

fn totals_of(counts: &Image<u32>) -> Vec<Total> {
    let sum: u64 = counts.pixels().iter().map(|count| u64::from(*count)).sum();
    let touched = counts.pixels().iter().filter(|count| **count > 0).count();
    let most = counts.pixels().iter().copied().max().unwrap_or(0);
    vec![
        Total { name: "in all", number: sum as f64, unit: "fragments" },
        Total { name: "pixels touched", number: touched as f64, unit: "px" },
        Total { name: "mean where touched", number: sum as f64 / touched.max(1) as f64, unit: "fragments" },
        Total { name: "most", number: f64::from(most), unit: "fragments" },
    ]
}

/// Shows whether all, some or none of a pixel's fragments passed the depth test.
pub(super) fn depth_test(context: &OverlayContext<'_>) -> Sheet {
    let overlay = Overlay::DepthTest;
    if context.frame.drawn.depth.is_none() {
        return Sheet::absent(overlay, context.frame.image().size(), "the depth test is off");
    }
    let watched = context.stats();
    let values = context.spread(|column, row| {
        let (came, passed) = (watched.rasterized.at(column, row), watched.passed.at(column, row));
        match (came, passed) {
            (0, _) => f32::NAN,
            (_, 0) => 2.0,
            (came, passed) if passed < came => 1.0,
            _ => 0.0,
        }
    });
    let sum = |counts: &Image<u32>| counts.pixels().iter().map(|count| f64::from(*count)).sum::<f64>();
    let (came, passed) = (sum(&watched.rasterized), sum(&watched.passed));
    let totals = vec![
        Total { name: "tested", number: came, unit: "fragments" },
        Total { name: "passed", number: passed, unit: "fragments" },
        Total { name: "rejected", number: came - passed, unit: "fragments" },
    ];
    Sheet::new(overlay, values, SheetLegend::Kinds(&OUTCOMES), totals)
}
