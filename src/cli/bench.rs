//! `rasterscope bench`: times the frames of one view and prints their cost, as a table or as JSON.

use std::sync::atomic::Ordering;

use crate::chain::Recipe;
use crate::math::lanes::Lanes;
use crate::measure::against::ErrorMetrics;
use crate::measure::bench::{BenchFrames, BenchReport, bench};
use crate::measure::motion::{FrameSequence, MotionError, Turn, between};
use crate::measure::noise;
use crate::measure::stages::StageSummary;
use crate::measure::timing::Summary;
use crate::upscale::Upscaling;
use clap::{Args, ValueEnum};
use serde::Serialize;

use super::bench_scrub;
use super::bench_verify;
use super::bench_window;
use super::diff::motion_line;
use super::failure::Failure;
use super::interrupt;
use super::output;
use super::parse;
use super::scene_args::FrameArgs;

/// Measure frame times, in total and per stage, and print counters and memory use
#[derive(Args, Debug)]
#[command(after_help = super::example("bench chess --frames 101"))]
pub(crate) struct BenchArgs {
    #[command(flatten)]
    frame: FrameArgs,

    /// Number of threads to draw with; all hardware threads if omitted
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    /// Number of timed frames, after some warm-up frames
    #[arg(long, value_name = "N", default_value_t = 31, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: u32,

    /// Angle in degrees by which the camera orbits per frame; the same 16 frames are timed repeatedly, and compared
    /// with native rendering; 0 measures the still view
    #[arg(long, value_name = "DEGREES", default_value_t = Turn::default().degrees, allow_hyphen_values = true, value_parser = parse::degrees,
          conflicts_with_all = ["scrub", "window", "verify"])]
    turn: f32,

    /// SIMD instruction set to draw with
    #[arg(long, value_enum, default_value_t = LanesArg::Best)]
    lanes: LanesArg,

    /// Measure the time of stepping through the drawing of the frame instead; --frames sets the number of steps of each
    /// kind
    #[arg(long, conflicts_with_all = ["threads", "lanes"])]
    scrub: bool,

    /// Measure the cost of drawing the window instead, panel by panel; --frames sets the number of passes, and --size
    /// the size of the window
    #[arg(long, conflicts_with_all = ["threads", "lanes", "scrub"])]
    window: bool,

    /// Measure the time from a change of the view to the picture and the explanation of the pixel in its middle instead;
    /// --frames sets the number of answers
    #[arg(long, conflicts_with_all = ["lanes", "scrub", "window"])]
    answers: bool,

    /// Verify instead of timing: compare tiled execution bit for bit with classic execution, on every instruction set
    /// and with several numbers of threads; exit code 1 if they differ
    #[arg(long, conflicts_with_all = ["lanes", "frames", "scrub", "window", "answers"])]
    verify: bool,

    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum LanesArg {
    /// Best instruction set of the processor
    Best,
    /// AVX2; the baseline if the processor lacks it
    Avx2,
    /// Baseline instruction set of the architecture
    Baseline,
}

/// Runs `bench`: draws the frames, and prints times and costs.
pub(crate) fn run(args: &BenchArgs) -> Result<(), Failure> {
    let (view, size) = (args.frame.view()?, args.frame.size()?);
    if args.window {
        let costs = bench_window::measure(view, size, args.frames as usize)?;
        return if args.json { output::print_json(&costs) } else { output::print(&bench_window::table(&costs, size)) };
    }
    if args.scrub {
        let report = bench_scrub::measure(&view, size, args.frames as usize);
        return if args.json { output::print_json(&report) } else { output::print(&bench_scrub::table(&report)) };
    }
    if args.verify {
        let threads = args.threads.map(usize::from);
        let found = bench_verify::verify(&view, size, threads)?;
        if args.json {
            output::print_json(&found)
        } else {
            output::print(&bench_verify::table(&view.scene.name, size, &found))
        }?;
        return bench_verify::check_equality(&found);
    }
    let lanes = match args.lanes {
        LanesArg::Best => Lanes::best(),
        LanesArg::Avx2 => Lanes::avx2().unwrap_or_else(Lanes::baseline),
        LanesArg::Baseline => Lanes::baseline(),
    };
    let threads = args.threads.map_or(0, usize::from);
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| Failure::Threads(e.to_string()))?;
    if args.answers {
        let turn = Turn::by(args.turn);
        let time = pool.install(|| bench_window::answers(view, size, turn, args.frames as usize))?;
        let time = time.ok_or_else(interrupt::nothing)?;
        return if args.json { output::print_json(&time) } else { output::print(&bench_window::answers_text(&time)) };
    }
    let interrupted = interrupt::flag();
    let shot = FrameSequence { scene: &view.scene, camera: &view.camera, viewport: size, turn: Turn::by(args.turn) };
    let frames = BenchFrames { count: args.frames as usize, cancel: interrupted };
    let report = pool.install(|| {
        let mut report = bench(&shot, &view.recipe, frames, lanes)?;
        let mut go_on = |_| !interrupted.load(Ordering::Relaxed);
        let error = if report.partial { None } else { MeasuredError::of(&shot, &view.recipe, &mut go_on) };
        report.partial |= interrupted.load(Ordering::Relaxed);
        Some(BenchOutput { report, error })
    });
    let report = report.ok_or_else(interrupt::nothing)?;
    if args.json {
        output::print_json(&report)?;
    } else {
        output::print(&table(&report))?;
    }
    interrupt::outcome(report.report.partial)
}

/// Output of `bench`: frame times, and the error of the upscaler.
#[derive(Serialize)]
struct BenchOutput {
    #[serde(flatten)]
    report: BenchReport,
    /// Error compared with native rendering; `None` if the frames are drawn with the native method.
    error: Option<MeasuredError>,
}

/// Error of an upscaler, compared with native frames from the same cameras.
#[derive(Serialize)]
struct MeasuredError {
    /// Error of the still view, after the upscaler has converged.
    still: ErrorMetrics,
    /// Error over the frames of a moving camera.
    motion: MotionError,
}

impl MeasuredError {
    /// Measures the error of a recipe's upscaler over the frames of a sequence. Returns `None` for the native method,
    /// which is the reference, or if `go_on` returns `false`.
    fn of(shot: &FrameSequence<'_>, recipe: &Recipe, go_on: &mut dyn FnMut(f32) -> bool) -> Option<Self> {
        if recipe.upscaler.is_native() {
            return None;
        }
        let native = Recipe { upscaler: Upscaling::NATIVE, ..*recipe };
        let still = between(&FrameSequence { turn: Turn::STILL, ..*shot }, [&native, recipe], go_on)?;
        let motion = if shot.turn.is_still() { still } else { between(shot, [&native, recipe], go_on)? };
        Some(Self { still: still.mean, motion })
    }
}

fn table(report: &BenchOutput) -> String {
    let BenchOutput { report, error } = report;
    let BenchReport {
        scene,
        size: [width, height],
        threads,
        machine,
        turn,
        noise,
        execution,
        frame_ms,
        stages,
        writing,
        counts,
        bytes,
        ..
    } = report;
    let turning = if turn.is_still() {
        String::new()
    } else {
        format!(", camera orbits by {}° per frame over {} views", turn.degrees, turn.frames)
    };
    let mut text = format!(
        "{scene}, {width} × {height} px, {execution}, {threads} {}, {} frames{turning}\n{}\n\n",
        if *threads == 1 { "thread" } else { "threads" },
        frame_ms.n,
        machine.summary()
    );
    if report.partial {
        text += "partial: interrupted before all frames were timed\n\n";
    }
    text += &format!("{:24} {:>10} {:>10} {:>10}\n", "milliseconds", "median", "p10", "p90");
    let line = |name: &str, [median, p10, p90]: [f64; 3]| format!("{name:24} {median:10.3} {p10:10.3} {p90:10.3}\n");
    let of_series = |ms: &Summary| [ms.median, ms.p10, ms.p90];
    text += &line("whole frame", of_series(frame_ms));
    text.extend(stages.iter().map(|StageSummary { stage, ms }| line(stage, [ms.median, ms.p10, ms.p90])));
    text += &line("memset of the frame size", of_series(&writing.ms));
    if let Some(noise) = noise {
        text += &format!(
            "\nnoise floor of the whole frame: {}, {:.3} ms; smaller differences of medians are {}\n",
            noise.words(),
            noise.ms(frame_ms.median),
            noise::WITHIN
        );
    }
    text.push('\n');
    if let Some(MeasuredError { still, motion }) = error {
        let codes = still.codes;
        text += &format!(
            "still view, against native: PSNR {:.2} dB, SSIM {:.6}, FLIP {:.4}\n",
            codes.psnr_db, codes.ssim, still.flip
        );
        if !turn.is_still() {
            text += &motion_line(motion, *turn);
        }
        text.push('\n');
    }
    text.extend(counts.iter().map(|(name, count)| format!("{name:24} {count:10}\n")));
    let megabytes = |bytes: usize| bytes as f64 / 1e6;
    text += &format!(
        "\n{:24} {:10.1} MB frame, {:.1} MB renderer, {:.1} MB scene\n",
        "memory",
        megabytes(bytes.frame),
        megabytes(bytes.renderer),
        megabytes(bytes.scene)
    );
    text + &format!(
        "{:24} {:10.2} ns per triangle, {:.2} ns per pixel, {:.1} × the time of a memset of the frame size\n",
        "cost", report.ns_per_triangle, report.ns_per_pixel, writing.frame_over_writing
    )
}
