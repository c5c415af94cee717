//! Counters of the work and the times of a frame.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use super::shade::ShadingWork;
use super::tile::TileCounts;

/// Work on one tile, with the times that it took.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TileWork {
    pub(super) rasterize: Duration,
    pub(super) shade: Duration,
    pub(super) coverage: TileCounts,
    pub(super) shading: ShadingWork,
}

/// Work counters and stage times of a frame, which all threads add to.
#[derive(Debug, Default)]
pub(super) struct FrameCounters {
    rasterize_ns: AtomicU64,
    shade_ns: AtomicU64,
    pub(super) visited: AtomicU64,
    pub(super) uniform: AtomicU64,
    pub(super) shaded: AtomicU64,
    pub(super) texels: AtomicU64,
}

impl FrameCounters {
    /// Adds the work on one tile.
    pub(super) fn add(&self, TileWork { rasterize, shade, coverage, shading }: TileWork) {
        self.rasterize_ns.fetch_add(rasterize.as_nanos() as u64, Ordering::Relaxed);
        self.shade_ns.fetch_add(shade.as_nanos() as u64, Ordering::Relaxed);
        self.visited.fetch_add(coverage.visited, Ordering::Relaxed);
        self.uniform.fetch_add(coverage.uniform, Ordering::Relaxed);
        self.shaded.fetch_add(shading.samples, Ordering::Relaxed);
        self.texels.fetch_add(shading.texels, Ordering::Relaxed);
    }

    /// Returns the part of a time that all threads together spent on rasterizing rather than on shading.
    pub(super) fn share_of_rasterizing(&self, time: Duration) -> Duration {
        let rasterize = self.rasterize_ns.load(Ordering::Relaxed) as f64;
        let shade = self.shade_ns.load(Ordering::Relaxed) as f64;
        time.mul_f64(if rasterize > 0.0 { rasterize / (rasterize + shade) } else { 0.0 })
    }
}
