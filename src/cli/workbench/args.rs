//! Options for state and appearance of the workbench.

use crate::cli::parse;
use crate::inspect::Intermediate;
use crate::inspect::fates::TriangleFate;
use crate::inspect::mesh_view::MeshStyle;
use crate::inspect::scrub::Moment;
use crate::lab::Page;
use crate::pipeline::viewport::Viewport;
use clap::{Args, ValueEnum};

use super::{Panel, Workspace, panel, workspace};

/// State and appearance of the workbench.
#[derive(Args, Clone, Debug)]
pub(crate) struct WorkbenchArgs {
    /// Width and height of the screenshot in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = parse::size)]
    pub(crate) size: Viewport,

    /// Pixels per point, from 0.5 to 4; more than 1 on high-density screens
    #[arg(long, default_value = "1.0", value_parser = scale)]
    pub(crate) scale: f32,

    /// Colour theme of the workbench
    #[arg(long, default_value = "dark")]
    pub(crate) theme: ThemeArg,

    /// Column and row of the pixel to pick in the scene's picture; the inspector explains it
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = parse::pixel)]
    pub(crate) at: Option<(u32, u32)>,

    /// Time all upscalers first, which takes a few seconds, and show their frame times; in the lab, compare all methods
    #[arg(long)]
    pub(crate) measure: bool,

    /// Compare the picture with those of other upscalers
    #[arg(long)]
    pub(crate) compare: Option<CompareArg>,

    /// Workspace of the window to show; by default, the one that the other options need
    #[arg(long, value_parser = workspace())]
    pub(crate) workspace: Option<Workspace>,

    /// Panel to show, in the first workspace that has it unless --workspace is given
    #[arg(long, value_parser = panel())]
    pub(crate) panel: Option<Panel>,

    /// Intermediate value of the pipeline to show instead of the colour
    #[arg(long, value_name = "NUMBER", value_parser = parse::choice::<Intermediate>())]
    pub(crate) number: Option<Intermediate>,

    /// Number of triangles to draw, and number of fragments of the last of them; all fragments if omitted
    #[arg(long, value_name = "TRIANGLES[,FRAGMENTS]", value_parser = moment)]
    pub(crate) moment: Option<Moment>,

    /// Show range and histogram of the shown quantity
    #[arg(long)]
    pub(crate) range: bool,

    /// Show the list of overlays
    #[arg(long)]
    pub(crate) overlays: bool,

    /// Fate of the triangles to select; shows the panel “Triangle fates”
    #[arg(long, value_name = "FATE", value_parser = parse::choice::<TriangleFate>())]
    pub(crate) fate: Option<TriangleFate>,
    /// Add the picked pixel to the watch list
    #[arg(long)]
    pub(crate) watch: bool,

    /// Dialog to open over the workbench
    #[arg(long)]
    pub(crate) open: Option<Open>,
    /// Run the stability probe with its default settings and show the result
    #[arg(long)]
    pub(crate) probe: bool,

    /// Style of the mesh view, which shows the scene from a second camera beside the picture; triangles are coloured by
    /// their fate if no style is given
    #[arg(long, value_name = "STYLE", num_args = 0..=1, default_missing_value = "fate", value_parser = parse::choice::<MeshStyle>())]
    pub(crate) mesh: Option<MeshStyle>,

    /// Page of the 2D lab to show instead of the pipeline
    #[arg(long, value_name = "PAGE", value_parser = parse::choice::<Page>())]
    pub(crate) lab: Option<Page>,

    /// Number of completed steps of the lab; all if omitted
    #[arg(long, value_name = "STEPS", requires = "lab")]
    pub(crate) lab_step: Option<usize>,
}

impl Default for WorkbenchArgs {
    fn default() -> Self {
        Self {
            size: Viewport { width: 1280, height: 800 },
            scale: 1.0,
            theme: ThemeArg::Dark,
            at: None,
            measure: false,
            compare: None,
            workspace: None,
            panel: None,
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

/// Colour theme of the workbench.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum ThemeArg {
    /// Light text on dark panels
    Dark,
    /// Dark text on light panels
    Light,
}

/// Mode of the comparison of pictures.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum CompareArg {
    /// Two tiles side by side
    Two,
    /// Four tiles side by side
    Four,
    /// One tile for every upscaler
    All,
    /// One picture left of a movable line, the other right of it
    Wipe,
    /// One picture at a time on the whole canvas
    Flip,
    /// Difference between two pictures, shown as a colour map
    Difference,
}

/// Dialog over the workbench.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Open {
    /// Key sheet: all keys and mouse gestures by topic
    Keys,
    /// Manual of the program
    Manual,
    /// Command palette: a search over all commands
    Palette,
    /// List of bookmarks, which contains one bookmark
    Bookmarks,
    /// Start card with examples, for new users
    StartCard,
    /// First step of the introduction on the live picture
    Coach,
}

fn moment(text: &str) -> Result<Moment, String> {
    let number = |text: &str| text.trim().parse().map_err(|_| format!("`{text}` is not a whole number"));
    let (triangles, fragments) = text.split_once(',').map_or((text, None), |(first, second)| (first, Some(second)));
    Ok(Moment { triangles: number(triangles)?, fragments: fragments.map(number).transpose()? })
}

fn scale(text: &str) -> Result<f32, String> {
    let scale = text.parse().ok().filter(|scale| (0.5..=4.0).contains(scale));
    scale.ok_or_else(|| "expected a number from 0.5 to 4".to_owned())
}
