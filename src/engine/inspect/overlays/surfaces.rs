//! Properties of the visible triangle at each pixel: facing, area, minimum height, texel density.

use super::sheet::{ColorScale, PixelKind, Sheet, SheetLegend, Total};
use super::watch::{VisibleSurface, area_and_height, corners_px};
use super::{Overlay, OverlayContext};
use crate::inspect::display::ColorMap;
use crate::inspect::view::Range;
use crate::pipeline::viewport::Viewport;

/// Kinds of pixels of the facing overlay.
const SIDES: [PixelKind; 2] = [
    PixelKind { name: "front", color: [40, 120, 230, 255], striped: false },
    PixelKind { name: "back", color: [240, 150, 20, 255], striped: false },
];

/// Triangle area at the low end of the colour scale, in px².
const MIN_AREA_PX2: f32 = 0.01;

/// Triangle height at the low end of the colour scale, in px: a quarter of the snapping step.
const MIN_HEIGHT_PX: f32 = 1.0 / 1024.0;

/// Area (px²) or height (px) below which triangles count as small or thin.
const ONE_PX: f64 = 1.0;

/// Texel densities at both ends of the colour scale, in texels per pixel: the same factor below and above 1.
const DENSITIES: Range = Range { low: 1.0 / 16.0, high: 16.0 };

/// Shows whether the visible triangle at each pixel is front-facing.
pub(super) fn facing(context: &OverlayContext<'_>) -> Sheet {
    let surfaces = &context.stats().surface;
    let values = context.spread(|column, row| {
        let VisibleSurface { area_px2, is_front, .. } = surfaces.at(column, row);
        if area_px2.is_nan() { f32::NAN } else { f32::from(u8::from(!is_front)) }
    });
    let seen = surfaces.pixels().iter().filter(|surface| !surface.area_px2.is_nan());
    let front = seen.clone().filter(|surface| surface.is_front).count();
    let totals = vec![
        Total { name: "front", number: front as f64, unit: "px" },
        Total { name: "back", number: (seen.count() - front) as f64, unit: "px" },
    ];
    Sheet::new(Overlay::Facing, values, SheetLegend::Kinds(&SIDES), totals)
}

/// Shows the area of the visible triangle at each pixel, in px².
pub(super) fn size(context: &OverlayContext<'_>) -> Sheet {
    let surfaces = &context.stats().surface;
    let values = context.spread(|column, row| surfaces.at(column, row).area_px2);
    let Viewport { width, height } = context.frame.raster;
    let range = Range { low: MIN_AREA_PX2, high: (width as f32 * height as f32).max(1.0) };
    let key = SheetLegend::Scale(log_scale(range, ColorMap::Viridis, true, "px²"));
    Sheet::new(Overlay::TriangleSize, values, key, triangles(context, 0, "smaller than 1 px²", "px²"))
}

/// Shows the minimum height of the visible triangle at each pixel, in px.
pub(super) fn sliver(context: &OverlayContext<'_>) -> Sheet {
    let surfaces = &context.stats().surface;
    let values = context.spread(|column, row| surfaces.at(column, row).height_px);
    let Viewport { width, height } = context.frame.raster;
    let range = Range { low: MIN_HEIGHT_PX, high: width.max(height).max(1) as f32 };
    let key = SheetLegend::Scale(log_scale(range, ColorMap::Viridis, true, "px high"));
    Sheet::new(Overlay::Sliver, values, key, triangles(context, 1, "thinner than 1 px", "px"))
}

/// Shows the texel density of the visible triangle at each pixel, in texels per pixel.
pub(super) fn texel_density(context: &OverlayContext<'_>) -> Sheet {
    let surfaces = &context.stats().surface;
    let values = context.spread(|column, row| surfaces.at(column, row).texels_per_px);
    let known: Vec<f64> =
        surfaces.pixels().iter().map(|s| f64::from(s.texels_per_px)).filter(|density| !density.is_nan()).collect();
    if known.is_empty() {
        return Sheet::absent(Overlay::TexelDensity, values.size(), "no textured surface is visible");
    }
    let skipping = known.iter().filter(|density| **density > 1.0).count();
    let totals = vec![
        Total { name: "textured", number: known.len() as f64, unit: "px" },
        Total { name: "above 1 texel per pixel", number: skipping as f64, unit: "px" },
        Total { name: "mean", number: known.iter().sum::<f64>() / known.len() as f64, unit: "texels per px" },
    ];
    let key = SheetLegend::Scale(log_scale(DENSITIES, ColorMap::Diverging, false, "texels per px"));
    Sheet::new(Overlay::TexelDensity, values, key, totals)
}

fn log_scale(range: Range, map: ColorMap, reversed: bool, unit: &'static str) -> ColorScale {
    ColorScale { range, logarithmic: true, map, reversed, unit }
}

/// Returns totals of all rasterized triangles, visible or not. They are the number of triangles, the number of small or
/// thin ones, and the minimum, median and maximum of their areas (`which` = 0) or minimum heights (`which` = 1).
fn triangles(context: &OverlayContext<'_>, which: usize, small: &'static str, unit: &'static str) -> Vec<Total> {
    let arithmetic = context.recipe.pipeline.arithmetic;
    let triangles = &context.frame.geometry().triangles;
    let mut sizes: Vec<f64> =
        triangles.iter().map(|triangle| area_and_height(&corners_px(triangle, arithmetic))[which]).collect();
    sizes.sort_by(f64::total_cmp);
    let mut totals = vec![
        Total { name: "triangles", number: sizes.len() as f64, unit: "" },
        Total { name: small, number: sizes.partition_point(|size| *size < ONE_PX) as f64, unit: "" },
    ];
    if let (Some(least), Some(greatest)) = (sizes.first(), sizes.last()) {
        totals.push(Total { name: "least", number: *least, unit });
        totals.push(Total { name: "median", number: sizes[sizes.len() / 2], unit });
        totals.push(Total { name: "greatest", number: *greatest, unit });
    }
    totals
}
