//! `rasterscope render`: one frame, one of its buffers, or the picture after a stage, as a PNG; and what it cost.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use rasterscope::chain::{Frame, KeepDepth, Recipe, Renderer};
use rasterscope::image::file::write_png;
use rasterscope::inspect::{Buffer, Hits, Stage, capture, stages, view};
use rasterscope::measure::stages::stage_times;
use rasterscope::measure::timing::summarize;
use rasterscope::scene::{Camera, Scene};

use super::failure::Failure;
use super::scene_args::{Drawn, FrameArgs};
use super::{output, parse};

/// What `render` takes.
#[derive(Args, Debug)]
pub(crate) struct RenderArgs {
    #[command(flatten)]
    frame: FrameArgs,

    /// The quantity to show
    #[arg(long, default_value = "color", value_parser = parse::choice::<Buffer>())]
    buffer: Buffer,

    /// Show the picture after this stage instead of a buffer
    #[arg(long, conflicts_with = "buffer", value_parser = parse::choice::<Stage>())]
    stage: Option<Stage>,

    /// Draw only the first so many of the rasterized triangles
    #[arg(long, value_name = "N")]
    triangles: Option<usize>,

    /// Taken so that a copied command works here too, and of no use: the picture has no selected pixel
    #[arg(long, value_name = "X,Y", hide = true)]
    at: Option<String>,

    /// Also print the time of each stage, each the median of this many frames
    #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(1..=1000))]
    times: Option<u32>,

    /// The PNG file to write
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
}

/// Draws, writes the picture, and says in one line what was made.
pub(crate) fn run(args: &RenderArgs) -> Result<(), Failure> {
    let Drawn { scene, camera, recipe, frame } = args.frame.draw(args.triangles)?;
    let mut faults = None;
    let image = match args.stage {
        Some(stage) => &stages::picture(&scene, &camera, &recipe, &frame, stage),
        None if args.buffer == Buffer::Color => frame.image(),
        None => {
            let buffers = capture(&scene, &recipe, &frame).completed_for(args.buffer, &recipe, &frame);
            let range = view::range(args.buffer, &frame, Some(&buffers));
            faults = buffers.hits.as_ref().map(Hits::summary);
            &view::picture(args.buffer, &frame, Some(&buffers), range)
        }
    };
    write_png(&args.output, image)?;
    output::print(&format!(
        "{}: {} × {} px, {} triangles in, {} drawn, {:.1} ms, {:.1} % of the pixels drawn\n",
        output::display(&args.output),
        frame.viewport.width,
        frame.viewport.height,
        scene.triangle_count(),
        frame.rasterized(),
        frame.times.total.as_secs_f64() * 1e3,
        frame.drawn_share() * 100.0,
    ))?;
    if let Some(faults) = faults {
        output::print(&format!("shared edges: {faults}\n"))?;
    }
    args.times.map_or(Ok(()), |frames| print_times(&scene, &camera, &recipe, &frame, frames))
}

/// One line per stage: the median of its times over frames drawn for this.
fn print_times(
    scene: &Arc<Scene>,
    camera: &Camera,
    recipe: &Recipe,
    frame: &Frame,
    frames: u32,
) -> Result<(), Failure> {
    let mut renderer = Renderer::default();
    let mut samples_ms: BTreeMap<usize, (&str, Vec<f64>)> = BTreeMap::new();
    for _ in 0..frames {
        let frame = renderer.render(scene, camera, recipe, frame.viewport, KeepDepth::Yes);
        for (place, (name, time)) in stage_times(scene, camera, recipe, &frame).named().into_iter().enumerate() {
            samples_ms.entry(place).or_insert((name, Vec::new())).1.push(time.as_secs_f64() * 1e3);
        }
    }
    let medians = samples_ms.into_values().filter_map(|(name, ms)| Some((name, summarize(&ms)?.median)));
    output::print(&medians.map(|(name, median)| format!("{name:11} {median:8.3} ms\n")).collect::<String>())
}
