//! Number of triangles in the bin of each tile of the tiled renderer.

use super::sheet::{ColorScale, Sheet, SheetLegend, Total};
use super::{Overlay, OverlayContext};
use crate::chain::samples::places_on_grid;
use crate::inspect::display::ColorMap;
use crate::inspect::view::Range;
use crate::pipeline::DrawnView;
use crate::pipeline::tiled::{self, TILE_SIDE};
use crate::upscale::Sampling;

/// Shows the number of triangles that are binned to each tile.
pub(super) fn load(context: &OverlayContext<'_>) -> Sheet {
    let OverlayContext { scene, recipe, frame, .. } = context;
    let absent = |why: &str| Sheet::absent(Overlay::TileLoad, frame.image().size(), why);
    if let Some(why) = tiled::obstacle(scene, &recipe.pipeline) {
        return absent(why);
    }
    let Sampling::Grid(grid) = frame.sampling else {
        return absent("the upscaler draws a smaller picture, whose tiles differ from those of this one");
    };
    let offsets = places_on_grid(frame.antialias).concat();
    let view = DrawnView { scene, camera: &frame.camera, settings: &recipe.pipeline, viewport: frame.raster };
    let counts = tiled::tile_loads(&view, grid, &offsets);
    let most = counts.pixels().iter().copied().max().unwrap_or(0);
    let sum: u64 = counts.pixels().iter().map(|count| u64::from(*count)).sum();
    let empty = counts.pixels().iter().filter(|count| **count == 0).count();
    let values = context.spread(|column, row| counts.at(column / TILE_SIDE, row / TILE_SIDE) as f32);
    let range = Range { low: 0.0, high: most.max(1) as f32 };
    let scale = ColorScale { range, logarithmic: false, map: ColorMap::Viridis, reversed: false, unit: "triangles" };
    let tiles = counts.pixels().len();
    let totals = vec![
        Total { name: "tiles", number: tiles as f64, unit: "" },
        Total { name: "tiles without triangles", number: empty as f64, unit: "" },
        Total { name: "entries", number: sum as f64, unit: "triangles" },
        Total { name: "mean per tile", number: sum as f64 / tiles.max(1) as f64, unit: "triangles" },
        Total { name: "most in a tile", number: f64::from(most), unit: "triangles" },
    ];
    Sheet::new(Overlay::TileLoad, values, SheetLegend::Scale(scale), totals)
}
