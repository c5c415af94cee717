//! Pixels that show a different triangle than exact arithmetic would.
//!
//! The reference is drawn with exact predicates on unsnapped corners by the bounding-box rasterizer. It shares
//! projection and depth with the frame. Differences come from rounding of corners and edges, or from a deliberately
//! wrong fill rule.

use super::sheet::{PixelKind, Sheet, SheetLegend, Total};
use super::watch::watch;
use super::{Overlay, OverlayContext};
use crate::antialias::settings::{Antialiasing, PostFilter};
use crate::chain::{Recipe, run};
use crate::pipeline::settings::{Arithmetic, Execution, FillRule, Rasterizer, Settings};
use crate::scene::TriangleId;

const DIFFERENCES: [PixelKind; 3] = [
    PixelKind { name: "another triangle", color: [255, 0, 190, 255], striped: false },
    PixelKind { name: "missing", color: [48, 132, 255, 255], striped: false },
    PixelKind { name: "extra", color: [255, 150, 0, 255], striped: false },
];

/// Returns the recipe that draws the exact reference.
fn oracle(recipe: &Recipe) -> Recipe {
    let Settings { fill_rule, .. } = recipe.pipeline;
    let pipeline = Settings {
        arithmetic: Arithmetic::Exact,
        rasterizer: Rasterizer::BoundingBox,
        fill_rule: if fill_rule.draws_shared_edges_once() { fill_rule } else { FillRule::TopLeft },
        ..recipe.pipeline
    };
    // Owners are compared at pixel centres, regardless of anti-aliasing and post filters.
    let (antialias, post) = (Antialiasing::default(), PostFilter::default());
    Recipe { execution: Execution::Classic, pipeline, antialias, post, wireframe: false, ..*recipe }
}

/// Marks pixels whose visible triangle differs from the exact reference.
pub(super) fn exact_owner(context: &OverlayContext<'_>) -> Sheet {
    let OverlayContext { scene, recipe, frame, .. } = context;
    let overlay = Overlay::ExactOwner;
    if !context.is_whole {
        return Sheet::absent(overlay, frame.image().size(), "only some triangles are drawn; draw the whole frame");
    }
    let oracle = oracle(recipe);
    let exact = run(scene, &frame.camera, &oracle, frame.viewport, &mut ());
    if exact.sampling != frame.sampling {
        return Sheet::absent(overlay, frame.image().size(), "the samples of this frame depend on previous frames");
    }
    let (drawn, due) = (&context.stats().owner, watch(scene, &oracle, &exact).owner);
    let kind = |column: u32, row: u32| match (drawn.at(column, row), due.at(column, row)) {
        (drawn, due) if drawn == due => None,
        (TriangleId::NONE, _) => Some(1),
        (_, TriangleId::NONE) => Some(2),
        _ => Some(0),
    };
    let (width, height) = drawn.size();
    let mut counts = [0_u64; 3];
    for kind in (0..height).flat_map(|row| (0..width).map(move |column| (column, row))).filter_map(|(c, r)| kind(c, r))
    {
        counts[kind] += 1;
    }
    let values = context.spread(|column, row| kind(column, row).map_or(f32::NAN, |kind| kind as f32));
    let totals =
        DIFFERENCES.iter().zip(counts).map(|(kind, n)| Total { name: kind.name, number: n as f64, unit: "px" });
    Sheet::new(overlay, values, SheetLegend::Kinds(&DIFFERENCES), totals.collect())
}
