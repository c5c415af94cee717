//! Rendering of one sample per pixel at a time, towards a converged picture.

use std::sync::Arc;

use super::view::raster_camera;
use super::{KeepDepth, Recipe, RenderInputs, Renderer};
use crate::antialias::pattern::Pattern;
use crate::antialias::resolve::Mean;
use crate::image::{Image, Rgba8};
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::settings::{ColorSpace, TexelFilter as TextureFilter};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};
use crate::upscale::Sampling;

/// Progressive rendering that adds one sample per pixel at a time, so that a caller can show progress and stop. Samples
/// follow the low-discrepancy pattern; a single sample lies at the pixel's centre. The samples are averaged in linear
/// light.
#[derive(Debug)]
pub struct ProgressiveRender {
    scene: Arc<Scene>,
    camera: Camera,
    recipe: Recipe,
    viewport: Viewport,
    places: Vec<[f64; 2]>,
    mean: Mean,
    renderer: Renderer,
}

impl ProgressiveRender {
    /// Starts rendering with only the pipeline settings of the recipe: without upscaler, filter, wireframe and
    /// mip-mapping.
    pub(crate) fn new(scene: &Arc<Scene>, camera: &Camera, recipe: &Recipe, viewport: Viewport, samples: u32) -> Self {
        let mut bare = Recipe { pipeline: recipe.pipeline, execution: recipe.execution, ..Recipe::default() };
        if bare.pipeline.filter.reads_mip_levels() {
            bare.pipeline.filter = TextureFilter::Bilinear;
        }
        Self {
            scene: Arc::clone(scene),
            camera: *camera,
            recipe: bare,
            viewport,
            places: Pattern::LowDiscrepancy { count: samples }.offsets(0, 0),
            mean: Mean::new((viewport.width, viewport.height), ColorSpace::Linear),
            renderer: Renderer::default(),
        }
    }

    /// Draws the next sample of every pixel; returns `false` if none is left.
    pub fn step(&mut self) -> bool {
        let Some(place) = self.places.get(self.mean.samples() as usize) else { return false };
        let seen = raster_camera(&self.camera, Sampling::Grid(SampleGrid::FULL), self.viewport, *place);
        let frame = self.renderer.render(
            RenderInputs { scene: &self.scene, camera: &seen, recipe: &self.recipe, viewport: self.viewport },
            KeepDepth::No,
        );
        self.mean.add(std::slice::from_ref(frame.image()));
        self.renderer.recycle(frame);
        true
    }

    /// Returns the mean of the samples drawn so far, in linear light.
    pub fn linear(&self) -> Image<[f32; 3]> {
        self.mean.linear()
    }

    /// Returns the mean of the samples drawn so far.
    pub fn picture(&self) -> Image<Rgba8> {
        self.mean.picture(&[], None)
    }
}
