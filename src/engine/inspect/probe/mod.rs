//! Stability probe: draws a view repeatedly with its camera or vertices moved by a few units in the last place, and
//! counts how often each pixel changes.
//!
//! Changes under such small jitter come from rounding, not from the scene: z-fighting surfaces, or edges through pixel
//! centres. A seed determines all jitter, so a finding is reproducible. The pipeline draws one sample at the centre of
//! every pixel, without anti-aliasing, upscaler or post filter.

mod counts;

mod draw;

mod findings;

mod heat;

mod jitter;

use std::sync::Arc;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::image::{Image, Rgba8, png_text};
use crate::inspect::control::TaskControl;
use crate::measure::shard::Shard;
use crate::pipeline::prepare;
use crate::pipeline::raster::SampleArea;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::{Choice, Settings, choice};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};

pub use counts::ProbeCounts;
pub use findings::{Changed, Fragile, ProbeFindings, ProbeSummary};
pub use heat::map_color;
pub use heat::picture;

choice! {
    /// Part of a view that the stability probe moves.
    pub JitterTarget {
        Camera = "camera", "Camera", "Eye and target move along x, y and z by up to the given number of units in the last place of their largest coordinate: the whole picture is recomputed.";
        Vertices = "vertices", "Vertices", "Every vertex moves along x, y and z by up to the given number of units in the last place of its largest coordinate; vertices at the same position move together.";
    }
}

choice! {
    /// Aspect in which the stability probe compares pixels.
    pub Heat {
        Owner = "owner", "Owner", "Number of runs in which a different triangle was visible at the pixel.";
        Depth = "depth", "Depth", "Number of runs in which the stored depth of the pixel differed, even by one step.";
        Color = "color", "Colour", "Number of runs in which the colour of the pixel differed.";
    }
}

/// Parameters of a stability probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
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

/// Everything that determines the result of a stability probe, without the scene itself.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ProbePlan {
    /// Name of the scene.
    pub scene: String,
    /// Number of triangles of the scene.
    triangles: usize,
    camera: Value,
    settings: Value,
    /// Parameters of the probe.
    pub probe: Probe,
    /// Picture that is drawn without jitter, as sRGB codes. Plans with different pictures belong to different scenes.
    #[serde(with = "png_text")]
    pub picture: Image<Rgba8>,
}

impl ProbePlan {
    /// Creates the plan of a probe, and draws its picture without jitter.
    pub fn new(subject: &ProbedView, probe: Probe) -> Self {
        Self {
            scene: subject.scene.name.clone(),
            triangles: subject.scene.triangle_count(),
            // Plain data can always be written.
            camera: serde_json::to_value(subject.camera).unwrap_or_default(),
            settings: serde_json::to_value(subject.settings).unwrap_or_default(),
            probe,
            picture: draw::draw_still(subject).color,
        }
    }
}

/// Result of a stability probe of a view.
#[derive(Clone, Debug)]
pub struct ProbeResult {
    /// View that was probed.
    pub subject: ProbedView,
    /// Pixels and triangles that changed.
    pub findings: ProbeFindings,
}

impl ProbeResult {
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
fn covers(triangle: &ScreenTriangle, settings: &Settings, pixel: (u32, u32)) -> bool {
    let mut spans = Vec::new();
    settings.coverage_rules().cover_within(triangle.corners_px(), SampleArea::pixel(pixel), &mut spans);
    !spans.is_empty()
}

/// Probes a view on the threads of the current rayon pool. Returns `None` if cancelled. Equal probes of equal views give
/// equal results on any number of threads.
pub fn run(subject: &ProbedView, probe: Probe, control: TaskControl<'_>) -> Option<ProbeResult> {
    let counts = count(subject, probe, Shard::WHOLE, control)?;
    let picture = draw::draw_still(subject).color;
    Some(ProbeResult { subject: subject.clone(), findings: ProbeFindings::new(probe, picture, &counts) })
}

/// Counts the changes of the runs that belong to a shard, as [`run`] does for all runs.
pub fn count(subject: &ProbedView, probe: Probe, shard: Shard, control: TaskControl<'_>) -> Option<ProbeCounts> {
    let still = draw::draw_still(subject);
    let mut counts = ProbeCounts::new(still.depth.is_some());
    let at_once = rayon::current_num_threads().max(1);
    let runs: Vec<u16> = (0..probe.runs).filter(|run| shard.owns((*run).into())).collect();
    for (index, batch) in runs.chunks(at_once).enumerate() {
        control.check()?;
        (control.progress)((index * at_once) as f32 / runs.len() as f32);
        let drawn: Vec<_> = batch.par_iter().map(|run| draw::jittered(subject, probe, *run)).collect();
        drawn.iter().for_each(|drawn| counts.add(&still, drawn));
    }
    Some(counts)
}

#[cfg(test)]
mod tests;
