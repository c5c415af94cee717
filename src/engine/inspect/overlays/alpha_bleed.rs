//! Colour bleeding: colour that straight-alpha texture filtering picks up from transparent texels.
//!
//! The frame's samples are drawn two more times: with the recipe's texture filtering, and with premultiplied filtering.

use super::sheet::{ColorScale, Sheet, SheetLegend, Total};
use super::{Overlay, OverlayContext};
use crate::chain::{Recipe, redraw};
use crate::image::Rgba8;
use crate::inspect::display::ColorMap;
use crate::inspect::view::Range;
use crate::pipeline::LastStage;
use crate::pipeline::settings::{AlphaMode, Settings};

/// Returns the greatest difference between two colours in any channel, in sRGB codes.
fn difference(a: Rgba8, b: Rgba8) -> u8 {
    a.iter().zip(b).map(|(a, b)| a.abs_diff(b)).max().unwrap_or(0)
}

/// Computes the difference between the recipe's texture filtering and premultiplied filtering at each pixel, in sRGB
/// codes.
pub(super) fn alpha_bleed(context: &OverlayContext<'_>) -> Sheet {
    let OverlayContext { scene, recipe, frame, .. } = context;
    let pipeline = Settings { alpha: AlphaMode::Premultiplied, ..recipe.pipeline };
    let premultiplied = Recipe { pipeline, ..**recipe };
    let [drawn, due] =
        [*recipe, &premultiplied].map(|recipe| redraw(scene, recipe, frame, LastStage::Shade, &mut ()).color);
    let codes = |column: u32, row: u32| difference(drawn.at(column, row), due.at(column, row));
    let (width, height) = drawn.size();
    let all = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
    let differing: Vec<u8> = all.map(|(column, row)| codes(column, row)).filter(|codes| *codes > 0).collect();
    let totals = vec![
        Total { name: "bleeding", number: differing.len() as f64, unit: "px" },
        Total { name: "greatest", number: differing.iter().copied().max().unwrap_or(0).into(), unit: "codes" },
    ];
    let values = context.spread(|column, row| match codes(column, row) {
        0 => f32::NAN,
        codes => codes.into(),
    });
    let scale = ColorScale {
        range: Range { low: 1.0, high: 255.0 },
        logarithmic: true,
        map: ColorMap::Magma,
        reversed: false,
        unit: "codes",
    };
    Sheet::new(Overlay::AlphaBleed, values, SheetLegend::Scale(scale), totals)
}
