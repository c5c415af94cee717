//! Renderer: draws successive frames on all threads.

use std::sync::{Arc, OnceLock};
use std::time::Instant;

use super::finish::{Finished, Spare, finish};
use super::frame::{FrameBuffers, LazyGeometry};
use super::pixel_samples::with_pixel_samples;
use super::run::{Passes, mean_of_passes, run_after};
use super::view::{gbuffer_recipe, outlines, raster_camera, raster_viewport, sampling_after, surfaces};
use super::{Frame, FrameTimes, Recipe};
use crate::image::{Image, Rgba8};
use crate::math::lanes::Lanes;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::gbuffer::GBuffer;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::motion::{FrameView, MotionVectors};
use crate::pipeline::prepare;
use crate::pipeline::settings::{Execution, Settings};
use crate::pipeline::tiled::{self, PixelSamples, TiledReport};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};
use crate::upscale::{Accumulated, History, UpscaleInputs};

/// Renderer that draws frames according to recipes and reuses buffers from frame to frame. With the tiled execution, it
/// uses all threads.
///
/// # Examples
/// ```
/// use std::sync::Arc;
///
/// use rasterscope_engine::chain::{KeepDepth, Recipe, Renderer};
/// # use rasterscope_engine::pipeline::viewport::Viewport;
/// # use rasterscope_engine::scene::builtin;
///
/// let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
/// let (recipe, viewport) = (Recipe::default(), Viewport { width: 64, height: 36 });
/// let mut renderer = Renderer::default();
/// let first = renderer.render(&scene, &scene.home, &recipe, viewport, KeepDepth::Yes);
/// let picture = first.image().clone();
///
/// // The second frame is drawn into the buffers of the first one.
/// renderer.recycle(first);
/// let second = renderer.render(&scene, &scene.home, &recipe, viewport, KeepDepth::Yes);
/// assert_eq!(*second.image(), picture);
/// ```
#[derive(Debug)]
pub struct Renderer {
    memory: tiled::TiledMemory,
    lanes: Lanes,
    /// Buffer for drawn colours, to be reused by the next frame.
    spare: Option<Image<Rgba8>>,
    /// Buffers for the full picture of an upscaled frame and for the upscaler's history, to be reused by the next
    /// frame.
    spare_full: Spare,
    /// Buffer for depths, to be reused by the next frame.
    spare_depth: Option<Image<f32>>,
    /// Buffer for the picture of an upscaler's history, to be reused by the next frame.
    spare_picture: Option<Image<Rgba8>>,
    spare_surfaces: Option<GBuffer>,
    spare_motion: Option<MotionVectors>,
    /// Preceding frame; `None` unless the upscaler of that frame reads history.
    past: Option<PreviousFrame>,
}

/// History of the preceding frame, with the inputs of that frame. The next frame reads the history only if it has the
/// same inputs.
#[derive(Debug)]
struct PreviousFrame {
    recipe: Recipe,
    viewport: Viewport,
    history: Arc<History>,
}

impl Default for Renderer {
    fn default() -> Self {
        Self {
            memory: tiled::TiledMemory::default(),
            lanes: Lanes::best(),
            spare: None,
            spare_full: Spare::default(),
            spare_depth: None,
            spare_picture: None,
            spare_surfaces: None,
            spare_motion: None,
            past: None,
        }
    }
}

/// Whether the depth buffer of a frame is kept after drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeepDepth {
    /// The depths are kept with the frame.
    Yes,
    /// The depths may be discarded after their last use in drawing.
    No,
}

impl Renderer {
    /// Returns a renderer that uses the given SIMD instruction set.
    pub(crate) fn on(lanes: Lanes) -> Self {
        Self { lanes, ..Self::default() }
    }

    /// Draws one frame of the viewport's size, on the threads of the current rayon pool.
    pub fn render(
        &mut self,
        scene: &Arc<Scene>,
        camera: &Camera,
        recipe: &Recipe,
        viewport: Viewport,
        keep_depth: KeepDepth,
    ) -> Frame {
        let same = |past: &PreviousFrame| {
            scene.is_pose_of(&past.history.scene) && past.recipe == *recipe && past.viewport == viewport
        };
        let past = self.past.take().filter(same).map(|past| past.history);
        let mut frame = if execution(scene, recipe).0 == Execution::Classic {
            run_after((past, std::mem::take(&mut self.spare_full)), scene, camera, recipe, viewport, &mut ())
        } else {
            self.render_tiled(past, scene, camera, recipe, viewport, keep_depth)
        };
        let finished = Instant::now();
        self.past = frame.take_history(scene, recipe, self.spare_picture.take()).map(|history| PreviousFrame {
            recipe: *recipe,
            viewport,
            history: Arc::new(history),
        });
        let remembering = finished.elapsed();
        frame.times.upscale += remembering;
        frame.times.total += remembering;
        frame
    }

    /// Discards the history, so that the next frame is drawn like a first one.
    pub fn forget_history(&mut self) {
        self.past = None;
    }

    /// Draws a view repeatedly until the upscaler's history has converged, and returns the last frame. Draws only one
    /// frame if the upscaler reads no history.
    pub fn render_converged(
        &mut self,
        scene: &Arc<Scene>,
        camera: &Camera,
        recipe: &Recipe,
        viewport: Viewport,
    ) -> Frame {
        let mut frame = self.render(scene, camera, recipe, viewport, KeepDepth::Yes);
        while frame.is_converging(recipe) {
            frame = self.render(scene, camera, recipe, viewport, KeepDepth::Yes);
        }
        frame
    }

    fn render_tiled(
        &mut self,
        past: Option<Arc<History>>,
        scene: &Arc<Scene>,
        camera: &Camera,
        recipe: &Recipe,
        viewport: Viewport,
        keep_depth: KeepDepth,
    ) -> Frame {
        let start = Instant::now();
        let settings = &recipe.pipeline;
        let (sampling, place) = sampling_after(past.as_deref(), recipe);
        let raster = raster_viewport(sampling, viewport);
        let seen_by = raster_camera(camera, sampling, viewport, place);
        let grid = sampling.grid();
        let geometry = {
            let (scene, settings) = (Arc::clone(scene), *settings);
            let make = Arc::new(move || prepare(&scene, &seen_by, &settings, raster, &mut ()));
            LazyGeometry { made: OnceLock::new(), make }
        };
        // Without supersampling passes, this draw gives the colours. If depths are kept, it also gives the depths.
        let one_pass = !recipe.antialias.has_passes();
        let mut centres = (one_pass || keep_depth == KeepDepth::Yes).then(|| {
            let memory = (self.spare.take(), self.spare_depth.take().filter(|_| keep_depth == KeepDepth::Yes));
            with_pixel_samples(recipe.antialias, self.lanes, |samples| {
                self.draw_tiled(scene, &seen_by, settings, (grid, raster, samples), memory, keep_depth)
            })
        });
        let mut passes = centres.as_ref().map(|(_, report)| report.times).unwrap_or_default();
        let Passes { mean, resolve } = mean_of_passes(recipe, (grid, raster), |place, spare| {
            let seen = raster_camera(camera, sampling, viewport, place);
            let memory = (spare.or_else(|| self.spare.take()), None);
            let (mut drawn, report) =
                self.draw_tiled(scene, &seen, settings, (grid, raster, PixelSamples::Centre), memory, KeepDepth::No);
            let color = std::mem::replace(&mut drawn.color, Image::filled(0, 0, [0; 4]));
            passes += report.times;
            centres.get_or_insert((drawn, report));
            color
        });
        let (mut drawn, mut report) = centres.unwrap_or_else(|| {
            self.draw_tiled(scene, &seen_by, settings, (grid, raster, PixelSamples::Centre), (None, None), keep_depth)
        });
        if let Some(mean) = mean {
            self.spare = Some(std::mem::replace(&mut drawn.color, mean));
            report.times = passes;
        }
        let surfaces_begun = Instant::now();
        let surfaces = gbuffer_recipe(recipe).and_then(|shown| {
            let spare = self.spare_motion.take();
            surfaces(past.as_deref(), FrameView { scene, camera }, self.lanes, spare, || {
                let area = (SampleGrid::FULL, viewport, PixelSamples::Centre);
                let memory = self.spare_surfaces.take().map(|GBuffer { object, distance }| (object, distance)).unzip();
                self.draw_tiled(scene, camera, &shown.pipeline, area, memory, KeepDepth::Yes).0
            })
        });
        let surfaces = surfaces.map(|shown| shown.with_reactivity(scene, recipe));
        let drawn_at = Instant::now();
        let outlines = outlines(scene, camera, recipe, viewport);
        let known =
            UpscaleInputs { color: &drawn.color, frame: surfaces.as_ref().map(|shown| shown.inputs(past.as_deref())) };
        let spare = std::mem::take(&mut self.spare_full);
        let Finished { picture, unfiltered, history: memory, transfer, post } =
            finish(recipe, &known, viewport, spare, || outlines.as_ref().unwrap_or_else(|| &geometry.triangles));
        let times = FrameTimes {
            geometry: report.times.transform + report.times.cull,
            pixels: report.times.rasterize + report.times.shade,
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
            geometry,
            plans: Arc::clone(&report.plans),
            viewport,
            raster,
            sampling,
            outlines,
            execution: Execution::Tiled,
            times,
            tiled: Some(report),
        }
    }

    /// Draws the samples of one pass with the tiled execution, and reuses spare buffers.
    fn draw_tiled(
        &mut self,
        scene: &Scene,
        seen: &Camera,
        settings: &Settings,
        (grid, raster, samples): (SampleGrid, Viewport, PixelSamples<'_>),
        memory: (Option<Image<Rgba8>>, Option<Image<f32>>),
        keep_depth: KeepDepth,
    ) -> (Framebuffer, TiledReport) {
        let keep = keep_depth == KeepDepth::Yes;
        let mut drawn = Framebuffer::reusing(grid, raster, memory, settings, keep);
        drawn.depth_scale = DepthScale::of(settings, seen);
        let report = tiled::draw(scene, seen, settings, raster, (&mut drawn, samples), &mut self.memory, self.lanes);
        (drawn, report)
    }

    /// Takes back the buffers of a frame that is no longer needed, for reuse.
    pub fn recycle(&mut self, frame: Frame) {
        let FrameBuffers { drawn, full, history, gbuffer, motion } = frame.into_buffers();
        self.spare_surfaces = gbuffer.or(self.spare_surfaces.take());
        self.spare_motion = motion.or(self.spare_motion.take());
        self.spare = Some(drawn.color);
        self.spare_depth = drawn.depth.or(self.spare_depth.take());
        self.spare_full.full = full.or(self.spare_full.full.take());
        let Some(History { picture, accumulated: memory, surfaces, .. }) = history else { return };
        self.spare_picture = picture;
        self.spare_full.history = memory;
        self.spare_surfaces = Arc::into_inner(surfaces).or(self.spare_surfaces.take());
    }

    /// Returns the size in bytes of the buffers held from frame to frame.
    pub(crate) fn bytes(&self) -> usize {
        self.memory.bytes()
            + self.spare.as_ref().map_or(0, Image::bytes)
            + self.spare_full.full.as_ref().map_or(0, Image::bytes)
            + self.spare_full.history.as_ref().map_or(0, Accumulated::bytes)
            + self.spare_picture.as_ref().map_or(0, Image::bytes)
            + self.spare_surfaces.as_ref().map_or(0, |shown| shown.object.bytes() + shown.distance.bytes())
            + self.spare_motion.as_ref().map_or(0, MotionVectors::bytes)
            + self.spare_depth.as_ref().map_or(0, Image::bytes)
    }
}

/// Returns the execution that is used for a scene and a recipe. If it is not the execution that the recipe selects, the
/// second value is the reason.
pub fn execution(scene: &Scene, recipe: &Recipe) -> (Execution, Option<&'static str>) {
    match recipe.execution {
        Execution::Classic => (Execution::Classic, None),
        Execution::Tiled => match tiled::obstacle(scene, &recipe.pipeline) {
            None => (Execution::Tiled, None),
            why => (Execution::Classic, why),
        },
    }
}
