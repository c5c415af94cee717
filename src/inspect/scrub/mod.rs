//! A frame at any moment of its making: after any of its triangles, or after any fragment of one.
//!
//! Triangles are drawn one after the other, in the order in which the frame has them, however the frame itself was drawn.
//! Copies of the framebuffer along the way make steps back as quick as steps on: drawing begins at the last copy before the
//! moment that is asked for. What is there then is bit for bit what drawing from the start gives.

pub mod timeline;

mod checkpoints;

mod touches;

pub use timeline::{Timeline, Unit};
pub use touches::{Count, MOST_FRAGMENTS, Touch, touches};

use std::sync::Arc;

use serde::Serialize;

use crate::chain::{Frame, Recipe, prepare_again};
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::raster::{Scissor, Span};
use crate::pipeline::viewport::Viewport;
use crate::pipeline::{Extent, Geometry, Until, draw, draw_samples, partial};
use crate::scene::Scene;
use checkpoints::Checkpoints;

/// Memory for copies of the framebuffer, bytes: fifteen of a full HD picture.
pub const BUDGET: usize = 256 << 20;

/// A moment of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Moment {
    /// How many of the rasterized triangles are drawn.
    pub triangles: usize,
    /// Of the last of them only so many fragments; all if none.
    pub fragments: Option<usize>,
}

impl Moment {
    /// After so many whole triangles.
    pub fn after(triangles: usize) -> Self {
        Self { triangles, fragments: None }
    }

    /// Orders moments by time.
    pub fn key(self) -> (usize, usize) {
        (self.triangles, self.fragments.unwrap_or(usize::MAX))
    }
}

/// Goes to moments of one frame.
#[derive(Debug)]
pub struct Scrubber {
    scene: Arc<Scene>,
    recipe: Recipe,
    /// All triangles.
    geometry: Geometry,
    grid: SampleGrid,
    raster: Viewport,
    checkpoints: Checkpoints,
    /// What is drawn after [`Scrubber::at`] whole triangles.
    now: Framebuffer,
    at: usize,
}

impl Scrubber {
    /// For the frame that `recipe` made of `scene`, with one sample for each pixel, keeping copies in at most `budget` bytes,
    /// or two of them if that is too little.
    pub fn new(scene: &Arc<Scene>, recipe: &Recipe, frame: &Frame, budget: usize) -> Self {
        let geometry = prepare_again(scene, recipe, frame, &mut ());
        let (grid, raster) = (frame.sampling.grid(), frame.raster);
        let mut now = Framebuffer::new(grid, raster.width, raster.height, scene.background, &recipe.pipeline);
        now.depth_scale = geometry.depth_scale;
        Self {
            checkpoints: Checkpoints::new(&geometry, raster, &now, budget),
            scene: Arc::clone(scene),
            recipe: *recipe,
            geometry,
            grid,
            raster,
            now,
            at: 0,
        }
    }

    /// All triangles of the frame, in the order in which they are drawn.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// What is drawn at a moment; the last one if it lies beyond.
    pub fn go(&mut self, moment: Moment) -> Framebuffer {
        let all = self.geometry.triangles.len();
        let triangles = moment.triangles.min(all);
        let first_sorted = self.geometry.sorted_from(&self.recipe.pipeline);
        if first_sorted < triangles {
            return self.draw_sorted(moment, first_sorted);
        }
        let Some(samples) = self.first_samples(moment).filter(|_| triangles == moment.triangles) else {
            self.seek(triangles);
            return self.now.clone();
        };
        self.seek(triangles - 1);
        let mut drawn = self.now.clone();
        let settings = &self.recipe.pipeline;
        draw_samples(&self.scene, &self.geometry, settings, (triangles - 1, &samples), &mut drawn);
        drawn
    }

    /// Draws a moment at which fragments are sorted: those of the triangles from `first` on, as if there were no later ones.
    fn draw_sorted(&mut self, moment: Moment, first: usize) -> Framebuffer {
        self.seek(first);
        let mut drawn = self.now.clone();
        let geometry = self.geometry_at(moment);
        let scissor = Scissor::full(self.raster.width, self.raster.height);
        let extent = Extent { triangles: first..geometry.triangles.len(), scissor };
        draw(&self.scene, &geometry, &self.recipe.pipeline, &extent, Until::Shade, &mut drawn, &mut ());
        drawn
    }

    /// The triangles that are drawn at a moment, the last of them in part if need be. They share the memory of all.
    pub fn geometry_at(&self, moment: Moment) -> Geometry {
        let mut first = Geometry { partial: self.first_samples(moment), ..self.geometry.clone() };
        first.triangles.truncate(moment.triangles);
        first
    }

    /// How many fragments a rasterized triangle has; none beyond the last.
    pub fn fragments_of(&self, place: usize) -> usize {
        partial::count(&self.samples_of(place))
    }

    /// Copies of the framebuffer that are held, and the bytes of all of them.
    pub fn memory(&self) -> (usize, usize) {
        self.checkpoints.memory()
    }

    fn samples_of(&self, place: usize) -> Vec<Span> {
        let triangle = self.geometry.triangles.get(place);
        triangle.map_or_else(Vec::new, |t| partial::samples_of(t, &self.recipe.pipeline, (self.grid, self.raster)))
    }

    /// The samples of the last triangle that are drawn at a moment, if that is not all of them.
    fn first_samples(&self, Moment { triangles, fragments }: Moment) -> Option<Vec<Span>> {
        let (place, most) = (triangles.checked_sub(1)?, fragments?);
        let samples = self.samples_of(place);
        (most < partial::count(&samples)).then(|| partial::first(&samples, most))
    }

    /// Draws until `triangles` whole triangles are there.
    fn seek(&mut self, triangles: usize) {
        if let Some(at) = self.checkpoints.restore_before(triangles, self.at, &mut self.now) {
            self.at = at;
        }
        while self.at < triangles {
            let end = self.checkpoints.next_after(self.at).min(triangles);
            let scissor = Scissor::full(self.raster.width, self.raster.height);
            let extent = Extent { triangles: self.at..end, scissor };
            let settings = &self.recipe.pipeline;
            draw(&self.scene, &self.geometry, settings, &extent, Until::Shade, &mut self.now, &mut ());
            self.at = end;
            self.checkpoints.keep(end, &self.now);
        }
    }
}

#[cfg(test)]
mod tests;
