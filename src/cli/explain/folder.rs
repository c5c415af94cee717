//! `rasterscope explain FOLDER`: explains all pictures in a folder, or a shard of them.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;

use crate::chain::Renderer;
use crate::explain::Setup;
use crate::image::sequence::pictures_in;
use crate::image::{Image, Rgba8, png_text};
use crate::measure::machine::Machine;
use crate::measure::part::{Experiment, Parts};
use crate::measure::shard::{Shard, ShardRun};
use crate::pipeline::viewport::Viewport;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{ExplainArgs, PICTURES, explained, picture};
use crate::cli::failure::Failure;
use crate::cli::progress::ProgressLine;
use crate::cli::scene_args::RequestedView;
use crate::cli::shard::{Merged, write_part};
use crate::cli::{interrupt, output};

/// Last line of the text of an interrupted run.
const PARTIAL: &str = "# partial: interrupted before every picture was explained\n";

/// Size in pixels of the drawing in a plan. Parts whose drawings differ belong to different scenes, even if these have one
/// name.
const SAMPLE: Viewport = Viewport { width: 96, height: 54 };

/// Everything that determines the explanations of a folder, without the scene and the pictures themselves.
#[derive(Serialize, Deserialize)]
struct FolderPlan {
    scene: String,
    triangles: usize,
    camera: Value,
    recipe: Value,
    without: Vec<String>,
    at: Vec<(u32, u32)>,
    /// File names, in the order of the explanations.
    pictures: Vec<String>,
    /// Our drawing at the size of [`SAMPLE`].
    #[serde(with = "png_text")]
    sample: Image<Rgba8>,
}

/// Explanations of the pictures of a shard, by their index in the plan.
type Explanations = BTreeMap<usize, PictureExplanation>;

/// Explanation of one picture.
#[derive(Serialize, Deserialize)]
struct PictureExplanation {
    /// Explanation as `explain PICTURE --json` prints it.
    json: Value,
    /// Explanation as `explain PICTURE` prints it.
    text: String,
}

/// Runs `explain` with a folder of pictures, or with a shard of it. A single picture is a folder of one.
pub(super) fn run(args: &ExplainArgs) -> Result<(), Failure> {
    let files = files(&args.picture)?;
    let shard = args.shard.shard.unwrap_or(Shard::WHOLE);
    let folder = args.output.as_deref().filter(|_| args.shard.shard.is_none());
    let owned: Vec<usize> = (0..files.len()).filter(|index| shard.owns(*index)).collect();
    // Faulty pictures and outputs are reported before the long search.
    for index in &owned {
        picture(args, &files[*index])?;
        folder.map_or(Ok(()), |folder| output::prepare_folder(&folder.join(name(&files[*index])), &PICTURES))?;
    }
    if args.shard.shard.is_some() {
        args.output.as_deref().map_or(Ok(()), output::check_writable)?;
    }
    let view = args.scene.view()?;
    let machine = Machine::at_start().with_host();
    let (line, interrupted) = (ProgressLine::new(), interrupt::flag());
    let mut results = Explanations::new();
    for (done, index) in owned.iter().enumerate() {
        let go_on = |share: f32| {
            line.show_share("searching", (done as f32 + share) / owned.len() as f32);
            !interrupted.load(Ordering::Relaxed)
        };
        let (file, theirs) = (&files[*index], picture(args, &files[*index])?);
        let drawings = folder.map(|folder| folder.join(name(file)));
        let Some(report) = explained(args, &view, theirs, drawings.as_deref(), &go_on)? else { break };
        let json = serde_json::to_value(&report).map_err(|error| Failure::Output(error.into()))?;
        results.insert(*index, PictureExplanation { json, text: report.to_string() });
    }
    drop(line);
    let partial = results.len() < owned.len();
    if partial && results.is_empty() {
        return Err(interrupt::nothing());
    }
    let plan = plan(args, &view, &files);
    if args.shard.shard.is_some() {
        let run = ShardRun { shard, machine: machine.at_end(), partial, results };
        return write_part(args.output.as_deref(), Experiment::Explain, plan, run);
    }
    output::print(&if args.json { json(&plan, &results, partial)? } else { text(&plan, &results, partial) })?;
    interrupt::outcome(partial)
}

/// Merges the parts of a folder's explanations.
pub(in crate::cli) fn merge(parts: Parts) -> Result<Merged, Failure> {
    let (plan, runs) = parts.into_runs(check)?;
    let partial = runs.iter().any(|run| run.partial);
    let results: Explanations = runs.into_iter().flat_map(|run| run.results).collect();
    let files =
        [("explanations.json", json(&plan, &results, partial)?), ("explanations.txt", text(&plan, &results, partial))];
    Ok(Merged { files: files.map(|(name, text)| (name, text.into_bytes())).into(), partial })
}

/// Returns the first contradiction between the explanations of a shard and the plan, in words.
fn check(plan: &FolderPlan, run: &ShardRun<Explanations>) -> Result<(), String> {
    let mut owned = plan.pictures.iter().enumerate().filter(|(index, _)| run.shard.owns(*index));
    match owned.find(|(index, _)| !run.results.contains_key(index)).filter(|_| !run.partial) {
        Some((_, picture)) => Err(format!("no explanation of {picture}")),
        None => Ok(()),
    }
}

/// Returns the pictures of a folder in the order of their names, or the picture itself.
fn files(path: &Path) -> Result<Vec<PathBuf>, Failure> {
    if path.is_dir() { Ok(pictures_in(path)?) } else { Ok(vec![path.to_owned()]) }
}

fn name(file: &Path) -> String {
    file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn plan(args: &ExplainArgs, view: &RequestedView, files: &[PathBuf]) -> FolderPlan {
    let ours = Setup::new(Arc::clone(&view.scene), view.camera, view.recipe, SAMPLE);
    FolderPlan {
        scene: view.scene.name.clone(),
        triangles: view.scene.triangle_count(),
        // Plain data can always be written.
        camera: serde_json::to_value(view.camera).unwrap_or_default(),
        recipe: serde_json::to_value(view.recipe).unwrap_or_default(),
        without: args.without.clone(),
        at: args.at.clone(),
        pictures: files.iter().map(|file| name(file)).collect(),
        sample: ours.draw(&mut Renderer::default()),
    }
}

/// Explanations of a folder as JSON.
#[derive(Serialize)]
struct FolderReport<'a> {
    scene: &'a str,
    pictures: Vec<NamedExplanation<'a>>,
    /// Whether the run was interrupted before every picture was explained.
    partial: bool,
}

#[derive(Serialize)]
struct NamedExplanation<'a> {
    picture: &'a str,
    #[serde(flatten)]
    explanation: &'a Value,
}

fn json(plan: &FolderPlan, results: &Explanations, partial: bool) -> Result<String, Failure> {
    let named = named(plan, results).map(|(picture, found)| NamedExplanation { picture, explanation: &found.json });
    output::json(&FolderReport { scene: &plan.scene, pictures: named.collect(), partial })
}

fn text(plan: &FolderPlan, results: &Explanations, partial: bool) -> String {
    let mut text = String::new();
    for (picture, found) in named(plan, results) {
        let _ = writeln!(text, "{picture}\n{}", found.text);
    }
    text + if partial { PARTIAL } else { "" }
}

/// Returns the explanations in the order of the pictures, with their file names.
fn named<'a>(
    plan: &'a FolderPlan,
    results: &'a Explanations,
) -> impl Iterator<Item = (&'a str, &'a PictureExplanation)> {
    plan.pictures.iter().enumerate().filter_map(|(index, name)| Some((&name[..], results.get(&index)?)))
}
