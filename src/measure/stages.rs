//! Where the time of a frame goes, stage by stage.
//!
//! Rasterizing, depth and shading are interleaved sample by sample, and a clock in that loop would cost more than what it
//! measures. They are told apart by drawing the frame three times, each time one stage further, and taking differences.

use std::hint::black_box;
use std::time::{Duration, Instant};

use crate::chain::{Frame, Recipe, redraw};
use crate::pipeline::Until;
use crate::scene::Scene;

/// Time of each stage of a frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct StageTimes {
    /// Plan and vertices.
    pub transform: Duration,
    /// Clipping.
    pub clip: Duration,
    /// Division and snapping.
    pub project: Duration,
    /// Facing and edge setup.
    pub cull: Duration,
    /// Finding covered samples.
    pub rasterize: Duration,
    /// Depth test and store.
    pub depth: Duration,
    /// Interpolating and shading.
    pub shade: Duration,
    /// Filling in.
    pub upscale: Duration,
}

impl StageTimes {
    /// The stages with their names, in their order.
    pub fn named(&self) -> [(&'static str, Duration); 8] {
        [
            ("transform", self.transform),
            ("clip", self.clip),
            ("project", self.project),
            ("cull", self.cull),
            ("rasterize", self.rasterize),
            ("depth", self.depth),
            ("shade", self.shade),
            ("upscale", self.upscale),
        ]
    }
}

/// Times every stage of a frame that was drawn of `scene` by `recipe`; costs about two more frames.
pub fn stage_times(scene: &Scene, recipe: &Recipe, frame: &Frame) -> StageTimes {
    let time_until = |until| {
        let start = Instant::now();
        black_box(redraw(scene, recipe, frame, until, &mut ()));
        start.elapsed()
    };
    let [coverage, depth, shade] = [Until::Coverage, Until::Depth, Until::Shade].map(time_until);
    let geometry = frame.geometry.times;
    StageTimes {
        transform: geometry.transform,
        clip: geometry.clip,
        project: geometry.project,
        cull: geometry.cull,
        rasterize: coverage,
        depth: depth.saturating_sub(coverage),
        shade: shade.saturating_sub(depth),
        upscale: frame.times.upscale,
    }
}
