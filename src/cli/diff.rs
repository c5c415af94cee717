//! `rasterscope diff`: what other settings do to a view: which pixels change, how far the pictures are apart, what it costs.

use std::path::PathBuf;

use clap::Args;
use rasterscope::chain::{Frame, Recipe, Renderer};
use rasterscope::image::file::write_png;
use rasterscope::inspect::fields::{FieldChange, changes};
use rasterscope::inspect::what_if::Changes;
use rasterscope::inspect::{Buffer, capture, view};
use rasterscope::measure::error::{ImageError, compare};
use rasterscope::measure::motion::{MotionError, Shot, Turn, between};
use rasterscope::measure::pair::{PairTimer, PairTimes};
use rasterscope::pipeline::viewport::Viewport;
use serde::Serialize;

use super::failure::Failure;
use super::scene_args::{FrameArgs, View};
use super::{output, parse};

/// What `diff` takes.
#[derive(Args, Debug)]
pub(crate) struct DiffArgs {
    #[command(flatten)]
    frame: FrameArgs,

    /// A setting that A has another value of; may be given several times. B has those of --set
    #[arg(long, value_name = "KEY=VALUE", required = true)]
    against: Vec<String>,

    /// The quantity whose values are compared
    #[arg(long, default_value = "color", value_parser = parse::choice::<Buffer>())]
    buffer: Buffer,

    /// Rounds of timing; none leaves timing out
    #[arg(long, value_name = "N", default_value_t = 15, value_parser = clap::value_parser!(u32).range(0..=100_000))]
    rounds: u32,

    /// Orbit the camera by this angle per frame while the error in motion is measured; 0 measures the still view alone
    #[arg(long, value_name = "DEGREES", default_value_t = Turn::default().degrees, allow_hyphen_values = true,
          value_parser = parse::degrees)]
    turn: f32,

    /// Print JSON instead of text
    #[arg(long)]
    json: bool,

    /// Write B with all that did not change in dark grey
    #[arg(short, long, value_name = "FILE.png")]
    output: Option<PathBuf>,
}

/// What differs, as JSON.
#[derive(Serialize)]
struct Told {
    scene: String,
    size: [u32; 2],
    /// What differs between A and B: key, value in A, value in B.
    fields: Vec<[String; 3]>,
    buffer: Buffer,
    changed_pixels: u64,
    changed_share: f64,
    picture_error: Option<ImageError>,
    turn: Turn,
    motion_error: Option<MotionError>,
    times: Option<PairTimes>,
}

/// Draws both, compares, times them, and says what differs.
pub(crate) fn run(args: &DiffArgs) -> Result<(), Failure> {
    let view = args.frame.view()?;
    let size = args.frame.size();
    let (a, b) = (view.against(&args.against)?, view.recipe);
    let frame = |recipe: &Recipe| Renderer::default().render_settled(&view.scene, &view.camera, recipe, size);
    let (before, after) = (frame(&a), frame(&b));
    let (changed, marked) = compared(args.buffer, &view, (&a, &before), (&b, &after))?;
    let told = Told {
        scene: view.scene.name.clone(),
        size: [size.width, size.height],
        fields: changes(&a, &b).into_iter().map(|FieldChange { key, before, after }| [key, before, after]).collect(),
        buffer: args.buffer,
        changed_pixels: changed.count,
        changed_share: changed.share(),
        picture_error: compare(before.image(), after.image()),
        turn: Turn::by(args.turn),
        motion_error: between(
            &Shot { scene: &view.scene, camera: &view.camera, viewport: size, turn: Turn::by(args.turn) },
            [&a, &b],
        ),
        times: timed(args.rounds as usize, &view, (a, b), size),
    };
    if let Some(path) = &args.output {
        write_png(path, &marked)?;
    }
    if args.json {
        return output::print_json(&told);
    }
    let written = args.output.as_deref().map(output::display);
    output::print(&(text(&told) + &written.map(|path| format!("{path}: the changed pixels\n")).unwrap_or_default()))
}

/// Which pixels of a buffer differ, and the buffer of B with only those in colour.
fn compared(
    buffer: Buffer,
    view: &View,
    (a, before): (&Recipe, &Frame),
    (b, after): (&Recipe, &Frame),
) -> Result<(Changes, rasterscope::image::Image<rasterscope::image::Rgba8>), Failure> {
    let captured =
        |recipe: &Recipe, frame: &Frame| capture(&view.scene, recipe, frame).completed_for(buffer, recipe, frame);
    let buffers = (buffer != Buffer::Color).then(|| [captured(a, before), captured(b, after)]);
    let [of_a, of_b] = [0, 1].map(|which| buffers.as_ref().map(|both| &both[which]));
    // Both were drawn at one size.
    let changed = Changes::of_buffer(buffer, (before, of_a), (after, of_b))
        .ok_or_else(|| Failure::Usage("A and B are of different sizes".to_owned()))?;
    let picture = view::picture(buffer, after, of_b, view::range(buffer, after, of_b));
    let marked = changed.marked(&picture);
    Ok((changed, marked))
}

fn timed(rounds: usize, view: &View, (a, b): (Recipe, Recipe), size: Viewport) -> Option<PairTimes> {
    let mut timer = (rounds > 0).then(|| PairTimer::new(a, b, rounds))?;
    loop {
        if let Some(times) = timer.step(&view.scene, &view.camera, size) {
            return Some(times);
        }
    }
}

fn text(told: &Told) -> String {
    let [width, height] = told.size;
    let mut text = format!("{}, {width} × {height} px\n", told.scene);
    for [key, before, after] in &told.fields {
        text += &format!("{key}: {before} → {after}\n");
    }
    if told.fields.is_empty() {
        text += "A and B have the same settings\n";
    }
    let pixels = u64::from(width) * u64::from(height);
    let name = rasterscope::pipeline::settings::Choice::id(told.buffer);
    let (count, share) = (told.changed_pixels, told.changed_share * 100.0);
    text += &format!("{name}: {count} of {pixels} pixels changed ({share:.4} %)\n");
    if let Some(ImageError { mse, psnr_db, ssim, max_abs, .. }) = told.picture_error {
        text += &format!("picture: MSE {mse:.4}, PSNR {psnr_db:.2} dB, SSIM {ssim:.6}, largest difference {max_abs}\n");
    }
    if let Some(motion) = told.motion_error.filter(|_| told.turn.degrees != 0.0) {
        text += &motion_line(&motion, told.turn);
    }
    if let Some(times) = &told.times {
        let verdict = if times.is_clear() { "larger than the noise" } else { "within the noise" };
        text += &format!(
            "time: A {:.3} ms, B {:.3} ms, change {:+.3} ms, {verdict} (±{:.3} ms; medians of {} rounds)\n",
            times.a_ms.median,
            times.b_ms.median,
            times.change_ms.median,
            times.noise(),
            times.a_ms.n
        );
    }
    text
}

/// Returns the error over a sequence as one line.
pub(super) fn motion_line(motion: &MotionError, turn: Turn) -> String {
    let MotionError { mean, worst } = motion;
    format!(
        "in motion ({} frames, {}° per frame): PSNR {:.2} dB, SSIM {:.6}, FLIP {:.4}; worst frame: PSNR {:.2} dB, FLIP {:.4}\n",
        turn.frames, turn.degrees, mean.codes.psnr_db, mean.codes.ssim, mean.flip, worst.codes.psnr_db, worst.flip
    )
}
