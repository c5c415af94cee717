//! Tiled execution, on all threads.

use std::sync::Arc;

use super::{Executed, Executor, Pass, PassTimes, Purpose};
use crate::chain::KeepDepth;
use crate::chain::frame::LazyGeometry;
use crate::chain::pixel_samples::with_pixel_samples;
use crate::chain::pool::BufferPool;
use crate::math::lanes::Lanes;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::framebuffer::{Framebuffer, UsedImages};
use crate::pipeline::settings::Execution;
use crate::pipeline::tiled::{self, PixelSamples, TiledMemory, TiledReport};
use crate::pipeline::{DrawnView, prepare};
use crate::scene::Scene;

/// Executor that keeps its working memory from frame to frame.
pub(in crate::chain) struct TiledExecutor<'a> {
    scene: &'a Arc<Scene>,
    memory: &'a mut TiledMemory,
    lanes: Lanes,
    /// Report of the pass [`Purpose::Frame`], or of the first one if that was not drawn, with the times of all passes.
    report: Option<TiledReport>,
}

impl<'a> TiledExecutor<'a> {
    pub(in crate::chain) fn new(scene: &'a Arc<Scene>, memory: &'a mut TiledMemory, lanes: Lanes) -> Self {
        Self { scene, memory, lanes, report: None }
    }

    fn draw_samples(
        &mut self,
        pass: &Pass<'_>,
        samples: PixelSamples<'_>,
        pool: &mut BufferPool,
    ) -> (Framebuffer, TiledReport) {
        let (Pass { scene, camera, area, .. }, settings) = (pass, &pass.recipe.pipeline);
        let (size, keep) = (area.packed_size(), pass.keep_depth);
        let color = pool.codes(size);
        let memory = UsedImages { color, depth: if keep == KeepDepth::Yes { pool.numbers(size) } else { None } };
        let mut drawn = Framebuffer::reusing(*area, memory, settings, keep);
        drawn.depth_scale = DepthScale::of(settings, camera);
        let view = DrawnView { scene, camera, settings, viewport: area.raster };
        let report = tiled::draw(&view, &mut drawn, samples, self.memory, self.lanes);
        (drawn, report)
    }

    fn add(&mut self, report: TiledReport) {
        match &mut self.report {
            Some(first) => first.times += report.times,
            None => self.report = Some(report),
        }
    }
}

impl Executor for TiledExecutor<'_> {
    const EXECUTION: Execution = Execution::Tiled;

    fn draw(&mut self, pass: &Pass<'_>, pool: &mut BufferPool) -> Framebuffer {
        let samples_of = match pass.purpose {
            Purpose::Frame => pass.recipe.antialias,
            Purpose::Supersample | Purpose::Surfaces => Default::default(),
        };
        let (drawn, report) =
            with_pixel_samples(samples_of, self.lanes, |samples| self.draw_samples(pass, samples, pool));
        if pass.purpose != Purpose::Surfaces {
            self.add(report);
        }
        drawn
    }

    fn finish(self, frame: &Pass<'_>) -> Executed {
        let (scene, camera) = (Arc::clone(self.scene), frame.camera);
        let (settings, raster) = (frame.recipe.pipeline, frame.area.raster);
        let report = self.report.unwrap_or_default();
        let times = PassTimes {
            geometry: report.times.transform + report.times.cull,
            pixels: report.times.rasterize + report.times.shade,
        };
        Executed {
            geometry: LazyGeometry::computed_by(move || prepare(&scene, &camera, &settings, raster, &mut ())),
            plans: Arc::clone(&report.plans),
            times,
            tiled: Some(report),
        }
    }
}
