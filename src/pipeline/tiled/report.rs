//! What drawing a frame was.

use std::ops::AddAssign;
use std::time::Duration;

use crate::pipeline::plan::DrawPlan;

/// Wall-clock time of each stage. Tiles are drawn and shaded in turn by all threads: the time of both is shared out by the
/// time that the threads spent on either.
#[derive(Clone, Copy, Debug, Default)]
pub struct TiledTimes {
    /// Planning, and vertices to the screen.
    pub transform: Duration,
    /// Culling, clipping, binning.
    pub cull: Duration,
    /// Coverage and depth.
    pub rasterize: Duration,
    /// Interpolation and shading.
    pub shade: Duration,
}

impl AddAssign for TiledTimes {
    /// Adds the times of another pass over the same frame, stage by stage.
    fn add_assign(&mut self, pass: Self) {
        self.transform += pass.transform;
        self.cull += pass.cull;
        self.rasterize += pass.rasterize;
        self.shade += pass.shade;
    }
}

/// What was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TiledCounts {
    /// Triangles of the scene.
    pub triangles_in: u64,
    /// Triangles of draws that are not outside as a whole.
    pub considered: u64,
    /// Triangles, and pieces of cut ones, that face the right way.
    pub rasterized: u64,
    /// Those of them that may hold a sample.
    pub kept: u64,
    /// Entries of triangles in tiles.
    pub binned: u64,
    /// Samples that were tested one by one.
    pub visited: u64,
    /// Samples that were taken in blocks.
    pub plain: u64,
    /// Vertices transformed.
    pub vertices: u64,
    /// Samples shaded.
    pub shaded: u64,
    /// Texels read.
    pub texels: u64,
}

/// What is left when a frame is drawn.
#[derive(Clone, Debug, Default)]
pub struct TiledReport {
    /// One plan per instance.
    pub plans: Vec<DrawPlan>,
    /// Where the time went.
    pub times: TiledTimes,
    /// What was done.
    pub counts: TiledCounts,
}
