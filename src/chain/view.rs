//! What is drawn for a view: how large a picture, seen by which camera, and what the upscaler reads besides.

use std::sync::Arc;

use rayon::prelude::*;

use super::{Recipe, samples};
use crate::math::lanes::Lanes;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::prepare;
use crate::pipeline::settings::{DepthTest, Settings, Shading};
use crate::pipeline::triangle_list::TriangleList;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};
use crate::upscale::{History, Sampling, Seen, Surfaces};

/// What is drawn after another frame, and where in their pixels the samples lie.
pub(super) fn sampling_after(past: Option<&History>, recipe: &Recipe) -> (Sampling, [f64; 2]) {
    let frames = past.map_or(0, |past| past.frames.wrapping_add(1));
    recipe.upscaler.upscaler().sampling_of(recipe.upscaler, frames)
}

/// The recipe that finds which object every pixel shows, if the upscaler reads that and depths are kept.
pub(super) fn shown_in_full(recipe: &Recipe) -> Option<Recipe> {
    let reads = recipe.upscaler.upscaler().reads().surfaces && recipe.pipeline.depth_test != DepthTest::Off;
    let pipeline = Settings { shading: Shading::ObjectId, ..recipe.pipeline };
    reads.then_some(Recipe { pipeline, ..Recipe::default() })
}

/// What the pixels of a view show: what those of the frame before did, if it had the same view, else what is drawn, a picture of
/// objects with its depths.
pub(super) fn surfaces(
    past: Option<&History>,
    camera: &Camera,
    lanes: Lanes,
    draw: impl FnOnce() -> Framebuffer,
) -> Option<Arc<Surfaces>> {
    /// Depths that a thread takes at a time.
    const TOGETHER: usize = 1 << 14;
    if let Some(past) = past.filter(|past| past.camera == *camera) {
        return Some(Arc::clone(&past.surfaces));
    }
    let Framebuffer { color: object, depth, depth_scale: scale, .. } = draw();
    let mut distance = depth?;
    distance.pixels_mut().par_chunks_mut(TOGETHER).for_each(|depths| scale.replace_by_distances(lanes, depths));
    Some(Arc::new(Surfaces { object, distance }))
}

/// What the upscaler may read besides colours.
pub(super) fn seen<'a>(
    surfaces: Option<&'a Surfaces>,
    camera: &'a Camera,
    past: Option<&'a History>,
) -> Option<Seen<'a>> {
    surfaces.map(|surfaces| Seen { surfaces, camera, past })
}

/// Size of the picture that is really drawn.
pub(super) fn raster_of(sampling: Sampling, Viewport { width, height }: Viewport) -> Viewport {
    let (width, height) = sampling.raster_size(width, height);
    Viewport { width, height }
}

/// The camera that sees the picture that is really drawn, with samples at `place` in its pixels.
pub(super) fn camera_of(camera: &Camera, sampling: Sampling, viewport: Viewport, place: [f64; 2]) -> Camera {
    samples::moved_window(camera, sampling, viewport, place).unwrap_or(*camera)
}

/// The triangles of the full picture, where lines over it need them and what is drawn is a smaller one.
pub(super) fn outlines(scene: &Scene, camera: &Camera, recipe: &Recipe, viewport: Viewport) -> Option<TriangleList> {
    let drawn_smaller = matches!(recipe.upscaler.sampling(), Sampling::Lattice(_));
    (recipe.wireframe && drawn_smaller).then(|| prepare(scene, camera, &recipe.pipeline, viewport, &mut ()).triangles)
}
