//! `rasterscope plan`: prints which parts of the pipeline each draw of a frame runs and skips, with the reasons and the
//! time saved, as text or as JSON.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::chain::{Recipe, RenderInputs, execution};
use crate::measure::noise;
use crate::measure::skipped_work::{Saving, Savings, savings};
use crate::pipeline::plan::PipelinePart;
use crate::pipeline::settings::Execution;
use crate::pipeline::viewport::Viewport;
use crate::pipeline::{prepare, tiled};
use crate::report::plan::{DrawGroup, WholeFrame, groups, text, whole, whole_text};
use crate::report::skipped_work::{SceneSavings, table, views};
use crate::scene::{Camera, Scene};
use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::output;
use super::progress::ProgressLine;
use super::scene_args::{FrameArgs, RequestedView};

/// Print which parts of the pipeline each draw runs and skips, and why
#[derive(Args, Debug)]
#[command(after_help = super::example("plan cubes --set shading=texture"))]
pub(crate) struct PlanArgs {
    #[command(flatten)]
    frame: FrameArgs,

    /// Measure the time saved by skipping: draw the view with every skip enabled, and with each skip disabled in turn
    #[arg(long, group = "measuring")]
    measure: bool,

    /// Measure the time saved by skipping on every built-in scene in its home view, and on a mesh of many triangles in
    /// view, close to the camera and behind the camera; print a table of scenes and parts
    #[arg(long, group = "measuring", conflicts_with_all = ["scene", "camera", "mirror_z"])]
    table: bool,

    /// Number of timed rounds, after some warm-up rounds
    #[arg(long, value_name = "N", default_value_t = 21, requires = "measuring",
          value_parser = clap::value_parser!(u32).range(1..=100_000))]
    rounds: u32,

    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

/// Plans of the draws of a frame, as JSON.
#[derive(Serialize)]
struct Planned<'a> {
    scene: &'a str,
    size: [u32; 2],
    frame: WholeFrame,
    groups: &'a [DrawGroup],
    #[serde(skip_serializing_if = "Option::is_none")]
    savings: Option<Savings>,
}

/// Runs `plan`: prints the plans of the draws without drawing them and, on request, measures the time saved by
/// skipping.
pub(crate) fn run(args: &PlanArgs) -> Result<(), Failure> {
    let RequestedView { scene, camera, recipe, .. } = args.frame.view()?;
    let viewport = args.frame.size()?;
    if args.table {
        return table_of_scenes(args, &recipe, viewport);
    }
    let Viewport { width, height } = viewport;
    let plans = match execution(&scene, &recipe).0 {
        Execution::Tiled => tiled::plans(&scene, &camera, &recipe.pipeline, viewport),
        Execution::Classic => prepare(&scene, &camera, &recipe.pipeline, viewport, &mut ()).plans,
    };
    let groups = groups(&scene, &plans);
    let frame = whole(&scene, &recipe, viewport);
    let savings = args.measure.then(|| {
        let line = ProgressLine::new();
        // The flag is never set: the only way to cancel is to end the process.
        savings(
            RenderInputs { scene: &scene, camera: &camera, recipe: &recipe, viewport },
            args.rounds as usize,
            &|share| line.show_share("measuring", share),
            &AtomicBool::new(false),
        )
    });
    let savings = savings.flatten();
    if args.json {
        let planned = Planned { scene: &scene.name, size: [width, height], frame, groups: &groups, savings };
        return output::print_json(&planned);
    }
    let head = format!("{}, {width} × {height} px\n", scene.name);
    let texts = groups.iter().map(|group| format!("\n{}", text(group)));
    let frame = format!("\n{}", whole_text(&frame));
    output::print(
        &(head + &texts.collect::<String>() + &frame + &savings.as_ref().map(savings_text).unwrap_or_default()),
    )
}

/// Measures the time saved by skipping on many scenes, and prints a table.
fn table_of_scenes(args: &PlanArgs, recipe: &Recipe, viewport: Viewport) -> Result<(), Failure> {
    let views = views();
    let count = views.len() as f32;
    let line = ProgressLine::new();
    let measure = |(number, (name, scene, camera)): (usize, (&'static str, Scene, Camera))| {
        let report_progress = |share: f32| line.show_share("measuring", (number as f32 + share) / count);
        // The flag is never set: the only way to cancel is to end the process.
        let never = AtomicBool::new(false);
        let inputs = RenderInputs { scene: &Arc::new(scene), camera: &camera, recipe, viewport };
        let savings = savings(inputs, args.rounds as usize, &report_progress, &never)?;
        Some(SceneSavings { scene: name, savings })
    };
    let rows: Vec<SceneSavings> = views.into_iter().enumerate().filter_map(measure).collect();
    drop(line);
    if args.json {
        return output::print_json(&rows);
    }
    output::print(&table(&rows, viewport, rayon::current_num_threads()))
}

fn savings_text(savings: &Savings) -> String {
    let Savings { planned_ms, noise, planning_ms, savings, .. } = savings;
    let mut text = format!(
        "\nFrame with every skip enabled: {:.3} ms (median of {}); noise floor {}, {:.3} ms\n",
        planned_ms.median,
        planned_ms.n,
        noise.words(),
        noise.ms(planned_ms.median)
    );
    text += &format!("Planning takes {:.2} µs of this time\n", planning_ms.median * 1e3);
    if savings.is_empty() {
        return text + "Nothing to measure: this frame has no skip that can be disabled.\n";
    }
    text += &format!("{:21} {:>10} {:>10} {:>10}  draws\n", "saved by skipping, ms", "median", "p10", "p90");
    for Saving { part, draws, saved_ms, within_noise, same_picture } in savings {
        let name = part.map_or("all parts", PipelinePart::name);
        let picture = if *same_picture { "" } else { ", and the picture DIFFERS: internal error" };
        let noise = if *within_noise { format!(", {}", noise::WITHIN) } else { String::new() };
        text += &format!(
            "{name:21} {:+10.3} {:+10.3} {:+10.3}  {draws}{noise}{picture}\n",
            saved_ms.median, saved_ms.p10, saved_ms.p90
        );
    }
    text
}
