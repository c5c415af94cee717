//! `rasterscope explain`: finds the faults of another renderer by which its picture of a scene differs from ours.

mod folder;

use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;

use crate::chain::Renderer;
use crate::explain::{ALL, Explanation, Query, Setup, TheirBuffers, by_id, depths, explain_with, ids};
use crate::image::file::{read, write_png};
use crate::image::picture::Picture;
use crate::image::{Image, Rgba8};
use crate::pipeline::viewport::Viewport;
use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::progress::ProgressLine;
use super::scene_args::{RequestedView, SceneArgs};
use super::shard::ShardArgs;
use super::{interrupt, output, parse};

pub(super) use folder::merge;

/// Names of the pictures that are written.
const PICTURES: [&str; 3] = ["ours.png", "ours-with-faults.png", "unexplained.png"];

/// Find the faults of another renderer by which its picture of a scene differs from ours
#[derive(Args, Debug)]
#[command(after_help = super::example("explain theirs.png model.obj --camera view.json"))]
pub(crate) struct ExplainArgs {
    /// Picture that another renderer drew of the scene, of any size; or a folder, all of whose pictures are explained, in
    /// the order of their names
    #[arg(value_name = "PICTURE")]
    picture: PathBuf,

    #[command(flatten)]
    scene: SceneArgs,

    #[command(flatten)]
    shard: ShardArgs,

    /// Picture of the depths that the other renderer stored, in any linear, reciprocal or logarithmic mapping: a float
    /// or grey picture, or an OpenEXR file with a channel `Z`
    #[arg(long, value_name = "PICTURE")]
    depth: Option<PathBuf>,

    /// Picture of the ids of the triangles or objects that the other renderer shows, as numbers or as colours
    #[arg(long, value_name = "PICTURE")]
    ids: Option<PathBuf>,

    /// Fault that is not considered; may be given several times. The known faults are listed in the manual
    #[arg(long, value_name = "FAULT", value_parser = fault)]
    without: Vec<String>,

    /// Pixel whose colours are printed: theirs, ours, and ours with the faults; may be given several times
    #[arg(long, value_name = "X,Y", value_parser = parse::pixel)]
    at: Vec<(u32, u32)>,

    /// Print JSON instead of text
    #[arg(long, conflicts_with = "shard")]
    json: bool,

    /// Folder for three pictures: ours.png, ours-with-faults.png, and unexplained.png with only the pixels in colour that
    /// still differ. With a folder of pictures, one subfolder for each; with --shard, file for the part
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
}

/// Colours of one pixel, as sRGB codes.
#[derive(Serialize)]
struct PixelColors {
    at: [u32; 2],
    theirs: [u8; 3],
    ours: [u8; 3],
    ours_with_faults: [u8; 3],
}

/// Explanation of one picture, as JSON and as text.
#[derive(Serialize)]
struct ExplanationReport {
    scene: String,
    size: [u32; 2],
    #[serde(flatten)]
    explanation: Explanation,
    pixels_at: Vec<PixelColors>,
}

impl Display for ExplanationReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.explanation, self.pixels_at.iter().map(text).collect::<String>())
    }
}

/// Runs `explain`: searches for the faults, writes the requested pictures, and prints the explanation.
pub(crate) fn run(args: &ExplainArgs) -> Result<(), Failure> {
    if args.picture.is_dir() || args.shard.shard.is_some() {
        if args.depth.is_some() || args.ids.is_some() {
            return Err(Failure::Usage("--depth and --ids belong to one picture, not to a folder or shard".to_owned()));
        }
        return folder::run(args);
    }
    if let Some(folder) = &args.output {
        output::prepare_folder(folder, &PICTURES)?;
    }
    let theirs = picture(args, &args.picture)?;
    let view = args.scene.view()?;
    let (line, interrupted) = (ProgressLine::new(), interrupt::flag());
    let go_on = |share: f32| {
        line.show_share("searching", share);
        !interrupted.load(Ordering::Relaxed)
    };
    let found = explained(args, &view, theirs, args.output.as_deref(), &go_on)?;
    drop(line);
    let report = found.ok_or_else(interrupt::nothing)?;
    if args.json { output::print_json(&report) } else { output::print(&report.to_string()) }
}

/// Reads a picture, and checks that it contains the requested pixels.
fn picture(args: &ExplainArgs, path: &Path) -> Result<Image<Rgba8>, Failure> {
    let theirs = read(path)?;
    let (width, height) = theirs.size();
    match args.at.iter().find(|(x, y)| *x >= width || *y >= height) {
        Some((x, y)) => Err(Failure::OutsidePicture { x: *x, y: *y, picture: Viewport { width, height } }),
        None => Ok(theirs),
    }
}

/// Explains a picture, and writes the drawings to `folder`. Returns `None` if interrupted.
fn explained(
    args: &ExplainArgs,
    view: &RequestedView,
    theirs: Image<Rgba8>,
    folder: Option<&Path>,
    go_on: &(dyn Fn(f32) -> bool + Sync),
) -> Result<Option<ExplanationReport>, Failure> {
    let (width, height) = theirs.size();
    let correct = Setup::new(Arc::clone(&view.scene), view.camera, view.recipe, Viewport { width, height });
    let query = Query { correct, theirs, without: args.without.clone() };
    let Ok(found) = explain_with(&query, &buffers(args, (width, height))?, go_on) else { return Ok(None) };
    let mut renderer = Renderer::default();
    let (ours, faulty) = (query.correct.draw(&mut renderer), found.setup.draw(&mut renderer));
    let pixels_at = args.at.iter().map(|at| colors(*at, [&query.theirs, &ours, &faulty])).collect();
    if let Some(folder) = folder {
        write_pictures(folder, &found, &query.theirs, [&ours, &faulty])?;
    }
    let scene = query.correct.scene.name.clone();
    Ok(Some(ExplanationReport { scene, size: [width, height], explanation: found, pixels_at }))
}

/// Reads the further pictures, which must have the size of the picture.
fn buffers(args: &ExplainArgs, size: (u32, u32)) -> Result<TheirBuffers, Failure> {
    let picture = |path: &PathBuf| {
        let picture = Picture::read(path)?;
        let ((width, height), (expected_width, expected_height)) = (picture.size(), size);
        if picture.size() != size {
            let path = path.display();
            let sizes = format!("{width} × {height} px, but the picture {expected_width} × {expected_height}");
            return Err(Failure::Usage(format!("{path}: it has {sizes}")));
        }
        Ok(picture)
    };
    let of_depth = |path: &PathBuf| {
        depths(&picture(path)?).map_err(|reason| Failure::Usage(format!("{}: {reason}", path.display())))
    };
    let depth = args.depth.as_ref().map(of_depth).transpose()?;
    let ids = args.ids.as_ref().map(|path| picture(path).map(|picture| ids(&picture))).transpose()?;
    Ok(TheirBuffers { depth, ids })
}

/// Checks that a fault exists.
fn fault(id: &str) -> Result<String, String> {
    match by_id(id) {
        Some(fault) => Ok(fault.id.to_owned()),
        None => {
            let known: Vec<_> = ALL.iter().map(|fault| fault.id).collect();
            Err(format!("no such fault; the known ones are {}", known.join(", ")))
        }
    }
}

fn colors((x, y): (u32, u32), pictures: [&Image<Rgba8>; 3]) -> PixelColors {
    let [theirs, ours, ours_with_faults] = pictures.map(|picture| {
        let [r, g, b, _] = picture.at(x, y);
        [r, g, b]
    });
    PixelColors { at: [x, y], theirs, ours, ours_with_faults }
}

fn text(pixel: &PixelColors) -> String {
    let PixelColors { at: [x, y], theirs, ours, ours_with_faults } = pixel;
    format!("pixel {x},{y}: theirs {theirs:?}, ours {ours:?}, ours with the faults {ours_with_faults:?}\n")
}

fn write_pictures(
    folder: &Path,
    found: &Explanation,
    theirs: &Image<Rgba8>,
    [ours, faulty]: [&Image<Rgba8>; 2],
) -> Result<(), Failure> {
    let unexplained = found.unexplained(theirs, faulty);
    let mut written = PICTURES.iter().zip([ours, faulty, &unexplained]);
    Ok(written.try_for_each(|(name, picture)| write_png(&folder.join(name), picture))?)
}
