//! Stability probe: draws a view repeatedly with its camera or vertices moved by a few units in the last place, and
//! counts how often each pixel changes.
//!
//! Changes under such small jitter come from rounding, not from the scene: z-fighting surfaces, or edges through pixel
//! centres. A seed determines all jitter, so a finding is reproducible. The pipeline draws one sample at the centre of
//! every pixel, without anti-aliasing, upscaler or post filter.

mod draw;

mod heat;

mod jitter;

mod tally;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use serde::Serialize;

use crate::image::{Image, Rgba8};
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::prepare;
use crate::pipeline::raster::{Scissor, cover_within};
use crate::pipeline::settings::{Choice, Settings, choice};
use crate::pipeline::viewport::{ScreenTriangle, Viewport};
use crate::scene::{Camera, Scene, TriangleId};

pub use heat::Heat;
pub use heat::map_color;
pub use heat::picture;

choice! {
    /// Part of a view that the stability probe moves.
    pub JitterTarget {
        Camera = "camera", "Camera", "Eye and target move along x, y and z by up to the given number of units in the last place of their largest coordinate: the whole picture is recomputed.";
        Vertices = "vertices", "Vertices", "Every vertex moves along x, y and z by up to the given number of units in the last place of its largest coordinate; vertices at the same position move together.";
    }
}

/// Parameters of a stability probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Probe {
    /// Part of the view that is moved.
    pub what: JitterTarget,
    /// Maximum movement of a coordinate, in units in the last place of the largest coordinate.
    pub ulps: u32,
    /// Number of jittered runs.
    pub runs: u16,
    /// Seed of the jitter; equal seeds give equal jitter.
    pub seed: u64,
}

impl Default for Probe {
    fn default() -> Self {
        Self { what: JitterTarget::Camera, ulps: 1, runs: 32, seed: 1 }
    }
}

/// View that is probed, with everything needed to draw it.
#[derive(Clone, Debug)]
pub struct ProbedView {
    /// Scene of the view.
    pub scene: Arc<Scene>,
    /// Camera without jitter.
    pub camera: Camera,
    /// Pipeline settings for drawing the view.
    pub settings: Settings,
    /// Size of the picture, in pixels.
    pub viewport: Viewport,
}

impl ProbedView {
    /// Whether both views have the same scene, camera, settings and size, so that they give the same picture.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene)
            && (self.camera, self.settings, self.viewport) == (other.camera, other.settings, other.viewport)
    }
}

/// Triangle that gained or lost pixels during a stability probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Fragile {
    /// Triangle that gained or lost pixels.
    pub triangle: TriangleId,
    /// Number of pixels that the triangle gained or lost, summed over all runs.
    pub changes: u64,
    /// Column and row of the pixel whose owner changed in the most runs, among the pixels that the triangle gained or
    /// lost.
    pub worst_pixel: (u32, u32),
    /// Number of runs in which `worst_pixel` had a different owner.
    pub worst_changes: u16,
}

/// Result of a stability probe. All images have the size of the probed view, and all counts are numbers of runs.
#[derive(Clone, Debug)]
pub struct ProbeResult {
    /// Parameters of the probe.
    pub probe: Probe,
    /// View that was probed.
    pub subject: ProbedView,
    /// Number of runs in which the owner of each pixel differed from the owner without jitter. A pixel that has an
    /// owner in only one of the two pictures counts as different.
    pub(crate) owner_changes: Image<u16>,
    /// Number of runs in which the stored depth of each pixel differed from the depth without jitter, even by one step;
    /// `None` without a depth test.
    pub(crate) depth_changes: Option<Image<u16>>,
    /// Number of runs in which the colour of each pixel differed from the colour without jitter.
    pub(crate) color_changes: Image<u16>,
    /// Triangle that owns each pixel in the picture without jitter.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests compare it with the exact owners"))]
    pub(crate) owners: Image<TriangleId>,
    /// Picture without jitter, as sRGB codes.
    pub(crate) picture: Image<Rgba8>,
    /// Triangles that lost or gained pixels, most fragile first.
    pub ranking: Vec<Fragile>,
}

/// Summary of the pixels that changed in one aspect, such as depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Changed {
    /// Number of pixels that changed in at least one run.
    pub pixels: u64,
    /// Number of runs in which the most frequently changed pixel changed.
    pub most: u16,
}

/// Summary of the result of a stability probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct ProbeSummary {
    /// Number of pixels in the picture.
    pub pixels: u64,
    /// Changes of the triangle that owns a pixel.
    pub owner: Changed,
    /// Changes of the stored depth; `None` without a depth test.
    pub depth: Option<Changed>,
    /// Changes of the pixel colour.
    pub color: Changed,
    /// Number of triangles that lost or gained pixels.
    pub fragile_triangles: usize,
}

impl ProbeResult {
    /// Summarises the changes over all pixels.
    pub fn summary(&self) -> ProbeSummary {
        let changed = |counts: &Image<u16>| Changed {
            pixels: counts.pixels().iter().filter(|count| **count > 0).count() as u64,
            most: counts.pixels().iter().copied().max().unwrap_or(0),
        };
        ProbeSummary {
            pixels: self.owner_changes.pixels().len() as u64,
            owner: changed(&self.owner_changes),
            depth: self.depth_changes.as_ref().map(changed),
            color: changed(&self.color_changes),
            fragile_triangles: self.ranking.len(),
        }
    }

    /// Returns, for each pixel, the number of runs in which one aspect changed; `None` for depth without a depth test.
    pub fn counts(&self, heat: Heat) -> Option<&Image<u16>> {
        match heat {
            Heat::Owner => Some(&self.owner_changes),
            Heat::Depth => self.depth_changes.as_ref(),
            Heat::Color => Some(&self.color_changes),
        }
    }

    /// Returns a fragile triangle as rasterized without jitter; `None` if it is not rasterized. For a clipped triangle,
    /// returns the piece that covers its worst pixel, or else the first piece.
    pub fn triangle_of(&self, fragile: &Fragile) -> Option<ScreenTriangle> {
        let ProbedView { scene, camera, settings, viewport } = &self.subject;
        let geometry = prepare(scene, camera, settings, *viewport, &mut ());
        let pieces = || geometry.triangles.iter().filter(|triangle| triangle.id == fragile.triangle);
        let covering = pieces().find(|piece| covers(piece, settings, fragile.worst_pixel));
        covering.or_else(|| pieces().next()).copied()
    }
}

/// Whether a triangle covers the centre of a pixel, according to the rasterizer in `settings`.
fn covers(triangle: &ScreenTriangle, settings: &Settings, (x, y): (u32, u32)) -> bool {
    let mut spans = Vec::new();
    let how = (settings.rasterizer, settings.arithmetic, settings.fill_rule);
    cover_within(how, triangle.corners_px(), (SampleGrid::FULL, Scissor::pixel(x, y)), &mut spans);
    !spans.is_empty()
}

/// Probes a view on the threads of the current rayon pool. Calls `report_progress` with the progress in [0, 1]. Returns
/// `None` once `stop` is set. Equal probes of equal views give equal results on any number of threads.
pub fn run(
    subject: &ProbedView,
    probe: Probe,
    report_progress: &dyn Fn(f32),
    stop: &AtomicBool,
) -> Option<ProbeResult> {
    let mut tally = tally::ProbeTally::new(draw::draw_still(subject), subject.scene.triangle_count());
    let at_once = rayon::current_num_threads().max(1);
    let runs: Vec<u16> = (0..probe.runs).collect();
    for (index, batch) in runs.chunks(at_once).enumerate() {
        if stop.load(Ordering::Relaxed) {
            return None;
        }
        report_progress((index * at_once) as f32 / runs.len() as f32);
        let drawn: Vec<_> = batch.par_iter().map(|run| draw::jittered(subject, probe, *run)).collect();
        // Adds results in the order of the runs, independent of the order in which threads finish.
        drawn.iter().for_each(|drawn| tally.add(drawn));
    }
    Some(tally.finish(subject.clone(), probe))
}

#[cfg(test)]
mod tests;
