//! `rasterscope check`: checks assertions on every fragment of a frame. The exit code is 1 if one is violated.

use crate::inspect::assertions::{Assertion, AssertionReport, Finding, check};
use crate::inspect::control::TaskControl;
use crate::pipeline::settings::Choice as _;
use clap::Args;

use super::failure::Failure;
use super::scene_args::{DrawnFrame, FrameArgs};
use super::{output, parse};

/// Check assertions on every fragment of a frame; exit code 1 if one is violated
#[derive(Args, Debug)]
#[command(after_help = super::example("check cubes --assert owner"))]
pub(crate) struct CheckArgs {
    #[command(flatten)]
    frame: FrameArgs,

    /// Assertion to check; may be given several times. All if omitted
    #[arg(long, value_name = "ID", value_parser = parse::choice::<Assertion>())]
    assert: Vec<Assertion>,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

/// Runs `check`: draws the frame, prints the findings, and fails if an assertion is violated.
pub(crate) fn run(args: &CheckArgs) -> Result<(), Failure> {
    let DrawnFrame { scene, recipe, frame, .. } = args.frame.draw(None)?;
    let wanted = if args.assert.is_empty() { Assertion::ALL } else { &args.assert };
    // The only way to cancel is to end the process.
    let Some(report) = check(&scene, &recipe, &frame, wanted, TaskControl::quiet()) else { return Ok(()) };
    if args.json {
        output::print_json(&report)?;
    } else {
        output::print(&table(&report))?;
    }
    let violated = report.findings.iter().filter(|finding| finding.violated > 0).count();
    if violated > 0 { Err(Failure::Violated { violated, of: report.findings.len() }) } else { Ok(()) }
}

/// Formats one line for each assertion, followed by the first fragment that violates it.
fn table(report: &AssertionReport) -> String {
    let mut text = format!("{:<14} {:>12} {:>12}  {}\n", "assertion", "checked", "violated", "condition");
    for Finding { assertion, checked, violated, first } in &report.findings {
        text += &format!("{:<14} {checked:>12} {violated:>12}  {}\n", assertion.id(), assertion.name());
        if let Some(first) = first {
            text += &format!(
                "{:<14} first at {},{}, triangle {}: {}\n",
                "", first.x, first.y, first.triangle.0, first.text
            );
        }
    }
    text
}
