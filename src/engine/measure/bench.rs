//! Benchmark of a view: total and per-stage frame times, counters and memory.

use std::hint::black_box;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;
use serde::Serialize;

use super::machine::Machine;
use super::motion::{FrameSequence, Playback, Turn};
use super::noise::{Noise, Pairs};
use super::stages::{StageSummary, summarize_stages};
use super::timing::{Summary, summarize};
use crate::chain::{Frame, Recipe, Renderer};
use crate::math::lanes::Lanes;
use crate::pipeline::settings::Choice as _;
use crate::pipeline::tiled::TiledReport;
use crate::pipeline::viewport::Viewport;
use crate::scene::Scene;

/// Number of warm-up frames before the measured ones. During warm-up, buffers are allocated, and caches and clock
/// frequencies settle.
const WARM_UP_FRAMES: i64 = 3;

/// Time to write as many bytes as a frame holds, without drawing: a lower bound for every frame time.
#[derive(Clone, Debug, Serialize)]
pub struct Writing {
    /// Time to fill as many bytes as the frame holds, with the same threads, in milliseconds.
    pub ms: Summary,
    /// Median frame time divided by the median of `ms`.
    pub frame_over_writing: f64,
}

/// Benchmark result of one view.
#[derive(Clone, Debug, Serialize)]
pub struct BenchReport {
    /// Name of the scene.
    pub scene: String,
    /// Image width and height, in pixels.
    pub size: [u32; 2],
    /// Number of threads in the rayon pool.
    pub threads: usize,
    /// Machine and build, with the system load at the start and at the end of the benchmark.
    pub machine: Machine,
    /// Camera motion over the measured frames; the sequence repeats until enough frames are timed.
    pub turn: Turn,
    /// Execution mode, classic or tiled, of the last frame.
    pub execution: &'static str,
    /// Whether the benchmark was cancelled before all frames were drawn.
    pub partial: bool,
    /// Noise floor, from comparing the times of odd frames with those of even frames. `None` for a single frame.
    pub noise: Option<Noise>,
    /// Frame time, in milliseconds.
    pub frame_ms: Summary,
    /// Time spent in each stage, in milliseconds and in pipeline order; the medians add up to the median frame time.
    pub stages: Vec<StageSummary>,
    /// Time to write the bytes of the frame, as a baseline for the frame time.
    pub writing: Writing,
    /// Counters of the last frame, in pipeline order.
    pub counts: Vec<(&'static str, u64)>,
    /// Memory held by the frame, the renderer and the scene, in bytes.
    pub bytes: Bytes,
    /// Median frame time per triangle of the scene, in nanoseconds.
    pub ns_per_triangle: f64,
    /// Median frame time per pixel of the image, in nanoseconds.
    pub ns_per_pixel: f64,
}

/// Memory in use after the last frame, in bytes.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Bytes {
    /// Memory used by the images of one frame, including its depth buffer if it is kept.
    pub frame: usize,
    /// Memory that the renderer keeps from frame to frame.
    pub renderer: usize,
    /// Memory used by the scene's meshes and textures.
    pub scene: usize,
}

/// Frame count and cancellation flag of a measurement.
#[derive(Clone, Copy, Debug)]
pub struct BenchFrames<'a> {
    /// Number of measured frames, at least 1.
    pub count: usize,
    /// Cancellation flag; when set, the measurement ends with the frames drawn so far.
    pub cancel: &'a AtomicBool,
}

/// Durations and counters of one timed frame.
struct FrameSample {
    total: Duration,
    stages: Vec<(&'static str, Duration)>,
    /// Memory used by the frame's images, in bytes.
    bytes: usize,
    execution: &'static str,
    counts: Vec<(&'static str, u64)>,
}

/// Times the frames of a sequence repeatedly on the current rayon pool. Frames that only build up the temporal history
/// of a timed frame are drawn before it and are not timed. Returns `None` if cancelled before the first measured frame
/// was complete.
pub fn bench(
    shot: &FrameSequence<'_>,
    recipe: &Recipe,
    BenchFrames { count, cancel }: BenchFrames<'_>,
    lanes: Lanes,
) -> Option<BenchReport> {
    let machine = Machine::at_start();
    let scene = shot.scene;
    let (mut playback, mut renderer) = (Playback::on(*recipe, lanes), Renderer::on(lanes));
    let mut samples: Vec<FrameSample> = Vec::with_capacity(count);
    for round in -WARM_UP_FRAMES..count as i64 {
        if cancel.load(Ordering::Relaxed) {
            break;
        }
        let number = shot.turn.frame_of_round(round);
        let sample = playback.draw(shot, number, &mut renderer, |frame| FrameSample {
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

/// Converts a duration to milliseconds.
fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// Fills a buffer of `bytes` bytes `times` times, and returns the duration of each fill. Each thread of the pool fills
/// an equal share. The durations of warm-up runs are not returned.
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
        ("surfaces", times.surfaces, recipe.upscaler.upscaler().reads().gbuffer),
        ("upscale", times.upscale.saturating_sub(times.transfer), true),
        ("transfer", times.transfer, recipe.upscaler.upscaler().process().is_some()),
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
            ("samples taken in blocks", done.uniform),
            ("samples shaded", done.shaded),
            ("texels read", done.texels),
        ]);
    } else {
        counts.push(("triangles rasterized", frame.geometry().triangles.len() as u64));
    }
    counts
}
