//! `rasterscope scaling`: measures the cost of a frame against the numbers of triangles, pixels, layers and threads.

use std::path::{Path, PathBuf};

use crate::chain::Recipe;
use crate::measure::scaling::{Scaling, ScalingError, ScalingPlan, ScalingQuantity, measure};
use crate::report::scaling::{csv, page, text};
use clap::Args;

use super::failure::Failure;
use super::progress::ProgressLine;
use super::{interrupt, output};

/// File names of the report's HTML page, CSV table and JSON.
const FILES: [&str; 3] = ["index.html", "scaling.csv", "scaling.json"];

/// Measure the cost of a frame against triangles, pixels, layers and threads, as a table or an HTML page
#[derive(Args, Debug)]
#[command(after_help = super::example("scaling -o scaling"))]
pub(crate) struct ScalingArgs {
    /// Folder for an HTML page, a CSV table and JSON; created if missing. Without a folder the table is printed
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,

    /// Setting to change for all measurements; may be given several times
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,

    /// Largest number of triangles, in powers of ten from 1000; 10000000 triangles take some 3 GB of memory
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u32).range(1000..=10_000_000))]
    most_triangles: u32,

    /// Largest number of threads, in powers of two from 1; the number of hardware threads if omitted
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    /// Number of timed rounds
    #[arg(long, value_name = "N", default_value_t = 9, value_parser = clap::value_parser!(u16).range(1..=1000))]
    rounds: u16,
}

/// Runs `scaling`: measures the cost, and prints a table or writes `index.html`, `scaling.csv` and `scaling.json`.
pub(crate) fn run(args: &ScalingArgs) -> Result<(), Failure> {
    let mut recipe = Recipe::default();
    recipe.set_all(&args.set)?;
    let machine = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = args.threads.map_or(machine, usize::from);
    let plan = ScalingPlan::new(recipe, args.most_triangles as usize, threads, args.rounds.into());
    if let Some(folder) = &args.output {
        output::prepare_folder(folder, &FILES)?;
    }
    let line = ProgressLine::new();
    let report_progress = |quantity: ScalingQuantity, share: f32| line.show_share(quantity.name(), share);
    let scaling = measure(&plan, &report_progress, interrupt::flag());
    drop(line);
    let scaling = scaling.map_err(|error| match error {
        ScalingError::Cancelled => interrupt::nothing(),
        ScalingError::Threads(error) => Failure::Threads(error.to_string()),
    })?;
    match &args.output {
        None => output::print(&text(&scaling))?,
        Some(folder) => write_all(folder, &scaling)?,
    }
    interrupt::outcome(scaling.partial)
}

fn write_all(folder: &Path, scaling: &Scaling) -> Result<(), Failure> {
    for (name, content) in FILES.iter().zip([page(scaling), csv(scaling), output::json(scaling)?]) {
        output::write(&folder.join(name), &content)?;
    }
    output::print(&format!("{}, with scaling.csv and scaling.json\n", output::display(&folder.join("index.html"))))
}
