//! `rasterscope screenshot`: renders the workbench to a PNG on the CPU, without a window or a display.

use std::path::{Path, PathBuf};

use crate::image::file::write_png;
use crate::image::picture::Picture;
use crate::image::sequence::FileSequence;
use crate::image::{Image, Rgba8};
use clap::Args;

use super::failure::Failure;
use super::output;
use super::scene_args::SceneArgs;
use super::seen_args::SeenArgs;
use super::workbench::{self, WorkbenchArgs};

/// Render the workbench to a PNG, without a window
#[derive(Args, Debug)]
#[command(after_help = super::example("screenshot chess --compare four -o compared.png"))]
pub(crate) struct ScreenshotArgs {
    #[command(flatten)]
    scene: SceneArgs,

    #[command(flatten)]
    look: WorkbenchArgs,

    #[command(flatten)]
    seen: SeenArgs,

    /// Earlier value of a setting, to show what has changed since; may be given several times
    #[arg(long, value_name = "KEY=VALUE")]
    against: Vec<String>,

    /// PNG file to write
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
}

/// Runs `screenshot`: renders the workbench to an image file.
pub(crate) fn run(args: &ScreenshotArgs) -> Result<(), Failure> {
    let SeenArgs { picture_a, picture_b, picture_reference, .. } = &args.seen;
    for path in [picture_a, picture_b, picture_reference].into_iter().flatten() {
        // In the window, an unusable picture gives a message; here it would only be in the picture.
        if FileSequence::is_named_by(path) {
            FileSequence::find(path)?;
        } else {
            Picture::read(path)?;
        }
    }
    let view = args.scene.view()?;
    let against = view.against(&args.against)?;
    let against = (!args.against.is_empty()).then_some(against);
    save(&workbench::draw(view, &args.look, args.seen.clone(), against)?, &args.output)
}

/// Writes a picture of the workbench to a PNG file and prints a summary line.
pub(crate) fn save(image: &Image<Rgba8>, path: &Path) -> Result<(), Failure> {
    write_png(path, image)?;
    let (width, height) = image.size();
    output::print(&format!("{}: the workbench, {width} × {height} px\n", output::display(path)))
}
