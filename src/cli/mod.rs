//! The command line: one file per subcommand, which defines its arguments with their help, and a function that runs it.
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
use window::WindowArgs;

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

/// Declares [`CliCommand`]: for each command a variant, and the module and type of its arguments. The module's function
/// `run` runs it; summary, help text and example are those of the arguments.
macro_rules! commands {
    ($($variant:ident: $module:ident::$args:ident,)+) => {
        #[derive(Subcommand, Debug)]
        enum CliCommand {
            $($variant($module::$args),)+
        }

        fn execute(command: &CliCommand) -> Result<(), Failure> {
            match command {
                $(CliCommand::$variant(args) => $module::run(args),)+
            }
        }
    };
}

commands! {
    Window: window::WindowArgs,
    Render: render::RenderArgs,
    Pixel: pixel::PixelArgs,
    Check: check::CheckArgs,
    Fates: fates::FatesArgs,
    Plan: plan::PlanArgs,
    Diff: diff::DiffArgs,
    Explain: explain::ExplainArgs,
    Compare: compare::CompareArgs,
    Screenshot: screenshot::ScreenshotArgs,
    Bench: bench::BenchArgs,
    Scaling: scaling::ScalingArgs,
    Case: case::CaseArgs,
    Stability: stability::StabilityArgs,
    Probe: probe::ProbeArgs,
    Report: report::ReportArgs,
    Merge: merge::MergeArgs,
    Vector: vector::VectorArgs,
    Lab: lab::LabArgs,
    Motion: motion::MotionArgs,
    Clip: clip::ClipArgs,
    Scenes: scenes::ScenesArgs,
}

/// Runs the program with the arguments of the process.
pub fn run() -> ExitCode {
    disk::protect_inputs();
    let outcome = match Cli::try_parse() {
        Ok(cli) => upscaler_args::with_process_failures(match &cli.command {
            Some(command) => execute(command),
            None => window::run_or_draw(&cli.start),
        }),
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
