//! `rasterscope lab`: a page of the 2D lab without the window.

use std::path::PathBuf;

use clap::Args;
use rasterscope::image::file;
use rasterscope::lab::drawing::write_recording;
use rasterscope::lab::recording::Recording;
use rasterscope::lab::{Lesson, Page};
use rasterscope::pipeline::settings::Choice as _;

use super::failure::Failure;
use super::{output, parse};

/// What `lab` takes.
#[derive(Args, Debug)]
pub(crate) struct LabArgs {
    /// The page
    #[arg(value_parser = parse::choice::<Page>())]
    page: Page,

    /// Steps that are done; all if omitted
    #[arg(long)]
    step: Option<usize>,

    /// A picture to fill in or to sample, on the pages seed-fill and sampling
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,

    /// Also compare all ways to do the same: error and time
    #[arg(long)]
    compare: bool,

    /// The file to write; its name tells the format: svg, pdf, png, bmp, jpg, tiff, or gif for all steps as an animation.
    /// Without one, the steps are told
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Runs the page, and writes or tells it.
pub(crate) fn run(args: &LabArgs) -> Result<(), Failure> {
    let mut lesson = Lesson::new(args.page);
    if let Some(path) = &args.picture {
        let picture = file::read(path)?;
        if !lesson.set_picture(&picture) {
            return Err(Failure::Usage(format!(
                "the page {} takes no picture; seed-fill and sampling do",
                args.page.id()
            )));
        }
    }
    let recording = lesson.record();
    let all = recording.steps.len();
    let steps = args.step.unwrap_or(all).min(all);
    match &args.output {
        Some(path) => {
            write_recording(path, &recording, steps)?;
            output::print(&format!("{}: {steps} of {all} steps\n", output::display(path)))?;
        }
        None => output::print(&told(&recording, steps))?,
    }
    let comparison = lesson.compare().filter(|_| args.compare);
    comparison.map_or(Ok(()), |comparison| {
        let rivals = comparison.rivals.iter().map(|rival| {
            let micros = rival.time.as_secs_f64() * 1e6;
            format!("{:28} {:12.4} {micros:12.2} µs\n", rival.name, rival.error)
        });
        let head = format!("{}; error: {}\n", comparison.task, comparison.error);
        let note = comparison.note.as_ref().map(|note| format!("{note}\n"));
        output::print(&std::iter::once(head).chain(rivals).chain(note).collect::<String>())
    })
}

/// One line per step, and what is true of the run.
fn told(recording: &Recording, steps: usize) -> String {
    let mut text = String::new();
    for (number, step) in recording.steps[..steps].iter().enumerate() {
        text.push_str(&format!("{:5}  {}\n", number + 1, step.says));
    }
    for (name, value) in &recording.facts {
        text.push_str(&format!("{name}: {value}\n"));
    }
    text
}
