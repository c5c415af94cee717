//! `rasterscope pixel`: why a pixel looks as it does, in words or as JSON.

use clap::Args;
use rasterscope::inspect::inspect;

use super::failure::Failure;
use super::pixel_text::describe;
use super::scene_args::{Drawn, FrameArgs};
use super::seen_args::moment;
use super::{output, parse};

/// What `pixel` takes.
#[derive(Args, Debug)]
pub(crate) struct PixelArgs {
    #[command(flatten)]
    frame: FrameArgs,

    /// Column and row of the pixel, counted from 0 at the top left
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = parse::pixel)]
    at: (u32, u32),

    /// Draw only the first so many of the rasterized triangles
    #[arg(long, value_name = "N")]
    triangles: Option<usize>,

    /// Of the last of them draw only the first fragments
    #[arg(long, value_name = "N", requires = "triangles")]
    fragments: Option<usize>,

    /// Taken so that a copied command works here too, and of no use: all about the pixel is told
    #[arg(long, hide = true)]
    buffer: Option<String>,

    /// As `buffer`
    #[arg(long, hide = true)]
    stage: Option<String>,

    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

/// Draws, replays the pixel, and prints what happened there.
pub(crate) fn run(args: &PixelArgs) -> Result<(), Failure> {
    let (x, y) = args.at;
    let picture = args.frame.size();
    let outside = || Failure::OutsidePicture { x, y, picture };
    if x >= picture.width || y >= picture.height {
        return Err(outside());
    }
    let Drawn { scene, recipe, frame, .. } = args.frame.draw(moment(args.triangles, args.fragments))?;
    let report = inspect(&scene, &recipe, &frame, x, y).ok_or_else(outside)?;
    if args.json {
        let json = serde_json::to_string_pretty(&report).map_err(|e| Failure::Output(e.into()))?;
        output::print(&(json + "\n"))
    } else {
        output::print(&describe(&report))
    }
}
