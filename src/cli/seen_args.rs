//! Options that select how the frame is displayed. The command “Copy view as command” adds them to the options for
//! scene, camera and settings.

use std::path::PathBuf;

use crate::inspect::display::Display;
use crate::inspect::overlays::OverlayLayer;
use crate::inspect::scrub::Moment;
use crate::inspect::{Buffer, Intermediate, Stage};
use crate::pipeline::viewport::Viewport;
use clap::Args;

use super::failure::Failure;
use super::parse::{self, Either};
use super::scene_args::{RequestedView, SceneArgs};

/// Options that select how the frame is displayed.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub(crate) struct SeenArgs {
    /// Quantity to show instead of the colour
    #[arg(long, value_parser = parse::either::<Buffer, Intermediate>())]
    pub(crate) buffer: Option<Either<Buffer, Intermediate>>,

    /// Show the picture after this pipeline stage instead of a buffer
    #[arg(long, conflicts_with = "buffer", value_parser = parse::choice::<Stage>())]
    pub(crate) stage: Option<Stage>,

    /// Range (all, most, 0.25..0.5), colour map and channels of the shown quantity, as in
    /// range=most,map=magma,reversed,channels=rg
    #[arg(long, value_name = "LOOK")]
    pub(crate) look: Option<Display>,

    /// Overlay on the picture, with its opacity, and the length of normals as a fraction of the scene's size; may be
    /// given several times, bottom first
    #[arg(long, value_name = "OVERLAY[=OPACITY[,length=SHARE]]", value_parser = parse::layer())]
    pub(crate) overlay: Vec<OverlayLayer>,

    /// Number of rasterized triangles to draw; all if omitted
    #[arg(long, value_name = "N")]
    pub(crate) triangles: Option<usize>,

    /// Number of fragments to draw of the last of these triangles; all if omitted
    #[arg(long, value_name = "N", requires = "triangles")]
    pub(crate) fragments: Option<usize>,

    /// Picture file, or sequence of picture files, to compare as A
    #[arg(long, value_name = "FILE")]
    pub(crate) picture_a: Option<PathBuf>,

    /// Picture file, or sequence of picture files, to compare as B
    #[arg(long, value_name = "FILE")]
    pub(crate) picture_b: Option<PathBuf>,

    /// Picture file, or sequence of picture files, to measure the compared pictures against
    #[arg(long, value_name = "FILE")]
    pub(crate) picture_reference: Option<PathBuf>,

    /// Width and height of the scene's picture in pixels; the size of the canvas if omitted
    #[arg(long, value_name = "WxH", value_parser = parse::size)]
    pub(crate) picture: Option<Viewport>,
}

/// Returns the point in the drawing of a frame at which `triangles` triangles are drawn. Of the last triangle, only the
/// first `fragments` fragments are drawn, or all if `fragments` is `None`. Returns `None` if `triangles` is `None`,
/// because the whole frame is drawn then.
pub(crate) fn moment(triangles: Option<usize>, fragments: Option<usize>) -> Option<Moment> {
    triangles.map(|triangles| Moment { triangles, fragments })
}

/// Open the window, or fail if no window can be opened
///
/// If neither a scene nor options are given, it resumes the scene, settings and view of the previous run.
#[derive(Args, Clone, Debug)]
#[command(after_help = super::example("window chess --set shading=gouraud"))]
pub(crate) struct WindowArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    #[command(flatten)]
    pub(crate) seen: SeenArgs,

    /// Column and row of the pixel to pick in the scene's picture
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = parse::pixel)]
    pub(crate) at: Option<(u32, u32)>,
}

impl WindowArgs {
    /// Loads the scene, and reads the camera and the settings. The view counts as default only if `seen` and `at` have
    /// their default values, too.
    pub(crate) fn view(&self) -> Result<RequestedView, Failure> {
        let view = self.scene.view()?;
        let is_default = view.is_default && self.seen == SeenArgs::default() && self.at.is_none();
        Ok(RequestedView { is_default, ..view })
    }
}
