//! `rasterscope motion`: measures upscalers over the frames of a clip, as a table, a page or JSON.

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use crate::report::motion::{MotionPlan, MotionReport, measure};
use crate::upscale::{Scale, Upscaling};
use clap::Args;

use super::failure::Failure;
use super::progress::ProgressLine;
use super::scene_args::FrameArgs;
use super::sequence_args::ShotArgs;
use super::{interrupt, output};

/// Options of the command `motion`.
#[derive(Args, Debug)]
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
    interrupt::outcome(report.partial)
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
