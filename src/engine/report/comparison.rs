//! Pixel-by-pixel comparison of the engine's coverage with an exact reference, for one part of a case file. In
//! [`TriCoverage`] and [`ClipTri`] cases, each triangle is a part; all other cases have one part.
//!
//! The reference comes from [`super::stability::oracle`], which shares no code with the engine. It supports only
//! [`TriCoverage`] and [`ClipTri`] cases; for all others, only the engine's pixels are available.

use std::io::{self, Write};

use super::stability::oracle::{ClipTriangle, ExactRegion, Snap};
use crate::case::{Answer, Case, ClipTri, Control, Options, Task, TriCoverage, Unanswered, answer};
use crate::image::Image;
use crate::pipeline::raster::Span;
use crate::pipeline::settings::{Arithmetic, FillRule};
use crate::pipeline::viewport::{MAX_PIXELS, Viewport};

/// Pixels that one part of a case file covers, according to the engine and according to the exact reference.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelComparison {
    /// Top-left pixel of the images, in the coordinates of the case; (0, 0) if the case specifies an image size.
    pub origin: (i64, i64),
    /// Fraction of each pixel covered by the engine, in [0, 1].
    pub ours: Image<f32>,
    /// Pixels that the exact reference covers; `None` for cases without a reference.
    pub exact: Option<Image<bool>>,
    /// Vertices of the outlines of the shapes in this part, in pixels.
    pub outlines: Vec<Vec<[f64; 2]>>,
}

/// Agreement between the engine and the exact reference on the coverage of one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Agreement {
    /// Pixel covered by neither the engine nor the exact reference.
    Outside,
    /// Pixel covered by both the engine and the exact reference or, if there is no reference, by the engine.
    Covered,
    /// Pixel covered by the engine but not by the exact reference.
    Extra,
    /// Pixel covered by the exact reference but not by the engine.
    Missing,
}

/// Displayable result of one part of a case file.
#[derive(Clone, Debug, PartialEq)]
pub enum DisplayedResult {
    /// Result as pixels.
    Pixels(PixelComparison),
    /// Result as lines of text: a numeric answer, or the reason why there is none.
    Text(Vec<String>),
}

/// Maximum length of a numeric answer, in bytes.
const MAX_TEXT_BYTES: usize = 1 << 20;

/// Maximum length of a line of a numeric answer, in bytes; a longer line consists of a single number.
const MAX_LINE_BYTES: usize = 160;

/// Maximum number of outline vertices; larger outlines are omitted.
const MAX_OUTLINE_CORNERS: usize = 1 << 14;

/// Computes the displayable result of part `part` of a case. Returns `None` if cancelled.
pub fn show(case: &Case, part: usize, options: Options, control: &Control<'_>) -> Option<DisplayedResult> {
    let text = |reason: String| DisplayedResult::Text(vec![reason]);
    match pixels_or_numbers(case, part, options, control) {
        Ok(shown) => Some(shown),
        Err(Unanswered::Refused(refusal)) => Some(text(refusal.to_string())),
        Err(Unanswered::Cancelled) => None,
    }
}

fn pixels_or_numbers(
    case: &Case,
    part: usize,
    options: Options,
    control: &Control<'_>,
) -> Result<DisplayedResult, Unanswered> {
    match &case.task {
        Task::TriCoverage(task) => {
            PixelComparison::of_triangle(task, part, options, control).map(DisplayedResult::Pixels)
        }
        Task::ClipTri(task) => {
            PixelComparison::of_clip_triangle(task, part, options, control).map(DisplayedResult::Pixels)
        }
        _ => Ok(PixelComparison::of_answer(case, answer(case, options, control)?)),
    }
}

impl PixelComparison {
    fn of_triangle(
        task: &TriCoverage,
        part: usize,
        options: Options,
        control: &Control<'_>,
    ) -> Result<Self, Unanswered> {
        let viewport = task.viewport();
        let mut ours = Image::filled(viewport.width, viewport.height, 0.0);
        task.rasterize(part, options, |spans, row| {
            spans.iter().for_each(|span| fill(&mut ours, *span, 1.0));
            control.step(f64::from(row) / f64::from(viewport.height))
        })?;
        let corners = task.corners_px(part);
        let snap = if options.arithmetic == Arithmetic::Fixed { Snap::Grid256 } else { Snap::Unsnapped };
        let exact = corners.map(|corners| ExactRegion::triangle(corners, snap, task.rule).spans(viewport));
        let finite = corners.filter(|corners| corners.as_flattened().iter().all(|c| c.is_finite()));
        let outlines = finite.map(|corners| corners.map(|corner| corner.map(f64::from)).to_vec()).into_iter().collect();
        control.check()?;
        Ok(Self { origin: (0, 0), ours, exact: Some(covered(viewport, &exact.unwrap_or_default())), outlines })
    }

    fn of_clip_triangle(
        task: &ClipTri,
        part: usize,
        options: Options,
        control: &Control<'_>,
    ) -> Result<Self, Unanswered> {
        let viewport = task.viewport();
        let mut ours = Image::filled(viewport.width, viewport.height, 0.0);
        task.rasterize(part, options, |_, spans| {
            spans.iter().for_each(|span| fill(&mut ours, *span, 1.0));
            control.check()
        })?;
        let triangle = task.corners(part).and_then(|corners| ClipTriangle::new(corners, viewport));
        let exact = triangle.map_or_else(Vec::new, |triangle| triangle.region(FillRule::TopLeft).spans(viewport));
        control.check()?;
        Ok(Self { origin: (0, 0), ours, exact: Some(covered(viewport, &exact)), outlines: Vec::new() })
    }

    /// Converts the engine's answer to a case without a reference: to pixels or, if it is not an image, to text.
    fn of_answer(case: &Case, answer: Answer) -> DisplayedResult {
        let pixels = match (&case.task, answer) {
            (Task::PolyFill(task), Answer::PolyFill(answer)) => {
                let mut ours = Image::filled(task.width, task.height, 0.0);
                for [row, left, right] in answer.spans {
                    fill(&mut ours, Span { row, left, right }, 1.0);
                }
                let mut outlines = task.outlines();
                if outlines.iter().map(Vec::len).sum::<usize>() > MAX_OUTLINE_CORNERS {
                    outlines.clear();
                }
                Ok(Self { origin: (0, 0), ours, exact: None, outlines })
            }
            (Task::TriArea(task), Answer::TriArea(answer)) => {
                let mut ours = Image::filled(task.width, task.height, 0.0);
                answer.area.iter().for_each(|(x, y, area)| ours.set(*x, *y, *area as f32));
                Ok(Self { origin: (0, 0), ours, exact: None, outlines: vec![task.outline()] })
            }
            (Task::DistanceLine(_), Answer::DistanceLine(answer)) => {
                Self::of_pixels(answer.pixels.iter().map(|(x, y)| (i64::from(*x), i64::from(*y))))
            }
            (Task::Line(_), Answer::Line(answer)) => Self::of_pixels(answer.pixels.iter().copied()),
            (Task::RealLine(_), Answer::RealLine(answer)) => Self::of_pixels(answer.pixels.iter().copied()),
            (Task::Circle(_), Answer::Circle(answer)) => Self::of_pixels(answer.pixels.iter().copied()),
            (Task::Ellipse(_), Answer::Ellipse(answer)) => Self::of_pixels(answer.pixels.iter().copied()),
            (Task::RegionFill(task), Answer::RegionFill(answer)) => {
                let (width, height) = task.grid.size();
                let filled = |x: u32, y: u32| answer.grid[y as usize][x as usize] != task.grid.at(x, y);
                let ours = Image::from_fn(width, height, |x, y| f32::from(u8::from(filled(x, y))));
                Ok(Self { origin: (0, 0), ours, exact: None, outlines: Vec::new() })
            }
            (_, answer) => return DisplayedResult::Text(numbers(&answer)),
        };
        pixels.map_or_else(|reason| DisplayedResult::Text(vec![reason]), DisplayedResult::Pixels)
    }

    /// Creates a result without a reference from the pixels that the engine covers. Its image encloses these pixels
    /// with a margin of one pixel.
    fn of_pixels(pixels: impl Iterator<Item = (i64, i64)> + Clone) -> Result<Self, String> {
        let range = |coordinate: fn((i64, i64)) -> i64| {
            let all = pixels.clone().map(coordinate);
            Some((all.clone().min()? - 1, all.max()? + 2))
        };
        let ((left, right), (top, bottom)) = range(|p| p.0).zip(range(|p| p.1)).ok_or("no pixel is drawn")?;
        let (width, height) = ((right - left) as u64, (bottom - top) as u64);
        if width.saturating_mul(height) > MAX_PIXELS {
            return Err(format!("a picture of {width} × {height} px is too large to be shown"));
        }
        let mut ours = Image::filled(width as u32, height as u32, 0.0);
        pixels.for_each(|(x, y)| ours.set((x - left) as u32, (y - top) as u32, 1.0));
        Ok(Self { origin: (left, top), ours, exact: None, outlines: Vec::new() })
    }

    /// Returns how the engine and the exact reference agree on the coverage of pixel (x, y) of the images.
    pub fn agreement(&self, x: u32, y: u32) -> Agreement {
        let ours = self.ours.at(x, y) > 0.0;
        match (ours, self.exact.as_ref().map_or(ours, |exact| exact.at(x, y))) {
            (true, true) => Agreement::Covered,
            (true, false) => Agreement::Extra,
            (false, true) => Agreement::Missing,
            (false, false) => Agreement::Outside,
        }
    }

    /// Counts the covered and differing pixels, and lists the first differing ones.
    pub fn figures(&self) -> PixelCounts {
        let mut figures = PixelCounts::default();
        let (width, height) = self.ours.size();
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let agreement = self.agreement(x, y);
            figures.concerned += u64::from(agreement != Agreement::Outside);
            figures.covered += u64::from(matches!(agreement, Agreement::Covered | Agreement::Extra));
            if matches!(agreement, Agreement::Extra | Agreement::Missing) {
                figures.differing += 1;
                if figures.first.len() < MAX_DIFFERING {
                    figures.first.push((x, y));
                }
            }
        }
        figures
    }
}

/// Maximum number of differing pixels whose positions are listed.
const MAX_DIFFERING: usize = 1 << 16;

/// Pixel counts of a comparison between the engine and the exact reference.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PixelCounts {
    /// Number of pixels covered by the engine, at least partly.
    pub covered: u64,
    /// Number of pixels covered by the engine, by the exact reference, or by both.
    pub concerned: u64,
    /// Number of pixels covered by the engine or by the exact reference, but not by both.
    pub differing: u64,
    /// Columns and rows of the first differing pixels in row-major order, at most 65 536.
    pub first: Vec<(u32, u32)>,
}

/// Sets the pixels of a span to a value.
fn fill<T: Copy>(image: &mut Image<T>, span: Span, value: T) {
    let start = span.row as usize * image.width() as usize;
    image.pixels_mut()[start + span.left as usize..start + span.right as usize].fill(value);
}

/// Returns an image in which the pixels of the spans are `true`.
fn covered(viewport: Viewport, spans: &[Span]) -> Image<bool> {
    let mut covered = Image::filled(viewport.width, viewport.height, false);
    spans.iter().for_each(|span| fill(&mut covered, *span, true));
    covered
}

/// Formats an answer that has no image: lists of numbers, each on one or more lines, up to [`MAX_TEXT_BYTES`].
fn numbers(answer: &Answer) -> Vec<String> {
    let mut start = Start { text: Vec::new() };
    // Fails only if the text exceeds its limit: numbers and lists of numbers can always be serialised.
    let is_whole = serde_json::to_writer(&mut start, answer).is_ok();
    let mut lines = vec!["The answer consists of numbers, as written by the command `case`:".to_owned(), String::new()];
    for list in String::from_utf8_lossy(&start.text).split_inclusive("],") {
        let mut line = String::new();
        for number in list.split_inclusive(',') {
            if line.len() + number.len() > MAX_LINE_BYTES {
                lines.push(std::mem::take(&mut line));
            }
            line += number;
        }
        lines.push(line);
    }
    if !is_whole {
        lines.push(format!("… and more: only the first {MAX_TEXT_BYTES} bytes are shown; `case` writes all."));
    }
    lines
}

/// Writer that stores a text of up to [`MAX_TEXT_BYTES`] and fails when more is written.
struct Start {
    text: Vec<u8>,
}

impl Write for Start {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.text.len() + bytes.len() > MAX_TEXT_BYTES {
            return Err(io::ErrorKind::FileTooLarge.into());
        }
        self.text.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Returns the number of parts of a case file that can be shown separately.
pub fn parts(case: &Case) -> usize {
    match &case.task {
        Task::TriCoverage(task) => task.triangles.len(),
        Task::ClipTri(task) => task.triangles.len(),
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::settings::Rasterizer;

    fn case(json: &str) -> Case {
        Case::parse(json.as_bytes(), "test.json".as_ref()).unwrap()
    }

    /// Computes the displayable result of a part of a case. The computation is never cancelled.
    fn shown(case: &Case, part: usize, options: Options) -> DisplayedResult {
        show(case, part, options, &Control::default()).unwrap()
    }

    fn pixels(case: &Case, options: Options) -> PixelComparison {
        let DisplayedResult::Pixels(comparison) = shown(case, 0, options) else { panic!("not pixels") };
        comparison
    }

    #[test]
    fn a_sound_rasterizer_agrees_with_the_exact_answer_and_a_published_one_does_not() {
        let case = case(
            r#"{"id":"t","kind":"tri_coverage","width":12,"height":10,"rule":"top_left",
                "triangles":[[[1.5,1.5],[9.5,2.5],[3.5,8.5]]]}"#,
        );
        let wrong = |rasterizer| {
            let options = Options { rasterizer, arithmetic: Arithmetic::Exact };
            pixels(&case, options).figures().differing
        };
        assert_eq!(wrong(Rasterizer::Tiled), 0);
        assert!(wrong(Rasterizer::ScanlinePublished) > 0);
        let DisplayedResult::Pixels(other) = shown(&case, 1, Options::default()) else { panic!("not pixels") };
        assert_eq!(other.figures().concerned, 0, "there is only one triangle");
    }

    #[test]
    fn lines_are_shown_at_their_position() {
        let case = case(r#"{"id":"l","kind":"line","p0":[-3,7],"p1":[-1,8],"last_pixel":true}"#);
        let shown = pixels(&case, Options::default());
        assert_eq!((shown.origin, shown.figures().covered, shown.exact), ((-4, 6), 3, None));
    }

    #[test]
    fn answers_without_an_image_are_shown_as_numbers() {
        let case = case(r#"{"id":"d","kind":"depth","mapping":"standard","format":"f32","near":1,"far":3,"z":[1,2]}"#);
        let DisplayedResult::Text(text) = shown(&case, 0, Options::default()) else { panic!("not text") };
        assert!(text[0].contains("`case`") && text[2].contains("0.75"), "{text:?}");
    }

    #[test]
    fn long_answers_are_broken_into_lines_and_cut() {
        let z = vec!["2.9"; 80_000].join(",");
        let case = case(&format!(
            r#"{{"id":"d","kind":"depth","mapping":"standard","format":"f32","near":1,"far":3,"z":[{z}]}}"#
        ));
        let DisplayedResult::Text(text) = shown(&case, 0, Options::default()) else { panic!("not text") };
        assert!(text.iter().all(|line| line.len() <= MAX_LINE_BYTES), "a line is too long");
        assert!(text.iter().map(String::len).sum::<usize>() < MAX_TEXT_BYTES + 1000);
        assert!(text.last().unwrap().starts_with("… and more"), "{:?}", text.last());
    }

    #[test]
    fn a_part_of_a_case_is_answered_alone() {
        // All parts together have more spans than an answer may contain.
        let large = "[[0,0],[16384,3],[5,2048]]";
        let triangles = vec![large; 20_000].join(",");
        let case = case(&format!(
            r#"{{"id":"t","kind":"tri_coverage","width":16384,"height":2048,"rule":"top_left","triangles":[{triangles}]}}"#
        ));
        let options = Options { rasterizer: Rasterizer::Scanline, ..Options::default() };
        assert!(answer(&case, options, &Control::default()).is_err());
        let DisplayedResult::Pixels(last) = shown(&case, 19_999, options) else { panic!("not pixels") };
        assert!(last.ours.at(100, 100) == 1.0 && last.ours.at(16_383, 2_047) == 0.0);
    }

    #[test]
    fn pixels_that_either_covers_are_counted_as_concerned() {
        let (ours, exact) =
            (Image::from_pixels(3, 1, vec![1.0, 0.0, 0.0]), Image::from_pixels(3, 1, vec![true, true, false]));
        let comparison = PixelComparison { origin: (0, 0), ours, exact: Some(exact), outlines: Vec::new() };
        let expected = PixelCounts { covered: 1, concerned: 2, differing: 1, first: vec![(1, 0)] };
        assert_eq!(comparison.figures(), expected);
    }
}
