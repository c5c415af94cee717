//! What the engine draws of a case beside what exact arithmetic says: the pixels of one part of a case, twice.
//!
//! The exact answer comes from [`super::stability::oracle`], which shares no code with the engine. It knows triangles; for
//! other kinds of cases there is only what the engine draws.

use super::stability::oracle::{ClipTriangle, Region, Snap};
use crate::case::{Answer, Case, Options, Task, answer};
use crate::image::Image;
use crate::pipeline::raster::Span;
use crate::pipeline::settings::{Arithmetic, FillRule};
use crate::pipeline::viewport::{MAX_PIXELS, Viewport};

/// One part of a case as pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The pixel at the top left; pictures of cases without a picture size begin where their pixels do.
    pub origin: (i64, i64),
    /// Share of each pixel that the engine covers, in [0, 1].
    pub ours: Image<f32>,
    /// Pixels that the exact answer covers; `None` where the program has no exact answer of its own.
    pub exact: Option<Image<bool>>,
    /// Corners of the shapes that the part is about, in px.
    pub outlines: Vec<Vec<[f64; 2]>>,
}

/// Where a pixel is covered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Agreement {
    /// Nowhere.
    Outside,
    /// By both, or by the engine where there is nothing to compare with.
    Covered,
    /// By the engine, wrongly.
    Extra,
    /// By the exact answer alone.
    Missing,
}

impl Comparison {
    /// Answers part number `part` of a case. `Err` says why there is no picture, or has the numbers that are the answer.
    pub fn new(case: &Case, part: usize, options: Options) -> Result<Self, String> {
        let answer = answer(case, options).map_err(|refusal| refusal.to_string())?;
        match (&case.task, answer) {
            (Task::TriCoverage(task), Answer::TriCoverage(answer)) => {
                let corners = task.corners_px(part).ok_or("the case has no such triangle")?;
                let viewport = Viewport { width: task.width, height: task.height };
                let snap = if options.arithmetic == Arithmetic::Fixed { Snap::Grid256 } else { Snap::Unsnapped };
                let exact = Region::triangle(corners, snap, task.rule).spans(viewport);
                let spans = answer.triangles.get(part).map_or(&[][..], |covered| &covered.spans);
                let is_finite = corners.as_flattened().iter().all(|c| c.is_finite());
                let outline = is_finite.then(|| corners.map(|corner| corner.map(f64::from)).to_vec());
                Ok(Self::of_spans(viewport, spans, Some(&exact), outline.into_iter().collect()))
            }
            (Task::ClipTri(task), Answer::ClipTri(answer)) => {
                let viewport = Viewport { width: task.width, height: task.height };
                let corners = task.corners(part).ok_or("the case has no such triangle")?;
                let exact = ClipTriangle::new(corners, viewport)
                    .map_or_else(Vec::new, |triangle| triangle.region(FillRule::TopLeft).spans(viewport));
                let spans = answer.triangles.get(part).map_or(&[][..], |covered| &covered.spans);
                Ok(Self::of_spans(viewport, spans, Some(&exact), Vec::new()))
            }
            (Task::PolyFill(task), Answer::PolyFill(answer)) => {
                let viewport = Viewport { width: task.width, height: task.height };
                Ok(Self::of_spans(viewport, &answer.spans, None, task.outlines()))
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
            (_, answer) => Err(numbers(&answer)),
        }
    }

    fn of_spans(
        Viewport { width, height }: Viewport,
        spans: &[[u32; 3]],
        exact: Option<&[Span]>,
        outlines: Vec<Vec<[f64; 2]>>,
    ) -> Self {
        let mut ours = Image::filled(width, height, 0.0);
        for [row, left, right] in spans {
            (*left..*right).for_each(|x| ours.set(x, *row, 1.0));
        }
        let exact = exact.map(|exact| {
            let mut covered = Image::filled(width, height, false);
            for span in exact {
                (span.left..span.right).for_each(|x| covered.set(x, span.row, true));
            }
            covered
        });
        Self { origin: (0, 0), ours, exact, outlines }
    }

    /// A picture just large enough, with a pixel of margin.
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

    /// What both say about a pixel of the pictures.
    pub fn agreement(&self, x: u32, y: u32) -> Agreement {
        let ours = self.ours.at(x, y) > 0.0;
        match (ours, self.exact.as_ref().map_or(ours, |exact| exact.at(x, y))) {
            (true, true) => Agreement::Covered,
            (true, false) => Agreement::Extra,
            (false, true) => Agreement::Missing,
            (false, false) => Agreement::Outside,
        }
    }

    /// Pixels on which both differ, in reading order.
    pub fn wrong(&self) -> Vec<(u32, u32)> {
        let (width, height) = self.ours.size();
        let all = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        all.filter(|(x, y)| matches!(self.agreement(*x, *y), Agreement::Extra | Agreement::Missing)).collect()
    }

    /// Pixels that the engine or the exact answer covers.
    pub fn concerned(&self) -> usize {
        self.covered() + self.wrong().into_iter().filter(|(x, y)| self.agreement(*x, *y) == Agreement::Missing).count()
    }

    /// Pixels that the engine covers at all.
    pub fn covered(&self) -> usize {
        self.ours.pixels().iter().filter(|share| **share > 0.0).count()
    }
}

/// An answer that no picture shows, a list of numbers on each line.
fn numbers(answer: &Answer) -> String {
    // Numbers and lists of them, which can always be written.
    let text = serde_json::to_string(answer).unwrap_or_default();
    format!("Answered in numbers, as the command `case` writes them:\n\n{}", text.replace("],", "],\n"))
}

/// How many parts a case has, each with a picture of its own.
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

    #[test]
    fn a_sound_rasterizer_agrees_with_the_exact_answer_and_a_published_one_does_not() {
        let case = case(
            r#"{"id":"t","kind":"tri_coverage","width":12,"height":10,"rule":"top_left",
                "triangles":[[[1.5,1.5],[9.5,2.5],[3.5,8.5]]]}"#,
        );
        let wrong = |rasterizer| {
            let options = Options { rasterizer, arithmetic: Arithmetic::Exact };
            Comparison::new(&case, 0, options).unwrap().wrong().len()
        };
        assert_eq!(wrong(Rasterizer::Tiled), 0);
        assert!(wrong(Rasterizer::ScanlinePublished) > 0);
        assert!(Comparison::new(&case, 1, Options::default()).is_err(), "there is but one triangle");
    }

    #[test]
    fn lines_are_shown_where_they_are() {
        let case = case(r#"{"id":"l","kind":"line","p0":[-3,7],"p1":[-1,8],"last_pixel":true}"#);
        let shown = Comparison::new(&case, 0, Options::default()).unwrap();
        assert_eq!((shown.origin, shown.covered(), shown.exact), ((-4, 6), 3, None));
    }

    #[test]
    fn what_no_picture_shows_is_told_in_numbers() {
        let case = case(r#"{"id":"d","kind":"depth","mapping":"standard","format":"f32","near":1,"far":3,"z":[1,2]}"#);
        let told = Comparison::new(&case, 0, Options::default()).unwrap_err();
        assert!(told.contains("0.75") && told.contains("`case`"), "{told}");
    }

    #[test]
    fn pixels_that_either_covers_are_concerned() {
        let (ours, exact) =
            (Image::from_pixels(3, 1, vec![1.0, 0.0, 0.0]), Image::from_pixels(3, 1, vec![true, true, false]));
        let comparison = Comparison { origin: (0, 0), ours, exact: Some(exact), outlines: Vec::new() };
        assert_eq!((comparison.covered(), comparison.concerned(), comparison.wrong().len()), (1, 2, 1));
    }
}
