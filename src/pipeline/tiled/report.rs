//! Report of a frame drawn by tiles.

use std::ops::AddAssign;
use std::time::Duration;

use crate::pipeline::plan::DrawPlan;

/// Wall-clock time of each stage. All threads draw and shade tiles in turn: the time of both is divided in proportion
/// to the thread time spent on each.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TiledTimes {
    /// Planning and vertex processing.
    pub(crate) transform: Duration,
    /// Culling, clipping and binning.
    pub(crate) cull: Duration,
    /// Coverage and depth.
    pub(crate) rasterize: Duration,
    /// Interpolation and shading.
    pub(crate) shade: Duration,
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

/// Counts of triangles, vertices, samples and texels of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TiledCounts {
    /// Triangles in the scene.
    pub(crate) triangles_in: u64,
    /// Triangles in draws that are not entirely outside the view.
    pub(crate) considered: u64,
    /// Triangles, and pieces of clipped ones, that pass facing culling.
    pub(crate) rasterized: u64,
    /// Rasterized triangles that may contain a sample.
    pub(crate) kept: u64,
    /// Bin entries: pairs of a triangle and a tile.
    pub(crate) binned: u64,
    /// Samples tested individually.
    pub(crate) visited: u64,
    /// Samples accepted in whole blocks.
    pub(crate) uniform: u64,
    /// Vertices transformed.
    pub(crate) vertices: u64,
    /// Samples shaded.
    pub shaded: u64,
    /// Texels read.
    pub texels: u64,
}

/// Report of a finished frame.
#[derive(Clone, Debug, Default)]
pub struct TiledReport {
    /// One plan per instance.
    pub(crate) plans: Vec<DrawPlan>,
    /// Time of each stage.
    pub(crate) times: TiledTimes,
    /// Counts of the frame.
    pub counts: TiledCounts,
}
