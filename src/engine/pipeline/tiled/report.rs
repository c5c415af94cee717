//! Report of a frame drawn by tiled execution.

use std::ops::AddAssign;
use std::sync::Arc;
use std::time::Duration;

use crate::pipeline::plan::DrawPlan;

/// Wall-clock time of each stage of a frame.
///
/// Each thread alternates between rasterizing and shading tiles. The wall-clock time of both stages is divided in
/// proportion to the thread time spent on each.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TiledTimes {
    /// Time spent planning draws and processing vertices.
    pub(crate) transform: Duration,
    /// Time spent on culling, clipping and binning.
    pub(crate) cull: Duration,
    /// Time spent on rasterization: coverage and depth.
    pub(crate) rasterize: Duration,
    /// Time spent on interpolation and shading.
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

/// Work counts of a frame: triangles, vertices, samples and texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TiledCounts {
    /// Number of triangles in the scene.
    pub(crate) triangles_in: u64,
    /// Number of triangles in draws that are not entirely outside the view.
    pub(crate) considered: u64,
    /// Number of triangles that pass face culling, including pieces of clipped triangles.
    pub(crate) rasterized: u64,
    /// Number of rasterized triangles that may cover a sample.
    pub(crate) kept: u64,
    /// Number of bin entries: pairs of a triangle and a tile.
    pub(crate) binned: u64,
    /// Number of samples whose coverage was tested individually.
    pub(crate) visited: u64,
    /// Number of samples in blocks that were accepted as a whole.
    pub(crate) uniform: u64,
    /// Number of vertices transformed.
    pub(crate) vertices: u64,
    /// Number of samples shaded.
    pub shaded: u64,
    /// Number of texels read.
    pub texels: u64,
}

/// Report of a finished frame: draw plans, stage times and work counts.
#[derive(Clone, Debug, Default)]
pub struct TiledReport {
    /// Draw plan of each instance.
    pub(crate) plans: Arc<Vec<DrawPlan>>,
    /// Wall-clock time of each stage.
    pub(crate) times: TiledTimes,
    /// Work counts of the frame.
    pub counts: TiledCounts,
}
