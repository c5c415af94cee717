//! Lab page on straight lines: every line algorithm on a coarse grid.

mod steps;

use std::collections::BTreeSet;

use glam::DVec2;

use self::steps::{area_steps, distance_steps, drift_of_longer, exact_steps, midpoint_steps, slope_steps};
use super::recording::{
    Ink, InkedPixel, Mark, MethodComparison, MethodResult, RecordedStep, Recording, Tone, cell, number, time_of,
};
use crate::antialias::weight::{Weight, weighted_coverage};
use crate::flat2d::distance_line::distance_line;
use crate::flat2d::line::{MidpointLine, clip_to, direction_independent_line, midpoint_line};
use crate::flat2d::real_line::real_line;
use crate::flat2d::slope_line::{Stepping, slope_line};
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Algorithm that draws a line.
    pub LineMethod {
        Distance = "distance", "By distance",
            "Tests every pixel of the bounding box; draws those at most half a pixel away from the line.";
        Intersection = "intersection", "By slope, rounded",
            "Computes y = m (x − x₀) + y₀ for every step along the longer axis, and rounds it.";
        Addition = "dda", "DDA",
            "Adds the slope at every step: no multiplication, but each addition rounds, and the errors add up.";
        Midpoint = "midpoint", "Midpoint (Bresenham)",
            "Integers only: the sign of a decision variable gives the side on which the line passes the next midpoint.";
        Exact = "exact", "Nearest pixel, exact",
            "Real endpoints; the nearest pixel of every step is decided without rounding.";
        AreaBox = "area-box", "Area, box",
            "The line is a strip one pixel wide; each pixel gets the share of its area that the strip covers.";
        AreaPyramid = "area-pyramid", "Area, pyramid",
            "Weights the coverage by a pyramid filter: most at the pixel's centre, and a little into its neighbours.";
        AreaCone = "area-cone", "Area, cone",
            "Weights the coverage by a cone filter, which is equal in all directions.";
    }
}

impl LineMethod {
    /// Returns how the method computes the coordinate along the shorter axis; `None` for methods that do not use the
    /// slope.
    fn stepping(self) -> Option<Stepping> {
        match self {
            Self::Intersection => Some(Stepping::Intersection),
            Self::Addition => Some(Stepping::Addition),
            _ => None,
        }
    }

    /// Returns the filter that weights the coverage in area sampling; `None` for other methods.
    pub(crate) fn weight(self) -> Option<Weight> {
        match self {
            Self::AreaBox => Some(Weight::Box),
            Self::AreaPyramid => Some(Weight::Pyramid),
            Self::AreaCone => Some(Weight::Cone),
            _ => None,
        }
    }
}

/// Size of the grid, in columns and rows.
const SIZE: (u32, u32) = (36, 22);

/// Margin between the border of the grid and the clip rectangle, in pixels.
const FRAME: u32 = 4;

/// Input and settings of the lab page on lines.
#[derive(Clone, Debug, PartialEq)]
pub struct LineLesson {
    /// Endpoints of the line, in pixels; pixel centres have integer coordinates.
    pub(crate) ends: [DVec2; 2],
    /// Selected algorithm.
    pub method: LineMethod,
    /// Whether the pixel at the second endpoint is drawn. If not, consecutive segments of a polyline share no pixel.
    pub last_pixel: bool,
    /// Whether the midpoint method breaks ties so that drawing the line in either direction covers the same pixels.
    pub direction_independent: bool,
    /// Whether the line is clipped to a rectangle first.
    pub clip: bool,
}

impl Default for LineLesson {
    fn default() -> Self {
        let ends = [DVec2::new(3.0, 4.0), DVec2::new(31.0, 16.0)];
        Self { ends, method: LineMethod::Midpoint, last_pixel: true, direction_independent: false, clip: false }
    }
}

/// Returns the centre of a pixel, in pixels from the top-left corner of the grid.
fn center((x, y): (i64, i64)) -> DVec2 {
    DVec2::new(x as f64 + 0.5, y as f64 + 0.5)
}

/// Returns the pixel nearest to a position in a space where pixel centres have integer coordinates.
fn nearest(place: DVec2) -> (i64, i64) {
    let rounded = (place + 0.5).floor();
    (rounded.x as i64, rounded.y as i64)
}

/// Returns the corners of a rectangle that is one pixel wide and has the segment as its axis; `None` if the segment has
/// no length.
fn strip([from, to]: [DVec2; 2]) -> Option<[DVec2; 4]> {
    let across = (to - from).try_normalize()?.perp() / 2.0;
    Some([from - across, to - across, to + across, from + across])
}

/// Returns the distance, in pixels, from a pixel centre to the line through both endpoints, or to their common point if
/// they coincide.
fn distance([from, to]: [DVec2; 2], (x, y): (i64, i64)) -> f64 {
    let (along, place) = (to - from, DVec2::new(x as f64, y as f64) - from);
    if along == DVec2::ZERO { place.length() } else { (along.perp_dot(place) / along.length()).abs() }
}

impl LineLesson {
    /// Returns the endpoints of the drawn line, clipped if clipping is on; `None` if the line misses the clip
    /// rectangle.
    fn drawn_ends(&self) -> Option<[DVec2; 2]> {
        if !self.clip {
            return Some(self.ends);
        }
        let frame = f64::from(FRAME);
        let [from, to] = self.ends.map(|end| (end - frame).into());
        let clipped = clip_to(from, to, SIZE.0 - 2 * FRAME - 1, SIZE.1 - 2 * FRAME - 1)?;
        Some([clipped.0, clipped.1].map(|end| DVec2::from(end) + frame))
    }

    fn steps(&self, ends: [DVec2; 2]) -> Box<dyn Iterator<Item = RecordedStep>> {
        match self.method {
            LineMethod::Distance => distance_steps(ends),
            LineMethod::Intersection => slope_steps(ends, Stepping::Intersection),
            LineMethod::Addition => slope_steps(ends, Stepping::Addition),
            LineMethod::Midpoint => midpoint_steps(self.midpoint_line(ends), ends),
            LineMethod::Exact => exact_steps(ends),
            LineMethod::AreaBox | LineMethod::AreaPyramid | LineMethod::AreaCone => {
                area_steps(ends, self.method.weight().unwrap_or(Weight::Box))
            }
        }
    }

    pub(super) fn record(&self) -> Recording {
        let mut recording = Recording::new(SIZE);
        let [from, to] = self.ends;
        recording.figure.push(Mark::Line(from + 0.5, to + 0.5, Tone::Ideal));
        if self.clip {
            let (low, high) = (f64::from(FRAME), [SIZE.0 - FRAME, SIZE.1 - FRAME].map(f64::from));
            let corners = [[low, low], [high[0], low], high, [low, high[1]]].map(DVec2::from);
            recording.figure.push(Mark::Outline(corners.to_vec(), Tone::B));
        }
        let Some(ends) = self.drawn_ends() else {
            recording.fact("pixels", "none: the line misses the clip rectangle");
            return recording;
        };
        if self.clip {
            let [from, to] = ends;
            recording.figure.push(Mark::Line(from + 0.5, to + 0.5, Tone::Focus));
            let length = (self.ends[1] - self.ends[0]).length();
            if length > 0.0 {
                let share = |end: DVec2| number((end - self.ends[0]).length() / length, 3);
                recording.fact("part inside", format!("t from {} to {}", share(from), share(to)));
            }
        }
        if let Some(strip) = strip(ends).filter(|_| self.method.weight().is_some()) {
            recording.figure.push(Mark::Outline(strip.map(|corner| corner + 0.5).to_vec(), Tone::Weak));
        }
        let last = nearest(ends[1]);
        let keeps = |step: &RecordedStep| self.last_pixel || !step.cells.iter().any(|cell| (cell.x, cell.y) == last);
        recording.collect(self.steps(ends).filter(keeps));
        summarize(&mut recording, ends);
        self.mark_other_direction(ends, &mut recording);
        if let Some(stepping) = self.method.stepping() {
            let drift = drift_of_longer(ends, stepping);
            recording
                .fact("drift at 1000 × the length", drift.map_or("–".to_owned(), |px| format!("{} px", number(px, 4))));
        }
        recording
    }

    /// Outlines the pixels that are covered only if the endpoints are swapped, and counts the pixels that differ. Does
    /// nothing for area sampling, which does not depend on the direction.
    fn mark_other_direction(&self, ends @ [from, to]: [DVec2; 2], recording: &mut Recording) {
        if self.method.weight().is_some() {
            return;
        }
        let places = |ends| -> BTreeSet<_> { self.pixels(ends, SIZE).iter().map(|cell| (cell.x, cell.y)).collect() };
        let (forth, back) = (places(ends), places([to, from]));
        for pixel in back.difference(&forth) {
            let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
            let outline = corners.map(|corner| center(*pixel) + DVec2::from(corner));
            recording.figure.push(Mark::Outline(outline.to_vec(), Tone::A));
        }
        let differing = forth.difference(&back).count();
        recording.fact("pixels that differ when reversed", differing.to_string());
    }

    /// Returns the pixels of a line without recording steps.
    fn pixels(&self, ends: [DVec2; 2], size: (u32, u32)) -> Vec<InkedPixel> {
        let [from, to] = ends;
        let full = |pixel| cell(pixel, Ink::Full);
        let by_slope = |stepping| slope_line(from, to, stepping).into_iter().flatten().map(full).collect();
        match self.method {
            LineMethod::Distance => {
                distance_line(from, to, size.0, size.1).map(|(x, y)| full((x.into(), y.into()))).collect()
            }
            LineMethod::Intersection => by_slope(Stepping::Intersection),
            LineMethod::Addition => by_slope(Stepping::Addition),
            LineMethod::Midpoint => self.midpoint_line(ends).map(full).collect(),
            LineMethod::Exact => real_line(from, to).into_iter().flatten().map(full).collect(),
            LineMethod::AreaBox | LineMethod::AreaPyramid | LineMethod::AreaCone => {
                covered(ends, self.method.weight().unwrap_or(Weight::Box)).collect()
            }
        }
    }

    /// Returns an iterator over the pixels of a line by the midpoint algorithm.
    fn midpoint_line(&self, [from, to]: [DVec2; 2]) -> MidpointLine {
        let line = if self.direction_independent { direction_independent_line } else { midpoint_line };
        line(nearest(from), nearest(to))
    }

    pub(super) fn walk(&self) -> usize {
        self.drawn_ends().map_or(0, |ends| self.pixels(ends, SIZE).len())
    }

    pub(super) fn explanation(&self) -> &'static str {
        match self.method {
            LineMethod::Distance => {
                "A pixel belongs to the line if its centre is at most half a pixel away. With d from end to end and v \
                 from the first end to the pixel, the distance is |d × v| / |d|. This is simple and correct, but it \
                 tests every pixel of the bounding box, and slanted lines get two pixels in some columns, because the \
                 width is measured across the line instead of along a column."
            }
            LineMethod::Intersection => {
                "A line of slope m between −1 and 1 meets each column once, at y = m (x − x₀) + y₀; rounding gives the \
                 nearest pixel. Steeper lines swap x and y, since one pixel per column would leave gaps. Each pixel \
                 costs one multiplication and one rounding."
            }
            LineMethod::Addition => {
                "The digital differential analyser (DDA): when x grows by 1, y grows by m, so an addition replaces the \
                 multiplication. Floating point rounds each sum, and the errors add up: the state shows how far y has \
                 drifted from the true line, and the facts show the drift of a line a thousand times as long."
            }
            LineMethod::Midpoint => {
                "After each pixel there are two candidates: a straight step or a diagonal step. The line passes above \
                 or below the midpoint between them. The sign of the decision variable D, which starts at 2·minor − \
                 major, selects the step, and one addition updates it. All numbers are integers, so nothing drifts. \
                 The other octants differ only in the signs of the steps: drag the endpoints to see all eight. Where \
                 the line passes exactly between two pixels, D is 0 and the step is straight, so the reversed line \
                 takes the other pixel, outlined here. If every tie is resolved as for a line that starts at the \
                 endpoint with the smaller x, both directions cover the same pixels."
            }
            LineMethod::Exact => {
                "Endpoints need not lie on pixel centres. Every step along the longer axis takes the pixel nearest to \
                 the true line; where floating point is not certain, exact arithmetic decides. The other methods are \
                 measured against this reference; a tie goes to the larger coordinate."
            }
            LineMethod::AreaBox | LineMethod::AreaPyramid | LineMethod::AreaCone => {
                "Jagged edges come from an all-or-nothing decision per pixel. As a strip one pixel wide, the line \
                 covers each pixel in part, and this coverage becomes the pixel's value. A box filter weights the \
                 whole pixel equally; a pyramid or cone filter gives more weight to the centre and reaches into the \
                 neighbours, which makes lines smoother and a little wider."
            }
        }
    }

    pub(super) fn handles(&self) -> Vec<DVec2> {
        self.ends.iter().map(|end| *end + 0.5).collect()
    }

    pub(super) fn move_handle(&mut self, handle: usize, to: DVec2) {
        let place = to - 0.5;
        let whole = self.method == LineMethod::Midpoint && !self.clip;
        // Steps of a quarter pixel are easy to hit and show the effect of fractional endpoints.
        let place = if whole { place.round() } else { (place * 4.0).round() / 4.0 };
        if let Some(end) = self.ends.get_mut(handle) {
            *end = place;
        }
    }

    /// Compares all methods that do not anti-alias, on a longer line with the same slope.
    pub(super) fn compare(&self) -> MethodComparison {
        const LONGER: f64 = 40.0;
        // Endpoints can be dragged far outside the grid, and the distance method tests every pixel of the bounding box.
        const LONGEST_PX: f64 = 2000.0;
        let [from, to] = self.ends.map(DVec2::round);
        let span = (to - from).abs();
        let longer = LONGER.min(LONGEST_PX / span.max_element());
        let ends = [DVec2::splat(50.0), DVec2::splat(50.0) + (span * longer).round()];
        let size = [ends[1].x, ends[1].y].map(|length| length as u32 + 51);
        let methods = LineMethod::ALL.iter().copied().filter(|method| method.weight().is_none());
        let rivals = methods.map(|method| {
            let lesson = Self { method, ..self.clone() };
            let run = || lesson.pixels(ends, (size[0], size[1]));
            let error = run().into_iter().map(|cell| distance(ends, (cell.x, cell.y))).fold(0.0, f64::max);
            MethodResult { name: method.name(), error, time: time_of(|| run().len()) }
        });
        let task = format!("a line of {} × {} px", number(ends[1].x - 50.0, 0), number(ends[1].y - 50.0, 0));
        MethodComparison { task, error: "greatest distance from the line, px", methods: rivals.collect(), note: None }
    }
}

/// Returns the pixels that a one-pixel-wide line covers, row by row, with their filtered coverage.
fn covered(ends: [DVec2; 2], weight: Weight) -> impl Iterator<Item = InkedPixel> {
    let strip = strip(ends);
    let reach = 0.5 + weight.radius_px();
    let (least, greatest) = (ends[0].min(ends[1]) - reach, ends[0].max(ends[1]) + reach);
    let rows = least.y.floor() as i64..=greatest.y.ceil() as i64;
    rows.flat_map(move |y| (least.x.floor() as i64..=greatest.x.ceil() as i64).map(move |x| (x, y))).filter_map(
        move |(x, y)| {
            let share = weighted_coverage(&strip?, DVec2::new(x as f64, y as f64), weight);
            (share > 0.0).then(|| cell((x, y), Ink::Share(share)))
        },
    )
}

fn summarize(recording: &mut Recording, ends: [DVec2; 2]) {
    let cells: Vec<_> = recording.steps.iter().flat_map(|step| step.cells.clone()).collect();
    recording.fact("pixels", cells.len().to_string());
    if ends[0] == ends[1] {
        return;
    }
    recording.fact("length of the line", format!("{} px", number((ends[1] - ends[0]).length(), 3)));
    if cells.iter().any(|cell| cell.ink != Ink::Full) {
        let sum: f64 = cells.iter().map(|cell| if let Ink::Share(share) = cell.ink { share } else { 0.0 }).sum();
        recording.fact("sum of shares", number(sum, 3));
        return;
    }
    let greatest = cells.iter().map(|cell| distance(ends, (cell.x, cell.y))).fold(0.0, f64::max);
    recording.fact("greatest distance", format!("{} px", number(greatest, 4)));
    let exact: Vec<_> = real_line(ends[0], ends[1]).into_iter().flatten().collect();
    let wrong = cells.iter().filter(|cell| !exact.contains(&(cell.x, cell.y))).count();
    recording.fact("not the nearest pixel", wrong.to_string());
}
