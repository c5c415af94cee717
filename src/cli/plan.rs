//! `rasterscope plan`: what each draw of a frame runs and leaves out, and why, in words or as JSON.

use clap::Args;
use rasterscope::pipeline::prepare;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::report::plan::{Group, groups, text};
use serde::Serialize;

use super::failure::Failure;
use super::output;
use super::scene_args::{FrameArgs, View};

/// What `plan` takes.
#[derive(Args, Debug)]
pub(crate) struct PlanArgs {
    #[command(flatten)]
    frame: FrameArgs,

    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

/// The plans of a frame, as JSON.
#[derive(Serialize)]
struct Planned<'a> {
    scene: &'a str,
    size: [u32; 2],
    groups: &'a [Group],
}

/// Plans the draws without drawing them.
pub(crate) fn run(args: &PlanArgs) -> Result<(), Failure> {
    let View { scene, camera, recipe, .. } = args.frame.view()?;
    let viewport = args.frame.size();
    let Viewport { width, height } = viewport;
    let plans = prepare(&scene, &camera, &recipe.pipeline, viewport, &mut ()).plans;
    let groups = groups(&scene, &plans);
    if args.json {
        let planned = Planned { scene: &scene.name, size: [width, height], groups: &groups };
        let json = serde_json::to_string_pretty(&planned).map_err(|e| Failure::Output(e.into()))?;
        return output::print(&(json + "\n"));
    }
    let head = format!("{}, {width} × {height} px\n", scene.name);
    let told = groups.iter().map(|group| format!("\n{}", text(group)));
    output::print(&(head + &told.collect::<String>()))
}
