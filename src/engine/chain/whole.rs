//! Optional parts of drawing a frame that belong to no single draw, such as upscaling and the post filter: whether each
//! part runs, and the reason if it is skipped.

use serde::Serialize;

use super::view::{gbuffer_recipe, raster_viewport, reactivity};
use super::{KeepDepth, Recipe, ViewChange, execution};
use crate::pipeline::plan::PlanStep;
use crate::pipeline::settings::{DepthTest, Execution};
use crate::pipeline::viewport::Viewport;
use crate::scene::Scene;

/// Optional part of drawing a frame that concerns the frame as a whole, not a single draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FramePart {
    /// Rasterizing and shading every pixel of the picture.
    EveryPixel,
    /// Drawing a G-buffer (object and distance of every rasterized pixel), unless the preceding frame had the same view.
    Surfaces,
    /// Finding the motion of every rasterized pixel since the preceding frame.
    Motion,
    /// Giving less weight to the history of surfaces that are blended or have holes.
    ReactiveMask,
    /// Drawing several samples per pixel.
    AntiAliasing,
    /// Storing the depths of the whole picture, not only of the tile that is being drawn.
    KeptDepths,
    /// Filling in pixels that were not drawn.
    Upscaling,
    /// Filtering the finished picture.
    Filter,
    /// Drawing the edges of triangles over the finished picture.
    Wireframe,
}

impl FramePart {
    /// All parts, in the order of the stages.
    pub const ALL: [Self; 9] = [
        Self::EveryPixel,
        Self::Surfaces,
        Self::Motion,
        Self::ReactiveMask,
        Self::AntiAliasing,
        Self::KeptDepths,
        Self::Upscaling,
        Self::Filter,
        Self::Wireframe,
    ];

    /// Returns the display name.
    pub fn name(self) -> &'static str {
        match self {
            Self::EveryPixel => "Every pixel",
            Self::Surfaces => "Full-size G-buffer",
            Self::Motion => "Motion vectors",
            Self::ReactiveMask => "Reactive mask",
            Self::AntiAliasing => "Anti-aliasing",
            Self::KeptDepths => "Stored depths",
            Self::Upscaling => "Upscaling",
            Self::Filter => "Post filter",
            Self::Wireframe => "Wireframe",
        }
    }

    /// Returns whether a frame runs the part, with the reason if it does not.
    pub fn step(self, scene: &Scene, recipe: &Recipe, keep_depth: KeepDepth, since: ViewChange) -> PlanStep {
        let (native, depth_test) = (recipe.upscaler.is_native(), recipe.pipeline.depth_test);
        let tiled = execution(scene, recipe).0 == Execution::Tiled;
        PlanStep::unless(match self {
            Self::EveryPixel => (!native).then_some("the upscaler reads fewer and fills in the rest"),
            Self::Surfaces if gbuffer_recipe(recipe).is_some() => {
                (since == ViewChange::Same).then_some("camera and scene are still: the preceding frame's is kept")
            }
            Self::Surfaces if recipe.upscaler.upscaler().reads().gbuffer => Some("the depth test is off"),
            Self::Surfaces => Some("the upscaler reads no G-buffer"),
            Self::Motion if !recipe.upscaler.upscaler().reads().history => Some("the upscaler reads no history"),
            Self::Motion | Self::KeptDepths if depth_test == DepthTest::Off => Some("the depth test is off"),
            Self::Motion => match since {
                ViewChange::First => Some("there is no preceding frame"),
                ViewChange::Same => Some("camera and scene are still"),
                ViewChange::Changed => None,
            },
            Self::ReactiveMask if !recipe.upscaler.upscaler().reads_reactive_mask() => {
                Some("the upscaler reads no reactive mask")
            }
            Self::ReactiveMask => {
                reactivity(scene, recipe).is_none().then_some("no surface is blended or alpha-tested")
            }
            Self::AntiAliasing => recipe.antialias.is_off().then_some("the setting is one sample per pixel"),
            Self::KeptDepths => {
                (tiled && keep_depth == KeepDepth::No).then_some("nothing reads them after a tile is drawn")
            }
            Self::Upscaling => native.then_some("every pixel is drawn"),
            Self::Filter => recipe.post.is_off().then_some("no filter is selected"),
            Self::Wireframe => (!recipe.wireframe).then_some("wireframe is off"),
        })
    }
}

/// Returns the maximum number of pixels rasterized per frame for a picture of this size.
pub(crate) fn rasterized_pixels(recipe: &Recipe, viewport: Viewport) -> u64 {
    let sampling = recipe.upscaler.sampling();
    let Viewport { width, height } = raster_viewport(sampling, viewport);
    sampling.grid().drawn_pixels(width, height)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::{RenderInputs, Renderer};
    use crate::pipeline::gbuffer::GBuffer;
    use crate::scene::builtin;
    use crate::scene::builtin::workload::layers;
    use crate::upscale::Upscaling;

    /// Picture size in pixels. Width and height are divisible by 3 and 4, so every upscaler's sample grid fits the
    /// picture exactly.
    const SIZE: Viewport = Viewport { width: 96, height: 48 };

    #[test]
    fn only_what_the_upscaler_reads_is_rasterized() {
        let scene = Arc::new(layers(1));
        for upscaler in Upscaling::every() {
            let recipe = Recipe { upscaler, ..Recipe::default() };
            let frame = Renderer::default().render(
                RenderInputs { scene: &scene, camera: &scene.home, recipe: &recipe, viewport: SIZE },
                KeepDepth::No,
            );
            let shaded = frame.tiled.as_ref().unwrap().counts.shaded;
            assert_eq!(shaded, rasterized_pixels(&recipe, SIZE), "{upscaler:?}");
            let all = FramePart::EveryPixel.step(&scene, &recipe, KeepDepth::No, frame.view_change()).runs();
            assert_eq!(all, shaded == 96 * 48 && upscaler.is_native(), "{upscaler:?}");
        }
    }

    #[test]
    fn what_runs_is_what_the_frame_holds() {
        let scene = Arc::new(layers(1));
        for (settings, keep) in [
            (&["depth_test=less"][..], KeepDepth::No),
            (&["depth_test=off"], KeepDepth::Yes),
            (&["upscaler.method=checkerboard-surfaces"], KeepDepth::Yes),
            (&["upscaler.method=checkerboard-surfaces", "depth_test=off"], KeepDepth::Yes),
            (&["execution=classic"], KeepDepth::No),
            (&["upscaler.method=fsr2"], KeepDepth::No),
        ] {
            let mut recipe = Recipe::default();
            recipe.set_all(settings).unwrap();
            let frame = Renderer::default()
                .render(RenderInputs { scene: &scene, camera: &scene.home, recipe: &recipe, viewport: SIZE }, keep);
            let runs = |part: FramePart| part.step(&scene, &recipe, keep, frame.view_change()).runs();
            assert_eq!(runs(FramePart::KeptDepths), frame.drawn.depth.is_some(), "{settings:?}");
            assert_eq!(runs(FramePart::Surfaces), frame.surfaces.is_some(), "{settings:?}");
            let has_mask = frame.surfaces.as_ref().is_some_and(|shown| shown.reactivity.is_some());
            assert_eq!(runs(FramePart::ReactiveMask), has_mask, "{settings:?}");
            assert_eq!(runs(FramePart::Upscaling), !std::ptr::eq(frame.image(), &frame.drawn.color), "{settings:?}");
        }
    }

    #[test]
    fn a_still_view_skips_motion_and_keeps_its_surfaces() {
        let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
        let mut moved = scene.home;
        moved.orbit(0.1, 0.0);
        for (method, reads_history) in [("fsr2", true), ("taa", true), ("native", false)] {
            let upscaler = Upscaling::new(method, if method == "fsr2" { 2 } else { 1 }).unwrap();
            let recipe = Recipe { upscaler, ..Recipe::default() };
            let mut renderer = Renderer::default();
            let mut before: Option<Arc<GBuffer>> = None;
            let changes = [scene.home, moved, moved].map(|camera| {
                let frame = renderer.render(
                    RenderInputs { scene: &scene, camera: &camera, recipe: &recipe, viewport: SIZE },
                    KeepDepth::No,
                );
                let since = frame.view_change();
                let runs = |part: FramePart| part.step(&scene, &recipe, KeepDepth::No, since).runs();
                let surfaces = frame.surfaces.clone();
                let has_motion = surfaces.as_ref().is_some_and(|shown| shown.motion.is_some());
                assert_eq!(runs(FramePart::Motion), has_motion, "{method} {since:?}");
                let now = surfaces.map(|shown| shown.gbuffer);
                let is_kept = matches!((&before, &now), (Some(before), Some(now)) if Arc::ptr_eq(before, now));
                assert_eq!(runs(FramePart::Surfaces), now.is_some() && !is_kept, "{method} {since:?}");
                before = now;
                since
            });
            let expected = [ViewChange::First, ViewChange::Changed, ViewChange::Same];
            assert_eq!(changes, if reads_history { expected } else { [ViewChange::First; 3] }, "{method}");
        }
    }

    #[test]
    fn surfaces_that_are_blended_or_have_holes_are_reactive() {
        let mut recipe = Recipe::default();
        recipe.set("upscaler.method=fsr2").unwrap();
        let mask = |scene: &str, recipe: &Recipe| reactivity(&builtin::by_id(scene).unwrap().build(), recipe);
        assert_eq!(mask("chess", &recipe), None);
        let glass = builtin::by_id("stained-glass").unwrap().build();
        let found = reactivity(&glass, &recipe).unwrap();
        for (instance, found) in glass.instances.iter().zip(found.iter()) {
            let opacity = glass.library.material(instance.material).opacity;
            let expected = if opacity < 1.0 { &[opacity.min(0.9)][..] } else { &[0.0, 0.9] };
            assert!(expected.contains(found), "{found}");
        }
        assert!([0.0, 0.9].iter().all(|some| found.contains(some)), "marble and leaves");
        assert!(mask("leaves", &recipe).unwrap().contains(&0.9));
        recipe.set("shading=normals").unwrap();
        assert_eq!(mask("stained-glass", &recipe), None, "normals are opaque");
        recipe.set_all(&["shading=lambert", "upscaler.method=taa"]).unwrap();
        assert_eq!(mask("stained-glass", &recipe), None, "TAA reads no mask");
    }
}
