//! `rasterscope screenshot`: the whole workbench as a PNG, drawn by the CPU, with no window and no display.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use rasterscope::image::file::write_png;
use rasterscope::image::{Image, Rgba8};
use rasterscope::inspect::Intermediate;
use rasterscope::inspect::fates::TriangleFate;
use rasterscope::inspect::mesh_view::MeshStyle;
use rasterscope::inspect::scrub::Moment;
use rasterscope::lab::Page;
use rasterscope::pipeline::viewport::Viewport;

use super::failure::Failure;
use super::scene_args::SceneArgs;
use super::seen_args::SeenArgs;
use super::{output, parse, workbench};

/// What `screenshot` takes.
#[derive(Args, Debug)]
pub(crate) struct ScreenshotArgs {
    #[command(flatten)]
    scene: SceneArgs,

    #[command(flatten)]
    look: Look,

    #[command(flatten)]
    seen: SeenArgs,

    /// Show what changes where one setting was this before; may be given several times
    #[arg(long, value_name = "KEY=VALUE")]
    against: Vec<String>,

    /// The PNG file to write
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
}

/// How the workbench looks.
#[derive(Args, Clone, Debug)]
pub(crate) struct Look {
    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = parse::size)]
    pub(crate) size: Viewport,

    /// Pixels per point, as on a screen of high density: 0.5 to 4
    #[arg(long, default_value = "1.0", value_parser = scale)]
    pub(crate) scale: f32,

    /// Colours of the workbench
    #[arg(long, default_value = "dark")]
    pub(crate) theme: Theme,

    /// Column and row of the scene's pixel that is selected, so that the inspector tells about it
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = parse::pixel)]
    pub(crate) at: Option<(u32, u32)>,

    /// Time all upscalers first, some seconds, and show their frame times; in the lab, all ways to do the same
    #[arg(long)]
    pub(crate) measure: bool,

    /// Compare the picture with others by their upscalers
    #[arg(long)]
    pub(crate) compare: Option<Compare>,

    /// The tab that is open
    #[arg(long)]
    pub(crate) tab: Option<Tab>,

    /// Show this number on the way from triangle to colour, all over the picture
    #[arg(long, value_name = "NUMBER", value_parser = parse::choice::<Intermediate>())]
    pub(crate) number: Option<Intermediate>,

    /// Draw only the first triangles, and of the last of them only the first fragments if their number is given, too
    #[arg(long, value_name = "TRIANGLES[,FRAGMENTS]", value_parser = moment)]
    pub(crate) moment: Option<Moment>,

    /// Show range and histogram of what is shown on the picture
    #[arg(long)]
    pub(crate) range: bool,

    /// Show the list of overlays
    #[arg(long)]
    pub(crate) overlays: bool,

    /// Select the triangles that ended so, and open the tab of fates
    #[arg(long, value_name = "FATE", value_parser = parse::choice::<TriangleFate>())]
    pub(crate) fate: Option<TriangleFate>,
    /// Watch the selected pixel
    #[arg(long)]
    pub(crate) watch: bool,

    /// What is open over the workbench
    #[arg(long)]
    pub(crate) open: Option<Open>,
    /// Probe how firmly the picture stands, with the default probe, and show it
    #[arg(long)]
    pub(crate) probe: bool,

    /// Show the scene from outside beside the picture, its triangles drawn so; by their fate if nothing is said
    #[arg(long, value_name = "STYLE", num_args = 0..=1, default_missing_value = "fate", value_parser = parse::choice::<MeshStyle>())]
    pub(crate) mesh: Option<MeshStyle>,

    /// Show this page of the 2D lab
    #[arg(long, value_name = "PAGE", value_parser = parse::choice::<Page>())]
    pub(crate) lab: Option<Page>,

    /// Steps of the lab that are done; all if omitted
    #[arg(long, value_name = "STEPS", requires = "lab")]
    pub(crate) lab_step: Option<usize>,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            size: Viewport { width: 1280, height: 800 },
            scale: 1.0,
            theme: Theme::Dark,
            at: None,
            measure: false,
            compare: None,
            tab: None,
            number: None,
            moment: None,
            range: false,
            overlays: false,
            fate: None,
            watch: false,
            open: None,
            probe: false,
            mesh: None,
            lab: None,
            lab_step: None,
        }
    }
}

/// Colours of the workbench.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Theme {
    /// Light text on dark panels
    Dark,
    /// Dark text on light panels
    Light,
}

/// How pictures are compared.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Compare {
    /// Two tiles side by side
    Two,
    /// Four tiles
    Four,
    /// Every upscaler in a tile
    All,
    /// One left of a line, the other right of it
    Wipe,
    /// One in the whole canvas
    Flip,
    /// Their difference by a colour map
    Difference,
}

/// What lies over the workbench.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Open {
    /// All keys by topic
    Keys,
    /// Everything that can be done, to be searched
    Palette,
    /// The list of bookmarks, of which there is one
    Bookmarks,
}

/// Tabs along the bottom.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Tab {
    /// Frame time of each upscaler
    FrameTime,
    /// What each upscaler costs and how wrong it is
    ErrorTime,
    /// Every step of the arithmetic of the picked pixel
    Arithmetic,
    /// What the picked pixel is made of
    Xray,
    /// How often each value of what is shown is there
    Histogram,
    /// Where triangles and fragments went
    Fates,
    /// What the scene needs and what is left out
    Plan,
    /// How cost grows
    Scaling,
    /// How the engine does on hard cases
    Stability,
    /// What holds for every fragment of the frame
    Assertions,
    /// What all buffers hold at watched pixels
    Watch,
    /// The vertices of the picked triangle at every stage
    Vertices,
    /// How firmly the picture stands
    Probe,
    /// Messages
    Log,
}

fn moment(text: &str) -> Result<Moment, String> {
    let number = |text: &str| text.trim().parse().map_err(|_| format!("`{text}` is not a whole number"));
    let (triangles, fragments) = text.split_once(',').map_or((text, None), |(first, second)| (first, Some(second)));
    Ok(Moment { triangles: number(triangles)?, fragments: fragments.map(number).transpose()? })
}

fn scale(text: &str) -> Result<f32, String> {
    let scale = text.parse().ok().filter(|scale| (0.5..=4.0).contains(scale));
    scale.ok_or_else(|| "the scale is a number from 0.5 to 4".to_owned())
}

/// Draws the workbench into a file.
pub(crate) fn run(args: &ScreenshotArgs) -> Result<(), Failure> {
    let view = args.scene.view()?;
    let against = view.against(&args.against)?;
    let against = (!args.against.is_empty()).then_some(against);
    save(&workbench::draw(view, &args.look, args.seen.clone(), against)?, &args.output)
}

/// Writes a picture of the workbench and says in one line what was made.
pub(crate) fn save(image: &Image<Rgba8>, path: &Path) -> Result<(), Failure> {
    write_png(path, image)?;
    let (width, height) = image.size();
    output::print(&format!("{}: the workbench, {width} × {height} px\n", output::display(path)))
}
