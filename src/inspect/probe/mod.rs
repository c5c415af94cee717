//! How firmly a picture stands: the view is drawn again and again with its camera or its vertices moved by a few units in
//! the last place, and every pixel is told by how often something else came out.
//!
//! What changes under a jitter that small does not depend on the scene but on rounding: surfaces that fight for one depth,
//! edges that pass through the centres of pixels. Everything is decided by a seed, so a finding can be repeated. What is
//! drawn is the pipeline's own picture, one sample in the centre of every pixel: no anti-aliasing, no upscaler, no filter.

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

pub use heat::{Heat, map_color, picture};

choice! {
    /// What is moved.
    Jittered {
        Camera = "camera", "Camera", "Eye and target move, each along x, y and z by up to k units in the last place of their largest coordinate: all of the picture is computed anew.";
        Vertices = "vertices", "Vertices", "Every vertex moves, along x, y and z by up to k units in the last place of its largest coordinate; vertices at one place stay together.";
    }
}

/// A probe: plain data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Probe {
    /// What is moved.
    pub what: Jittered,
    /// By how many units in the last place at most, k.
    pub ulps: u32,
    /// How many times.
    pub runs: u16,
    /// Equal seeds give equal jitter.
    pub seed: u64,
}

impl Default for Probe {
    fn default() -> Self {
        Self { what: Jittered::Camera, ulps: 1, runs: 32, seed: 1 }
    }
}

/// What is probed: all that one picture is drawn from.
#[derive(Clone, Debug)]
pub struct Subject {
    /// The scene.
    pub scene: Arc<Scene>,
    /// The view.
    pub camera: Camera,
    /// How it is drawn.
    pub settings: Settings,
    /// How large.
    pub viewport: Viewport,
}

impl Subject {
    /// Whether both give the same picture.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene)
            && (self.camera, self.settings, self.viewport) == (other.camera, other.settings, other.viewport)
    }
}

/// A triangle that came or went.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Fragile {
    /// The triangle.
    pub triangle: TriangleId,
    /// Pixels that it lost or gained, added up over all runs.
    pub changes: u64,
    /// The one of these pixels that changed its owner most often: column and row.
    pub worst_pixel: (u32, u32),
    /// In how many runs that pixel had another owner.
    pub worst_changes: u16,
}

/// What a probe found. All pictures have the size of the subject's viewport and count runs.
#[derive(Clone, Debug)]
pub struct ProbeResult {
    /// What was asked.
    pub probe: Probe,
    /// Of what.
    pub subject: Subject,
    /// In how many runs another triangle won the pixel than without jitter, or none at all, or one instead of none.
    pub owner_changes: Image<u16>,
    /// In how many runs another depth was stored, be it by one step; `None` without a depth test.
    pub depth_changes: Option<Image<u16>>,
    /// In how many runs the colour was another.
    pub color_changes: Image<u16>,
    /// Who won each pixel without jitter.
    pub owners: Image<TriangleId>,
    /// The picture without jitter.
    pub picture: Image<Rgba8>,
    /// Triangles that lost or gained pixels, the most fragile first.
    pub ranking: Vec<Fragile>,
}

/// One figure of a [`Summary`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Changed {
    /// Pixels that changed in one run at least.
    pub pixels: u64,
    /// In how many runs the one did that changed most often.
    pub most: u16,
}

/// A result in few numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Summary {
    /// Pixels of the picture.
    pub pixels: u64,
    /// Of the owner.
    pub owner: Changed,
    /// Of the depth.
    pub depth: Option<Changed>,
    /// Of the colour.
    pub color: Changed,
    /// Triangles that lost or gained pixels.
    pub fragile_triangles: usize,
}

impl ProbeResult {
    /// In few numbers.
    pub fn summary(&self) -> Summary {
        let changed = |counts: &Image<u16>| Changed {
            pixels: counts.pixels().iter().filter(|count| **count > 0).count() as u64,
            most: counts.pixels().iter().copied().max().unwrap_or(0),
        };
        Summary {
            pixels: self.owner_changes.pixels().len() as u64,
            owner: changed(&self.owner_changes),
            depth: self.depth_changes.as_ref().map(changed),
            color: changed(&self.color_changes),
            fragile_triangles: self.ranking.len(),
        }
    }

    /// How often the pixels changed in a respect; `None` where there is no depth.
    pub fn counts(&self, heat: Heat) -> Option<&Image<u16>> {
        match heat {
            Heat::Owner => Some(&self.owner_changes),
            Heat::Depth => self.depth_changes.as_ref(),
            Heat::Color => Some(&self.color_changes),
        }
    }

    /// A fragile triangle as it is drawn without jitter: of its pieces, if it was cut, the one that covers its worst pixel
    /// or else the first. `None` if it is not rasterized at all without jitter.
    pub fn triangle_of(&self, fragile: &Fragile) -> Option<ScreenTriangle> {
        let Subject { scene, camera, settings, viewport } = &self.subject;
        let geometry = prepare(scene, camera, settings, *viewport, &mut ());
        let pieces = || geometry.triangles.iter().filter(|triangle| triangle.id == fragile.triangle);
        let covering = pieces().find(|piece| covers(piece, settings, fragile.worst_pixel));
        covering.or_else(|| pieces().next()).copied()
    }
}

/// Whether a triangle covers the centre of a pixel, by the very rasterizer that draws it.
fn covers(triangle: &ScreenTriangle, settings: &Settings, (x, y): (u32, u32)) -> bool {
    let mut spans = Vec::new();
    let how = (settings.rasterizer, settings.arithmetic, settings.fill_rule);
    cover_within(how, triangle.corners_px(), (SampleGrid::FULL, Scissor::pixel(x, y)), &mut spans);
    !spans.is_empty()
}

/// Probes a view on the threads of the present rayon pool. `tell` hears the share of the runs that are done, in [0, 1];
/// nothing is returned once `stop` is set. Equal probe and equal subject give an equal result on any number of threads.
pub fn run(subject: &Subject, probe: Probe, tell: &dyn Fn(f32), stop: &AtomicBool) -> Option<ProbeResult> {
    let mut tally = tally::Tally::new(draw::still(subject), subject.scene.triangle_count());
    let at_once = rayon::current_num_threads().max(1);
    let runs: Vec<u16> = (0..probe.runs).collect();
    for (index, batch) in runs.chunks(at_once).enumerate() {
        if stop.load(Ordering::Relaxed) {
            return None;
        }
        tell((index * at_once) as f32 / runs.len() as f32);
        let drawn: Vec<_> = batch.par_iter().map(|run| draw::jittered(subject, probe, *run)).collect();
        // In the order of the runs, whoever was done first.
        drawn.iter().for_each(|drawn| tally.add(drawn));
    }
    Some(tally.finish(subject.clone(), probe))
}

#[cfg(test)]
mod tests;
