//! The command line: one file per subcommand, each a function from its options to results on standard output.
//!
//! Warnings and errors go to standard error, one line each. Exit codes: 0 done; 2 input that cannot be used or output
//! that cannot be written; 3 no window where one was asked for; 130 a
//! measurement was interrupted, and what was complete is written; 1 what `check` or `bench --verify` checked does not hold.

mod bench;
mod bench_scrub;
mod bench_verify;
mod bench_window;
mod case;
mod check;
mod diff;
mod failure;
mod fates;
mod interrupt;
mod lab;
mod output;
mod parse;
mod pixel;
mod pixel_text;
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
mod stability;
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

use failure::Failure;
use rasterscope::disk;
use seen_args::WindowArgs;

/// An interactive workbench for a software rendering pipeline
///
/// Without a command the window opens; without scene and options, too, it takes up scene, settings and view as they were
/// left. Where there is no display, the whole workbench is drawn once into rasterscope.png instead.
#[derive(Parser, Debug)]
#[command(version, long_version = VERSION, args_conflicts_with_subcommands = true, after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,

    #[command(flatten)]
    start: WindowArgs,
}

/// Version, and the licences of the fonts and icons in the program.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\n\n", include_str!("../../assets/NOTICES.txt"));

const EXIT_CODES: &str = "Exit codes: 0 done; 2 bad input, or output that cannot be written; 3 no window possible; 130 interrupted; 1 what `check` or `bench --verify` checked does not hold";

#[derive(Subcommand, Debug)]
enum Command {
    /// Open the window, and fail where that is impossible
    ///
    /// Without scene and options it takes up scene, settings and view as they were left.
    #[command(after_help = EXIT_CODES)]
    Window(WindowArgs),
    /// Draw one frame, or one of its buffers, into a PNG
    #[command(after_help = EXIT_CODES)]
    Render(render::RenderArgs),
    /// Tell why a pixel looks as it does: every fragment there, who won and why, down to the texels
    #[command(after_help = EXIT_CODES)]
    Pixel(pixel::PixelArgs),
    /// Check assertions on every fragment of a frame; exit code 1 if one is violated
    #[command(after_help = EXIT_CODES)]
    Check(check::CheckArgs),
    /// Tell how every triangle and every fragment ended, in all and per object
    #[command(after_help = EXIT_CODES)]
    Fates(fates::FatesArgs),
    /// Tell what each draw runs and leaves out, and why
    #[command(after_help = EXIT_CODES)]
    Plan(plan::PlanArgs),
    /// Tell what other settings change in a view: which pixels, how far, and what it costs
    #[command(after_help = EXIT_CODES)]
    Diff(diff::DiffArgs),
    /// Draw the whole workbench into a PNG, without a window
    #[command(after_help = EXIT_CODES)]
    Screenshot(screenshot::ScreenshotArgs),
    /// Time frames: in all and per stage, with counts and memory
    #[command(after_help = EXIT_CODES)]
    Bench(bench::BenchArgs),
    /// Tell what a frame costs against triangles, pixels, layers and threads, as a table or a page
    #[command(after_help = EXIT_CODES)]
    Scaling(scaling::ScalingArgs),
    /// Answer numerical cases: small inputs to one algorithm each, to be compared with exact answers
    #[command(after_help = EXIT_CODES)]
    Case(case::CaseArgs),
    /// Judge the engine: stiff and extreme cases against every rasterizer, arithmetic and depth format
    #[command(after_help = EXIT_CODES)]
    Stability(stability::StabilityArgs),
    /// Move camera or vertices by a few units in the last place, and tell which pixels and triangles do not stand firm
    #[command(after_help = EXIT_CODES)]
    Probe(probe::ProbeArgs),
    /// Measure error against run time of every upscaler, and write a page, a table and JSON
    #[command(after_help = EXIT_CODES)]
    Report(report::ReportArgs),
    /// Write a scene as drawing commands: wireframe, without hidden lines, or as polygons
    #[command(after_help = EXIT_CODES)]
    Vector(vector::VectorArgs),
    /// Run a page of the 2D lab, and write its drawing or tell its steps
    #[command(after_help = EXIT_CODES)]
    Lab(lab::LabArgs),
    /// List the built-in scenes
    #[command(after_help = EXIT_CODES)]
    Scenes,
}

/// Runs the program with the arguments of the process.
pub(crate) fn run() -> ExitCode {
    disk::protect_inputs();
    let outcome = match Cli::try_parse() {
        Ok(cli) => execute(&cli),
        Err(error) => usage(&error),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            output::complain("error", &failure);
            failure.exit_code()
        }
    }
}

fn execute(cli: &Cli) -> Result<(), Failure> {
    match &cli.command {
        None => window::run_or_draw(&cli.start),
        Some(Command::Window(args)) => window::run(args),
        Some(Command::Render(args)) => render::run(args),
        Some(Command::Pixel(args)) => pixel::run(args),
        Some(Command::Check(args)) => check::run(args),
        Some(Command::Fates(args)) => fates::run(args),
        Some(Command::Plan(args)) => plan::run(args),
        Some(Command::Diff(args)) => diff::run(args),
        Some(Command::Screenshot(args)) => screenshot::run(args),
        Some(Command::Bench(args)) => bench::run(args),
        Some(Command::Scaling(args)) => scaling::run(args),
        Some(Command::Case(args)) => case::run(args),
        Some(Command::Stability(args)) => stability::run(args),
        Some(Command::Probe(args)) => probe::run(args),
        Some(Command::Report(args)) => report::run(args),
        Some(Command::Vector(args)) => vector::run(args),
        Some(Command::Lab(args)) => lab::run(args),
        Some(Command::Scenes) => scenes::run(),
    }
}

/// Prints help that was asked for; all else is a failure, of which the first paragraph says what is wrong.
fn usage(error: &clap::Error) -> Result<(), Failure> {
    let text = error.render().to_string();
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        return output::print(&text);
    }
    let first = text.split("\n\n").next().unwrap_or(&text);
    Err(Failure::Usage(first.trim_start_matches("error: ").to_owned()))
}

// Without the window nothing reads all of a view, and that is said where it is declared.
#[cfg(all(test, feature = "ui"))]
mod tests;
