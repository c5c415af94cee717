//! A finished frame.

use std::fmt;
use std::ops::{Deref, DerefMut};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use super::Recipe;
use super::finish::{Finished, Spare, Unfiltered, finish};
use super::run::redraw;
use super::view::{camera_of, sampling_after, seen};
use crate::antialias::settings::Antialiasing;
use crate::image::{Image, Rgba8};
use crate::pipeline::depth::DepthScale;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::plan::DrawPlan;
use crate::pipeline::settings::Execution;
use crate::pipeline::tiled::TiledReport;
use crate::pipeline::triangle_list::TriangleList;
use crate::pipeline::viewport::{ScreenTriangle, Viewport};
use crate::pipeline::{Geometry, Until};
use crate::scene::{Camera, Scene};
use crate::upscale::{Drawn, History, Sampling, Surfaces};

/// Wall-clock time of each part of a frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct FrameTimes {
    /// Plan to cull, of all passes.
    pub geometry: Duration,
    /// Rasterize to shade, of all passes; averaging where samples lie elsewhere in each pixel.
    pub pixels: Duration,
    /// Averaging the passes of supersampling.
    pub resolve: Duration,
    /// Finding the surface that each pixel shows, for upscalers that read it.
    pub surfaces: Duration,
    /// Filling in pixels that were not drawn, and keeping the frame as history.
    pub upscale: Duration,
    /// Post filter and wireframe.
    pub post: Duration,
    /// Time from the plan to the finished picture.
    pub total: Duration,
}

/// A finished frame and what it was made from.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The full picture where it is not what was drawn itself.
    pub(super) finished: Option<Image<Rgba8>>,
    /// The full picture before filter and lines.
    pub(super) unfiltered: Unfiltered,
    /// What the upscaler wants to be remembered, until that is part of a history.
    pub(super) memory: Option<Image<[f32; 4]>>,
    /// What was really drawn: colours of all samples, depths of the centres of pixels.
    pub drawn: Framebuffer,
    /// How the pixels that were drawn were sampled.
    pub antialias: Antialiasing,
    /// The view.
    pub camera: Camera,
    /// What every pixel shows, if the upscaler reads it and depths are kept.
    pub surfaces: Option<Arc<Surfaces>>,
    /// The frame before, if the upscaler reads it and there is one.
    pub past: Option<Arc<History>>,
    /// The triangles that were rasterized.
    pub geometry: LazyGeometry,
    /// One plan per instance.
    pub plans: Vec<DrawPlan>,
    /// Size of the full picture.
    pub viewport: Viewport,
    /// Size of the picture that `geometry` and `drawn` are of: the full one, or a smaller one of the same view.
    pub raster: Viewport,
    /// What of the full picture was drawn.
    pub sampling: Sampling,
    /// The triangles of the full picture, where lines over it need them and `geometry` is of a smaller one.
    pub(super) outlines: Option<TriangleList>,
    /// How it was drawn.
    pub execution: Execution,
    /// Where the time went.
    pub times: FrameTimes,
    /// What was counted while it was drawn tile by tile.
    pub tiled: Option<TiledReport>,
}

impl Frame {
    /// The full picture.
    pub fn image(&self) -> &Image<Rgba8> {
        self.finished.as_ref().unwrap_or(&self.drawn.color)
    }

    /// The full picture before it was filtered and lines were laid over it; the same where neither was done.
    pub fn unfiltered(&self) -> &Image<Rgba8> {
        match &self.unfiltered {
            Unfiltered::Finished => self.image(),
            Unfiltered::Drawn => &self.drawn.color,
            Unfiltered::Kept(picture) => picture,
        }
    }

    /// Colours drawn, with all else that the upscaler may read.
    pub fn as_drawn<'a>(&'a self, color: &'a Image<Rgba8>) -> Drawn<'a> {
        Drawn { color, seen: seen(self.surfaces.as_deref(), &self.camera, self.past.as_deref()) }
    }

    /// Whether the next frame of the same view may be better, as the upscaler knows more by then.
    pub fn wants_another(&self, recipe: &Recipe) -> bool {
        let before = self.past.as_ref().filter(|past| past.camera == self.camera).map_or(0, |past| past.still);
        self.surfaces.is_some() && before + 1 < recipe.upscaler.upscaler().settles_after(recipe.upscaler)
    }

    /// Takes a picture apart for its memory: colours and depths that were drawn, the full picture if there is another, and the
    /// frame before if nobody else looks at it.
    pub(super) fn into_memory(self) -> (Framebuffer, Option<Image<Rgba8>>, Option<History>) {
        let full = match self.unfiltered {
            Unfiltered::Kept(picture) => Some(picture),
            Unfiltered::Finished | Unfiltered::Drawn => self.finished,
        };
        (self.drawn, full, self.past.and_then(Arc::into_inner))
    }

    /// What the next frame may read of this one, if the upscaler reads the past, in memory that is no longer needed. To be
    /// asked for once.
    pub(super) fn history(&mut self, recipe: &Recipe, spare: Option<Image<Rgba8>>) -> Option<History> {
        let surfaces = self.surfaces.clone().filter(|_| recipe.upscaler.upscaler().reads().past)?;
        let memory = self.memory.take();
        let picture = memory.is_none().then(|| {
            let (width, height) = self.unfiltered().size();
            let mut copy = Image::reusing(spare, width, height, [0; 4]);
            copy.pixels_mut().copy_from_slice(self.unfiltered().pixels());
            copy
        });
        let still = self.past.as_ref().filter(|past| past.camera == self.camera).map_or(0, |past| past.still);
        Some(History {
            picture,
            memory,
            surfaces,
            camera: self.camera,
            frames: self.past.as_ref().map_or(0, |past| past.frames.wrapping_add(1)),
            still: still + 1,
        })
    }

    /// Share of the picture's pixels that were drawn, in [0, 1].
    pub fn drawn_share(&self) -> f64 {
        let Viewport { width, height } = self.viewport;
        self.drawn_pixels() as f64 / (f64::from(width) * f64::from(height))
    }

    /// How many samples were drawn.
    pub fn drawn_pixels(&self) -> u64 {
        self.drawn.grid.drawn_pixels(self.raster.width, self.raster.height)
    }

    /// Whether a pixel of the full picture was drawn itself.
    pub fn is_drawn(&self, x: u32, y: u32) -> bool {
        matches!(self.sampling, Sampling::Grid(grid) if grid.sample_at(x, y).is_some())
    }

    /// The packed sample that stands for a pixel of the full picture: its own if it was drawn, the nearest if samples lie
    /// between pixels, else none.
    pub fn sample_at(&self, x: u32, y: u32) -> Option<(u32, u32)> {
        match self.sampling {
            Sampling::Grid(grid) => grid.sample_at(x, y),
            Sampling::Lattice(lattice) => {
                Some((lattice.nearest(x, self.raster.width), lattice.nearest(y, self.raster.height)))
            }
        }
    }

    /// The pixel of the full picture that a packed sample lies in.
    pub fn pixel_of(&self, sample: (u32, u32)) -> (u32, u32) {
        self.sampling.pixel(sample, (self.viewport.width, self.viewport.height))
    }

    /// The triangles that were rasterized, on the full picture; none if the frame was drawn smaller and without lines.
    pub fn outlines(&self) -> &[ScreenTriangle] {
        match self.sampling {
            Sampling::Grid(_) => &self.geometry.triangles,
            Sampling::Lattice(_) => self.outlines.as_deref().unwrap_or_default(),
        }
    }

    /// Triangles, and pieces of cut ones, that were rasterized.
    pub fn rasterized(&self) -> usize {
        self.tiled.as_ref().map_or_else(|| self.geometry.triangles.len(), |report| report.counts.rasterized as usize)
    }

    /// The view that was drawn: the frame's own, or one moved to where the samples lie. `recipe` is the frame's.
    pub fn drawn_from(&self, recipe: &Recipe) -> Camera {
        let (_, place) = sampling_after(self.past.as_deref(), recipe);
        camera_of(&self.camera, self.sampling, self.viewport, place)
    }

    /// What depths of the frame mean.
    pub fn depth_scale(&self) -> &DepthScale {
        &self.drawn.depth_scale
    }

    /// Draws the list of triangles once more, after it was changed, with one sample for each pixel.
    pub fn redraw(&mut self, scene: &Scene, recipe: &Recipe) {
        let drawn = redraw(scene, recipe, self, Until::Shade, &mut ());
        *self = self.at_moment(recipe, drawn, Geometry::clone(&self.geometry));
    }

    /// The frame as it was at an earlier moment: `drawn` is what was drawn by then, with one sample for each pixel, and
    /// `geometry` has the triangles that were drawn.
    pub fn at_moment(&self, recipe: &Recipe, drawn: Framebuffer, geometry: Geometry) -> Self {
        let Finished { picture, unfiltered, .. } = {
            let triangles = || self.outlines.as_ref().unwrap_or(&geometry.triangles);
            finish(recipe, &self.as_drawn(&drawn.color), self.viewport, Spare::default(), triangles)
        };
        Self {
            finished: picture,
            unfiltered,
            memory: None,
            drawn,
            antialias: Antialiasing::default(),
            camera: self.camera,
            surfaces: self.surfaces.clone(),
            past: self.past.clone(),
            geometry: LazyGeometry::made(geometry),
            plans: self.plans.clone(),
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

/// The geometry of a frame, made when it is first asked for: what was drawn tile by tile needed none in this form.
#[derive(Clone)]
pub struct LazyGeometry {
    pub(super) made: OnceLock<Geometry>,
    pub(super) make: Arc<dyn Fn() -> Geometry + Send + Sync>,
}

impl LazyGeometry {
    pub(super) fn made(geometry: Geometry) -> Self {
        Self { made: geometry.into(), make: Arc::new(Geometry::default) }
    }
}

impl fmt::Debug for LazyGeometry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("LazyGeometry").field(&self.made).finish()
    }
}

impl Deref for LazyGeometry {
    type Target = Geometry;

    fn deref(&self) -> &Geometry {
        self.made.get_or_init(|| (self.make)())
    }
}

impl DerefMut for LazyGeometry {
    fn deref_mut(&mut self) -> &mut Geometry {
        let made = self.made.take().unwrap_or_else(|| (self.make)());
        self.made = made.into();
        self.made.get_mut().expect("it was put there a line above")
    }
}
