//! `rasterscope probe`: jitters camera or vertices by a few units in the last place and prints which pixels and
//! triangles change.

use std::path::{Path, PathBuf};

use crate::case::MinimalCase;
use crate::image::file::{encode_png, write_png};
use crate::inspect::control::TaskControl;
use crate::inspect::probe::{
    Changed, Fragile, Heat, JitterTarget, Probe, ProbeCounts, ProbeFindings, ProbePlan, ProbeResult, ProbedView, count,
    picture, run as probe,
};
use crate::measure::machine::Machine;
use crate::measure::part::{Experiment, Parts};
use crate::measure::shard::ShardRun;
use crate::pipeline::settings::Choice as _;
use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::scene_args::{FrameArgs, RequestedView};
use super::shard::{Merged, ShardArgs, write_part};
use super::{interrupt, output, parse};

/// Maximum number of triangles listed in the text output.
const MAX_LISTED: usize = 10;

/// Move camera or vertices by a few units in the last place, and print which pixels and triangles change
#[derive(Args, Debug)]
#[command(after_help = super::example("probe z-fighting --ulps 2 -o heat.png"))]
pub(crate) struct ProbeArgs {
    #[command(flatten)]
    frame: FrameArgs,

    /// Inputs of the frame to jitter
    #[arg(long, value_name = "WHAT", default_value = "camera", value_parser = parse::choice::<JitterTarget>())]
    what: JitterTarget,

    /// Largest jitter, in units in the last place
    #[arg(long, value_name = "K", default_value_t = 1)]
    ulps: u32,

    /// Number of runs, each with its own jitter
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u16).range(1..))]
    runs: u16,

    /// Seed of the jitter; the same seed gives the same jitter
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Property by which the heat map compares pixels
    #[arg(long, default_value = "owner", conflicts_with = "shard", value_parser = parse::choice::<Heat>())]
    heat: Heat,

    #[command(flatten)]
    shard: ShardArgs,

    /// Print JSON, with all triangles that lost or gained pixels
    #[arg(long, conflicts_with = "shard")]
    json: bool,

    /// PNG file for the heat map; with --shard, file for the part
    #[arg(short, long, value_name = "HEAT.png")]
    output: Option<PathBuf>,

    /// Case file to write for the most fragile triangle
    #[arg(long, value_name = "CASE.json", conflicts_with = "shard")]
    save_case: Option<PathBuf>,
}

/// Runs `probe`: draws the view repeatedly with jittered inputs, writes the requested files, and prints the findings.
pub(crate) fn run(args: &ProbeArgs) -> Result<(), Failure> {
    let RequestedView { scene, recipe, camera, .. } = args.frame.view()?;
    let subject = ProbedView { scene, camera, settings: recipe.pipeline, viewport: args.frame.size()? };
    let what = Probe { what: args.what, ulps: args.ulps, runs: args.runs, seed: args.seed };
    if let Some(shard) = args.shard.shard {
        let machine = Machine::at_start().with_host();
        let Some(results) = count(&subject, what, shard, TaskControl::quiet()) else { return Ok(()) };
        let run = ShardRun { shard, machine: machine.at_end(), partial: false, results };
        return write_part(args.output.as_deref(), Experiment::Probe, ProbePlan::new(&subject, what), run);
    }
    let Some(found) = probe(&subject, what, TaskControl::quiet()) else { return Ok(()) };
    if let Some(path) = &args.output {
        let (heat, _) = picture(&found.findings, args.heat)
            .ok_or_else(|| Failure::Usage("--heat depth: without a depth test the frame has no depth".to_owned()))?;
        write_png(path, &heat)?;
    }
    if let Some(path) = &args.save_case {
        save_case(&found, path)?;
    }
    let ProbeResult { subject, findings } = &found;
    output::print(&if args.json { json(&subject.scene.name, findings)? } else { text(findings) })
}

/// Merges the parts of a probe into its findings as JSON and text, and one heat map for each aspect.
pub(crate) fn merge(parts: Parts) -> Result<Merged, Failure> {
    let (plan, runs) = parts.into_runs(ProbeCounts::check)?;
    let partial = runs.iter().any(|run| run.partial);
    let mut counts = runs.into_iter().map(|run| run.results);
    let first = counts.next().ok_or_else(interrupt::nothing)?;
    let counts = counts.fold(first, |mut all, more| {
        all.join(more);
        all
    });
    let ProbePlan { scene, probe, picture: still, .. } = plan;
    let found = ProbeFindings::new(probe, still, &counts);
    let mut files = vec![("probe.json", json(&scene, &found)?.into_bytes()), ("probe.txt", text(&found).into_bytes())];
    for (name, heat) in
        [("heat-owner.png", Heat::Owner), ("heat-depth.png", Heat::Depth), ("heat-color.png", Heat::Color)]
    {
        if let Some((heat, _)) = picture(&found, heat) {
            files.push((name, encode_png(&heat).map_err(Failure::Output)?));
        }
    }
    Ok(Merged { files, partial })
}

/// Writes the most fragile triangle, which gained and lost the most pixels, to a case file.
fn save_case(found: &ProbeResult, path: &Path) -> Result<(), Failure> {
    let worst = found.findings.ranking.first().and_then(|worst| Some((worst, found.triangle_of(worst)?)));
    let Some((worst, triangle)) = worst else {
        return Err(Failure::Usage("--save-case: no triangle lost or gained a pixel; raise --ulps".to_owned()));
    };
    let ProbedView { scene, settings, viewport, .. } = &found.subject;
    let case = MinimalCase::new(&triangle, worst.worst_pixel, *viewport, settings, &scene.name);
    output::write(path, &case.to_json())
}

/// Findings of the stability probe, as JSON.
#[derive(Serialize)]
struct ProbeJsonOutput<'a> {
    scene: &'a str,
    width: u32,
    height: u32,
    probe: Probe,
    summary: crate::inspect::probe::ProbeSummary,
    ranking: &'a [Fragile],
}

fn json(scene: &str, found: &ProbeFindings) -> Result<String, Failure> {
    let (width, height) = found.size();
    let (summary, ranking) = (found.summary(), &found.ranking[..]);
    let printed = ProbeJsonOutput { scene, width, height, probe: found.probe, summary, ranking };
    output::json(&printed)
}

fn text(found: &ProbeFindings) -> String {
    let Probe { what, ulps, runs, seed } = found.probe;
    let summary = found.summary();
    let name = what.name().to_lowercase();
    let mut text = format!("{runs} runs, {name} moved by up to {ulps} ulp, seed {seed}\n");
    let mut line = |name: &str, Changed { pixels, most }: Changed| {
        let percent = pixels as f64 / summary.pixels as f64 * 100.0;
        text.push_str(&format!(
            "{name:7} {pixels:9} pixels changed ({percent:.2} %), each in up to {most} of {runs} runs\n"
        ));
    };
    line("owner", summary.owner);
    if let Some(depth) = summary.depth {
        line("depth", depth);
    }
    line("colour", summary.color);
    text.push_str(&format!("{} triangles lost or gained pixels\n", summary.fragile_triangles));
    for Fragile { triangle, changes, worst_pixel: (x, y), worst_changes } in found.ranking.iter().take(MAX_LISTED) {
        text.push_str(&format!(
            "  triangle {:8} {changes:9} changes, worst at pixel {x},{y}: {worst_changes} of {runs} runs\n",
            triangle.0
        ));
    }
    text
}
