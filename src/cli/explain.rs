//! `rasterscope explain`: finds the faults of another renderer by which its picture of a scene differs from ours.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use crate::chain::Renderer;
use crate::explain::{ALL, Explanation, Query, Setup, by_id, explain};
use crate::image::file::{read, write_png};
use crate::image::{Image, Rgba8};
use crate::pipeline::viewport::Viewport;
use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::progress::ProgressLine;
use super::scene_args::{RequestedView, SceneArgs};
use super::{interrupt, output, parse};

/// Names of the pictures that are written.
const PICTURES: [&str; 3] = ["ours.png", "ours-with-faults.png", "unexplained.png"];

/// Arguments of `explain`.
#[derive(Args, Debug)]
pub(crate) struct ExplainArgs {
    /// Picture that another renderer drew of the scene, of any size
    #[arg(value_name = "PICTURE")]
    picture: PathBuf,

    #[command(flatten)]
    scene: SceneArgs,

    /// Fault that is not considered; may be given several times. The known faults are listed in the manual
    #[arg(long, value_name = "FAULT", value_parser = fault)]
    without: Vec<String>,

    /// Pixel whose colours are printed: theirs, ours, and ours with the faults; may be given several times
    #[arg(long, value_name = "X,Y", value_parser = parse::pixel)]
    at: Vec<(u32, u32)>,

    /// Print JSON instead of text
    #[arg(long)]
    json: bool,

    /// Folder for three pictures: ours.png, ours-with-faults.png, and unexplained.png with only the pixels in colour that
    /// still differ
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

/// Explanation as JSON.
#[derive(Serialize)]
struct ExplanationReport<'a> {
    scene: &'a str,
    size: [u32; 2],
    #[serde(flatten)]
    explanation: &'a Explanation,
    pixels_at: Vec<PixelColors>,
}

/// Runs `explain`: searches for the faults, writes the requested pictures, and prints the explanation.
pub(crate) fn run(args: &ExplainArgs) -> Result<(), Failure> {
    if let Some(folder) = &args.output {
        output::prepare_folder(folder, &PICTURES)?;
    }
    let theirs = read(&args.picture)?;
    let RequestedView { scene, recipe, camera, .. } = args.scene.view()?;
    let (width, height) = theirs.size();
    if let Some((x, y)) = args.at.iter().find(|(x, y)| *x >= width || *y >= height) {
        return Err(Failure::OutsidePicture { x: *x, y: *y, picture: Viewport { width, height } });
    }
    let correct = Setup::new(scene, camera, recipe, Viewport { width, height });
    let (line, interrupted) = (ProgressLine::new(), interrupt::flag());
    let go_on = |share: f32| {
        line.show_share("searching", share);
        !interrupted.load(Ordering::Relaxed)
    };
    let query = Query { correct, theirs, without: args.without.clone() };
    let Ok(found) = explain(&query, &go_on) else { return Err(interrupt::nothing()) };
    drop(line);
    let mut renderer = Renderer::default();
    let (ours, faulty) = (query.correct.draw(&mut renderer), found.setup.draw(&mut renderer));
    let pixels_at = args.at.iter().map(|at| colors(*at, [&query.theirs, &ours, &faulty])).collect();
    if let Some(folder) = &args.output {
        write_pictures(folder, &found, &query.theirs, [&ours, &faulty])?;
    }
    if args.json {
        let size = [width, height];
        let report = ExplanationReport { scene: &query.correct.scene.name, size, explanation: &found, pixels_at };
        return output::print_json(&report);
    }
    output::print(&(found.to_string() + &pixels_at.iter().map(text).collect::<String>()))
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
