//! Explanation of a pixel as text and as an HTML page: verdict, remedies, fragments, and the calculation of its colour.

mod earlier;

mod text;

use std::io;
use std::sync::Arc;

pub use text::describe;
use text::{color, fragment_rows, outcome, source_line};

use super::html::{FittedPictures, MAX_PAGE_BYTES, command_section, document, escaped, table};
use crate::chain::{Frame, Recipe};
use crate::image::{Image, Rgba8};
use crate::inspect::remedy_search::remedies;
use crate::inspect::trace::TraceLine;
use crate::inspect::{FragmentRecord, PixelReport, Survey, Trace, explain};
use crate::pipeline::settings::Choice as _;
use crate::scene::Scene;
use crate::scene::seams::Seams;

/// CSS rules specific to this page.
const STYLE: &str = include_str!("page.css");

/// Number of pixels from the pixel to each side of the picture of its neighbourhood.
const REACH: u32 = 10;

/// Part of the page that remains for text, in bytes.
const TEXT_BYTES: usize = 600_000;

/// Maximum number of listed triangles without a fragment at the pixel.
const MAX_ABSENT: usize = 500;

/// Maximum number of fragments with all their properties.
const MAX_FRAGMENTS: usize = 200;

/// Explains a pixel with everything that is known about it: its fragments, the triangles without a fragment, and, if
/// `is_whole`, the remedies. A frame that is drawn only up to a triangle has no remedies. Returns `None` outside the
/// picture.
pub fn explain_fully(
    scene: &Arc<Scene>,
    recipe: &Recipe,
    frame: &Frame,
    pixel: (u32, u32),
    is_whole: bool,
) -> Option<PixelReport> {
    let mut survey = Survey::of(scene, recipe, frame);
    survey.set_seams(Arc::new(Seams::of(scene)));
    let mut report = explain(scene, recipe, frame, &survey, pixel)?;
    if is_whole {
        report.remedies = remedies(scene, recipe, frame, &report);
    }
    Some(report)
}

/// Content of the page about a pixel.
#[derive(Clone, Copy, Debug)]
pub struct PixelPage<'a> {
    /// Name of the scene.
    pub scene: &'a str,
    /// Frame with the pixel.
    pub frame: &'a Frame,
    /// Report on the pixel.
    pub report: &'a PixelReport,
    /// Calculation of one of its fragments.
    pub trace: &'a Trace,
    /// Command that writes the page again.
    pub command: &'a str,
}

impl PixelPage<'_> {
    /// Returns the page as HTML with all pictures embedded.
    ///
    /// # Errors
    /// Returns an error if a picture cannot be encoded.
    pub fn html(&self) -> io::Result<String> {
        let PixelReport { x, y, .. } = *self.report;
        let title = format!("Pixel {x}, {y} of {}", self.scene);
        let body = [
            self.head(&title),
            self.pictures()?,
            self.fragments(),
            self.other_inputs(),
            self.report.temporal.as_ref().map_or_else(String::new, earlier::section),
            self.calculation(),
            command_section(self.command),
        ];
        Ok(document(&title, STYLE, &body.concat()))
    }

    fn head(&self, title: &str) -> String {
        let (width, height) = self.frame.image().size();
        let report = self.report;
        let remedies: String = report
            .remedies
            .iter()
            .map(|remedy| {
                let [label, change, effect] = [remedy.label().as_str(), &remedy.change(), remedy.effect()].map(escaped);
                format!("<li><b>{label}</b> (<code>{change}</code>). {effect}.</li>\n")
            })
            .collect();
        let remedies = match remedies.as_str() {
            "" => String::new(),
            list => format!("<h3>Remedies</h3>\n<ul>\n{list}</ul>\n"),
        };
        format!(
            "<h1>{}</h1>\n<p class=\"soft\">Picture of {width} × {height} px</p>\n<section class=\"verdict\">\n<p>{}</p>\n\
             <p><b>{}</b></p>\n{remedies}</section>\n",
            escaped(title),
            swatch(report.color),
            escaped(&report.verdict)
        )
    }

    /// Returns the frame and the pixel's neighbourhood, both with the pixel marked.
    fn pictures(&self) -> io::Result<String> {
        let picture = self.frame.image();
        let (width, height) = picture.size();
        let PixelReport { x, y, .. } = *self.report;
        let side = 2 * REACH + 1;
        let (left, top) = (x.saturating_sub(REACH), y.saturating_sub(REACH));
        let (right, bottom) = ((left + side).min(width), (top + side).min(height));
        let near = Image::from_fn(right - left, bottom - top, |i, j| picture.at(left + i, top + j));
        let fitted = FittedPictures::new(&[picture], MAX_PAGE_BYTES - TEXT_BYTES)?;
        let near_source = FittedPictures::new(&[&near], MAX_PAGE_BYTES)?;
        let ring = f64::from(width.max(height)) / 60.0;
        let (center_x, center_y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let ring_mark =
            |class: &str| format!("<circle class=\"{class}\" cx=\"{center_x}\" cy=\"{center_y}\" r=\"{ring}\"/>");
        let square_mark = |class: &str| {
            format!("<rect class=\"{class}\" x=\"{}\" y=\"{}\" width=\"1\" height=\"1\"/>", x - left, y - top)
        };
        let whole = marked((width, height), &fitted.sources[0], &(ring_mark("halo") + &ring_mark("sign")));
        let near = marked(near.size(), &near_source.sources[0], &(square_mark("halo") + &square_mark("sign")));
        let note = fitted.note();
        Ok(format!(
            "<section>\n<h2>Where it is</h2>\n<div class=\"places\">\n<figure>{whole}<figcaption>Whole picture. {note}\
             </figcaption></figure>\n<figure>{near}<figcaption>Columns {left} to {}, rows {top} to {}</figcaption>\
             </figure>\n</div>\n</section>\n",
            right - 1,
            bottom - 1
        ))
    }

    fn fragments(&self) -> String {
        let fragments = &self.report.fragments;
        if fragments.is_empty() {
            return "<section>\n<h2>Fragments</h2>\n<p>No triangle covers the pixel.</p>\n</section>\n".to_owned();
        }
        let rows = fragments.iter().enumerate().map(|(index, fragment)| {
            vec![
                (index + 1).to_string(),
                format!("{} of “{}”", fragment.triangle.0, fragment.instance),
                outcome(fragment.outcome).to_owned(),
                fragment.depth.to_string(),
                fragment.reason.clone(),
            ]
        });
        let overview = table(&["#", "Triangle", "Outcome", "Depth", "Reason"], rows, true);
        let details: String = fragments.iter().take(MAX_FRAGMENTS).enumerate().map(details).collect();
        format!(
            "<section>\n<h2>Fragments in drawing order</h2>\n{overview}<h3>All values</h3>\n{details}{}</section>\n",
            left_out(fragments.len(), MAX_FRAGMENTS, "fragments")
        )
    }

    /// Returns what else decides the colour: triangles without a fragment, samples of anti-aliasing, and sources of the
    /// upscaler. Empty if there is nothing else.
    fn other_inputs(&self) -> String {
        let report = self.report;
        let mut parts = String::new();
        if !report.absent.is_empty() {
            let rows = report.absent.iter().take(MAX_ABSENT).map(|absent| {
                let triangle = format!("{} of “{}”", absent.triangle.0, absent.instance);
                vec![triangle, absent.cause.name().to_owned(), absent.reason.clone()]
            });
            parts += "<h3>Triangles without a fragment here</h3>\n";
            parts += &table(&["Triangle", "Cause", "Reason"], rows, true);
            parts += &left_out(report.absent.len(), MAX_ABSENT, "triangles");
        }
        if !report.samples.is_empty() {
            let rows = report.samples.iter().map(|sample| {
                let [x, y] = sample.place;
                vec![format!("{x:.4}, {y:.4}"), color(sample.color)]
            });
            parts += &format!("<h3>Mean of {} samples</h3>\n", report.samples.len());
            parts += &table(&["Position in the pixel", "Colour"], rows, true);
        }
        if report.drawn_at != [report.x, report.y] || report.sources.len() > 1 {
            let rows = report.sources.iter().map(|source| vec![source_line(source)]);
            parts += "<h3>Drawn samples from which the upscaler computes the pixel</h3>\n";
            parts += &table(&["Sample × weight: colour"], rows, true);
        }
        match parts.as_str() {
            "" => String::new(),
            parts => format!("<section>\n<h2>What else was there</h2>\n{parts}</section>\n"),
        }
    }

    fn calculation(&self) -> String {
        let trace = self.trace;
        let of = match trace.fragment {
            Some(fragment) => format!("Fragment {} of {}, line by line.", fragment + 1, trace.fragments),
            None => "No triangle covers the pixel.".to_owned(),
        };
        let stages: String = trace
            .stages()
            .map(|(stage, lines)| {
                let heads = ["Quantity", "Value", "Formula", "Rounding"];
                format!(
                    "<h3>{}</h3>\n<p class=\"soft\">{}</p>\n{}",
                    escaped(stage.name()),
                    escaped(stage.help()),
                    table(&heads, lines.iter().map(trace_row), true)
                )
            })
            .collect();
        format!("<section>\n<h2>Calculation</h2>\n<p class=\"soft\">{}</p>\n{stages}</section>\n", escaped(&of))
    }
}

/// Returns the properties of a fragment as HTML that can be opened.
fn details((index, fragment): (usize, &FragmentRecord)) -> String {
    let rows: String = fragment_rows(fragment)
        .map(|(name, text)| format!("<dt>{}</dt><dd>{}</dd>\n", escaped(name), escaped(&text)))
        .collect();
    format!(
        "<details><summary>Fragment {}<small>triangle {} of “{}”, {}</small></summary>\n<dl>\n{rows}</dl></details>\n",
        index + 1,
        fragment.triangle.0,
        escaped(&fragment.instance),
        outcome(fragment.outcome)
    )
}

fn trace_row(line: &TraceLine) -> Vec<String> {
    let kind = if line.kind.is_empty() { String::new() } else { format!(" [{} {}]", line.kind, line.bits) };
    let aside = if line.aside { " (not computed by the pipeline)" } else { "" };
    let numbers = if line.numbers.is_empty() { String::new() } else { format!(" = {}", line.numbers) };
    let flags: String = line.flags.iter().map(|flag| format!(" ! {}", flag.words())).collect();
    vec![
        format!("{}{aside}", line.what),
        format!("{}{kind}{flags}", line.value_text()),
        format!("{}{numbers}", line.formula),
        line.rounding(),
    ]
}

/// Returns a sentence that says how many items are not listed; empty if all are.
fn left_out(all: usize, listed: usize, noun: &str) -> String {
    match all.saturating_sub(listed) {
        0 => String::new(),
        more => format!("<p class=\"soft\">{more} more {noun} are not listed.</p>\n"),
    }
}

/// Returns a colour as HTML: a filled square and its codes.
fn swatch(codes: Rgba8) -> String {
    let [r, g, b, _] = codes;
    format!("<i class=\"swatch\" style=\"background:#{r:02x}{g:02x}{b:02x}\"></i>{}", escaped(&color(codes)))
}

/// Returns a picture of `size` pixels with marks in its coordinates, as inline SVG.
fn marked((width, height): (u32, u32), source: &str, marks: &str) -> String {
    format!(
        "<svg class=\"marked\" viewBox=\"0 0 {width} {height}\"><image width=\"{width}\" height=\"{height}\" \
         href=\"{source}\"/>{marks}</svg>"
    )
}
