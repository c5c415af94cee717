//! `rasterscope vector`: a scene as drawing commands, or as a bitmap of them.

use std::path::PathBuf;

use clap::Args;
use rasterscope::drawing::file;
use rasterscope::inspect::outline::{OutlineKind, outline};

use super::failure::Failure;
use super::scene_args::{FrameArgs, View};
use super::{output, parse};

/// What `vector` takes.
#[derive(Args, Debug)]
pub(crate) struct VectorArgs {
    #[command(flatten)]
    frame: FrameArgs,

    /// What is drawn
    #[arg(long, default_value = "hidden-line", value_parser = parse::choice::<OutlineKind>())]
    kind: OutlineKind,

    /// The file to write; its name tells the format: svg, pdf, png, bmp, jpg, gif, tiff
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

/// Draws, writes, and says in one line what was made.
pub(crate) fn run(args: &VectorArgs) -> Result<(), Failure> {
    file::format_of(&args.output)?;
    let View { scene, recipe, camera, .. } = args.frame.view()?;
    let drawing = outline(&scene, &camera, &recipe, args.frame.size(), args.kind);
    file::write(&args.output, &drawing, 1.0)?;
    let (path, shapes) = (output::display(&args.output), drawing.shape_count());
    output::print(&format!("{path}: {shapes} shapes on {} × {} px\n", drawing.size.x, drawing.size.y))
}
