//! `rasterscope merge`: combines the parts of an experiment into the files of its result.

use std::path::PathBuf;

use crate::measure::part::{Experiment, Parts};
use clap::Args;

use super::failure::Failure;
use super::shard::Merged;
use super::upscaler_args::UpscalerArgs;
use super::{explain, interrupt, output, probe, report, stability};

/// Combine the parts that `report`, `stability`, `probe` or `explain` wrote with --shard, for example on several
/// machines, into the result of one run
#[derive(Args, Debug)]
#[command(after_help = super::example("merge part-1.json part-2.json -o result"))]
pub(crate) struct MergeArgs {
    /// All parts of one experiment, in any order
    #[arg(value_name = "PART", required = true)]
    parts: Vec<PathBuf>,

    /// Folder for the result; created if missing
    #[arg(short, long, value_name = "DIR", long_help = OUTPUT_HELP)]
    output: PathBuf,

    #[command(flatten)]
    upscalers: UpscalerArgs,
}

const OUTPUT_HELP: &str = "Folder for the result; created if missing. Files:\n\
    report: index.html, report.csv, report.json\n\
    stability: stability.html, stability.csv, stability.json, stability.txt\n\
    probe: probe.json, probe.txt, heat-owner.png, heat-depth.png (with a depth test), heat-color.png\n\
    explain: explanations.json, explanations.txt";

/// Runs `merge`: combines the parts, and writes the files only if all parts fit together.
pub(crate) fn run(args: &MergeArgs) -> Result<(), Failure> {
    args.upscalers.register()?;
    let parts = Parts::read(&args.parts)?;
    let Merged { files, partial } = match parts.experiment {
        Experiment::Stability => stability::merge(parts)?,
        Experiment::Probe => probe::merge(parts)?,
        Experiment::Report => report::merge(parts)?,
        Experiment::Explain => explain::merge(parts)?,
    };
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    output::prepare_folder(&args.output, &names)?;
    for (name, content) in &files {
        output::write_bytes(&args.output.join(name), content)?;
    }
    output::print(&format!("{}: {}\n", output::display(&args.output), names.join(", ")))?;
    interrupt::outcome(partial)
}
