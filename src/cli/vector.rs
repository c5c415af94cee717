//! `rasterscope vector`: exports a scene as vector drawing commands, or as a bitmap drawn from them.

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use crate::drawing::file;
use crate::inspect::control::TaskControl;
use crate::inspect::outline::{OutlineKind, OutlineRequest, outline};
use clap::Args;

use super::failure::Failure;
use super::progress::ProgressLine;
use super::scene_args::{FrameArgs, RequestedView};
use super::{interrupt, output, parse};

/// Export a scene as a vector drawing: wireframe, hidden-line drawing, or polygons
#[derive(Args, Debug)]
#[command(after_help = super::example("vector cubes --kind hidden-line -o cubes.svg"))]
pub(crate) struct VectorArgs {
    #[command(flatten)]
    frame: FrameArgs,

    /// Kind of drawing to export
    #[arg(long, default_value = "hidden-line", value_parser = parse::choice::<OutlineKind>())]
    kind: OutlineKind,

    /// Output file; its extension determines the format: svg, pdf, png, bmp, jpg, gif, tiff
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

/// Runs `vector`: writes the drawing and prints a summary line.
pub(crate) fn run(args: &VectorArgs) -> Result<(), Failure> {
    file::format_of(&args.output)?;
    let RequestedView { scene, recipe, camera, .. } = args.frame.view()?;
    let request = OutlineRequest {
        scene: &scene,
        camera: &camera,
        recipe: &recipe,
        viewport: args.frame.size()?,
        kind: args.kind,
    };
    let interrupted = interrupt::flag();
    let line = ProgressLine::new();
    let control = TaskControl { progress: &|share| line.show_share("drawing", share), cancel: interrupted };
    let drawing = outline(&request, control).ok_or_else(interrupt::nothing)?;
    drop(line);
    let bytes = file::encode(&args.output, &drawing, 1.0)?;
    if interrupted.load(Ordering::Relaxed) {
        return Err(interrupt::nothing());
    }
    file::save(&args.output, &bytes)?;
    let (path, shapes) = (output::display(&args.output), drawing.shape_count());
    output::print(&format!("{path}: {shapes} shapes on {} × {} px\n", drawing.size.x, drawing.size.y))
}
