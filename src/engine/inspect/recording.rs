//! Recording of the quantities of a frame: the winning triangle of each sample, its weights, overdraw and shading counts.
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
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::scene::seams::Seams;
use crate::scene::{Scene, TriangleId};

/// Source of the values of a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BufferOrigin {
    /// The finished picture.
    Picture,
    /// The depth buffer of the frame.
    DepthBuffer,
    /// What [`capture`] records while the frame is drawn again.
    Drawing,
    /// [`Buffers::hits`].
    Hits,
    /// [`Buffers::motion`].
    Motion,
    /// [`Buffers::reprojection_error`].
    Reprojection,
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
    /// Hit counts, cracks and double hits; `None` until they are displayed.
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

impl Buffers {
    /// Whether the values of this origin are present, or cannot be.
    pub(super) fn has(&self, origin: BufferOrigin, frame: &Frame) -> bool {
        match origin {
            BufferOrigin::Picture | BufferOrigin::DepthBuffer | BufferOrigin::Drawing => true,
            BufferOrigin::Hits => self.hits.is_some(),
            BufferOrigin::Motion => self.motion.is_some() || frame.before.is_none(),
            BufferOrigin::Reprojection => self.reprojection_error.is_some() || frame.before.is_none(),
        }
    }

    /// Computes the values of an origin.
    pub(super) fn with(self, origin: BufferOrigin, scene: &Scene, recipe: &Recipe, frame: &Frame) -> Self {
        let motion = |motion: Option<MotionBuffers>| motion.or_else(|| frame.motion(scene, recipe));
        match origin {
            BufferOrigin::Picture | BufferOrigin::DepthBuffer | BufferOrigin::Drawing => self,
            BufferOrigin::Hits => Self { hits: Some(Hits::of(frame, &recipe.pipeline)), ..self },
            BufferOrigin::Motion => Self { motion: motion(self.motion), ..self },
            BufferOrigin::Reprojection => {
                let motion = motion(self.motion);
                let reprojection_error = match &motion {
                    Some(motion) => errors(scene, recipe, frame, motion),
                    None => self.reprojection_error,
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
