//! Quantities of a frame as images: the winning triangle of each sample, its weights, overdraw and shading counts.
//!
//! An observer collects these quantities while the frame is drawn again; normal drawing has no overhead.

use super::hits::Hits;
use super::reprojection::errors;
use crate::chain::{Frame, MotionBuffers, Recipe, redraw};
use crate::image::{Image, Rgba8};
use crate::pipeline::LastStage;
use crate::pipeline::interpolate::{Fragment, affine_weights};
use crate::pipeline::observe::Observer;
use crate::pipeline::raster::RasterSample;
use crate::pipeline::settings::{Choice, choice};
use crate::pipeline::viewport::ScreenTriangle;
use crate::scene::seams::Seams;
use crate::scene::{Scene, TriangleId};

choice! {
    /// A quantity that can be displayed instead of the colour.
    pub Buffer {
        Color = "color", "Colour", "The finished picture.", also ["final", "color buffer", "framebuffer"];
        Depth = "depth", "Depth", "The depth buffer at the end of the frame.", also ["zbuffer", "z-buffer", "depth buffer"];
        TriangleId = "triangle-id", "Triangle id", "The triangle that won each sample, one colour per triangle.";
        Lambda = "lambda", "Barycentric: linear", "Screen-space weights of the winning triangle: λ0 red, λ1 green, λ2 blue.";
        PerspectiveLambda = "perspective-lambda", "Barycentric: perspective-correct", "Weights of attributes in the winning triangle; equal to the linear ones if interpolation is affine.";
        Overdraw = "overdraw", "Overdraw",
            "Number of triangles that cover each sample, whether or not they pass the depth test.",
            also ["heatmap", "fill rate"];
        Shaded = "shaded", "Times shaded", "Number of times each sample was shaded: work that the depth test did not save.";
        MotionX = "motion-x", "Motion: x",
            "Position of the surface in the preceding frame minus its position now, in px to the right. Exact: from the transforms of both frames.",
            also ["motion vector", "velocity", "optical flow"];
        MotionY = "motion-y", "Motion: y",
            "Position of the surface in the preceding frame minus its position now, in px downwards.",
            also ["motion vector", "velocity", "optical flow"];
        Disocclusion = "disocclusion", "Disocclusion",
            "1 where the preceding frame does not show the surface: it was hidden, outside the picture or behind the eye.";
        PreviousX = "previous-x", "Previous position: x",
            "Position of the surface in the preceding frame, in px of that frame from the left.", also ["reprojection"];
        PreviousY = "previous-y", "Previous position: y",
            "Position of the surface in the preceding frame, in px of that frame from the top.", also ["reprojection"];
        ReprojectionError = "reprojection-error", "Reprojection error",
            "Largest difference of a channel, in sRGB codes, from the colour at the previous position. Both frames are drawn without history, anti-aliasing and post filter.",
            also ["motion vector", "ghosting"];
        Hits = "hits", "Hit count", "Number of triangles that cover each sample, without depth test. Cracks along shared edges are blue, double hits orange.";
    }
}

/// All displayable quantities of one frame, in the packed layout of its framebuffer.
#[derive(Clone, Debug)]
pub struct Buffers {
    /// Triangle shaded last at each sample, or [`TriangleId::NONE`]. Among blended triangles, this is normally the
    /// nearest.
    pub triangle: Image<TriangleId>,
    /// Screen-space barycentric weights of the winning triangle at each sample, for corners 0, 1 and 2.
    pub lambda: Image<[f32; 3]>,
    /// Weights used to interpolate the attributes of the winning triangle at each sample.
    pub perspective_lambda: Image<[f32; 3]>,
    /// Whether a depth was stored at each sample; blended triangles store none.
    pub depth_stored: Image<bool>,
    /// Number of triangles that cover each sample, whether or not they pass the depth test.
    pub overdraw: Image<u32>,
    /// Number of times that each sample was shaded.
    pub shaded: Image<u32>,
    /// Motion since the preceding frame; `None` until it is displayed, or if there is none.
    pub motion: Option<MotionBuffers>,
    /// Difference from the colour at the position in the preceding frame, in sRGB codes, of every rasterized pixel; NaN
    /// outside that frame. `None` until it is displayed, or if there is no motion.
    pub reprojection_error: Option<Image<f32>>,
    /// Hit counts, cracks and double hits; `None` until [`Buffer::Hits`] is displayed.
    pub hits: Option<Hits>,
}

/// Draws the frame again and records all quantities except the hits and the motion.
///
/// # Examples
/// ```
/// # use rasterscope_engine::chain::{Recipe, run};
/// # use rasterscope_engine::pipeline::viewport::Viewport;
/// # use rasterscope_engine::scene::builtin;
/// #
/// # let scene = builtin::by_id("interpenetrating").unwrap().build();
/// # let (recipe, viewport) = (Recipe::default(), Viewport { width: 64, height: 36 });
/// # let frame = run(&scene, &scene.home, &recipe, viewport, &mut ());
/// use rasterscope_engine::inspect::capture;
/// use rasterscope_engine::scene::TriangleId;
///
/// let buffers = capture(&scene, &recipe, &frame);
/// assert_eq!(buffers.overdraw.at(32, 18), 2);
/// assert_eq!(buffers.triangle.at(32, 18), TriangleId(1));
/// assert_eq!(buffers.triangle.at(0, 0), TriangleId::NONE);
///
/// let [a, b, c] = buffers.lambda.at(32, 18);
/// assert!((a + b + c - 1.0).abs() < 1e-5);
/// ```
pub fn capture(scene: &Scene, recipe: &Recipe, frame: &Frame) -> Buffers {
    let (width, height) = frame.drawn.color.size();
    let mut buffers = Buffers {
        triangle: Image::filled(width, height, TriangleId::NONE),
        lambda: Image::filled(width, height, [0.0; 3]),
        perspective_lambda: Image::filled(width, height, [0.0; 3]),
        depth_stored: Image::filled(width, height, false),
        overdraw: Image::filled(width, height, 0),
        shaded: Image::filled(width, height, 0),
        motion: None,
        reprojection_error: None,
        hits: None,
    };
    redraw(scene, recipe, frame, LastStage::Shade, &mut buffers);
    buffers
}

impl Buffer {
    /// Whether the buffer needs the motion since the preceding frame.
    pub(super) fn is_motion(self) -> bool {
        matches!(
            self,
            Self::MotionX
                | Self::MotionY
                | Self::Disocclusion
                | Self::PreviousX
                | Self::PreviousY
                | Self::ReprojectionError
        )
    }
}

impl Buffers {
    /// Whether [`Self::completed_for`] has nothing to add for a buffer.
    pub fn is_complete_for(&self, buffer: Buffer, frame: &Frame) -> bool {
        match buffer {
            Buffer::Hits => self.hits.is_some(),
            _ if frame.before.is_none() => true,
            Buffer::ReprojectionError => self.reprojection_error.is_some(),
            _ => self.motion.is_some() || !buffer.is_motion(),
        }
    }

    /// Adds the hits or the motion if `buffer` shows them and they are missing; [`capture`] does not record them.
    pub fn completed_for(self, buffer: Buffer, scene: &Scene, recipe: &Recipe, frame: &Frame) -> Self {
        match buffer {
            _ if self.is_complete_for(buffer, frame) => self,
            Buffer::Hits => Self { hits: Some(Hits::of(frame, &recipe.pipeline)), ..self },
            _ => {
                let motion = self.motion.or_else(|| frame.motion(scene, recipe));
                let reprojection_error = match (&motion, buffer) {
                    (Some(motion), Buffer::ReprojectionError) => errors(scene, recipe, frame, motion),
                    _ => self.reprojection_error,
                };
                Self { motion, reprojection_error, ..self }
            }
        }
    }
}

impl Buffers {
    /// Whether hits were counted, but the cracks and double hits along open seams are still missing.
    pub fn misses_seams(&self) -> bool {
        self.hits.as_ref().is_some_and(|hits| hits.mesh.is_none())
    }

    /// Adds the cracks and double hits along the open seams of the scene, if hits were counted.
    pub fn with_seams(self, scene: &Scene, recipe: &Recipe, frame: &Frame, seams: &Seams) -> Self {
        Self { hits: self.hits.map(|hits| hits.with_seams(scene, recipe, frame, seams)), ..self }
    }
}

impl Observer for Buffers {
    fn covered(&mut self, _triangle: &ScreenTriangle, sample: &RasterSample) {
        let count = self.overdraw.at(sample.column, sample.row);
        self.overdraw.set(sample.column, sample.row, count + 1);
    }

    fn depth_stored(&mut self, _triangle: &ScreenTriangle, sample: &RasterSample) {
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
