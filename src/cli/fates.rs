//! `rasterscope fates`: prints the fate of every triangle and fragment of a frame, such as drawn, culled or rejected by
//! the depth test, as counts in total and per object.

use crate::inspect::Fates;
use crate::inspect::fates::{Account, FragmentCounts, FragmentFate, ObjectFates, TriangleCounts, TriangleFate};
use crate::pipeline::settings::Choice;
use crate::pipeline::viewport::Viewport;
use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::output;
use super::scene_args::{DrawnFrame, FrameArgs};

/// Print the fate of every triangle and every fragment, in total and per object
#[derive(Args, Debug)]
#[command(after_help = super::example("fates near-plane"))]
pub(crate) struct FatesArgs {
    #[command(flatten)]
    frame: FrameArgs,

    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

/// Fates of the triangles and fragments of a frame, as JSON.
#[derive(Serialize)]
struct FatesJsonOutput<'a> {
    scene: &'a str,
    size: [u32; 2],
    triangles: TriangleCounts,
    fragments: FragmentCounts<u64>,
    objects: &'a [ObjectFates],
    /// Number of triangles with a normal or texture coordinate that is NaN or infinite in the model.
    broken: usize,
    balanced: bool,
    account: &'a Account,
}

/// Runs `fates`: draws the frame, and counts and prints the fates of its triangles and fragments.
pub(crate) fn run(args: &FatesArgs) -> Result<(), Failure> {
    let DrawnFrame { scene, recipe, frame, .. } = args.frame.draw(None)?;
    let fates = Fates::of(&scene, &recipe, &frame);
    let Viewport { width, height } = frame.viewport;
    if args.json {
        let output = FatesJsonOutput {
            scene: &scene.name,
            size: [width, height],
            triangles: fates.triangle_counts(),
            fragments: fates.fragment_counts(),
            objects: &fates.objects,
            broken: fates.broken.len(),
            balanced: fates.account.is_balanced(),
            account: &fates.account,
        };
        return output::print_json(&output);
    }
    output::print(&(format!("{}, {width} × {height} px\n", scene.name) + &text(&fates)))
}

fn text(fates: &Fates) -> String {
    let (triangles, fragments) = (fates.triangle_counts(), fates.fragment_counts());
    let mut text = funnel::<TriangleFate>("triangles", triangles.sum(), |fate| triangles.of(fate));
    text += &funnel::<FragmentFate>("fragments", fragments.sum(), |fate| fragments.of(fate));
    text += &objects(&fates.objects, &triangles);
    text.push('\n');
    if !fates.broken.is_empty() {
        text += &format!(
            "{} triangles have a normal or texture coordinate that is NaN or infinite in the model.\n",
            fates.broken.len()
        );
    }
    match fates.account.complaints() {
        none if none.is_empty() => text += "All sums match: every triangle and every fragment has exactly one fate.\n",
        complaints => complaints.iter().for_each(|complaint| text += &format!("SUMS DO NOT MATCH: {complaint}.\n")),
    }
    text
}

/// Formats a line for each fate that occurs, with its count, its percentage of all triangles or fragments, and a bar.
fn funnel<C: Choice>(what: &str, all: u64, count: impl Fn(C) -> u64) -> String {
    /// Length of the longest bar, in characters.
    const BAR: f64 = 40.0;
    let mut text = format!("\n{what:18} {all:12}\n");
    for fate in C::ALL.iter().filter(|fate| count(**fate) > 0) {
        let share = count(*fate) as f64 / all.max(1) as f64;
        let bar = "█".repeat((share * BAR).ceil() as usize);
        text += &format!("  {:16} {:12} {:6.2} %  {bar}\n", fate.name().to_lowercase(), count(*fate), share * 100.0);
    }
    text
}

/// Formats a row for each object, with a column for each fate that occurs in the frame.
fn objects(objects: &[ObjectFates], all: &TriangleCounts) -> String {
    let bins: Vec<_> = TriangleFate::ALL.iter().copied().filter(|fate| all.of(*fate) > 0).collect();
    let heading = |fate: &TriangleFate| format!("  {:>12}", fate.id());
    let mut text = format!("\n{:20} {:>10}{}\n", "object", "triangles", bins.iter().map(heading).collect::<String>());
    for ObjectFates { name, triangles, .. } in objects {
        let cells: String = bins.iter().map(|fate| format!("  {:12}", triangles.of(*fate))).collect();
        text += &format!("{:20} {:10}{cells}\n", shortened(name), triangles.sum());
    }
    text
}

/// Truncates a name to the width of its column in the table.
fn shortened(name: &str) -> String {
    const COLUMN: usize = 20;
    if name.chars().count() <= COLUMN {
        name.to_owned()
    } else {
        name.chars().take(COLUMN - 1).chain(['…']).collect()
    }
}
