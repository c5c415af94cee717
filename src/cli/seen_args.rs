//! What of a frame is looked at: the options that "Copy as command" adds to scene, view and settings.

use clap::Args;
use rasterscope::inspect::display::Display;
use rasterscope::inspect::overlays::Layer;
use rasterscope::inspect::scrub::Moment;
use rasterscope::inspect::{Buffer, Intermediate, Stage};
use rasterscope::pipeline::viewport::Viewport;

use super::failure::Failure;
use super::parse::{self, Either};
use super::scene_args::{SceneArgs, View};

/// What the window shows of the frame.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub(crate) struct SeenArgs {
    /// The quantity to show instead of the colour
    #[arg(long, value_parser = parse::either::<Buffer, Intermediate>())]
    pub(crate) buffer: Option<Either<Buffer, Intermediate>>,

    /// Show the picture after this stage instead of a buffer
    #[arg(long, conflicts_with = "buffer", value_parser = parse::choice::<Stage>())]
    pub(crate) stage: Option<Stage>,

    /// By which range (all, most, 0.25..0.5), colour map and channels it is shown, as range=most,map=magma,reversed,channels=rg
    #[arg(long, value_name = "LOOK")]
    pub(crate) look: Option<Display>,

    /// Lay this over the picture, as strong as is said, normals as long as is said in shares of the scene's size; may be given several times, the lowest first
    #[arg(long, value_name = "OVERLAY[=OPACITY[,length=SHARE]]", value_parser = parse::layer())]
    pub(crate) overlay: Vec<Layer>,

    /// Draw only the first so many of the rasterized triangles
    #[arg(long, value_name = "N")]
    pub(crate) triangles: Option<usize>,

    /// Of the last of them draw only the first fragments
    #[arg(long, value_name = "N", requires = "triangles")]
    pub(crate) fragments: Option<usize>,

    /// Width and height of the scene's picture in pixels; as large as the canvas if omitted
    #[arg(long, value_name = "WxH", value_parser = parse::size)]
    pub(crate) picture: Option<Viewport>,
}

/// The moment after so many triangles, or within the one after them.
pub(crate) fn moment(triangles: Option<usize>, fragments: Option<usize>) -> Option<Moment> {
    triangles.map(|triangles| Moment { triangles, fragments })
}

/// What the window starts with.
#[derive(Args, Clone, Debug)]
pub(crate) struct WindowArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    #[command(flatten)]
    pub(crate) seen: SeenArgs,

    /// Column and row of the scene's pixel that is selected
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = parse::pixel)]
    pub(crate) at: Option<(u32, u32)>,
}

impl WindowArgs {
    /// Reads everything; what is looked at is particular, too.
    pub(crate) fn view(&self) -> Result<View, Failure> {
        let view = self.scene.view()?;
        let is_default = view.is_default && self.seen == SeenArgs::default() && self.at.is_none();
        Ok(View { is_default, ..view })
    }
}
