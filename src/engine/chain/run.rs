//! Classic execution of a frame: draws one triangle after the other and reports every step to an [`Observer`].

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::finish::{Finished, Spare, finish};
use super::frame::LazyGeometry;
use super::view::{gbuffer_recipe, outlines, raster_camera, raster_viewport, sampling_after, surfaces};
use super::{Frame, FrameTimes, Recipe, samples};
use crate::antialias::resolve::Mean;
use crate::image::{Image, Rgba8};
use crate::math::lanes::Lanes;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::motion::FrameView;
use crate::pipeline::observe::Observer;
use crate::pipeline::settings::Execution;
use crate::pipeline::viewport::Viewport;
use crate::pipeline::{Extent, Geometry, LastStage, draw, prepare};
use crate::scene::{Camera, Scene};
use crate::upscale::{History, UpscaleInputs};

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
    run_after((None, Spare::default()), scene, camera, recipe, viewport, observer)
}

/// Draws a frame as [`run`] does, without an observer. Not generic, so that it is compiled with the optimisations of this
/// crate, whichever crate calls it.
pub fn run_unobserved(scene: &Scene, camera: &Camera, recipe: &Recipe, viewport: Viewport) -> Frame {
    run(scene, camera, recipe, viewport, &mut ())
}

/// Draws a frame as [`run`] does, after a preceding frame of the same scene and recipe, and reuses spare buffers.
pub(super) fn run_after<O: Observer>(
    (past, spare): (Option<Arc<History>>, Spare),
    scene: &Scene,
    camera: &Camera,
    recipe: &Recipe,
    viewport: Viewport,
    observer: &mut O,
) -> Frame {
    let start = Instant::now();
    let (sampling, place) = sampling_after(past.as_deref(), recipe);
    let raster = raster_viewport(sampling, viewport);
    let seen_by = raster_camera(camera, sampling, viewport, place);
    let geometry = prepare(scene, &seen_by, &recipe.pipeline, raster, observer);
    let mut geometry_time = start.elapsed();

    let grid = sampling.grid();
    let pixels_begun = Instant::now();
    let mut drawn = draw_pixels(scene, recipe, &geometry, (grid, raster), LastStage::Shade, observer);
    if recipe.antialias.is_per_pixel() {
        drawn.color = samples::per_pixel(scene, &geometry, recipe, (grid, raster));
    }
    let mut pixels_time = pixels_begun.elapsed();
    let Passes { mean, resolve } = mean_of_passes(recipe, (grid, raster), |place, _| {
        let begun = Instant::now();
        let seen = raster_camera(camera, sampling, viewport, place);
        let geometry = prepare(scene, &seen, &recipe.pipeline, raster, &mut ());
        let prepared = Instant::now();
        let color = draw_pixels(scene, recipe, &geometry, (grid, raster), LastStage::Shade, &mut ()).color;
        geometry_time += prepared - begun;
        pixels_time += prepared.elapsed();
        color
    });
    drawn.color = mean.unwrap_or(drawn.color);
    let surfaces_begun = Instant::now();
    let surfaces = gbuffer_recipe(recipe).and_then(|shown| {
        surfaces(past.as_deref(), FrameView { scene, camera }, Lanes::best(), None, || {
            let geometry = prepare(scene, camera, &shown.pipeline, viewport, &mut ());
            draw_pixels(scene, &shown, &geometry, (SampleGrid::FULL, viewport), LastStage::Shade, &mut ())
        })
    });
    let surfaces = surfaces.map(|shown| shown.with_reactivity(scene, recipe));
    let drawn_at = Instant::now();

    let outlines = outlines(scene, camera, recipe, viewport);
    let known =
        UpscaleInputs { color: &drawn.color, frame: surfaces.as_ref().map(|shown| shown.inputs(past.as_deref())) };
    let Finished { picture, unfiltered, history: memory, transfer, post } =
        finish(recipe, &known, viewport, spare, || outlines.as_ref().unwrap_or(&geometry.triangles));
    let times = FrameTimes {
        geometry: geometry_time,
        pixels: pixels_time,
        resolve,
        surfaces: drawn_at - surfaces_begun,
        transfer,
        upscale: drawn_at.elapsed().saturating_sub(post),
        post,
        total: start.elapsed(),
    };
    Frame {
        finished: picture,
        unfiltered,
        upscaler_history: memory,
        drawn,
        antialias: recipe.antialias,
        camera: *camera,
        surfaces,
        before: None,
        history: past,
        plans: Arc::new(geometry.plans.clone()),
        geometry: LazyGeometry::made(geometry),
        viewport,
        raster,
        sampling,
        outlines,
        execution: Execution::Classic,
        times,
        tiled: None,
    }
}

/// Result of the supersampling passes of a frame.
pub(super) struct Passes {
    /// Mean of the passes; `None` if the recipe has no supersampling passes.
    pub(super) mean: Option<Image<Rgba8>>,
    /// Time spent on averaging, excluding the passes themselves.
    pub(super) resolve: Duration,
}

/// Averages the supersampling passes of a recipe. `pass` draws the picture with one sample per pixel at the given
/// position, in pixels from the pixel's top left corner. Its second argument is the picture of the preceding pass, if
/// any, as a buffer to reuse.
pub(super) fn mean_of_passes(
    recipe: &Recipe,
    (grid, raster): (SampleGrid, Viewport),
    mut pass: impl FnMut([f64; 2], Option<Image<Rgba8>>) -> Image<Rgba8>,
) -> Passes {
    let (width, height) = grid.packed_size(raster.width, raster.height);
    let (mut mean, mut spare, mut resolve) = (None, None, Duration::ZERO);
    for place in samples::passes(recipe.antialias) {
        let picture = pass(place, spare.take());
        let drawn_at = Instant::now();
        mean.get_or_insert_with(|| Mean::new(width, height, recipe.antialias.light)).add(&picture);
        resolve += drawn_at.elapsed();
        spare = Some(picture);
    }
    let drawn_at = Instant::now();
    let mean = mean.map(|mean| mean.picture());
    Passes { mean, resolve: resolve + drawn_at.elapsed() }
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
    let area = (frame.sampling.grid(), frame.raster);
    draw_pixels(scene, recipe, &frame.geometry, area, until, observer)
}

/// Runs the geometry stages of a frame again with an observer, for all triangles, even if the frame's own list was
/// truncated. `recipe` must have the upscaler of the frame's recipe; all other settings may differ.
pub(crate) fn prepare_again<O: Observer>(scene: &Scene, recipe: &Recipe, frame: &Frame, observer: &mut O) -> Geometry {
    prepare(scene, &frame.drawn_from(recipe), &recipe.pipeline, frame.raster, observer)
}

pub(super) fn draw_pixels<O: Observer>(
    scene: &Scene,
    recipe: &Recipe,
    geometry: &Geometry,
    (grid, viewport): (SampleGrid, Viewport),
    until: LastStage,
    observer: &mut O,
) -> Framebuffer {
    let (Viewport { width, height }, settings) = (viewport, &recipe.pipeline);
    let mut drawn = Framebuffer::new(grid, width, height, scene.background, settings);
    draw(scene, geometry, settings, &Extent::all(geometry, viewport), until, &mut drawn, observer);
    drawn.depth_scale = geometry.depth_scale;
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::antialias::settings::{AntialiasMethod, Antialiasing};

    #[test]
    fn the_time_of_averaging_excludes_the_passes() {
        let size = Viewport { width: 4, height: 4 };
        let antialias = Antialiasing { method: AntialiasMethod::Regular, ..Antialiasing::default() };
        let (begun, mut in_passes) = (Instant::now(), Duration::ZERO);
        let passes = mean_of_passes(&Recipe { antialias, ..Recipe::default() }, (SampleGrid::FULL, size), |_, _| {
            let begun = Instant::now();
            std::thread::sleep(Duration::from_millis(2));
            let picture = Image::filled(4, 4, [9, 9, 9, 255]);
            in_passes += begun.elapsed();
            picture
        });
        assert_eq!(passes.mean, Some(Image::filled(4, 4, [9, 9, 9, 255])));
        assert!(passes.resolve + in_passes <= begun.elapsed(), "disjoint");
    }
}
