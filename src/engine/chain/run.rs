//! Frames drawn by the classic execution, and their stages run again, with an [`Observer`] that receives every step.

use super::driver::FrameRequest;
use super::executor::{ClassicExecutor, Drawing};
use super::pool::BufferPool;
use super::{Frame, KeepDepth, Recipe};
use crate::math::lanes::Lanes;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::observe::Observer;
use crate::pipeline::viewport::Viewport;
use crate::pipeline::{Geometry, LastStage, prepare};
use crate::scene::{Camera, Scene};

/// Draws one frame of the viewport's size with the classic execution. `observer` receives one sample per pixel, at the
/// pixel's centre, even if the pixel has several samples. Cannot fail, because every scene is renderable.
///
/// # Examples
/// ```
/// use rasterscope_engine::chain::{Recipe, run};
/// use rasterscope_engine::pipeline::observe::Counters;
/// # use rasterscope_engine::pipeline::viewport::Viewport;
/// # use rasterscope_engine::scene::builtin;
///
/// let scene = builtin::by_id("interpenetrating").unwrap().build();
/// let (recipe, viewport) = (Recipe::default(), Viewport { width: 64, height: 36 });
/// let mut counters = Counters::default();
/// let frame = run(&scene, &scene.home, &recipe, viewport, &mut counters);
///
/// assert_eq!(frame.rasterized(), 2);
/// assert!(counters.shaded > 0 && counters.passed <= counters.covered);
/// assert_eq!(counters.shaded, counters.passed, "both triangles are opaque");
/// ```
pub fn run<O: Observer>(
    scene: &Scene,
    camera: &Camera,
    recipe: &Recipe,
    viewport: Viewport,
    observer: &mut O,
) -> Frame {
    let (keep_depth, past, lanes) = (KeepDepth::Yes, None, Lanes::best());
    let request = FrameRequest { scene, camera, recipe, viewport, keep_depth, past, lanes };
    request.draw(ClassicExecutor::new(observer), &mut BufferPool::default())
}

/// Draws a frame as [`run`] does, without an observer. Not generic, so that it is compiled with the optimisations of this
/// crate, whichever crate calls it.
pub fn run_unobserved(scene: &Scene, camera: &Camera, recipe: &Recipe, viewport: Viewport) -> Frame {
    run(scene, camera, recipe, viewport, &mut ())
}

/// Draws the triangles of a frame again into a new framebuffer, up to the stage `until`. `recipe` may differ from the
/// frame's recipe only in per-sample settings, such as depth test and shading. Transparency does not change:
/// fragments that failed the alpha test stay discarded, and blended fragments are drawn last and do not write depth.
pub(crate) fn redraw<O: Observer>(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    until: LastStage,
    observer: &mut O,
) -> Framebuffer {
    let area = frame.drawn_area();
    Drawing { scene, settings: &recipe.pipeline, geometry: frame.geometry(), area }.draw(until, observer)
}

/// Runs the geometry stages of a frame again with an observer, for all triangles, even if the frame's own list was
/// truncated. `recipe` must have the upscaler of the frame's recipe; all other settings may differ.
pub(crate) fn prepare_again<O: Observer>(scene: &Scene, recipe: &Recipe, frame: &Frame, observer: &mut O) -> Geometry {
    prepare(scene, &frame.drawn_from(recipe), &recipe.pipeline, frame.raster, observer)
}
