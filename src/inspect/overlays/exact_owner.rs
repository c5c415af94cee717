//! Where another triangle is seen than exact arithmetic would show.
//!
//! The oracle draws the scene once more with exact predicates on corners that are not snapped, by the plainest rasterizer. It
//! shares projection and depth with the frame; what differs is rounding of corners and of edges, and the fill rule where that
//! one is wrong on purpose.

use super::sheet::{Key, Kind, Sheet, Total};
use super::watch::watch;
use super::{Context, Overlay};
use crate::antialias::settings::{Antialiasing, PostFilter};
use crate::chain::{Recipe, run};
use crate::pipeline::settings::{Arithmetic, Execution, FillRule, Rasterizer, Settings};
use crate::scene::TriangleId;

const DIFFERENCES: [Kind; 3] = [
    Kind { name: "another triangle", color: [255, 0, 190, 255], striped: false },
    Kind { name: "missing", color: [48, 132, 255, 255], striped: false },
    Kind { name: "extra", color: [255, 150, 0, 255], striped: false },
];

/// The recipe of the oracle.
fn oracle(recipe: &Recipe) -> Recipe {
    let Settings { fill_rule, .. } = recipe.pipeline;
    let pipeline = Settings {
        arithmetic: Arithmetic::Exact,
        rasterizer: Rasterizer::BoundingBox,
        fill_rule: if fill_rule.is_sound() { fill_rule } else { FillRule::TopLeft },
        ..recipe.pipeline
    };
    // Owners are those of the centres of pixels, whatever their colours are made of.
    let (antialias, post) = (Antialiasing::default(), PostFilter::default());
    Recipe { execution: Execution::Classic, pipeline, antialias, post, wireframe: false, ..*recipe }
}

/// Where owners differ.
pub(super) fn exact_owner(context: &Context<'_>) -> Sheet {
    let Context { scene, recipe, frame, .. } = context;
    let overlay = Overlay::ExactOwner;
    if !context.is_whole {
        return Sheet::absent(overlay, frame.image().size(), "only some of the triangles are drawn");
    }
    let oracle = oracle(recipe);
    let exact = run(scene, &frame.camera, &oracle, frame.viewport, &mut ());
    if exact.sampling != frame.sampling {
        return Sheet::absent(overlay, frame.image().size(), "this frame's samples depend on the frames before");
    }
    let (drawn, due) = (&context.watched().owner, watch(scene, &oracle, &exact).owner);
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
    Sheet::new(overlay, values, Key::Kinds(&DIFFERENCES), totals.collect())
}
