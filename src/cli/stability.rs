//! `rasterscope stability`: stiff and extreme cases against everything that can be switched.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use rasterscope::pipeline::settings::{Arithmetic, Rasterizer};
use rasterscope::report::stability::catalogue::{self, Class};
use rasterscope::report::stability::sweep::{self, DEFAULT_SEED, Plan, Progress, Report};
use rasterscope::report::stability::{csv::csv, html::html, text::text};

use super::failure::Failure;
use super::progress::ProgressLine;
use super::{interrupt, output, parse};

/// What `stability` takes.
#[derive(Args, Debug)]
pub(crate) struct StabilityArgs {
    /// Run this class of cases only; may be given several times
    #[arg(long, value_name = "CLASS", value_parser = class())]
    class: Vec<&'static Class>,

    /// Run this rasterizer only; may be given several times
    #[arg(long, value_name = "RASTERIZER", value_parser = parse::choice::<Rasterizer>())]
    rasterizer: Vec<Rasterizer>,

    /// Run this arithmetic only; may be given several times
    #[arg(long, value_name = "ARITHMETIC", value_parser = parse::choice::<Arithmetic>())]
    arithmetic: Vec<Arithmetic>,

    /// The cases depend on this number
    #[arg(long, default_value_t = DEFAULT_SEED)]
    seed: u64,

    /// Take no times: quicker, and the same bytes wherever it runs but for the head
    #[arg(long)]
    untimed: bool,

    /// Write JSON, with the worst case of every cell
    #[arg(long, group = "format")]
    json: bool,

    /// Write comma-separated values, one line per cell
    #[arg(long, group = "format")]
    csv: bool,

    /// Write a page for the browser
    #[arg(long, group = "format")]
    html: bool,

    /// The file to write instead of standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Parser for classes of cases, which help lists with what they stress.
fn class() -> impl TypedValueParser<Value = &'static Class> {
    let values = catalogue::all().map(|class| PossibleValue::new(class.id).help(class.about));
    PossibleValuesParser::new(values).try_map(|id| catalogue::by_id(&id).ok_or("no such class"))
}

/// Runs what was asked for and writes the report.
pub(crate) fn run(args: &StabilityArgs) -> Result<(), Failure> {
    let everything = Plan::default();
    let plan = Plan {
        classes: or_all(&args.class, everything.classes),
        rasterizers: or_all(&args.rasterizer, everything.rasterizers),
        arithmetics: or_all(&args.arithmetic, everything.arithmetics),
        seed: args.seed,
        timed: !args.untimed,
    };
    args.output.as_deref().map_or(Ok(()), output::check_writable)?;
    let line = ProgressLine::new();
    let show = |Progress { stage, done, of }: Progress| line.show(&format!("{}: {done} of {of}", stage.name()));
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

fn or_all<T: Clone>(chosen: &[T], all: Vec<T>) -> Vec<T> {
    if chosen.is_empty() { all } else { chosen.to_vec() }
}

fn render(args: &StabilityArgs, report: &Report) -> Result<String, Failure> {
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
