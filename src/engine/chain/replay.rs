//! Samples of single pixels of a frame, drawn again.

use rayon::prelude::*;

use super::samples::{candidates, passes, sampled};
use super::view::{raster_camera, raster_viewport};
use super::{Frame, Recipe};
use crate::image::Rgba8;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::raster::Scissor;
use crate::pipeline::{DrawCall, Extent, Geometry, prepare};
use crate::scene::Scene;

/// Draws the given pixels of a frame again and returns the samples of each, in drawing order. There is one sample per
/// pixel unless the frame is anti-aliased. Pixels that were not drawn have no samples.
pub(crate) fn replay(scene: &Scene, recipe: &Recipe, frame: &Frame, pixels: &[(u32, u32)]) -> Vec<Vec<Rgba8>> {
    let Frame { antialias, sampling, viewport, camera, .. } = frame;
    if antialias.is_off() {
        return replay_pass(scene, recipe, frame, frame.geometry(), pixels)
            .into_iter()
            .map(|s| s.into_iter().collect())
            .collect();
    }
    if antialias.is_per_pixel() {
        return pixels.iter().map(|pixel| replay_pixel(scene, recipe, frame, *pixel)).collect();
    }
    let passes: Vec<Vec<Option<Rgba8>>> = passes(*antialias)
        .into_par_iter()
        .map(|offset| {
            let seen = raster_camera(camera, *sampling, *viewport, offset);
            let geometry = prepare(scene, &seen, &recipe.pipeline, raster_viewport(*sampling, *viewport), &mut ());
            replay_pass(scene, recipe, frame, &geometry, pixels)
        })
        .collect();
    (0..pixels.len()).map(|pixel| passes.iter().filter_map(|pass| pass[pixel]).collect()).collect()
}

/// Draws one sample of each given pixel again, from the triangles in `geometry`. Returns the colour of each pixel, or
/// `None` for a pixel that was not drawn.
fn replay_pass(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    geometry: &Geometry,
    pixels: &[(u32, u32)],
) -> Vec<Option<Rgba8>> {
    let grid = frame.drawn.grid;
    let color = |&(x, y): &(u32, u32)| {
        let sample = grid.sample_at(x, y)?;
        let mut one = Framebuffer::one_sample(grid, sample, scene.background, &recipe.pipeline);
        let extent = Extent { triangles: 0..geometry.triangles.len(), scissor: Scissor::pixel(x, y) };
        DrawCall::new(scene, geometry, &recipe.pipeline, &extent).draw(&mut one, &mut ());
        Some(one.color.at(0, 0))
    };
    pixels.iter().map(color).collect()
}

/// Draws all samples of one pixel again, for a per-pixel method. Returns an empty list if the pixel was not drawn.
fn replay_pixel(scene: &Scene, recipe: &Recipe, frame: &Frame, (x, y): (u32, u32)) -> Vec<Rgba8> {
    let Some(sample) = frame.drawn.grid.sample_at(x, y) else { return Vec::new() };
    let cleared = Framebuffer::one_sample(frame.drawn.grid, sample, scene.background, &recipe.pipeline);
    let extent = Extent { triangles: 0..frame.geometry().triangles.len(), scissor: Scissor::pixel(x, y) };
    let places = candidates(frame.antialias);
    let call = DrawCall::new(scene, frame.geometry(), &recipe.pipeline, &extent);
    let frames = sampled(call, frame.antialias, &places, cleared);
    frames.iter().map(|frame| frame.color.at(0, 0)).collect()
}
