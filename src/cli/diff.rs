//! `rasterscope diff`: compares a view under two sets of settings: changed pixels, error between the pictures, and
//! cost.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use crate::chain::{Frame, Recipe, RenderInputs, Renderer};
use crate::image::file::write_png;
use crate::image::{Image, Rgba8};
use crate::inspect::fields::changes;
use crate::inspect::what_if::{Changes, values_of_buffer};
use crate::inspect::{Buffer, capture, view};
use crate::measure::error::{ImageError, compare};
use crate::measure::machine::Machine;
use crate::measure::motion::{FrameSequence, MotionError, Turn, between};
use crate::measure::noise;
use crate::measure::pair::{PairTimer, PairTimes};
use crate::pipeline::settings::Choice as _;
use crate::report::pictures::{MetricTable, PictureFigure, PicturePage};
use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::output::is_html;
use super::progress::ProgressLine;
use super::scene_args::{FrameArgs, RequestedView};
use super::{interrupt, output, parse};

/// Compare a view under two sets of settings: which pixels change, by how much, and at what cost
#[derive(Args, Debug)]
#[command(after_help = super::example("diff chess --set filter=point --against filter=bilinear"))]
pub(crate) struct DiffArgs {
    #[command(flatten)]
    frame: FrameArgs,

    /// Setting that differs in A; may be given several times. B has the settings of --set
    #[arg(long, value_name = "KEY=VALUE", required = true)]
    against: Vec<String>,

    /// Quantity whose values are compared
    #[arg(long, default_value = "color", value_parser = parse::choice::<Buffer>())]
    buffer: Buffer,

    /// Number of timed rounds; 0 disables timing
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(0..=100_000))]
    rounds: u32,

    /// Angle in degrees by which the camera orbits per frame, for the error in motion and for times; 0 measures the
    /// still view only
    #[arg(long, value_name = "DEGREES", default_value_t = Turn::default().degrees, allow_hyphen_values = true,
          value_parser = parse::degrees)]
    turn: f32,

    /// Print JSON instead of text
    #[arg(long)]
    json: bool,

    /// PNG file for the picture of B, with unchanged pixels in dark grey, or HTML file for both pictures, their
    /// difference, the settings that differ, and the errors
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Differences between the pictures A and B, as JSON.
#[derive(Serialize)]
struct DiffReport {
    scene: String,
    size: [u32; 2],
    /// Settings that differ between A and B, each as key, value in A and value in B.
    fields: Vec<[String; 3]>,
    buffer: Buffer,
    changed_pixels: u64,
    changed_share: f64,
    picture_error: Option<ImageError>,
    /// Camera motion during the compared and timed frames.
    turn: Turn,
    /// Error over the frames of a moving camera; `None` if interrupted.
    motion_error: Option<MotionError>,
    /// Frame times of A and B; `None` without timed rounds or if interrupted.
    times: Option<PairTimes>,
    machine: Machine,
    /// Whether the measurement was interrupted before it was complete.
    partial: bool,
}

/// Runs `diff`: draws the pictures A and B, compares and times them, and prints the differences.
pub(crate) fn run(args: &DiffArgs) -> Result<(), Failure> {
    let view = args.frame.view()?;
    let size = args.frame.size()?;
    let (a, b) = (view.against(&args.against)?, view.recipe);
    let frame = |recipe: &Recipe| {
        Renderer::default().render_converged(RenderInputs {
            scene: &view.scene,
            camera: &view.camera,
            recipe,
            viewport: size,
        })
    };
    let (before, after) = (frame(&a), frame(&b));
    let [of_a, of_b] = [(&a, &before), (&b, &after)].map(|(recipe, frame)| ComparedFrame { recipe, frame });
    let (changed, marked) = compared(args.buffer, &view, of_a, of_b)?;
    let shot = FrameSequence { scene: &view.scene, camera: &view.camera, viewport: size, turn: Turn::by(args.turn) };
    let (machine, interrupted) = (Machine::at_start(), interrupt::flag());
    let line = ProgressLine::new();
    let mut go_on = |share: f32| {
        line.show_share("measuring", share);
        !interrupted.load(Ordering::Relaxed)
    };
    let report = DiffReport {
        scene: view.scene.name.clone(),
        size: [size.width, size.height],
        fields: changes(&a, &b)
            .into_iter()
            .map(|change| [change.key.id().to_owned(), change.before, change.after])
            .collect(),
        buffer: args.buffer,
        changed_pixels: changed.count,
        changed_share: changed.share(),
        picture_error: compare(before.image(), after.image()),
        turn: shot.turn,
        motion_error: between(&shot, [&a, &b], &mut go_on),
        times: timed(args.rounds as usize, &shot, [a, b], &mut go_on),
        machine: machine.at_end(),
        partial: interrupted.load(Ordering::Relaxed),
    };
    if let Some(path) = args.output.as_ref().filter(|path| !is_html(path)) {
        write_png(path, &marked)?;
    } else if let Some(path) = &args.output {
        let pictures = [before.image(), after.image(), &marked].map(|picture| Arc::new(picture.clone()));
        output::write_page(path, page(&report, pictures).html())?;
    }
    drop(line);
    if args.json {
        output::print_json(&report)?;
    } else {
        let written = args.output.as_deref().map(output::display);
        let written = written
            .map(|path| match args.output.as_deref().is_some_and(is_html) {
                true => format!("{path}: both pictures, their difference, and errors\n"),
                false => format!("{path}: picture of B with only the changed pixels in colour\n"),
            })
            .unwrap_or_default();
        output::print(&(text(&report) + &written))?;
    }
    interrupt::outcome(report.partial)
}

/// Frame A or B, and the recipe with which it was drawn.
#[derive(Clone, Copy)]
struct ComparedFrame<'a> {
    recipe: &'a Recipe,
    frame: &'a Frame,
}

/// Returns the pixels at which a buffer differs between A and B, and the picture of B with unchanged pixels dimmed.
fn compared(
    buffer: Buffer,
    view: &RequestedView,
    a: ComparedFrame<'_>,
    b: ComparedFrame<'_>,
) -> Result<(Changes, Image<Rgba8>), Failure> {
    let captured = |ComparedFrame { recipe, frame }: ComparedFrame<'_>| {
        capture(&view.scene, recipe, frame).completed_for(buffer, &view.scene, recipe, frame)
    };
    let buffers = (buffer != Buffer::Color).then(|| [captured(a), captured(b)]);
    let [of_a, of_b] = [0, 1].map(|which| buffers.as_ref().map(|both| &both[which]));
    // Both pictures have the same size.
    let changed =
        Changes::of_values(&values_of_buffer(buffer, a.frame, of_a), &values_of_buffer(buffer, b.frame, of_b))
            .ok_or_else(|| Failure::Usage("A and B have different sizes".to_owned()))?;
    let picture = view::picture(buffer, b.frame, of_b, view::range(buffer, b.frame, of_b));
    let marked = changed.with_unchanged_dimmed(&picture);
    Ok((changed, marked))
}

/// Returns the HTML page. The pictures are A, B, and B with only the changed pixels in colour. Times and motion are left
/// out, so that the same command writes the same page.
fn page(report: &DiffReport, [a, b, marked]: [Arc<Image<Rgba8>>; 3]) -> PicturePage {
    let figure = |label: &str, picture, lines| PictureFigure { label: label.to_owned(), picture, lines, command: None };
    let values = |which: usize| report.fields.iter().map(|field| format!("{}: {}", field[0], field[which])).collect();
    let metrics = report.picture_error.map(|ImageError { mse, psnr_db, ssim, max_abs, .. }| {
        let row = |name: &str, value: String| vec![name.to_owned(), value];
        MetricTable {
            columns: vec!["A against B".to_owned()],
            rows: vec![
                row("PSNR", format!("{psnr_db:.2} dB")),
                row("SSIM", format!("{ssim:.6}")),
                row("MSE", format!("{mse:.4}")),
                row("Largest difference", max_abs.to_string()),
            ],
        }
    });
    PicturePage {
        title: format!("Comparison of settings: {}", report.scene),
        summary: vec![format!("{} × {} px", report.size[0], report.size[1]), changed_line(report)],
        figures: vec![
            figure("A", a, values(1)),
            figure("B", b, values(2)),
            figure("B with only the changed pixels in colour", marked, Vec::new()),
        ],
        metrics,
        command: Some(output::command_line()),
    }
}

/// Returns the number and the share of the changed pixels as one line.
fn changed_line(report: &DiffReport) -> String {
    let pixels = u64::from(report.size[0]) * u64::from(report.size[1]);
    let name = report.buffer.id();
    let (count, share) = (report.changed_pixels, report.changed_share * 100.0);
    format!("{name}: {count} of {pixels} pixels changed ({share:.4} %)\n")
}

fn timed(
    rounds: usize,
    shot: &FrameSequence<'_>,
    [a, b]: [Recipe; 2],
    go_on: &mut dyn FnMut(f32) -> bool,
) -> Option<PairTimes> {
    let mut timer = (rounds > 0).then(|| PairTimer::new(a, b, rounds))?;
    while go_on(timer.progress()) {
        if let Some(times) = timer.step(shot) {
            return Some(times);
        }
    }
    None
}

fn text(report: &DiffReport) -> String {
    let [width, height] = report.size;
    let mut text = format!("{}, {width} × {height} px\n", report.scene);
    for [key, before, after] in &report.fields {
        text += &format!("{key}: {before} → {after}\n");
    }
    if report.fields.is_empty() {
        text += "A and B have the same settings\n";
    }
    text += &changed_line(report);
    if let Some(ImageError { mse, psnr_db, ssim, max_abs, .. }) = report.picture_error {
        text += &format!("picture: MSE {mse:.4}, PSNR {psnr_db:.2} dB, SSIM {ssim:.6}, largest difference {max_abs}\n");
    }
    if let Some(motion) = report.motion_error.filter(|_| !report.turn.is_still()) {
        text += &motion_line(&motion, report.turn);
    }
    if let Some(times) = &report.times {
        text += &format!(
            "time: A {:.3} ms, B {:.3} ms, change {:+.3} ms, {}; medians of {} rounds\n",
            times.a_ms.median,
            times.b_ms.median,
            times.change_ms.median,
            noise::label(times.within_noise),
            times.a_ms.n
        );
        text += &format!(
            "noise floor: {}, {:.3} ms\n{}\n",
            times.noise.words(),
            times.noise_ms(),
            report.machine.summary()
        );
    }
    if report.partial {
        text += "partial: interrupted before all measurements were complete\n";
    }
    text
}

/// Formats the error over a sequence of frames as one line.
pub(super) fn motion_line(motion: &MotionError, turn: Turn) -> String {
    let MotionError { mean, worst, .. } = motion;
    format!(
        "in motion ({} frames, {}° per frame): PSNR {:.2} dB, SSIM {:.6}, FLIP {:.4}; worst frame: PSNR {:.2} dB, FLIP {:.4}\n",
        motion.frames, turn.degrees, mean.codes.psnr_db, mean.codes.ssim, mean.flip, worst.codes.psnr_db, worst.flip
    )
}
