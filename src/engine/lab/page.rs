//! Recorded run as one HTML page: a drawing that can be stepped through, and a table of the steps.

use super::Lesson;
use super::drawing::{colored, grid, shape_of};
use super::recording::{InkedPixel, RecordedStep, Recording};
use crate::drawing::svg;
use crate::pipeline::settings::Choice as _;
use crate::report::html::{MAX_PAGE_BYTES, command_section, document, escaped};

/// CSS rules specific to this page.
const STYLE: &str = include_str!("page.css");

/// Script that adds the controls. Without it, the page shows the run after its last step.
const SCRIPT: &str = include_str!("page.js");

/// Content of the page.
#[derive(Clone, Copy, Debug)]
pub struct LabPage<'a> {
    /// Lesson that was run.
    pub lesson: &'a Lesson,
    /// Recording of the run.
    pub recording: &'a Recording,
    /// Number of steps to show.
    pub steps: usize,
    /// Command that writes the page again; `None` if the input of the lesson was edited.
    pub command: Option<&'a str>,
}

impl LabPage<'_> {
    /// Returns the page as HTML. Of a long run, only every n-th step is shown, so that the page has at most
    /// [`MAX_PAGE_BYTES`].
    pub fn html(&self) -> String {
        let steps = &self.recording.steps[..self.steps.min(self.recording.steps.len())];
        let mut stride = 1;
        loop {
            let html = self.html_with(steps, stride);
            if html.len() <= MAX_PAGE_BYTES || stride >= steps.len() {
                return html;
            }
            stride *= 2;
        }
    }

    /// Returns the page with every step whose number is divisible by `stride`, and the last one.
    fn html_with(&self, steps: &[RecordedStep], stride: usize) -> String {
        let page = self.lesson.page();
        let note = match stride {
            1 => String::new(),
            _ => format!(
                "<p class=\"soft\">Every {stride}th step is shown, so that the page has at most {} MB.</p>\n",
                MAX_PAGE_BYTES / 1_000_000
            ),
        };
        let facts: String = self
            .recording
            .facts
            .iter()
            .map(|(name, value)| format!("<dt>{}</dt><dd>{}</dd>\n", escaped(name), escaped(value)))
            .collect();
        let command = self.command.map_or_else(String::new, command_section);
        let body = format!(
            "<h1>{name}</h1>\n<p class=\"soft\">{}</p>\n<div class=\"run\">\n<section>\n{}<p id=\"now\" class=\"soft\">After \
             the last step</p>\n<div id=\"controls\" hidden><button id=\"back\" aria-label=\"Step back\">◀</button><button \
             id=\"play\" aria-label=\"Play or pause\">Play</button><button id=\"forward\" aria-label=\"Step \
             forward\">▶</button><input id=\"at\" type=\"range\" min=\"0\" value=\"0\" aria-label=\"Step\"></div>\n\
             </section>\n<section>\n<h2>Steps</h2>\n{note}{}</section>\n</div>\n<section>\n<h2>Facts about the whole \
             run</h2>\n<dl>\n{facts}</dl>\n</section>\n{command}<script>\n{SCRIPT}</script>\n",
            escaped(self.lesson.explanation()),
            self.drawing(steps, stride),
            step_table(steps, stride),
            name = escaped(page.name()),
        );
        document(&format!("2D lab: {}", page.name()), STYLE, &body)
    }

    /// Returns the drawing as inline SVG, with one group for the pixels and one for the marks of each shown step.
    fn drawing(&self, steps: &[RecordedStep], stride: usize) -> String {
        let size @ (width, height) = self.recording.size;
        let figure: Vec<_> = self.recording.figure.iter().map(shape_of).collect();
        let lines: Vec<_> = grid(size).collect();
        let mut parts = vec![pixels(size, self.recording.ground.iter(), 0)];
        let last = steps.len().div_ceil(stride);
        for (number, together) in (1..).zip(steps.chunks(stride)) {
            parts.push(pixels(size, together.iter().flat_map(|step| &step.cells), number));
        }
        parts.push(svg::group(&lines, &[]));
        parts.push(svg::group(&figure, &[]));
        for (number, together) in (1..).zip(steps.chunks(stride)) {
            let marks: Vec<_> =
                together.iter().next_back().into_iter().flat_map(|step| &step.marks).map(shape_of).collect();
            let display = if number == last { "inline" } else { "none" };
            let attributes = [("data-marks", format!("{number}")), ("style", format!("display:{display}"))];
            parts.push(svg::group(&marks, &attributes));
        }
        format!(
            "<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"Drawing of the run\">\n<rect \
             width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n{}\n</svg>\n",
            parts.join("\n")
        )
    }
}

/// Returns the pixels that the shown step `number` sets as a group, with one path for each run of equal colours. The
/// pixels of the input have the number 0.
fn pixels<'a>(size: (u32, u32), cells: impl Iterator<Item = &'a InkedPixel>, number: usize) -> String {
    let cells: Vec<_> = colored(size, cells).collect();
    let paths = cells.chunk_by(|a, b| a.2 == b.2).filter_map(|run| {
        let [r, g, b] = run.first()?.2;
        let data: String = run.iter().map(|(x, y, _)| format!("M{x} {y}h1v1h-1z")).collect();
        Some(format!("<path fill=\"#{r:02x}{g:02x}{b:02x}\" d=\"{data}\"/>"))
    });
    let paths: String = paths.collect();
    if number == 0 { format!("<g>{paths}</g>") } else { format!("<g data-cells=\"{number}\">{paths}</g>") }
}

/// Returns a table of the shown steps: number, description and state of the algorithm.
fn step_table(steps: &[RecordedStep], stride: usize) -> String {
    let rows: String = (1..)
        .zip(steps.chunks(stride))
        .filter_map(|(number, together)| {
            let step = together.last()?;
            let state: Vec<_> = step.state.iter().map(|(name, value)| format!("{name} {value}")).collect();
            let numbered = ((number - 1) * stride + together.len()).to_string();
            let cells = [numbered.as_str(), &step.description, &state.join(" · ")].map(escaped);
            let cells: String = cells.iter().map(|cell| format!("<td>{cell}</td>")).collect();
            Some(format!("<tr data-row=\"{number}\">{cells}</tr>\n"))
        })
        .collect();
    format!(
        "<div class=\"steps\"><table class=\"rows prose\">\n<thead><tr><th>#</th><th>Step</th><th>State after \
         it</th></tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::Page;
    use crate::lab::recording::Ink;
    use crate::lab::recording::cell;

    #[test]
    fn every_page_is_small_and_has_a_row_for_each_step() {
        for page in Page::ALL {
            let lesson = Lesson::new(*page);
            let recording = lesson.record();
            let steps = recording.steps.len();
            let html = LabPage { lesson: &lesson, recording: &recording, steps, command: Some("<&\"") }.html();
            assert!(html.len() <= MAX_PAGE_BYTES, "{}: {}", page.id(), html.len());
            assert!(html.contains("&lt;&amp;&quot;") && !html.contains("<&"));
            if !html.contains("th step is shown") {
                assert_eq!(html.matches("data-row=").count(), steps, "{}", page.id());
                assert_eq!(html.matches("data-cells=").count(), steps, "{}", page.id());
            }
            assert_eq!(html.matches("display:inline").count(), usize::from(steps > 0), "{}", page.id());
        }
    }

    #[test]
    fn long_runs_are_thinned_out_and_keep_their_last_step() {
        let lesson = Lesson::new(Page::Lines);
        let mut recording = Recording::new((100, 100));
        recording.collect((0..15_001).map(|step| RecordedStep {
            cells: vec![cell((step % 100, step / 100 % 100), Ink::Full)],
            description: format!("Step {step} of a run that takes long"),
            ..RecordedStep::default()
        }));
        let html = LabPage { lesson: &lesson, recording: &recording, steps: usize::MAX, command: None }.html();
        assert!(html.len() <= MAX_PAGE_BYTES && html.contains("th step is shown"), "{}", html.len());
        assert!(html.contains("<td>15001</td>"));
        let squares = html.matches("h1v1h-1z").count();
        assert_eq!(squares, 15_001, "every pixel is drawn");
    }
}
