//! `rasterscope render`: one frame, or one of its buffers, as a PNG.

use std::path::PathBuf;

use clap::Args;
use rasterscope::image::file::write_png;
use rasterscope::inspect::{Buffer, capture, view};

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

    /// The PNG file to write
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
}

/// Draws, writes the picture, and says in one line what was made.
pub(crate) fn run(args: &RenderArgs) -> Result<(), Failure> {
    let Drawn { scene, recipe, frame } = args.frame.draw()?;
    let image = if args.buffer == Buffer::Color {
        &frame.image
    } else {
        let buffers = capture(&scene, &recipe, &frame);
        let range = view::range(args.buffer, &frame, Some(&buffers));
        &view::picture(args.buffer, &frame, Some(&buffers), range)
    };
    write_png(&args.output, image)?;
    output::print(&format!(
        "{}: {} × {} px, {} triangles in, {} drawn, {:.1} ms, {:.1} % of the pixels drawn\n",
        output::display(&args.output),
        frame.viewport.width,
        frame.viewport.height,
        frame.geometry.triangles_in,
        frame.geometry.triangles.len(),
        frame.times.total.as_secs_f64() * 1e3,
        frame.drawn_share() * 100.0,
    ))
}
