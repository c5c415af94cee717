//! The command line: one file per subcommand, which defines its options and a function that runs it.
//!
//! Results go to standard output or to files; warnings and errors go to standard error, one line each. Exit codes: 0
//! success; 1 a violation found by `check`, `compare` or `bench --verify`; 2 unusable input, unwritable output, or a
//! failed upscaler process, whose pictures are filled in by nearest neighbour; 3 the requested window cannot be opened;
//! 130 interrupted measurement, or one merged from an interrupted part, whose complete results are written.

mod bench;
mod bench_scrub;
mod bench_verify;
mod bench_window;
mod case;
mod check;
mod clip;
mod compare;
mod diff;
mod explain;
mod explain_folder;
mod failure;
mod fates;
mod interrupt;
mod lab;
mod merge;
mod motion;
mod output;
mod parse;
mod pixel;
mod plan;
mod probe;
mod progress;
mod render;
mod report;
mod scaling;
mod scene_args;
mod scenes;
mod screenshot;
mod seen_args;
mod sequence_args;
mod shard;
mod stability;
mod upscaler_args;
mod vector;
mod window;
#[cfg(feature = "ui")]
mod workbench;
#[cfg(not(feature = "ui"))]
#[path = "workbench_absent.rs"]
mod workbench;

use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};

use crate::disk;
use failure::Failure;
use seen_args::WindowArgs;

/// An interactive workbench for a software rendering pipeline
///
/// Without a command, the window opens. If neither a scene nor options are given, it resumes the scene, settings and
/// view of the previous run. If there is no display, the workbench is rendered once to the image file rasterscope.png
/// instead.
#[derive(Parser, Debug)]
#[command(version, long_version = VERSION, args_conflicts_with_subcommands = true, after_help = example("chess"))]
struct Cli {
    #[command(subcommand)]
    command: Option<CliCommand>,

    #[command(flatten)]
    start: WindowArgs,
}

/// Version, and the licences of the embedded fonts and icons.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\n\n", include_str!("../../assets/NOTICES.txt"));

const EXIT_CODES: &str = "Exit codes: 0 success; 1 violation found by `check`, `compare` or `bench --verify`; 2 unusable \
    input, unwritable output or failed upscaler process; 3 window cannot be opened; 130 interrupted, or \
    merged from an interrupted part; the results so far are written";

/// Returns the final part of a command's help text: an example and the exit codes.
fn example(arguments: &str) -> String {
    format!("Example: rasterscope {arguments}\n\n{EXIT_CODES}")
}

#[derive(Subcommand, Debug)]
enum CliCommand {
    /// Open the window, or fail if no window can be opened
    ///
    /// If neither a scene nor options are given, it resumes the scene, settings and view of the previous run.
    #[command(after_help = example("window chess --set shading=gouraud"))]
    Window(WindowArgs),
    /// Render one frame or one of its buffers to a PNG, or all its buffers to an OpenEXR file; with --frames, a sequence
    #[command(after_help = example("render chess --buffer depth -o depth.png"))]
    Render(render::RenderArgs),
    /// Explain a pixel: list every fragment, which one won, and why, down to the texels
    #[command(after_help = example("pixel chess --at 700,300 --trace"))]
    Pixel(pixel::PixelArgs),
    /// Check assertions on every fragment of a frame; exit code 1 if one is violated
    #[command(after_help = example("check cubes --assert owner"))]
    Check(check::CheckArgs),
    /// Print the fate of every triangle and every fragment, in total and per object
    #[command(after_help = example("fates near-plane"))]
    Fates(fates::FatesArgs),
    /// Print which parts of the pipeline each draw runs and skips, and why
    #[command(after_help = example("plan cubes --set shading=texture"))]
    Plan(plan::PlanArgs),
    /// Compare a view under two sets of settings: which pixels change, by how much, and at what cost
    #[command(after_help = example("diff chess --set filter=point --against filter=bilinear"))]
    Diff(diff::DiffArgs),
    /// Find the faults of another renderer by which its picture of a scene differs from ours
    #[command(after_help = example("explain theirs.png model.obj --camera view.json"))]
    Explain(explain::ExplainArgs),
    /// Measure the error between two picture files, or of both against a reference, without a scene
    #[command(after_help = example("compare a.exr b.exr --reference converged.exr --max flip=0.05"))]
    Compare(compare::CompareArgs),
    /// Render the workbench to a PNG, without a window
    #[command(after_help = example("screenshot chess --compare four -o compared.png"))]
    Screenshot(screenshot::ScreenshotArgs),
    /// Measure frame times, in total and per stage, and print counters and memory use
    #[command(after_help = example("bench chess --frames 101"))]
    Bench(bench::BenchArgs),
    /// Measure the cost of a frame against triangles, pixels, layers and threads, as a table or an HTML page
    #[command(after_help = example("scaling -o scaling"))]
    Scaling(scaling::ScalingArgs),
    /// Evaluate numerical cases: small inputs to one algorithm each, for comparison with exact answers
    #[command(after_help = example("case line.json -o result.json"))]
    Case(case::CaseArgs),
    /// Measure numerical stability: run ill-conditioned and extreme cases on every rasterizer, arithmetic and depth
    /// format
    #[command(after_help = example("stability --class slivers --html -o slivers.html"))]
    Stability(stability::StabilityArgs),
    /// Move camera or vertices by a few units in the last place, and print which pixels and triangles change
    #[command(after_help = example("probe z-fighting --ulps 2 -o heat.png"))]
    Probe(probe::ProbeArgs),
    /// Measure error against run time of every upscaler, and write an HTML page, a CSV table and JSON
    #[command(after_help = example("report chess --size 640x360 -o report"))]
    Report(report::ReportArgs),
    /// Combine the parts that `report`, `stability`, `probe` or `explain` wrote with --shard, for example on several
    /// machines, into the result of one run
    #[command(after_help = example("merge part-1.json part-2.json -o result"))]
    Merge(merge::MergeArgs),
    /// Export a scene as a vector drawing: wireframe, hidden-line drawing, or polygons
    #[command(after_help = example("vector cubes --kind hidden-line -o cubes.svg"))]
    Vector(vector::VectorArgs),
    /// Run a page of the 2D lab, and write its drawing or an HTML page, or print its steps
    #[command(after_help = example("lab polygons -o polygons.gif"))]
    Lab(lab::LabArgs),
    /// Measure upscalers over the frames of a clip: quality, flicker and ghosting against the converged reference
    #[command(after_help = example("motion fence --size 640x360 --frames 24 -o motion.html"))]
    Motion(motion::MotionArgs),
    /// Write the inputs of a temporal upscaler and converged references of the frames of a clip, for research
    #[command(after_help = example("clip chess-motion --path turntable --frames 16 -o clip"))]
    Clip(clip::ClipArgs),
    /// List the built-in scenes
    #[command(after_help = example("scenes"))]
    Scenes,
}

/// Runs the program with the arguments of the process.
pub fn run() -> ExitCode {
    disk::protect_inputs();
    let outcome = match Cli::try_parse() {
        Ok(cli) => upscaler_args::with_process_failures(execute(&cli)),
        Err(error) => usage(&error),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            output::report("error", &failure);
            failure.exit_code()
        }
    }
}

fn execute(cli: &Cli) -> Result<(), Failure> {
    match &cli.command {
        None => window::run_or_draw(&cli.start),
        Some(CliCommand::Window(args)) => window::run(args),
        Some(CliCommand::Render(args)) => render::run(args),
        Some(CliCommand::Pixel(args)) => pixel::run(args),
        Some(CliCommand::Check(args)) => check::run(args),
        Some(CliCommand::Fates(args)) => fates::run(args),
        Some(CliCommand::Plan(args)) => plan::run(args),
        Some(CliCommand::Diff(args)) => diff::run(args),
        Some(CliCommand::Explain(args)) => explain::run(args),
        Some(CliCommand::Compare(args)) => compare::run(args),
        Some(CliCommand::Screenshot(args)) => screenshot::run(args),
        Some(CliCommand::Bench(args)) => bench::run(args),
        Some(CliCommand::Scaling(args)) => scaling::run(args),
        Some(CliCommand::Case(args)) => case::run(args),
        Some(CliCommand::Stability(args)) => stability::run(args),
        Some(CliCommand::Probe(args)) => probe::run(args),
        Some(CliCommand::Report(args)) => report::run(args),
        Some(CliCommand::Merge(args)) => merge::run(args),
        Some(CliCommand::Vector(args)) => vector::run(args),
        Some(CliCommand::Lab(args)) => lab::run(args),
        Some(CliCommand::Motion(args)) => motion::run(args),
        Some(CliCommand::Clip(args)) => clip::run(args),
        Some(CliCommand::Scenes) => scenes::run(),
    }
}

/// Prints the help text or the version if requested. Any other error becomes a failure whose message is the first
/// paragraph of the error.
fn usage(error: &clap::Error) -> Result<(), Failure> {
    let text = error.render().to_string();
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        return output::print(&text);
    }
    let first = text.split("\n\n").next().unwrap_or(&text);
    Err(Failure::Usage(first.trim_start_matches("error: ").to_owned()))
}

// The tests read fields of `RequestedView` that are declared as never read in builds without the window.
#[cfg(all(test, feature = "ui"))]
mod tests;
