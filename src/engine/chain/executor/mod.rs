//! The two ways to draw the samples of a frame. [`super::driver`] runs everything else of a frame, for both alike.

mod classic;
mod tiled;

use std::ops::AddAssign;
use std::sync::Arc;
use std::time::Duration;

pub(super) use classic::{ClassicExecutor, Drawing};
pub(super) use tiled::TiledExecutor;

use super::frame::LazyGeometry;
use super::pool::BufferPool;
use super::{KeepDepth, Recipe};
use crate::pipeline::area::DrawnArea;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::plan::DrawPlan;
use crate::pipeline::settings::Execution;
use crate::pipeline::tiled::TiledReport;
use crate::scene::{Camera, Scene};

/// Way to draw the passes of one frame: triangle after triangle, or tile after tile.
pub(super) trait Executor {
    /// Execution mode that the frame reports.
    const EXECUTION: Execution;

    /// Draws the samples of one pass into a new framebuffer.
    fn draw(&mut self, pass: &Pass<'_>, pool: &mut BufferPool) -> Framebuffer;

    /// Returns what is known about the drawn passes of the frame. `frame` is its pass [`Purpose::Frame`], which need not
    /// have been drawn.
    fn finish(self, frame: &Pass<'_>) -> Executed;
}

/// Samples to draw for a frame, with one position per pixel or with those that the recipe's anti-aliasing spreads within
/// every pixel.
pub(super) struct Pass<'a> {
    pub(super) purpose: Purpose,
    pub(super) scene: &'a Scene,
    /// Camera of the rasterized picture, shifted to the samples.
    pub(super) camera: Camera,
    pub(super) recipe: &'a Recipe,
    pub(super) area: DrawnArea,
    pub(super) keep_depth: KeepDepth,
}

/// Use of the samples of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// The samples at the pixel centres with their depths, and the colours unless the frame has passes of the next kind.
    Frame,
    /// One of the supersampling passes, whose mean is the picture.
    Supersample,
    /// The ids and depths of the visible surfaces, for upscalers that read them.
    Surfaces,
}

/// Result of drawing the passes of a frame, besides the samples.
pub(super) struct Executed {
    /// Geometry of the pass [`Purpose::Frame`].
    pub(super) geometry: LazyGeometry,
    /// Draw plans, one per instance.
    pub(super) plans: Arc<Vec<DrawPlan>>,
    pub(super) times: PassTimes,
    /// Counts and times of the tiled execution.
    pub(super) tiled: Option<TiledReport>,
}

/// Wall-clock times, summed over all passes except those for surfaces.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PassTimes {
    /// Time spent in the geometry stages, from plan to cull.
    pub(super) geometry: Duration,
    /// Time spent in the pixel stages, from rasterize to shade.
    pub(super) pixels: Duration,
}

impl AddAssign for PassTimes {
    fn add_assign(&mut self, other: Self) {
        self.geometry += other.geometry;
        self.pixels += other.pixels;
    }
}
