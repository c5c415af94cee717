//! `rasterscope stability`: runs ill-conditioned and extreme cases on every rasterizer, arithmetic and depth format.

use std::path::PathBuf;

use crate::measure::part::{Experiment, Parts};
use crate::pipeline::settings::{Arithmetic, Rasterizer};
use crate::report::stability::catalogue::{self, Class};
use crate::report::stability::observations::{Observations, observe};
use crate::report::stability::sweep::{self, DEFAULT_SEED, StabilityPlan, StabilityProgress, StabilityReport};
use crate::report::stability::{csv::csv, html::html, text::text};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use super::failure::Failure;
use super::progress::ProgressLine;
use super::shard::{Merged, ShardArgs, write_part};
use super::{interrupt, output, parse};

/// Measure numerical stability: run ill-conditioned and extreme cases on every rasterizer, arithmetic and depth
/// format
#[derive(Args, Debug)]
#[command(after_help = super::example("stability --class slivers --html -o slivers.html"))]
pub(crate) struct StabilityArgs {
    /// Class of cases to run; may be given several times. All if omitted
    #[arg(long, value_name = "CLASS", value_parser = class())]
    class: Vec<&'static Class>,

    /// Rasterizer to run; may be given several times. All if omitted
    #[arg(long, value_name = "RASTERIZER", value_parser = parse::choice::<Rasterizer>())]
    rasterizer: Vec<Rasterizer>,

    /// Arithmetic to run; may be given several times. All if omitted
    #[arg(long, value_name = "ARITHMETIC", value_parser = parse::choice::<Arithmetic>())]
    arithmetic: Vec<Arithmetic>,

    /// Seed of the generated cases
    #[arg(long, default_value_t = DEFAULT_SEED)]
    seed: u64,

    /// Skip timing; the run is faster, and the output is identical on every machine except for the header
    #[arg(long)]
    untimed: bool,

    #[command(flatten)]
    shard: ShardArgs,

    /// Write JSON, with the worst case for every cell of the table
    #[arg(long, group = "format", conflicts_with = "shard")]
    json: bool,

    /// Write comma-separated values, one line for every cell of the table
    #[arg(long, group = "format", conflicts_with = "shard")]
    csv: bool,

    /// Write an HTML page
    #[arg(long, group = "format", conflicts_with = "shard")]
    html: bool,

    /// File to write instead of standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Returns a parser for classes of cases; the help text lists each with its description.
fn class() -> impl TypedValueParser<Value = &'static Class> {
    let values = catalogue::all().map(|class| PossibleValue::new(class.id).help(class.about));
    PossibleValuesParser::new(values).try_map(|id| catalogue::by_id(&id).ok_or("no such class"))
}

/// Runs `stability`: runs the requested cases and writes the report.
pub(crate) fn run(args: &StabilityArgs) -> Result<(), Failure> {
    let everything = StabilityPlan::default();
    let plan = StabilityPlan {
        classes: or_all(&args.class, everything.classes),
        rasterizers: or_all(&args.rasterizer, everything.rasterizers),
        arithmetics: or_all(&args.arithmetic, everything.arithmetics),
        seed: args.seed,
        timed: !args.untimed,
    };
    args.output.as_deref().map_or(Ok(()), output::check_writable)?;
    let line = ProgressLine::new();
    let show = |StabilityProgress { stage, done, of }: StabilityProgress| {
        line.show(&format!("{}: {done} of {of}", stage.name()));
    };
    if let Some(shard) = args.shard.shard {
        let run = observe(&plan, shard, &show, interrupt::flag());
        drop(line);
        let run = run.ok_or_else(interrupt::nothing)?;
        return write_part(args.output.as_deref(), Experiment::Stability, &plan, run);
    }
    let report = sweep::run(&plan, &show, interrupt::flag());
    drop(line);
    let report = report.ok_or_else(interrupt::nothing)?;
    let written = render(args, &report)?;
    match &args.output {
        None => output::print(&written)?,
        Some(path) => output::write(path, &written)?,
    }
    interrupt::outcome(report.partial)
}

/// Merges the parts of a report into the same report in every format.
pub(crate) fn merge(parts: Parts) -> Result<Merged, Failure> {
    let (plan, runs) = parts.into_runs(Observations::check)?;
    let report = sweep::combine(&plan, &runs).ok_or_else(interrupt::nothing)?;
    let files = [
        ("stability.html", html(&report)),
        ("stability.csv", csv(&report)),
        ("stability.json", output::json(&report)?),
        ("stability.txt", text(&report)),
    ];
    Ok(Merged { files: files.map(|(name, text)| (name, text.into_bytes())).into(), partial: report.partial })
}

fn or_all<T: Clone>(chosen: &[T], all: Vec<T>) -> Vec<T> {
    if chosen.is_empty() { all } else { chosen.to_vec() }
}

fn render(args: &StabilityArgs, report: &StabilityReport) -> Result<String, Failure> {
    if args.json {
        output::json(report)
    } else if args.csv {
        Ok(csv(report))
    } else if args.html {
        Ok(html(report))
    } else {
        Ok(text(report))
    }
}
