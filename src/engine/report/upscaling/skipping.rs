//! Comparison of two ways to draw fewer pixels: skipping unwanted pixels inside the loop, as naive renderers do, or not
//! visiting them at all.
//!
//! The naive loop iterates over the bounding box of a triangle pixel by pixel and skips unwanted ones. That saves their
//! shading, but rasterization still visits every pixel. A [`SampleGrid`] iterates over the wanted samples only. Both
//! give the same samples. Here both are timed on one thread, with the same edge functions, depth test and shading.

use std::hint::black_box;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::measure::timing::{Summary, summarize};
use crate::pipeline::depth::DepthComparison;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::interpolate::interpolate;
use crate::pipeline::raster::{Fixed, RasterTriangle};
use crate::pipeline::screen_triangle::depth_at;
use crate::pipeline::settings::{Arithmetic, Rasterizer, Settings};
use crate::pipeline::viewport::Viewport;
use crate::pipeline::{DrawCall, DrawnView, Extent, LastStage, prepare};
use crate::scene::Transparency;

/// Sample grids to measure: every pixel, ½, ¼, 1/9 and 1/16 of the pixels.
const GRIDS: [SampleGrid; 5] = [
    SampleGrid::FULL,
    SampleGrid::Checkerboard,
    SampleGrid::Block { step: 2 },
    SampleGrid::Block { step: 3 },
    SampleGrid::Block { step: 4 },
];

/// Frame times of both ways to draw a given fraction of the pixels, in milliseconds.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct PixelShareTimes {
    /// Fraction of the pixels that are drawn, in (0, 1].
    pub(crate) drawn: f64,
    /// Frame time if pixels are skipped inside the loop.
    pub(crate) skipping: Split,
    /// Frame time if only the wanted pixels are visited.
    pub(crate) visiting: Split,
}

/// Frame time split into rasterization and shading, in milliseconds.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Split {
    /// Time spent clearing the framebuffer, finding samples and testing their depth, in milliseconds.
    pub(crate) raster: Summary,
    /// Duration of the whole frame, including shading, in milliseconds. The difference from `raster` is the shading
    /// time.
    pub(crate) whole: Summary,
}

impl Split {
    /// Returns the median shading time in milliseconds; 0 if it is too short to measure.
    pub(crate) fn shade_ms(&self) -> f64 {
        (self.whole.median - self.raster.median).max(0.0)
    }
}

/// Whether the naive loop can draw this view. It supports only opaque surfaces.
pub(crate) fn applies(view: &DrawnView<'_>) -> bool {
    let geometry = prepare(view.scene, view.camera, &settings(view.settings), view.viewport, &mut ());
    geometry.plans.iter().all(|plan| plan.transparency() == Transparency::Opaque)
}

/// Returns the settings with the only rasterizer and arithmetic that the naive loop supports.
fn settings(settings: &Settings) -> Settings {
    Settings { rasterizer: Rasterizer::BoundingBox, arithmetic: Arithmetic::Fixed, ..*settings }
}

/// Times both ways to draw fewer pixels, with every sample grid, in interleaved rounds after one warm-up round. Returns
/// `None` if cancelled.
pub(crate) fn measure(
    view: &DrawnView<'_>,
    rounds: usize,
    cancelled: &dyn Fn() -> bool,
) -> Option<Vec<PixelShareTimes>> {
    let DrawnView { scene, camera, viewport, .. } = *view;
    let settings = settings(view.settings);
    let geometry = prepare(scene, camera, &settings, viewport, &mut ());
    let extent = Extent::all(&geometry, viewport);
    let whole = DrawCall::new(scene, &geometry, &settings, &extent);
    let runs = GRIDS.len() * 4;
    let mut times = vec![Vec::with_capacity(rounds); runs];
    for round in 0..=rounds {
        for (place, times) in times.iter_mut().enumerate() {
            if cancelled() {
                return None;
            }
            let grid = GRIDS[place / 4];
            let until = if place.is_multiple_of(2) { LastStage::Depth } else { LastStage::Shade };
            let start = Instant::now();
            let call = DrawCall { until, ..whole };
            black_box(if place % 4 < 2 {
                draw_skipping(call, viewport, grid)
            } else {
                draw_visiting(call, viewport, grid)
            });
            if round > 0 {
                times.push(start.elapsed().as_secs_f64() * 1e3);
            }
        }
    }
    let pixels = f64::from(viewport.width) * f64::from(viewport.height);
    let summaries: Vec<Summary> = times.iter().filter_map(|times| summarize(times)).collect();
    let shares = GRIDS.iter().zip(summaries.chunks_exact(4)).map(|(grid, s)| PixelShareTimes {
        drawn: grid.drawn_pixels(viewport.width, viewport.height) as f64 / pixels,
        skipping: Split { raster: s[0], whole: s[1] },
        visiting: Split { raster: s[2], whole: s[3] },
    });
    Some(shares.collect())
}

fn draw_visiting(call: DrawCall<'_>, Viewport { width, height }: Viewport, grid: SampleGrid) -> Framebuffer {
    let mut frame = Framebuffer::new(grid, width, height, call.scene.background, call.settings);
    call.draw(&mut frame, &mut ());
    frame
}

/// Draws with the naive loop, which visits every pixel in the bounding box of every triangle and skips unwanted ones.
fn draw_skipping(call: DrawCall<'_>, Viewport { width, height }: Viewport, grid: SampleGrid) -> Framebuffer {
    let DrawCall { scene, geometry, settings, until, .. } = call;
    let mut frame = Framebuffer::new(SampleGrid::FULL, width, height, scene.background, settings);
    let comparison = DepthComparison::of(settings);
    let shaders = call.shaders();
    for triangle in &geometry.triangles {
        let corners_px = triangle.corners_px();
        let Some(edges) = RasterTriangle::<Fixed>::new(corners_px, settings.fill_rule) else { continue };
        let shader = &shaders[triangle.instance as usize];
        let attributes = shader.attributes();
        let range = |axis: usize, size: u32| {
            let all = corners_px.map(|corner| corner[axis]);
            let (low, high) = (all[0].min(all[1]).min(all[2]), all[0].max(all[1]).max(all[2]));
            (low.floor().max(0.0) as u32).min(size)..(high.ceil().max(0.0) as u32).min(size)
        };
        for y in range(1, height) {
            for x in range(0, width) {
                if grid.sample_at(x, y).is_none() || !edges.contains(x.into(), y.into()) {
                    continue;
                }
                let sample = edges.sample((x, y), (x, y));
                if let Some(depth) = &mut frame.depth {
                    let new = depth_at(triangle, &sample);
                    if !comparison.passes(new, depth.at(x, y)) {
                        continue;
                    }
                    depth.set(x, y, new);
                }
                if until == LastStage::Shade {
                    let fragment = interpolate(triangle, sample, attributes);
                    frame.color.set(x, y, shader.shade(&fragment, triangle));
                }
            }
        }
    }
    frame
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use crate::scene::builtin;

    /// Returns the pixels of `full` that the grid samples, as a packed image.
    fn packed<T: Copy>(full: &Image<T>, grid: SampleGrid) -> Image<T> {
        let (width, height) = grid.packed_size(full.width(), full.height());
        Image::from_fn(width, height, |column, row| {
            let (x, y) = grid.pixel(column, row);
            full.at(x.min(full.width() - 1), y)
        })
    }

    #[test]
    fn both_ways_draw_the_same_samples() {
        let scene = builtin::by_id("chess").unwrap().build();
        let settings = settings(&Settings { arithmetic: Arithmetic::F32, ..Settings::default() });
        let viewport = Viewport { width: 96, height: 64 };
        let geometry = prepare(&scene, &scene.home, &settings, viewport, &mut ());
        let extent = Extent::all(&geometry, viewport);
        let call = DrawCall::new(&scene, &geometry, &settings, &extent);
        for grid in GRIDS {
            let skipped = draw_skipping(call, viewport, grid);
            let visited = draw_visiting(call, viewport, grid);
            assert_eq!(packed(&skipped.color, grid), visited.color, "{grid:?}");
        }
    }

    #[test]
    fn every_share_is_timed_both_ways_until_it_is_cancelled() {
        let scene = builtin::by_id("triangle").unwrap().build();
        let (settings, viewport) = (&Settings::default(), Viewport { width: 32, height: 32 });
        let view = DrawnView { scene: &scene, camera: &scene.home, settings, viewport };
        assert!(applies(&view));
        let shares = measure(&view, 3, &|| false).unwrap();
        assert_eq!(shares.iter().map(|share| share.drawn).collect::<Vec<_>>()[..3], [1.0, 0.5, 0.25]);
        assert!(shares.iter().all(|share| share.skipping.whole.n == 3 && share.visiting.whole.median > 0.0));
        assert!(measure(&view, 3, &|| true).is_none());
    }
}
