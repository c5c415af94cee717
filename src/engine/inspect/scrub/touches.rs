//! Playback positions at which a triangle has a fragment at a given pixel.

use super::Moment;
use crate::chain::{Frame, Recipe};
use crate::image::Rgba8;
use crate::pipeline::area::DrawnArea;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::interpolate::Fragment;
use crate::pipeline::observe::Observer;
use crate::pipeline::raster::{RasterSample, Scissor};
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::{DrawCall, Extent, Geometry, partial};
use crate::scene::{Scene, TriangleId};

/// Precision with which the fragments at a pixel are located in the drawing order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TouchPrecision {
    /// Each fragment is located only by its triangle.
    Triangles,
    /// Each fragment is located exactly, until the traversed triangles have more than [`MAX_FRAGMENTS`] fragments in
    /// total. Later fragments are located only by their triangles.
    Fragments,
}

/// Maximum number of fragments traversed to locate the fragments at a pixel, which takes a fraction of a second.
pub(crate) const MAX_FRAGMENTS: usize = 8_000_000;

/// Fragment at the picked pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Touch {
    /// Triangle that produced the fragment.
    pub(crate) triangle: TriangleId,
    /// Playback position immediately after the fragment.
    pub moment: Moment,
    /// Whether the fragment was written to the framebuffer.
    pub written: bool,
}

/// Drawing of a frame, or of its first triangles, whose fragments at a pixel are located.
#[derive(Clone, Copy, Debug)]
pub struct TouchedDrawing<'a> {
    /// Scene of the frame.
    pub scene: &'a Scene,
    /// Recipe of the frame.
    pub recipe: &'a Recipe,
    /// Rasterized triangles.
    pub geometry: &'a Geometry,
    /// Pixels that are drawn.
    pub area: DrawnArea,
}

impl<'a> TouchedDrawing<'a> {
    /// Returns the drawing of a frame, which was drawn from `scene` with `recipe`.
    pub fn of_frame(scene: &'a Scene, recipe: &'a Recipe, frame: &'a Frame) -> Self {
        Self { scene, recipe, geometry: frame.geometry(), area: frame.drawn_area() }
    }

    /// Returns every fragment at a drawn pixel, in order of submission; empty if the pixel is not drawn.
    pub fn touches(&self, (x, y): (u32, u32), precision: TouchPrecision) -> Vec<Touch> {
        let Self { scene, recipe, geometry, area } = *self;
        let Some(sample) = area.grid.sample_at(x, y) else { return Vec::new() };
        let settings = &recipe.pipeline;
        let mut one = Framebuffer::one_sample(area.grid, sample, scene.background, settings);
        let extent = Extent { triangles: 0..geometry.triangles.len(), scissor: Scissor::pixel(x, y) };
        let mut watch = TouchObserver { geometry, touches: Vec::new() };
        DrawCall::new(scene, geometry, settings, &extent).draw(&mut one, &mut watch);
        let mut touches = watch.touches;
        // Depth-sorted fragments are not drawn in the order of their triangles.
        touches.sort_by_key(|touch| touch.moment.key());
        let mut counted = 0;
        for touch in &mut touches {
            let Some(triangle) = geometry.triangles.get(touch.moment.triangles - 1) else { continue };
            if precision == TouchPrecision::Triangles || counted > MAX_FRAGMENTS {
                break;
            }
            let samples = partial::samples_of(triangle, settings, area);
            counted += partial::count(&samples);
            touch.moment.fragments = partial::index_of(&samples, sample).map(|place| place + 1);
        }
        touches
    }
}

struct TouchObserver<'a> {
    geometry: &'a Geometry,
    touches: Vec<Touch>,
}

impl Observer for TouchObserver<'_> {
    fn covered(&mut self, triangle: &ScreenTriangle, _sample: &RasterSample) {
        let moment = Moment::after(self.geometry.index_of(triangle) + 1);
        self.touches.push(Touch { triangle: triangle.id, moment, written: false });
    }

    fn shaded(&mut self, _triangle: &ScreenTriangle, _fragment: &Fragment, _color: Rgba8) {
        if let Some(last) = self.touches.last_mut() {
            last.written = true;
        }
    }
}
