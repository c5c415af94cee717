//! `rasterscope motion`: measures upscalers over the frames of a clip, as a table, a page or JSON.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use crate::chain::Recipe;
use crate::pipeline::settings::Choice as _;
use crate::report::animation::{AnimatedMethod, AnimationFormat, AnimationPlan, Arrangement, animate};
use crate::report::motion::{MotionPlan, MotionReport, measure};
use crate::upscale::{Scale, Upscaling};
use clap::Args;

use super::failure::Failure;
use super::progress::ProgressLine;
use super::scene_args::FrameArgs;
use super::sequence_args::ShotArgs;
use super::{interrupt, output, parse};

/// Measure upscalers over the frames of a clip: quality, flicker and ghosting against the converged reference
#[derive(Args, Debug)]
#[command(after_help = super::example("motion fence --size 640x360 --frames 24 -o motion.html"))]
pub(crate) struct MotionArgs {
    #[command(flatten)]
    frame: FrameArgs,

    #[command(flatten)]
    shot: ShotArgs,

    /// Number of frames to measure
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = clap::value_parser!(u32).range(2..=10_000))]
    frames: u32,

    /// Number of samples per pixel of the references
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=4096))]
    samples: u32,

    /// Pixels per degree of visual angle, for ColorVideoVDP
    #[arg(long, value_name = "PPD", default_value_t = 67.0)]
    ppd: f64,

    /// Measure only this method, at every scale unless --scale is given; may be given several times
    #[arg(long, value_name = "ID")]
    only: Vec<String>,

    /// Measure only methods at this scale, besides methods without upscaling
    #[arg(long, value_name = "SCALE", default_value_t = 2.0)]
    scale: f64,

    /// HTML page to write, besides the table: errors over time, and pictures of every frame
    #[arg(short, long, value_name = "FILE.html")]
    output: Option<PathBuf>,

    /// Animated picture to write, besides the table: a GIF file, or a PNG file (APNG) with exact colours
    #[arg(long, value_name = "FILE.gif|FILE.png")]
    animation: Option<PathBuf>,

    /// Arrangement of the methods in the animated picture
    #[arg(long, value_name = "ARRANGEMENT", default_value = "side-by-side", requires = "animation",
          value_parser = parse::choice::<Arrangement>())]
    arrangement: Arrangement,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

impl MotionArgs {
    /// Returns the upscalers to measure.
    fn upscalers(&self) -> Result<Vec<Upscaling>, Failure> {
        let scale = Scale::from(self.scale);
        let is_chosen =
            |upscaler: &Upscaling| self.only.is_empty() || self.only.iter().any(|id| id == upscaler.method());
        let has_scale = |upscaler: &Upscaling| [Scale::ONE, scale].contains(&upscaler.scale());
        let chosen: Vec<_> = Upscaling::every().filter(is_chosen).filter(has_scale).collect();
        if chosen.is_empty() {
            return Err(Failure::Usage("--only and --scale leave no method to measure".to_owned()));
        }
        Ok(chosen)
    }

    /// Returns the animated picture of the measured methods.
    fn animation(&self, plan: &MotionPlan, path: &Path) -> Result<AnimationPlan, Failure> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        let format = AnimationFormat::ALL.iter().find(|format| extension.as_deref() == Some(format.id()));
        let format = format.ok_or_else(|| {
            Failure::Usage(format!("--animation {}: the name must end in .gif or .png", output::display(path)))
        })?;
        let method = |upscaler: &Upscaling| AnimatedMethod {
            label: upscaler.label(),
            recipe: Recipe { upscaler: *upscaler, ..plan.recipe },
        };
        let animation = AnimationPlan {
            shot: plan.shot.clone(),
            methods: plan.upscalers.iter().map(method).collect(),
            viewport: plan.viewport,
            frames: plan.frames,
            arrangement: self.arrangement,
            format: *format,
        };
        animation.check().map_err(|reason| Failure::Usage(format!("--animation: {reason}")))?;
        output::check_writable(path)?;
        Ok(animation)
    }
}

/// Runs `motion`: measures the clip, prints the table and writes the page.
pub(crate) fn run(args: &MotionArgs) -> Result<(), Failure> {
    let (view, viewport, upscalers) = (args.frame.view()?, args.frame.size()?, args.upscalers()?);
    let shot = args.shot.shot(&view)?;
    if let Some(page) = &args.output {
        output::check_writable(page)?;
    }
    let plan = MotionPlan {
        shot,
        recipe: view.recipe,
        upscalers,
        viewport,
        frames: args.frames,
        samples: args.samples,
        pixels_per_degree: args.ppd,
        keeps_pictures: args.output.is_some(),
    };
    let animation = args.animation.as_deref().map(|path| Ok::<_, Failure>((path, args.animation(&plan, path)?)));
    let animation = animation.transpose()?;
    let (line, stop) = (ProgressLine::new(), interrupt::flag());
    let report = measure(&plan, &mut |done, total| {
        line.show(&format!("frame {done} of {total}"));
        !stop.load(Ordering::Relaxed)
    });
    drop(line);
    let report =
        report.map_err(|source| Failure::ResultFile { path: args.output.clone().unwrap_or_default(), source })?;
    let report = report.ok_or_else(interrupt::nothing)?;
    if let Some(page) = &args.output {
        output::write_page(page, Ok(report.html(&output::command_line())))?;
    }
    if args.json {
        output::print_json(&report)?;
    } else {
        output::print(&table(&report))?;
    }
    interrupt::outcome(report.partial)?;
    animation.map_or(Ok(()), |(path, animation)| write_animation(path, &animation))
}

/// Draws and writes an animated picture.
fn write_animation(path: &Path, animation: &AnimationPlan) -> Result<(), Failure> {
    let (line, stop) = (ProgressLine::new(), interrupt::flag());
    let bytes = animate(animation, &mut |done, total| {
        line.show(&format!("animation: frame {done} of {total}"));
        !stop.load(Ordering::Relaxed)
    });
    drop(line);
    let bytes = bytes.map_err(|source| Failure::ResultFile { path: path.to_owned(), source })?;
    let bytes = bytes.ok_or_else(interrupt::nothing)?;
    output::write_bytes(path, &bytes)
}

/// Returns the table as text with aligned columns.
fn table(report: &MotionReport) -> String {
    let rows: Vec<_> = std::iter::once(MotionReport::HEADS.map(str::to_owned).to_vec()).chain(report.rows()).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<_> = (0..MotionReport::HEADS.len()).map(width).collect();
    let mut text = String::new();
    for row in rows {
        for (column, (cell, width)) in row.iter().zip(&widths).enumerate() {
            let gap = width - cell.chars().count();
            let padded = if column == 0 { format!("{cell}{:gap$}", "") } else { format!("  {:gap$}{cell}", "") };
            text.push_str(&padded);
        }
        text.push('\n');
    }
    if let Some(noise) = &report.noise {
        text.push_str(&format!("noise floor of the times: {}\n", noise.words()));
    }
    text
}
