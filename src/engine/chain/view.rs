//! Inputs for drawing a view: size and camera of the rasterized picture, and the upscaler's inputs other than colours.

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
use crate::upscale::{FrameInputs, GBuffer, History, Sampling};

/// Returns the sampling of the frame that follows `past`, and the position of the sample within each pixel, in pixels
/// from the pixel's top left corner.
pub(super) fn sampling_after(past: Option<&History>, recipe: &Recipe) -> (Sampling, [f64; 2]) {
    let frames = past.map_or(0, |past| past.frames.wrapping_add(1));
    recipe.upscaler.upscaler().frame_sampling(recipe.upscaler, frames)
}

/// Returns the recipe for drawing the G-buffer at full resolution; `None` unless the upscaler reads a G-buffer and the
/// depth test is on.
pub(super) fn gbuffer_recipe(recipe: &Recipe) -> Option<Recipe> {
    let reads = recipe.upscaler.upscaler().reads().gbuffer && recipe.pipeline.depth_test != DepthTest::Off;
    let pipeline = Settings { shading: Shading::ObjectId, ..recipe.pipeline };
    reads.then_some(Recipe { pipeline, ..Recipe::default() })
}

/// Returns the G-buffer of a view. Reuses the G-buffer of the preceding frame if the camera has not changed. Otherwise
/// converts the result of `draw`, a framebuffer with object colours and depths.
pub(super) fn gbuffer(
    past: Option<&History>,
    camera: &Camera,
    lanes: Lanes,
    draw: impl FnOnce() -> Framebuffer,
) -> Option<Arc<GBuffer>> {
    /// Number of depths converted per parallel task.
    const TOGETHER: usize = 1 << 14;
    if let Some(past) = past.filter(|past| past.camera == *camera) {
        return Some(Arc::clone(&past.surfaces));
    }
    let Framebuffer { color: object, depth, depth_scale: scale, .. } = draw();
    let mut distance = depth?;
    distance.pixels_mut().par_chunks_mut(TOGETHER).for_each(|depths| scale.replace_by_distances(lanes, depths));
    Some(Arc::new(GBuffer { object, distance }))
}

/// Returns the upscaler's inputs other than colours, or `None` if there is no G-buffer.
pub(super) fn frame_inputs<'a>(
    surfaces: Option<&'a GBuffer>,
    camera: &'a Camera,
    past: Option<&'a History>,
) -> Option<FrameInputs<'a>> {
    surfaces.map(|surfaces| FrameInputs { gbuffer: surfaces, camera, history: past })
}

/// Returns the size, in pixels, of the picture that is rasterized before upscaling.
pub(super) fn raster_viewport(sampling: Sampling, Viewport { width, height }: Viewport) -> Viewport {
    let (width, height) = sampling.raster_size(width, height);
    Viewport { width, height }
}

/// Returns the camera of the picture that is rasterized before upscaling. The sample of each rasterized pixel lies at
/// `place`, in pixels from the pixel's top left corner.
pub(super) fn raster_camera(camera: &Camera, sampling: Sampling, viewport: Viewport, place: [f64; 2]) -> Camera {
    samples::jittered_camera(camera, sampling, viewport, place).unwrap_or(*camera)
}

/// Returns the triangles of the full picture if the wireframe needs them and the rasterized picture is smaller, else
/// `None`.
pub(super) fn outlines(scene: &Scene, camera: &Camera, recipe: &Recipe, viewport: Viewport) -> Option<TriangleList> {
    let drawn_smaller = matches!(recipe.upscaler.sampling(), Sampling::Lattice(_));
    (recipe.wireframe && drawn_smaller).then(|| prepare(scene, camera, &recipe.pipeline, viewport, &mut ()).triangles)
}
