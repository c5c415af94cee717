//! `rasterscope screenshot`: the whole workbench as a PNG, drawn by the CPU, with no window and no display.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use rasterscope::pipeline::viewport::Viewport;

use super::failure::Failure;
use super::parse;
use super::scene_args::{SceneArgs, View};

/// What `screenshot` takes.
#[derive(Args, Debug)]
pub(crate) struct ScreenshotArgs {
    #[command(flatten)]
    scene: SceneArgs,

    #[command(flatten)]
    look: Look,

    /// The PNG file to write
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
}

/// How the workbench looks.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct Look {
    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = parse::size)]
    size: Viewport,

    /// Pixels per point, as on a screen of high density: 0.5 to 4
    #[arg(long, default_value = "1.0", value_parser = scale)]
    scale: f32,

    /// Colours of the workbench
    #[arg(long, default_value = "dark")]
    theme: Theme,

    /// Column and row of the scene's pixel that is selected, so that the inspector tells about it
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = parse::pixel)]
    at: Option<(u32, u32)>,
}

impl Default for Look {
    fn default() -> Self {
        Self { size: Viewport { width: 1280, height: 800 }, scale: 1.0, theme: Theme::Dark, at: None }
    }
}

/// Colours of the workbench.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Theme {
    /// Light text on dark panels
    Dark,
    /// Dark text on light panels
    Light,
}

fn scale(text: &str) -> Result<f32, String> {
    let scale = text.parse().ok().filter(|scale| (0.5..=4.0).contains(scale));
    scale.ok_or_else(|| "the scale is a number from 0.5 to 4".to_owned())
}

/// Draws the workbench into a file.
pub(crate) fn run(args: &ScreenshotArgs) -> Result<(), Failure> {
    draw(args.scene.view()?, &args.look, &args.output)
}

/// Draws the workbench and says in one line what was made.
#[cfg(feature = "ui")]
pub(crate) fn draw(view: View, look: &Look, path: &Path) -> Result<(), Failure> {
    use rasterscope::image::file::write_png;
    use rasterscope::ui::{self, ScreenshotRequest};

    use super::{open, output};

    let image = ui::screenshot(&ScreenshotRequest {
        start: open::start(view),
        size: look.size,
        pixels_per_point: look.scale,
        theme: match look.theme {
            Theme::Dark => ui::Theme::Dark,
            Theme::Light => ui::Theme::Light,
        },
        selected: look.at,
    });
    write_png(path, &image)?;
    let (width, height) = image.size();
    output::print(&format!("{}: the workbench, {width} × {height} px\n", output::display(path)))
}

#[cfg(not(feature = "ui"))]
pub(crate) fn draw(_view: View, _look: &Look, _path: &Path) -> Result<(), Failure> {
    Err(Failure::NoWindow(super::window::BUILT_WITHOUT.to_owned()))
}
