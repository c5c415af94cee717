//! `rasterscope clip`: writes the inputs of a temporal upscaler and converged references of the frames of a clip.

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use crate::disk;
use crate::report::clip::{Clip, ClipFile, ClipPlan};
use crate::upscale::Upscaling;
use clap::Args;

use super::failure::Failure;
use super::progress::ProgressLine;
use super::scene_args::FrameArgs;
use super::sequence_args::ShotArgs;
use super::{interrupt, output};

/// Write the inputs of a temporal upscaler and converged references of the frames of a clip, for research
#[derive(Args, Debug)]
#[command(after_help = super::example("clip chess-motion --path turntable --frames 16 -o clip"))]
pub(crate) struct ClipArgs {
    #[command(flatten)]
    frame: FrameArgs,

    #[command(flatten)]
    shot: ShotArgs,

    /// Number of frames to write
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: u32,

    /// Number of samples per pixel of the references
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=4096))]
    samples: u32,

    /// Folder to write; it is created if it does not exist
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
}

/// Runs `clip`: draws the frames one after the other, and writes two files for each and an index.
pub(crate) fn run(args: &ClipArgs) -> Result<(), Failure> {
    let (view, viewport) = (args.frame.view()?, args.frame.size()?);
    let mut recipe = view.recipe;
    if !recipe.upscaler.upscaler().reads().history {
        // The inputs of a method without history have neither jitter nor a lower resolution.
        let chosen = if recipe.upscaler.is_native() { Upscaling::new("taa", 2) } else { None };
        recipe.upscaler = chosen.ok_or_else(|| {
            let name = recipe.upscaler.upscaler().name();
            Failure::Usage(format!("{name} reads no history: choose a temporal upscaler, such as upscaler.method=taa"))
        })?;
    }
    let shot = args.shot.shot(&view)?;
    let folder = |source| Failure::ResultFile { path: args.output.clone(), source };
    std::fs::create_dir_all(&args.output).map_err(folder)?;
    let mut clip = Clip::new(ClipPlan { shot, recipe, viewport, frames: args.frames, samples: args.samples });
    let (line, stop) = (ProgressLine::new(), interrupt::flag());
    let write = |file: &ClipFile| {
        let path = args.output.join(&file.name);
        disk::write(&path, &file.bytes).map_err(|source| Failure::ResultFile { path, source })
    };
    let mut frames = 0;
    while let Some(files) =
        (!stop.load(Ordering::Relaxed)).then(|| clip.next_frame()).transpose().map_err(folder)?.flatten()
    {
        files.iter().try_for_each(write)?;
        frames += 1;
        line.show(&format!("frame {frames} of {}", args.frames));
    }
    let index = clip.index(&output::command_line()).map_err(|error| folder(error.into()))?;
    write(&index)?;
    drop(line);
    output::print(&format!("{}: {frames} frames\n", output::display(&args.output.join(&index.name))))?;
    interrupt::outcome(frames < args.frames)
}
