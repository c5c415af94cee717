//! Playback of a frame's drawing: draws the frame as it was after any triangle or fragment.
//!
//! Triangles are drawn one by one in the order of the frame, regardless of how the frame itself was drawn. Checkpoints
//! of the framebuffer make steps backwards as fast as steps forwards: drawing starts at the last checkpoint before the
//! requested position. The result is bit-identical to drawing from the start.

pub(crate) mod timeline;

mod checkpoints;

mod last_triangle;

mod touches;

pub use last_triangle::LastTriangle;
pub use timeline::Timeline;
pub use timeline::Unit;
pub(crate) use touches::Touch;
pub use touches::TouchPrecision;
pub use touches::TouchedDrawing;

use std::sync::Arc;

use serde::Serialize;

use crate::chain::{Frame, Recipe, prepare_again};
use crate::pipeline::area::DrawnArea;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::raster::{Scissor, Span};
use crate::pipeline::{DrawCall, Extent, Geometry, partial};
use crate::scene::Scene;
use checkpoints::Checkpoints;
use last_triangle::silhouette;

/// Memory budget for framebuffer checkpoints, in bytes: enough for 16 copies at 1920 × 1080.
pub const BUDGET: usize = 256 << 20;

/// Playback position in the drawing of a frame: the numbers of triangles and fragments drawn so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Moment {
    /// Number of rasterized triangles drawn, including a partially drawn last one.
    pub triangles: usize,
    /// Number of drawn fragments of the last triangle; `None` if it is complete.
    pub fragments: Option<usize>,
}

impl Moment {
    /// Returns the playback position after `triangles` complete triangles.
    pub fn after(triangles: usize) -> Self {
        Self { triangles, fragments: None }
    }

    /// Returns a sort key that orders playback positions by time.
    pub fn key(self) -> (usize, usize) {
        (self.triangles, self.fragments.unwrap_or(usize::MAX))
    }
}

/// Player for the drawing of one frame: draws the frame as it was at any playback position.
#[derive(Debug)]
pub struct Scrubber {
    scene: Arc<Scene>,
    recipe: Recipe,
    /// All rasterized triangles of the frame.
    geometry: Geometry,
    /// Pixels that are drawn.
    area: DrawnArea,
    checkpoints: Checkpoints,
    /// Framebuffer after `completed_triangles` triangles.
    framebuffer: Framebuffer,
    completed_triangles: usize,
}

impl Scrubber {
    /// Creates a scrubber for `frame`, which was drawn from `scene` with `recipe`. It draws one sample per pixel.
    /// Checkpoints take at most `budget` bytes, or the size of two framebuffers if that is larger.
    pub fn new(scene: &Arc<Scene>, recipe: &Recipe, frame: &Frame, budget: usize) -> Self {
        let geometry = prepare_again(scene, recipe, frame, &mut ());
        let area @ DrawnArea { grid, raster } = frame.drawn_area();
        let mut framebuffer = Framebuffer::new(grid, raster.width, raster.height, scene.background, &recipe.pipeline);
        framebuffer.depth_scale = geometry.depth_scale;
        Self {
            checkpoints: Checkpoints::new(&geometry, raster, &framebuffer, budget),
            scene: Arc::clone(scene),
            recipe: *recipe,
            geometry,
            area,
            framebuffer,
            completed_triangles: 0,
        }
    }

    /// Returns all rasterized triangles of the frame, in drawing order.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// Returns the drawing of the whole frame.
    pub fn drawing(&self) -> TouchedDrawing<'_> {
        let Self { scene, recipe, geometry, area, .. } = self;
        TouchedDrawing { scene, recipe, geometry, area: *area }
    }

    /// Draws the frame as it was at a playback position. Positions past the end give the complete frame.
    pub fn frame_at(&mut self, moment: Moment) -> Framebuffer {
        let all = self.geometry.triangles.len();
        let triangles = moment.triangles.min(all);
        let first_sorted = self.geometry.sorted_from(&self.recipe.pipeline);
        if first_sorted < triangles {
            return self.draw_sorted(moment, first_sorted);
        }
        let Some(samples) = self.first_samples(moment).filter(|_| triangles == moment.triangles) else {
            self.seek(triangles);
            return self.framebuffer.clone();
        };
        self.seek(triangles - 1);
        let mut drawn = self.framebuffer.clone();
        let scissor = Scissor::full(self.area.raster.width, self.area.raster.height);
        let extent = Extent { triangles: triangles - 1..triangles, scissor };
        DrawCall::new(&self.scene, &self.geometry, &self.recipe.pipeline, &extent).draw_samples(&samples, &mut drawn);
        drawn
    }

    /// Draws a frame with depth-sorted fragments as it was at a playback position. `first` is the first triangle whose
    /// fragments are sorted. Fragments after the playback position are neither sorted nor drawn.
    fn draw_sorted(&mut self, moment: Moment, first: usize) -> Framebuffer {
        self.seek(first);
        let mut drawn = self.framebuffer.clone();
        let geometry = self.geometry_at(moment);
        let scissor = Scissor::full(self.area.raster.width, self.area.raster.height);
        let extent = Extent { triangles: first..geometry.triangles.len(), scissor };
        DrawCall::new(&self.scene, &geometry, &self.recipe.pipeline, &extent).draw(&mut drawn, &mut ());
        drawn
    }

    /// Returns the geometry drawn up to a playback position; its last triangle may be partial. The triangles share
    /// memory with the full list.
    pub fn geometry_at(&self, moment: Moment) -> Geometry {
        let mut first = Geometry { partial: self.first_samples(moment), ..self.geometry.clone() };
        first.triangles.truncate(moment.triangles);
        first
    }

    /// Returns the number of fragments of the rasterized triangle at index `place`; 0 past the last one.
    pub fn fragments_of(&self, place: usize) -> usize {
        partial::count(&self.samples_of(place))
    }

    /// Returns the triangle that was drawn last at a playback position; `None` before the first one. `scale` converts
    /// positions in the drawn picture to pixels of the full picture. The silhouette of `known` is reused if that
    /// triangle belongs to the same instance.
    pub fn last_triangle(&self, moment: Moment, scale: [f32; 2], known: Option<LastTriangle>) -> Option<LastTriangle> {
        let triangles = &self.geometry.triangles;
        let last = triangles.get(moment.triangles.checked_sub(1)?)?;
        let instance = last.instance;
        let outline = || Arc::new(silhouette(triangles.iter().filter(|t| t.instance == instance), scale));
        Some(LastTriangle {
            id: last.id,
            instance,
            corners_px: last.corners_px().map(|corner| last_triangle::scaled(corner, scale)),
            silhouette: known.filter(|known| known.instance == instance).map_or_else(outline, |known| known.silhouette),
        })
    }

    /// Returns the number of stored checkpoints and their total size in bytes.
    pub fn memory(&self) -> (usize, usize) {
        self.checkpoints.memory()
    }

    fn samples_of(&self, place: usize) -> Vec<Span> {
        let triangle = self.geometry.triangles.get(place);
        triangle.map_or_else(Vec::new, |t| partial::samples_of(t, &self.recipe.pipeline, self.area))
    }

    /// Returns the drawn samples of the last triangle at a playback position; `None` if all of its samples are drawn.
    fn first_samples(&self, Moment { triangles, fragments }: Moment) -> Option<Vec<Span>> {
        let (place, most) = (triangles.checked_sub(1)?, fragments?);
        let samples = self.samples_of(place);
        (most < partial::count(&samples)).then(|| partial::first(&samples, most))
    }

    /// Brings the framebuffer to the state after exactly `triangles` complete triangles.
    fn seek(&mut self, triangles: usize) {
        if let Some(at) = self.checkpoints.restore_before(triangles, self.completed_triangles, &mut self.framebuffer) {
            self.completed_triangles = at;
        }
        while self.completed_triangles < triangles {
            let end = self.checkpoints.next_after(self.completed_triangles).min(triangles);
            let scissor = Scissor::full(self.area.raster.width, self.area.raster.height);
            let extent = Extent { triangles: self.completed_triangles..end, scissor };
            let call = DrawCall::new(&self.scene, &self.geometry, &self.recipe.pipeline, &extent);
            call.draw(&mut self.framebuffer, &mut ());
            self.completed_triangles = end;
            self.checkpoints.store_checkpoint(end, &self.framebuffer);
        }
    }
}

#[cfg(test)]
mod tests;
