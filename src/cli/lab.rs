//! `rasterscope lab`: runs a page of the 2D lab without the window.

use std::path::PathBuf;

use crate::image::file;
use crate::lab::drawing::write_recording;
use crate::lab::page::LabPage;
use crate::lab::recording::Recording;
use crate::lab::{Lesson, Page};
use crate::pipeline::settings::Choice as _;
use clap::Args;

use super::failure::Failure;
use super::output::is_html;
use super::{output, parse};

/// Run a page of the 2D lab, and write its drawing or an HTML page, or print its steps
#[derive(Args, Debug)]
#[command(after_help = super::example("lab polygons -o polygons.gif"))]
pub(crate) struct LabArgs {
    /// Page of the lab to run
    #[arg(value_parser = parse::choice::<Page>())]
    page: Page,

    /// Number of completed steps; all if omitted
    #[arg(long)]
    step: Option<usize>,

    /// Picture to fill or to sample, on the pages seed-fill and sampling
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,

    /// Also compare error and run time of all methods on the page
    #[arg(long)]
    compare: bool,

    /// Output file; its extension determines the format: svg, pdf, png, bmp, jpg, tiff, gif for all steps as an
    /// animation, or html for a page to step through. Without a file, the steps are printed
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Runs `lab`: writes the drawing of the page, or prints its steps.
pub(crate) fn run(args: &LabArgs) -> Result<(), Failure> {
    let mut lesson = Lesson::new(args.page);
    if let Some(path) = &args.picture {
        let picture = file::read(path)?;
        if !lesson.set_picture(&picture) {
            return Err(Failure::Usage(format!(
                "--picture: the page {} takes no picture; use seed-fill or sampling",
                args.page.id()
            )));
        }
    }
    let recording = lesson.record();
    let all = recording.steps.len();
    let steps = args.step.unwrap_or(all).min(all);
    match &args.output {
        Some(path) => {
            if is_html(path) {
                let command = output::command_line();
                let page = LabPage { lesson: &lesson, recording: &recording, steps, command: Some(&command) };
                output::write(path, &page.html())?;
            } else {
                write_recording(path, &recording, steps)?;
            }
            output::print(&format!("{}: {steps} of {all} steps\n", output::display(path)))?;
        }
        None => output::print(&steps_text(&recording, steps))?,
    }
    let comparison = lesson.compare().filter(|_| args.compare);
    comparison.map_or(Ok(()), |comparison| {
        let rivals = comparison.methods.iter().map(|rival| {
            let micros = rival.time.as_secs_f64() * 1e6;
            format!("{:28} {:12.4} {micros:12.2} µs\n", rival.name, rival.error)
        });
        let head = format!("{}; error: {}\n", comparison.task, comparison.error);
        let note = comparison.note.as_ref().map(|note| format!("{note}\n"));
        output::print(&std::iter::once(head).chain(rivals).chain(note).collect::<String>())
    })
}

/// Formats one line for each step, followed by the results of the run.
fn steps_text(recording: &Recording, steps: usize) -> String {
    let mut text = String::new();
    for (number, step) in recording.steps[..steps].iter().enumerate() {
        text.push_str(&format!("{:5}  {}\n", number + 1, step.description));
    }
    for (name, value) in &recording.facts {
        text.push_str(&format!("{name}: {value}\n"));
    }
    text
}
