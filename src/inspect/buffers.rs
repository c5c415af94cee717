//! Any quantity of a frame as a picture: who won each sample, with which weights, how often it was drawn.
//!
//! The frame is drawn once more with an observer that keeps these quantities; the frame itself pays nothing for them.

use super::hits::Hits;
use crate::chain::{Frame, Recipe, redraw};
use crate::image::{Image, Rgba8};
use crate::pipeline::Until;
use crate::pipeline::interpolate::{Fragment, affine_weights};
use crate::pipeline::observe::Observer;
use crate::pipeline::raster::Sample;
use crate::pipeline::settings::{Choice, choice};
use crate::pipeline::viewport::ScreenTriangle;
use crate::scene::seams::Seams;
use crate::scene::{Scene, TriangleId};

choice! {
    /// A quantity that can be shown instead of the colour.
    Buffer {
        Color = "color", "Colour", "The finished picture.";
        Depth = "depth", "Depth", "What the depth buffer holds in the end.";
        TriangleId = "triangle-id", "Triangle id", "The triangle that won each sample, one colour each.";
        Lambda = "lambda", "λ on screen", "Screen-space weights of the winner: λ0 red, λ1 green, λ2 blue.";
        PerspectiveLambda = "perspective-lambda", "λ in space", "Weights of the winner that attributes are interpolated with (perspective-correct unless affine).";
        Overdraw = "overdraw", "Overdraw", "How many triangles cover each sample, drawn or not.";
        Shaded = "shaded", "Times shaded", "How often each sample was shaded: what the depth test could not save.";
        Hits = "hits", "Hit count", "How many triangles cover each sample, without depth test. Cracks and double hits along shared edges are blue and orange.";
    }
}

/// All quantities of one frame, packed as its framebuffer is.
#[derive(Clone, Debug)]
pub struct Buffers {
    /// Winner of each sample, the nearest one where some are blended, or [`TriangleId::NONE`].
    pub triangle: Image<TriangleId>,
    /// Screen-space weights of the winner.
    pub lambda: Image<[f32; 3]>,
    /// Attribute weights of the winner.
    pub perspective_lambda: Image<[f32; 3]>,
    /// Where anything left its depth; blended triangles leave none.
    pub depth_stored: Image<bool>,
    /// Triangles that cover each sample.
    pub overdraw: Image<u32>,
    /// How often each sample was shaded.
    pub shaded: Image<u32>,
    /// Cracks and double hits, if they were looked for.
    pub hits: Option<Hits>,
}

/// Draws the frame again and keeps everything.
pub fn capture(scene: &Scene, recipe: &Recipe, frame: &Frame) -> Buffers {
    let (width, height) = frame.drawn.color.size();
    let mut buffers = Buffers {
        triangle: Image::filled(width, height, TriangleId::NONE),
        lambda: Image::filled(width, height, [0.0; 3]),
        perspective_lambda: Image::filled(width, height, [0.0; 3]),
        depth_stored: Image::filled(width, height, false),
        overdraw: Image::filled(width, height, 0),
        shaded: Image::filled(width, height, 0),
        hits: None,
    };
    redraw(scene, recipe, frame, Until::Shade, &mut buffers);
    buffers
}

impl Buffers {
    /// With all that a buffer needs: only the hit count needs more than [`capture`] keeps.
    pub fn completed_for(self, buffer: Buffer, recipe: &Recipe, frame: &Frame) -> Self {
        if buffer != Buffer::Hits || self.hits.is_some() {
            return self;
        }
        Self { hits: Some(Hits::of(frame, &recipe.pipeline)), ..self }
    }
}

impl Buffers {
    /// Whether hits were counted, and the faults along open seams are not yet among them.
    pub fn misses_seams(&self) -> bool {
        self.hits.as_ref().is_some_and(|hits| hits.mesh.is_none())
    }

    /// With the faults along the open seams of the scene, if hits were counted.
    pub fn with_seams(self, scene: &Scene, recipe: &Recipe, frame: &Frame, seams: &Seams) -> Self {
        Self { hits: self.hits.map(|hits| hits.with_seams(scene, recipe, frame, seams)), ..self }
    }
}

impl Observer for Buffers {
    fn covered(&mut self, _triangle: &ScreenTriangle, sample: &Sample) {
        let count = self.overdraw.at(sample.column, sample.row);
        self.overdraw.set(sample.column, sample.row, count + 1);
    }

    fn depth_stored(&mut self, _triangle: &ScreenTriangle, sample: &Sample) {
        self.depth_stored.set(sample.column, sample.row, true);
    }

    fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, _color: Rgba8) {
        let (column, row) = (fragment.sample.column, fragment.sample.row);
        self.triangle.set(column, row, triangle.id);
        self.lambda.set(column, row, affine_weights(triangle, &fragment.sample));
        self.perspective_lambda.set(column, row, fragment.weights);
        let count = self.shaded.at(column, row);
        self.shaded.set(column, row, count + 1);
    }
}
