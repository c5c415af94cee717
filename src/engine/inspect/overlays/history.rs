//! Overlays of the pixels whose history the upscaler rejected, clamped or locked, with their agreement with the exact
//! disocclusion.

use super::sheet::{PixelKind, Sheet, SheetLegend, Total};
use super::{Overlay, OverlayContext};
use crate::image::Image;
use crate::inspect::temporal::{HistoryMask, HistoryMasks, MaskScore};

/// Kinds of pixels in a mask.
const KINDS: [PixelKind; 2] = [
    PixelKind { name: "disoccluded", color: [40, 120, 230, 255], striped: false },
    PixelKind { name: "visible in the preceding frame", color: [240, 150, 20, 255], striped: false },
];

/// Shows a mask. Its colours distinguish disoccluded pixels from those that the preceding frame shows.
pub(super) fn mask(overlay: Overlay, mask: HistoryMask, context: &OverlayContext<'_>) -> Sheet {
    let (width, height) = context.frame.image().size();
    let Some(masks) = HistoryMasks::of(context.scene, context.recipe, context.frame) else {
        let reads_history = context.recipe.upscaler.upscaler().reads().history;
        let why = if reads_history { "the frame has no history" } else { "the upscaler reads no history" };
        return Sheet::absent(overlay, (width, height), why);
    };
    let values = Image::from_fn(width, height, |x, y| {
        let kind = f32::from(u8::from(!masks.is_disoccluded((x, y))));
        if masks.contains(mask, (x, y)) { kind } else { f32::NAN }
    });
    Sheet::new(overlay, values, SheetLegend::Kinds(&KINDS), totals(&masks.score(mask)))
}

fn totals(score: &MaskScore) -> Vec<Total> {
    let percent = |name, fraction: Option<f64>| {
        let number = (fraction? * 1000.0).round() / 10.0;
        Some(Total { name, number, unit: "%" })
    };
    let pixels = Total { name: "pixels", number: score.marked.into(), unit: "px" };
    let found = [percent("precision", score.precision()), percent("recall", score.recall())];
    std::iter::once(pixels).chain(found.into_iter().flatten()).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, OnceLock};

    use super::*;
    use crate::chain::{KeepDepth, MotionBuffers, Recipe, RenderInputs, Renderer};
    use crate::inspect::view::Value;
    use crate::pipeline::motion::FrameView;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;
    use crate::upscale::Upscaling;

    #[test]
    fn the_legend_has_precision_and_recall_against_the_disocclusion() {
        let scene = Arc::new(builtin::by_id("chess-motion").unwrap().build());
        let recipe = Recipe { upscaler: Upscaling::new("taa", 1).unwrap(), ..Recipe::default() };
        let (mut renderer, mut camera) = (Renderer::default(), scene.home);
        let mut frames = Vec::new();
        for _ in 0..2 {
            frames.push(renderer.render(
                RenderInputs {
                    scene: &scene,
                    camera: &camera,
                    recipe: &recipe,
                    viewport: Viewport { width: 64, height: 36 },
                },
                KeepDepth::Yes,
            ));
            camera.orbit(0.05, 0.0);
        }
        let sheet = |frame: usize, overlay: Overlay| {
            overlay.sheet(&OverlayContext {
                scene: &scene,
                recipe: &recipe,
                frame: &frames[frame],
                is_whole: true,
                stats_cache: &OnceLock::new(),
                seams: None,
                shown: &|_, _| Value::Nothing,
                range: None,
            })
        };
        assert_eq!(sheet(0, Overlay::RejectedHistory).absence.as_deref(), Some("the frame has no history"));
        let rejected = sheet(1, Overlay::RejectedHistory);
        let [now, before] = [&frames[1].camera, &scene.home].map(|camera| FrameView { scene: &scene, camera });
        let motion = MotionBuffers::between(now, before, &recipe, frames[1].viewport).unwrap();
        let (mut both, mut marked, mut disoccluded) = (0.0, 0.0, 0.0);
        for (x, y) in (0..36).flat_map(|y| (0..64).map(move |x| (x, y))) {
            let (value, is_stale) = (rejected.values.at(x, y), motion.is_disoccluded(x, y));
            both += f64::from(u8::from(value == 0.0 && is_stale));
            marked += f64::from(u8::from(!value.is_nan()));
            disoccluded += f64::from(u8::from(is_stale));
        }
        let numbers: Vec<_> = rejected.totals.iter().map(|total| total.number).collect();
        let percent = |fraction: f64| (fraction * 1000.0).round() / 10.0;
        assert_eq!(numbers, [marked, percent(both / marked), percent(both / disoccluded)]);
        assert!(both > 20.0 && sheet(1, Overlay::ClampedHistory).totals[0].number > 20.0);
        assert_eq!(sheet(1, Overlay::LockedHistory).totals[0].number, 0.0, "TAA has no locks");
    }
}
