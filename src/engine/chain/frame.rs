//! Finished frame, with its inputs and timings.

use std::fmt;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use super::Recipe;
use super::finish::{Finished, Unfiltered, finish};
use super::pool::BufferPool;
use super::view::{Surfaces, raster_camera, sampling_after};
use crate::antialias::settings::Antialiasing;
use crate::image::{Image, Rgba8};
use crate::pipeline::Geometry;
use crate::pipeline::area::DrawnArea;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::plan::DrawPlan;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::Execution;
use crate::pipeline::tiled::TiledReport;
use crate::pipeline::triangle_list::TriangleList;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};
use crate::upscale::{Accumulated, History, Sampling, UpscaleInputs};

/// Wall-clock time of each part of a frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct FrameTimes {
    /// Time spent in the geometry stages, from plan to cull, summed over all passes.
    pub(crate) geometry: Duration,
    /// Time spent in the pixel stages, from rasterize to shade, summed over all passes; includes the averaging of
    /// samples if sample positions differ from pixel to pixel.
    pub(crate) pixels: Duration,
    /// Time spent averaging the supersampling passes.
    pub(crate) resolve: Duration,
    /// Time spent drawing the G-buffer, for upscalers that read it.
    pub(crate) surfaces: Duration,
    /// Time spent filling in pixels that were not drawn, and storing the frame as history.
    pub(crate) upscale: Duration,
    /// Part of `upscale` that was spent on transfers to and from the process of the upscaler.
    pub(crate) transfer: Duration,
    /// Time spent on the post filter and the wireframe.
    pub(crate) post: Duration,
    /// Total time from the plan to the finished picture.
    pub total: Duration,
}

/// Scene and camera of the frame before another one.
#[derive(Clone, Debug)]
pub struct PrecedingView {
    /// Scene at the time of the preceding frame, a pose of the same scene.
    pub scene: Arc<Scene>,
    /// Camera of the preceding frame.
    pub camera: Camera,
}

/// Finished frame with its inputs and intermediate results.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Finished picture at full resolution; `None` if the drawn picture is already the finished one.
    pub(super) finished: Option<Image<Rgba8>>,
    /// Full-resolution picture before the post filter and the wireframe.
    pub(super) unfiltered: Unfiltered,
    /// History that the upscaler stored; `None` if it stores none, or after it has been moved into a [`History`].
    pub(super) upscaler_history: Option<Accumulated>,
    /// Drawn pixels before upscaling: the colour of each, averaged over its samples, and the depth at its centre.
    pub drawn: Framebuffer,
    /// Anti-aliasing settings of the drawn pixels.
    pub antialias: Antialiasing,
    /// Camera of the view, before it is shifted to the sample positions.
    pub(crate) camera: Camera,
    /// Visible surfaces of the rasterized pixels; `None` unless the upscaler reads them and the depth test is on.
    pub(super) surfaces: Option<Surfaces>,
    /// View of the preceding frame, from which [`Frame::motion`] computes vectors; `None` without a preceding frame. The
    /// renderer leaves it `None`: callers that draw a sequence set it.
    pub before: Option<PrecedingView>,
    /// Preceding frame as history; `None` unless the upscaler reads history and a preceding frame exists.
    pub history: Option<Arc<History>>,
    pub(super) geometry: LazyGeometry,
    /// Draw plans, one per instance.
    pub plans: Arc<Vec<DrawPlan>>,
    /// Size of the full picture, in pixels.
    pub viewport: Viewport,
    /// Size, in pixels, of the picture to which `geometry` and `drawn` belong: the full picture, or a smaller one of
    /// the same view.
    pub raster: Viewport,
    /// Positions of the drawn samples in the full picture.
    pub sampling: Sampling,
    /// Triangles for the wireframe, with corners in pixels of the full picture; `None` unless the wireframe is drawn
    /// and `geometry` belongs to a smaller picture.
    pub(super) outlines: Option<TriangleList>,
    /// Execution mode, classic or tiled, in which the frame was drawn.
    pub execution: Execution,
    /// Wall-clock time of each part of the frame.
    pub times: FrameTimes,
    /// Counts and times of the tiled execution; `None` for the classic one.
    pub tiled: Option<TiledReport>,
}

/// Change of camera or scene since the preceding frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewChange {
    /// There is no preceding frame, or the upscaler does not read it.
    First,
    /// Camera and scene are unchanged.
    Same,
    /// The camera or the scene has moved.
    Changed,
}

impl Frame {
    /// Returns the geometry of the frame, with the list of rasterized triangles. After a tiled execution, which does not
    /// need it in this form, the first call computes it, and later calls return the same.
    pub fn geometry(&self) -> &Geometry {
        self.geometry.get()
    }

    /// Returns the geometry of the frame like [`Frame::geometry`], to change it.
    pub fn geometry_mut(&mut self) -> &mut Geometry {
        self.geometry.get_mut()
    }

    /// Returns the finished picture at full resolution.
    pub fn image(&self) -> &Image<Rgba8> {
        self.finished.as_ref().unwrap_or(&self.drawn.color)
    }

    /// Returns the full-resolution picture before the post filter and the wireframe. This is the finished picture if
    /// neither was applied.
    pub(crate) fn unfiltered(&self) -> &Image<Rgba8> {
        match &self.unfiltered {
            Unfiltered::Finished => self.image(),
            Unfiltered::Drawn => &self.drawn.color,
            Unfiltered::Kept(picture) => picture,
        }
    }

    /// Returns the inputs of the upscaler, with `color` as the drawn colours.
    pub(crate) fn as_drawn<'a>(&'a self, color: &'a Image<Rgba8>) -> UpscaleInputs<'a> {
        UpscaleInputs { color, frame: self.surfaces.as_ref().map(|shown| shown.inputs(self.history.as_deref())) }
    }

    /// Returns whether the next frame of the same view may improve, because the upscaler's history has not converged
    /// yet.
    pub fn is_converging(&self, recipe: &Recipe) -> bool {
        self.surfaces.is_some()
            && self.still_frames_before() + 1 < recipe.upscaler.upscaler().converges_after(recipe.upscaler)
    }

    /// Returns the number of consecutive preceding frames with the camera and the scene of this frame.
    fn still_frames_before(&self) -> u32 {
        let is_still = self.view_change() == ViewChange::Same;
        self.history.as_ref().filter(|_| is_still).map_or(0, |past| past.still_frames)
    }

    /// Returns the change of camera or scene since the preceding frame.
    pub fn view_change(&self) -> ViewChange {
        match (&self.history, &self.surfaces) {
            (Some(_), Some(Surfaces { motion: None, .. })) => ViewChange::Same,
            (Some(_), Some(_)) => ViewChange::Changed,
            _ => ViewChange::First,
        }
    }

    /// Gives the buffers of the frame to a pool, except those that something else still shares.
    pub(super) fn give_buffers(self, pool: &mut BufferPool) {
        let full = match self.unfiltered {
            Unfiltered::Kept(picture) => Some(picture),
            Unfiltered::Finished | Unfiltered::Drawn => self.finished,
        };
        pool.give_codes(self.drawn.color);
        self.drawn.depth.into_iter().for_each(|depth| pool.give_numbers(depth));
        full.into_iter().for_each(|full| pool.give_codes(full));
        self.history.and_then(Arc::into_inner).into_iter().for_each(|history| pool.give_history(history));
        let Some(Surfaces { gbuffer, motion, .. }) = self.surfaces else { return };
        Arc::into_inner(gbuffer).into_iter().for_each(|surfaces| pool.give_surfaces(surfaces));
        motion.and_then(Arc::into_inner).into_iter().for_each(|vectors| pool.give_vectors(vectors));
    }

    /// Returns the history that the next frame may read, or `None` if the upscaler reads no history or the frame has no
    /// G-buffer. Reuses a buffer of the pool. Must be called at most once.
    pub(super) fn take_history(
        &mut self,
        scene: &Arc<Scene>,
        recipe: &Recipe,
        pool: &mut BufferPool,
    ) -> Option<History> {
        let surfaces = self.surfaces.clone().filter(|_| recipe.upscaler.upscaler().reads().history)?;
        let memory = self.upscaler_history.take();
        let picture = memory.is_none().then(|| {
            let (width, height) = self.unfiltered().size();
            let mut copy = Image::reusing(pool.codes((width, height)), width, height, [0; 4]);
            copy.pixels_mut().copy_from_slice(self.unfiltered().pixels());
            copy
        });
        Some(History {
            picture,
            accumulated: memory,
            surfaces: surfaces.gbuffer,
            scene: Arc::clone(scene),
            camera: self.camera,
            frames: self.history.as_ref().map_or(0, |past| past.frames.wrapping_add(1)),
            still_frames: self.still_frames_before() + 1,
        })
    }

    /// Returns which pixels of the rasterized picture were drawn.
    pub fn drawn_area(&self) -> DrawnArea {
        DrawnArea { grid: self.sampling.grid(), raster: self.raster }
    }

    /// Returns the fraction of the picture's pixels that were drawn, in [0, 1].
    pub fn drawn_share(&self) -> f64 {
        let Viewport { width, height } = self.viewport;
        self.drawn_pixels() as f64 / (f64::from(width) * f64::from(height))
    }

    /// Returns the number of drawn pixels.
    pub fn drawn_pixels(&self) -> u64 {
        self.drawn.grid.drawn_pixels(self.raster.width, self.raster.height)
    }

    /// Returns whether a pixel of the full picture was drawn, rather than filled in by the upscaler.
    pub fn is_drawn(&self, x: u32, y: u32) -> bool {
        matches!(self.sampling, Sampling::Grid(grid) if grid.sample_at(x, y).is_some())
    }

    /// Returns the position in the framebuffer, as (column, row), of the sample of a pixel; `None` if the pixel was not
    /// drawn. With [`Sampling::Lattice`], samples do not coincide with pixels, and the nearest sample is returned.
    pub(crate) fn sample_at(&self, x: u32, y: u32) -> Option<(u32, u32)> {
        match self.sampling {
            Sampling::Grid(grid) => grid.sample_at(x, y),
            Sampling::Lattice(lattice) => {
                Some((lattice.nearest(x, self.raster.width), lattice.nearest(y, self.raster.height)))
            }
        }
    }

    /// Returns the pixel of the full picture that contains a sample of the framebuffer.
    pub fn pixel_of(&self, sample: (u32, u32)) -> (u32, u32) {
        self.sampling.pixel(sample, (self.viewport.width, self.viewport.height))
    }

    /// Returns the rasterized triangles, with corners in pixels of the full picture. The list is empty if the frame was
    /// rasterized at a lower resolution and without the wireframe.
    pub(crate) fn outlines(&self) -> &[ScreenTriangle] {
        match self.sampling {
            Sampling::Grid(_) => &self.geometry().triangles,
            Sampling::Lattice(_) => self.outlines.as_deref().unwrap_or_default(),
        }
    }

    /// Returns the number of rasterized triangles, counting each piece of a clipped triangle.
    pub fn rasterized(&self) -> usize {
        self.tiled.as_ref().map_or_else(|| self.geometry().triangles.len(), |report| report.counts.rasterized as usize)
    }

    /// Returns the camera with which the frame was rasterized: the camera of the view, shifted to the sample positions
    /// if necessary. `recipe` must be the recipe of the frame.
    pub(crate) fn drawn_from(&self, recipe: &Recipe) -> Camera {
        let (_, place) = sampling_after(self.history.as_deref(), recipe);
        raster_camera(&self.camera, self.sampling, self.viewport, place)
    }

    /// Returns the mapping between view distances and stored depths of the frame.
    pub fn depth_scale(&self) -> &DepthScale {
        &self.drawn.depth_scale
    }

    /// Returns the frame as it looks at an intermediate point of drawing. `drawn` holds the samples drawn up to that
    /// point, one per pixel, and `geometry` the triangles drawn up to that point.
    pub fn at_moment(&self, recipe: &Recipe, drawn: Framebuffer, geometry: Geometry) -> Self {
        let Finished { picture, unfiltered, .. } = {
            let triangles = || self.outlines.as_ref().unwrap_or(&geometry.triangles);
            finish(recipe, &self.as_drawn(&drawn.color), self.viewport, &mut BufferPool::default(), triangles)
        };
        Self {
            finished: picture,
            unfiltered,
            upscaler_history: None,
            drawn,
            antialias: Antialiasing::default(),
            camera: self.camera,
            surfaces: self.surfaces.clone(),
            before: self.before.clone(),
            history: self.history.clone(),
            geometry: LazyGeometry::made(geometry),
            plans: Arc::clone(&self.plans),
            viewport: self.viewport,
            raster: self.raster,
            sampling: self.sampling,
            outlines: self.outlines.clone(),
            execution: Execution::Classic,
            times: self.times,
            tiled: None,
        }
    }
}

/// Geometry of a frame, computed on first access.
#[derive(Clone)]
pub(super) struct LazyGeometry {
    made: OnceLock<Geometry>,
    make: Arc<dyn Fn() -> Geometry + Send + Sync>,
}

impl LazyGeometry {
    pub(super) fn made(geometry: Geometry) -> Self {
        Self { made: geometry.into(), make: Arc::new(Geometry::default) }
    }

    pub(super) fn computed_by(make: impl Fn() -> Geometry + Send + Sync + 'static) -> Self {
        Self { made: OnceLock::new(), make: Arc::new(make) }
    }

    pub(super) fn get(&self) -> &Geometry {
        self.made.get_or_init(|| (self.make)())
    }

    fn get_mut(&mut self) -> &mut Geometry {
        let made = self.made.take().unwrap_or_else(|| (self.make)());
        self.made = made.into();
        self.made.get_mut().expect("was set in the line above")
    }
}

impl fmt::Debug for LazyGeometry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("LazyGeometry").field(&self.made).finish()
    }
}
