//! Classic execution: draws one triangle after the other and reports every step to an [`Observer`].

use std::sync::Arc;
use std::time::Instant;

use super::{Executed, Executor, Pass, PassTimes, Purpose};
use crate::chain::frame::LazyGeometry;
use crate::chain::pool::BufferPool;
use crate::chain::samples;
use crate::pipeline::area::DrawnArea;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::observe::Observer;
use crate::pipeline::settings::{Execution, Settings};
use crate::pipeline::{DrawCall, Extent, Geometry, LastStage, prepare};
use crate::scene::Scene;

/// Executor whose observer receives the samples of the pass [`Purpose::Frame`].
pub(in crate::chain) struct ClassicExecutor<'a, O> {
    observer: &'a mut O,
    geometry: Option<Geometry>,
    times: PassTimes,
}

impl<'a, O: Observer> ClassicExecutor<'a, O> {
    pub(in crate::chain) fn new(observer: &'a mut O) -> Self {
        Self { observer, geometry: None, times: PassTimes::default() }
    }
}

impl<O: Observer> Executor for ClassicExecutor<'_, O> {
    const EXECUTION: Execution = Execution::Classic;

    fn draw(&mut self, pass: &Pass<'_>, _: &mut BufferPool) -> Framebuffer {
        let (drawn, times) = match pass.purpose {
            Purpose::Frame => {
                let DrawnPass { mut drawn, geometry, mut times } = draw_pass(pass, self.observer);
                if pass.recipe.antialias.is_per_pixel() {
                    let begun = Instant::now();
                    drawn.color = samples::per_pixel(pass.scene, &geometry, pass.recipe, pass.area);
                    times.pixels += begun.elapsed();
                }
                self.geometry = Some(geometry);
                (drawn, times)
            }
            Purpose::Supersample | Purpose::Surfaces => {
                let DrawnPass { drawn, times, .. } = draw_pass(pass, &mut ());
                (drawn, times)
            }
        };
        if pass.purpose != Purpose::Surfaces {
            self.times += times;
        }
        drawn
    }

    fn finish(self, frame: &Pass<'_>) -> Executed {
        let geometry = self.geometry.unwrap_or_else(|| prepared(frame, &mut ()));
        let plans = Arc::new(geometry.plans.clone());
        Executed { geometry: LazyGeometry::made(geometry), plans, times: self.times, tiled: None }
    }
}

/// Result of one pass.
struct DrawnPass {
    drawn: Framebuffer,
    geometry: Geometry,
    times: PassTimes,
}

fn draw_pass<O: Observer>(pass: &Pass<'_>, observer: &mut O) -> DrawnPass {
    let begun = Instant::now();
    let geometry = prepared(pass, observer);
    let prepared = Instant::now();
    let Pass { scene, recipe, area, .. } = *pass;
    let drawing = Drawing { scene, settings: &recipe.pipeline, geometry: &geometry, area };
    let drawn = drawing.draw(LastStage::Shade, observer);
    DrawnPass { drawn, geometry, times: PassTimes { geometry: prepared - begun, pixels: prepared.elapsed() } }
}

fn prepared<O: Observer>(pass: &Pass<'_>, observer: &mut O) -> Geometry {
    prepare(pass.scene, &pass.camera, &pass.recipe.pipeline, pass.area.raster, observer)
}

/// Triangles to draw into a new framebuffer.
pub(in crate::chain) struct Drawing<'a> {
    pub(in crate::chain) scene: &'a Scene,
    pub(in crate::chain) settings: &'a Settings,
    pub(in crate::chain) geometry: &'a Geometry,
    pub(in crate::chain) area: DrawnArea,
}

impl Drawing<'_> {
    /// Draws the triangles up to and including the stage `until`.
    pub(in crate::chain) fn draw<O: Observer>(&self, until: LastStage, observer: &mut O) -> Framebuffer {
        let Self { scene, settings, geometry, area: DrawnArea { grid, raster } } = *self;
        let mut drawn = Framebuffer::new(grid, raster.width, raster.height, scene.background, settings);
        let extent = &Extent::all(geometry, raster);
        DrawCall { scene, geometry, settings, extent, until }.draw(&mut drawn, observer);
        drawn.depth_scale = geometry.depth_scale;
        drawn
    }
}
