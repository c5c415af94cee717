//! `rasterscope report`: measures error against run time of every upscaler, and writes an HTML page, a CSV table and
//! JSON.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use crate::chain::Recipe;
use crate::measure::metric::Metric;
use crate::measure::motion::Turn;
use crate::measure::part::{Experiment, Parts};
use crate::measure::reference::Reference;
use crate::pipeline::viewport::Viewport;
use crate::report::upscaling::csv::csv;
use crate::report::upscaling::measurements::{Measurements, measure};
use crate::report::upscaling::page::page;
use crate::report::upscaling::sweep::{self, NamedView, UpscalingPlan, UpscalingProgress, UpscalingReport};
use crate::upscale::Upscaling;
use clap::Args;

use super::failure::Failure;
use super::progress::ProgressLine;
use super::scene_args::{DEFAULT_SIZE, MemoryArgs, NamedScene};
use super::shard::{Merged, ShardArgs, write_part};
use super::upscaler_args::UpscalerArgs;
use super::{interrupt, output, parse, scene_args};

/// File names of the report's HTML page, CSV table and JSON.
const FILES: [&str; 3] = ["index.html", "report.csv", "report.json"];

/// Measure error against run time of every upscaler, and write an HTML page, a CSV table and JSON
#[derive(Args, Debug)]
#[command(after_help = super::example("report chess --size 640x360 -o report"))]
pub(crate) struct ReportArgs {
    /// Ids of built-in scenes, or paths of models or projects, whose settings and size other options override; the first built-in scene if omitted
    #[arg(value_name = "SCENE")]
    scenes: Vec<PathBuf>,

    /// Folder for the report; created if missing. With --shard, file for the part
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,

    #[command(flatten)]
    shard: ShardArgs,

    /// Setting to change for all measurements; may be given several times. The upscaler is varied by the report itself
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,

    /// Width and height of the pictures in pixels [default: that of the projects, or 1280x720]
    #[arg(long, value_name = "WxH", value_parser = parse::size)]
    size: Option<Viewport>,

    #[command(flatten)]
    memory: MemoryArgs,

    #[command(flatten)]
    upscalers: UpscalerArgs,

    /// Number of timed rounds; each draws one frame of the sequence with every upscaler
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u16).range(1..=1000))]
    rounds: u16,

    /// Number of threads to draw with; all hardware threads if omitted
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    /// Reference picture that errors are measured against
    #[arg(long, value_name = "REFERENCE", default_value = "native", value_parser = parse::choice::<Reference>())]
    reference: Reference,

    /// Metric on the error axis, by which the upscalers are ranked; a mean over single frames
    #[arg(long, value_name = "METRIC", default_value = "flip", value_parser = parse::choice::<Metric>())]
    metric: Metric,

    /// Angle in degrees by which the camera orbits per frame, for errors and times; 0 measures the still view
    #[arg(long, value_name = "DEGREES", default_value_t = Turn::default().degrees, allow_hyphen_values = true,
          value_parser = parse::degrees)]
    turn: f32,
}

/// Runs `report`: measures the upscalers, and writes `index.html`, `report.csv` and `report.json`, or a part of them.
pub(crate) fn run(args: &ReportArgs) -> Result<(), Failure> {
    let plan = plan(args)?;
    match args.shard.shard {
        None => output::prepare_folder(&args.output, &FILES)?,
        Some(_) => output::check_writable(&args.output)?,
    }
    let line = ProgressLine::new();
    let show = |UpscalingProgress { scene, stage, done, of }: UpscalingProgress| {
        line.show(&format!("{scene}, {stage}: {done} of {of}"));
    };
    let threads = args.threads.map_or(0, usize::from);
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| Failure::Threads(e.to_string()))?;
    let interrupted = interrupt::flag();
    let is_interrupted = || interrupted.load(Ordering::Relaxed);
    if let Some(shard) = args.shard.shard {
        let part = pool.install(|| measure(&plan, shard, &show, &is_interrupted));
        drop(line);
        let part = part.ok_or_else(interrupt::nothing)?;
        return write_part(Some(&args.output), Experiment::Report, plan.record(), part);
    }
    let report = pool.install(|| sweep::run(&plan, &show, &is_interrupted));
    drop(line);
    let report = report.ok_or_else(interrupt::nothing)?;
    let index = args.output.join(FILES[0]);
    for (name, content) in files(&report)? {
        output::write_bytes(&args.output.join(name), &content)?;
    }
    let rows = report.scenes.iter().map(|scene| scene.rows.len()).sum::<usize>();
    output::print(&format!("{}: {rows} rows, with report.csv and report.json\n", output::display(&index)))?;
    interrupt::outcome(report.partial)
}

/// Returns the names and contents of a report's files.
fn files(report: &UpscalingReport) -> Result<Vec<(&'static str, Vec<u8>)>, Failure> {
    let contents = [page(report).map_err(Failure::Output)?, csv(report), output::json(report)?];
    Ok(FILES.into_iter().zip(contents.map(String::into_bytes)).collect())
}

/// Merges the parts of a report.
pub(crate) fn merge(parts: Parts) -> Result<Merged, Failure> {
    let (plan, runs) = parts.into_runs(Measurements::check)?;
    let report = sweep::combine(&plan, &runs).ok_or_else(interrupt::nothing)?;
    Ok(Merged { files: files(&report)?, partial: report.partial })
}

fn plan(args: &ReportArgs) -> Result<UpscalingPlan, Failure> {
    args.upscalers.register()?;
    // Invalid options are reported before a scene is loaded.
    Recipe::default().set_all(&args.set)?;
    let names = args.scenes.iter().map(Some);
    let names: Vec<Option<&PathBuf>> = if args.scenes.is_empty() { vec![None] } else { names.collect() };
    let mut subjects = Vec::with_capacity(names.len());
    let mut size_of_projects = None;
    for name in names {
        let NamedScene { scene, camera, mut recipe, size } =
            scene_args::named_scene(name.map(PathBuf::as_path), args.memory)?;
        recipe.set_all(&args.set)?;
        subjects.push(NamedView { name: scene.name.clone(), camera, recipe, scene: Arc::new(scene) });
        let differs = size_of_projects.is_some() && size.is_some() && size != size_of_projects;
        if differs && args.size.is_none() {
            return Err(Failure::Usage("the projects have different sizes; choose one with --size".to_owned()));
        }
        size_of_projects = size_of_projects.or(size);
    }
    Ok(UpscalingPlan {
        subjects,
        upscalers: Upscaling::every().collect(),
        viewport: args.size.or(size_of_projects).unwrap_or(DEFAULT_SIZE),
        rounds: args.rounds.into(),
        reference: args.reference,
        metric: args.metric,
        turn: Turn::by(args.turn),
    })
}
