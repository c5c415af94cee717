//! `rasterscope pixel`: explains a pixel, as text, as JSON or as an HTML page.

use std::hint::black_box;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use crate::inspect::Trace;
use crate::inspect::temporal::{ClipView, HistoryClip, PixelHistory, TemporalSearch};
use crate::measure::timing::summarize;
use crate::pipeline::viewport::Viewport;
use crate::report::pixel::{PixelPage, describe, explain_fully};
use clap::Args;

use super::failure::Failure;
use super::scene_args::{DrawnFrame, FrameArgs};
use super::seen_args::moment;
use super::sequence_args::{SequenceRenderer, ShotArgs};
use super::{output, parse};

/// Explain a pixel: list every fragment, which one won, and why, down to the texels
#[derive(Args, Debug)]
#[command(after_help = super::example("pixel chess --at 700,300 --trace"))]
pub(crate) struct PixelArgs {
    #[command(flatten)]
    frame: FrameArgs,

    /// Column and row of the pixel, counted from 0 at the top left [default: the picked pixel of the project]
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = parse::pixel)]
    at: Option<(u32, u32)>,

    /// Number of the frame of a sequence in which the pixel is explained, with the history of all frames from frame 0 on.
    /// Frame k shows the time k divided by --fps [default: a still view at --time, whose history has converged]
    #[arg(long = "frame", value_name = "N", conflicts_with_all = ["time", "triangles"])]
    number: Option<u32>,

    #[command(flatten)]
    shot: ShotArgs,

    /// Number of rasterized triangles to draw before the pixel is explained; all if omitted
    #[arg(long, value_name = "N")]
    triangles: Option<usize>,

    /// Number of fragments to draw of the last of these triangles; all if omitted
    #[arg(long, value_name = "N", requires = "triangles")]
    fragments: Option<usize>,

    /// Accepted and ignored, so that a copied command also works here: the explanation covers all buffers
    #[arg(long, hide = true)]
    buffer: Option<String>,

    /// Accepted and ignored like --buffer
    #[arg(long, hide = true)]
    stage: Option<String>,

    /// Accepted and ignored like --buffer
    #[arg(long, hide = true)]
    look: Option<String>,

    /// Accepted and ignored like --buffer
    #[arg(long, hide = true)]
    overlay: Vec<String>,

    /// Print JSON instead of text
    #[arg(long)]
    json: bool,

    /// HTML file for the explanation with the calculation, the picture, and the pixel's neighbourhood
    #[arg(long, value_name = "FILE.html", conflicts_with_all = ["json", "times"])]
    html: Option<PathBuf>,

    /// Print the calculation of the visible fragment line by line: formula, value, bits, exact value, rounding
    #[arg(long)]
    trace: bool,

    /// Number of the fragment to trace instead of the visible one, counted from 1 in drawing order
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    fragment: Option<u32>,

    /// Number of traces to time; also prints their median time
    #[arg(long, value_name = "TRACES", requires = "trace", value_parser = clap::value_parser!(u32).range(1..=10000))]
    times: Option<u32>,
}

/// Runs `pixel`: draws the frame, replays the pixel, and prints all its fragments.
pub(crate) fn run(args: &PixelArgs) -> Result<(), Failure> {
    if args.number.is_none() && args.shot.has_path() {
        return Err(Failure::Usage("--path needs --frame N: the number of the frame along the camera path".to_owned()));
    }
    let pick = || args.frame.pick()?.ok_or_else(|| Failure::Usage("--at X,Y is missing: name a pixel".to_owned()));
    let (x, y) = args.at.map_or_else(pick, Ok)?;
    let picture = args.frame.size()?;
    let outside = || Failure::OutsidePicture { x, y, picture };
    if x >= picture.width || y >= picture.height {
        return Err(outside());
    }
    let (DrawnFrame { scene, recipe, frame, .. }, clip) = draw(args, picture)?;
    let is_whole = args.triangles.is_none();
    let mut report = explain_fully(&scene, &recipe, &frame, (x, y), is_whole).ok_or_else(outside)?;
    if !args.trace || args.html.is_some() {
        report.temporal = clip.and_then(|clip| pixel_history(clip, (x, y)));
    }
    if !args.trace && args.html.is_none() {
        let text = || describe(&report) + &report.temporal.as_ref().map(PixelHistory::describe).unwrap_or_default();
        return if args.json { output::print_json(&report) } else { output::print(&text()) };
    }
    let fragment = args.fragment.map(|number| number as usize - 1);
    if let Some(number) = args.fragment.filter(|number| *number as usize > report.fragments.len()) {
        return Err(Failure::NoSuchFragment { number, there_are: report.fragments.len() });
    }
    let make = || Trace::of(&scene, &recipe, &frame, &report, fragment);
    let trace = make();
    if let Some(path) = &args.html {
        let page = PixelPage {
            scene: &scene.name,
            frame: &frame,
            report: &report,
            trace: &trace,
            command: &output::command_line(),
        };
        output::write_page(path, page.html())?;
        return output::print(&format!("{}: pixel {x}, {y}: {}\n", output::display(path), report.verdict));
    }
    if args.json {
        output::print_json(&trace)?;
    } else {
        output::print(&trace.to_string())?;
    }
    args.times.map_or(Ok(()), |times| print_time(times, make))
}

/// Draws the frame of the options. Returns it with the frames that share its history; those of a frame that is drawn only
/// up to a triangle are unknown.
fn draw(args: &PixelArgs, size: Viewport) -> Result<(DrawnFrame, Option<HistoryClip>), Failure> {
    let (drawn, view, last) = match args.number {
        Some(number) => {
            let view = args.frame.view()?;
            let shot = args.shot.shot(&view)?;
            let drawn = SequenceRenderer::new(shot.clone(), view.recipe, size).draw(number, None);
            (drawn, ClipView::Moving(shot), number)
        }
        None => {
            let drawn = args.frame.draw(moment(args.triangles, args.fragments))?;
            let view = ClipView::Still { scene: Arc::clone(&drawn.scene), camera: drawn.camera };
            let how = drawn.recipe.upscaler;
            (drawn, view, how.upscaler().converges_after(how).saturating_sub(1))
        }
    };
    let recipe = drawn.recipe;
    Ok((drawn, args.triangles.is_none().then_some(HistoryClip { view, recipe, viewport: size, last })))
}

/// Finds the contribution of earlier frames to a pixel; `None` if the upscaler reads no history.
fn pixel_history(clip: HistoryClip, pixel: (u32, u32)) -> Option<PixelHistory> {
    let mut search = TemporalSearch::new(clip, pixel)?;
    while search.step() {}
    Some(search.finish())
}

/// Computes the same trace `times` times and prints the median time.
fn print_time(times: u32, make: impl Fn() -> Trace) -> Result<(), Failure> {
    let times_ms = (0..times).map(|_| {
        let start = Instant::now();
        black_box(make());
        start.elapsed().as_secs_f64() * 1e3
    });
    let Some(summary) = summarize(&times_ms.collect::<Vec<_>>()) else { return Ok(()) };
    output::print(&format!("\ntime of a trace: {:.3} ms, median of {times}\n", summary.median))
}
