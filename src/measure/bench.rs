//! What frames of a view cost: time in all and per stage, counts, memory.

use std::hint::black_box;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;
use serde::Serialize;

use super::machine::Machine;
use super::motion::{Playback, Shot, Turn};
use super::noise::{Noise, Pairs};
use super::stages::{StageSummary, summarize_stages};
use super::timing::{Summary, summarize};
use crate::chain::{Frame, Recipe, Renderer};
use crate::math::lanes::Lanes;
use crate::pipeline::settings::Choice as _;
use crate::pipeline::tiled::TiledReport;
use crate::pipeline::viewport::Viewport;
use crate::scene::Scene;

/// Frames before those that count: memory is found, caches and clocks settle.
const WARM_UP_FRAMES: i64 = 3;

/// How long the bytes of a frame take to write when nothing is drawn: what no frame can fall below.
#[derive(Clone, Debug, Serialize)]
pub struct Writing {
    /// Milliseconds to set as many bytes as the frame holds, by the same threads.
    pub ms: Summary,
    /// Median time of a whole frame over the median of these.
    pub frame_over_writing: f64,
}

/// What the frames of one view cost.
#[derive(Clone, Debug, Serialize)]
pub struct BenchReport {
    /// Scene.
    pub scene: String,
    /// Picture size in px.
    pub size: [u32; 2],
    /// Threads that could be used.
    pub threads: usize,
    /// Machine and build, with the load at the start and at the end.
    pub machine: Machine,
    /// Motion of the camera over the frames, which are timed again and again.
    pub turn: Turn,
    /// How frames were executed.
    pub execution: &'static str,
    /// Whether it was cancelled before all frames were drawn.
    pub partial: bool,
    /// Noise floor: every other frame against the frames between; `None` for a single frame.
    pub noise: Option<Noise>,
    /// Milliseconds of a whole frame.
    pub frame_ms: Summary,
    /// Milliseconds of its stages, in their order; they add up to the median frame.
    pub stages: Vec<StageSummary>,
    /// What merely writing it takes.
    pub writing: Writing,
    /// What was done in a frame, in the order of the stages.
    pub counts: Vec<(&'static str, u64)>,
    /// Bytes held by frame, renderer and scene.
    pub bytes: Bytes,
    /// Median nanoseconds per triangle of the scene.
    pub ns_per_triangle: f64,
    /// Median nanoseconds per pixel of the picture.
    pub ns_per_pixel: f64,
}

/// Memory in bytes.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Bytes {
    /// Pictures of one frame.
    pub frame: usize,
    /// What the renderer keeps from frame to frame.
    pub renderer: usize,
    /// Meshes and textures.
    pub scene: usize,
}

/// The frames of a measurement.
#[derive(Clone, Copy, Debug)]
pub struct Frames<'a> {
    /// Number of frames that count, at least 1.
    pub count: usize,
    /// Ends the measurement with the frames drawn so far.
    pub cancel: &'a AtomicBool,
}

/// Durations of one timed frame and its stages.
struct Sample {
    total: Duration,
    stages: Vec<(&'static str, Duration)>,
    /// Bytes of the frame's pictures.
    bytes: usize,
    execution: &'static str,
    counts: Vec<(&'static str, u64)>,
}

/// Draws the frames of a sequence again and again, with the history that they have in it, on the threads of the present rayon
/// pool. `None` if it was cancelled before a frame that counts was complete.
pub fn bench(
    shot: &Shot<'_>,
    recipe: &Recipe,
    Frames { count, cancel }: Frames<'_>,
    lanes: Lanes,
) -> Option<BenchReport> {
    let machine = Machine::at_start();
    let scene = shot.scene;
    let (mut playback, mut renderer) = (Playback::on(*recipe, lanes), Renderer::on(lanes));
    let mut samples: Vec<Sample> = Vec::with_capacity(count);
    for round in -WARM_UP_FRAMES..count as i64 {
        if cancel.load(Ordering::Relaxed) {
            break;
        }
        let number = shot.turn.frame_of_round(round);
        let sample = playback.draw(shot, number, &mut renderer, |frame| Sample {
            total: frame.times.total,
            stages: stages(frame, recipe),
            bytes: frame.image().bytes() + frame.drawn.depth.as_ref().map_or(0, crate::image::Image::bytes),
            execution: frame.execution.id(),
            counts: counts(scene, frame),
        });
        if round >= 0 {
            samples.push(sample);
        }
    }
    let summary = |times: &mut dyn Iterator<Item = Duration>| summarize(&times.map(ms).collect::<Vec<_>>());
    let frame_ms = summary(&mut samples.iter().map(|sample| sample.total))?;
    let mut pairs = Pairs::default();
    pairs.add_alternating(&samples.iter().map(|sample| ms(sample.total)).collect::<Vec<_>>());
    let Viewport { width, height } = shot.viewport;
    let stages: Vec<_> = samples.iter_mut().map(|sample| std::mem::take(&mut sample.stages)).collect();
    let last = samples.last()?;
    let writing = summary(&mut times_of_writing(last.bytes, samples.len()).into_iter())?;
    let renderer_bytes = renderer.bytes() + playback.bytes();
    Some(BenchReport {
        scene: scene.name.clone(),
        size: [width, height],
        threads: rayon::current_num_threads(),
        machine: machine.at_end(),
        turn: shot.turn,
        execution: last.execution,
        partial: samples.len() < count,
        noise: pairs.noise(),
        stages: summarize_stages(&stages)?,
        writing: Writing { frame_over_writing: frame_ms.median / writing.median, ms: writing },
        counts: last.counts.clone(),
        bytes: Bytes { frame: last.bytes, renderer: renderer_bytes, scene: scene.memory().shared_bytes },
        ns_per_triangle: frame_ms.median * 1e6 / scene.triangle_count().max(1) as f64,
        ns_per_pixel: frame_ms.median * 1e6 / (f64::from(width) * f64::from(height)),
        frame_ms,
    })
}

/// Returns a time in milliseconds.
fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// Sets all of some bytes to one value, again and again, each of the pool's threads its share.
fn times_of_writing(bytes: usize, times: usize) -> Vec<Duration> {
    let mut memory = vec![0_u8; bytes.max(1)];
    let share = memory.len().div_ceil(rayon::current_num_threads());
    let mut write = |value: usize| {
        let start = Instant::now();
        memory.par_chunks_mut(share).for_each(|bytes| bytes.fill(value as u8));
        black_box(&mut memory);
        start.elapsed()
    };
    let warm_up = WARM_UP_FRAMES as usize;
    (0..warm_up + times).map(&mut write).skip(warm_up).collect()
}

fn stages(frame: &Frame, recipe: &Recipe) -> Vec<(&'static str, Duration)> {
    let mut stages = match &frame.tiled {
        Some(TiledReport { times, .. }) => vec![
            ("transform", times.transform),
            ("cull and bin", times.cull),
            ("rasterize", times.rasterize),
            ("shade", times.shade),
        ],
        None => vec![("geometry", frame.times.geometry), ("pixels", frame.times.pixels)],
    };
    let times = &frame.times;
    let rest = [
        ("resolve", times.resolve, recipe.antialias.has_passes()),
        ("surfaces", times.surfaces, recipe.upscaler.upscaler().reads().surfaces),
        ("upscale", times.upscale, true),
        ("post filter", times.post, !recipe.post.is_off() || recipe.wireframe),
    ];
    stages.extend(rest.into_iter().filter(|(.., runs)| *runs).map(|(name, time, _)| (name, time)));
    let named: Duration = stages.iter().map(|(_, time)| *time).sum();
    stages.push(("other", times.total.saturating_sub(named)));
    stages
}

fn counts(scene: &Scene, frame: &Frame) -> Vec<(&'static str, u64)> {
    let mut counts = vec![("triangles in", scene.triangle_count() as u64)];
    if let Some(TiledReport { counts: done, .. }) = &frame.tiled {
        counts.extend([
            ("vertices transformed", done.vertices),
            ("triangles culled", done.triangles_in.saturating_sub(done.kept)),
            ("triangles kept", done.kept),
            ("entries binned", done.binned),
            ("samples tested", done.visited),
            ("samples taken in blocks", done.plain),
            ("samples shaded", done.shaded),
            ("texels read", done.texels),
        ]);
    } else {
        counts.push(("triangles rasterized", frame.geometry.triangles.len() as u64));
    }
    counts
}
