//! Straight lines on a coarse grid, by every algorithm.

use std::collections::BTreeSet;

use glam::DVec2;

use super::recording::{Cell, Comparison, Ink, Mark, Recording, Rival, Step, Tone, cell, number, pair, time_of};
use crate::antialias::weight::{Weight, weighted_coverage};
use crate::flat2d::distance_line::distance_line;
use crate::flat2d::line::{MidpointLine, clip_to, direction_independent_line, midpoint_line};
use crate::flat2d::real_line::real_line;
use crate::flat2d::slope_line::{Stepping, slope_line};
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// How a line is drawn.
    LineMethod {
        Distance = "distance", "By distance", "Every pixel of the box around the line is looked at; those at most half a pixel off belong to it.";
        Intersection = "intersection", "By slope, rounded", "y = m (x − x₀) + y₀ is computed for every step along the longer axis, and rounded.";
        Addition = "dda", "DDA", "The slope is added at every step: no multiplication, but each addition rounds and the errors sum up.";
        Midpoint = "midpoint", "Midpoint (Bresenham)", "Whole numbers only: a decision variable tells on which side of the next midpoint the line passes.";
        Exact = "exact", "Nearest pixel, exactly", "Real ends; which pixel is nearest at every step is decided without any rounding.";
        AreaBox = "area-box", "Smooth, box", "The line is a strip one pixel wide; each pixel is as dark as the part of it that is covered.";
        AreaPyramid = "area-pyramid", "Smooth, pyramid", "What is covered near the pixel's centre counts more, and neighbours count a little: a pyramid of weights.";
        AreaCone = "area-cone", "Smooth, cone", "The same with a cone of weights: no direction is special.";
    }
}

impl LineMethod {
    /// How the slope is used, by those that use it.
    fn stepping(self) -> Option<Stepping> {
        match self {
            Self::Intersection => Some(Stepping::Intersection),
            Self::Addition => Some(Stepping::Addition),
            _ => None,
        }
    }

    /// The weight of area sampling, for those that sample areas.
    pub fn weight(self) -> Option<Weight> {
        match self {
            Self::AreaBox => Some(Weight::Box),
            Self::AreaPyramid => Some(Weight::Pyramid),
            Self::AreaCone => Some(Weight::Cone),
            _ => None,
        }
    }
}

/// Columns and rows of the grid.
const SIZE: (u32, u32) = (36, 22);

/// The part of the grid that a clipped line stays in: columns and rows left out on each side.
const FRAME: u32 = 4;

/// A line to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct LineLesson {
    /// Ends, where whole numbers are pixels' places.
    pub ends: [DVec2; 2],
    /// How.
    pub method: LineMethod,
    /// Whether the pixel of the second end is drawn; without it, lines in a row share no pixel.
    pub last_pixel: bool,
    /// Whether the midpoint method decides ties so that both directions cover the same pixels.
    pub direction_independent: bool,
    /// Whether the line is cut to a frame first.
    pub clip: bool,
}

impl Default for LineLesson {
    fn default() -> Self {
        let ends = [DVec2::new(3.0, 4.0), DVec2::new(31.0, 16.0)];
        Self { ends, method: LineMethod::Midpoint, last_pixel: true, direction_independent: false, clip: false }
    }
}

/// The centre of a pixel, px.
fn center((x, y): (i64, i64)) -> DVec2 {
    DVec2::new(x as f64 + 0.5, y as f64 + 0.5)
}

/// The pixel that a place, where whole numbers are pixels' places, is nearest to.
fn nearest(place: DVec2) -> (i64, i64) {
    let rounded = (place + 0.5).floor();
    (rounded.x as i64, rounded.y as i64)
}

/// Corners of the strip of one pixel's width around a segment; none without length.
fn strip([from, to]: [DVec2; 2]) -> Option<[DVec2; 4]> {
    let across = (to - from).try_normalize()?.perp() / 2.0;
    Some([from - across, to - across, to + across, from + across])
}

/// Distance of a pixel from the line through both ends, px; from the point that they are if they are one.
fn distance([from, to]: [DVec2; 2], (x, y): (i64, i64)) -> f64 {
    let (along, place) = (to - from, DVec2::new(x as f64, y as f64) - from);
    if along == DVec2::ZERO { place.length() } else { (along.perp_dot(place) / along.length()).abs() }
}

impl LineLesson {
    /// The ends that are drawn: cut to the frame if that is asked for; none if nothing is left.
    fn drawn_ends(&self) -> Option<[DVec2; 2]> {
        if !self.clip {
            return Some(self.ends);
        }
        let frame = f64::from(FRAME);
        let [from, to] = self.ends.map(|end| (end - frame).into());
        let clipped = clip_to(from, to, SIZE.0 - 2 * FRAME - 1, SIZE.1 - 2 * FRAME - 1)?;
        Some([clipped.0, clipped.1].map(|end| DVec2::from(end) + frame))
    }

    fn steps(&self, ends: [DVec2; 2]) -> Box<dyn Iterator<Item = Step>> {
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
            recording.fact("pixels", "none: the line misses the frame");
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
        let keeps = |step: &Step| self.last_pixel || !step.cells.iter().any(|cell| (cell.x, cell.y) == last);
        recording.collect(self.steps(ends).filter(keeps));
        summarize(&mut recording, ends);
        self.mark_other_direction(ends, &mut recording);
        if let Some(stepping) = self.method.stepping() {
            let drift = drift_of_longer(ends, stepping);
            recording.fact(
                "drift if 1000 times as long",
                drift.map_or("–".to_owned(), |px| format!("{} px", number(px, 4))),
            );
        }
        recording
    }

    /// Outlines the pixels that belong to the line only when it is drawn from its second end to its first, and counts those
    /// that differ. Areas have no direction.
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
        recording.fact("other pixels from the second end", differing.to_string());
    }

    /// The pixels of a line, without any record of how they were found.
    fn pixels(&self, ends: [DVec2; 2], size: (u32, u32)) -> Vec<Cell> {
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

    /// The walk of the midpoint method.
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
                "A pixel belongs to the line if its place is at most half a pixel away. With d from end to end and v from the first end to the \
                 pixel, the distance is |d × v| / |d|. Simple and right, but every pixel of the box is looked at, and slanted lines come out \
                 with steps of two pixels in some columns and gaps in none or many: the width is measured across, not along a column."
            }
            LineMethod::Intersection => {
                "A line of slope m between −1 and 1 meets each column once, at y = m (x − x₀) + y₀; the nearest pixel is found by rounding. \
                 Steeper lines swap the roles of x and y, otherwise columns would leave gaps. One multiplication and one rounding per pixel."
            }
            LineMethod::Addition => {
                "The digital differential analyser: since x grows by 1, y grows by m, so an addition replaces the multiplication. Floats \
                 round each sum, and the errors add up: the state shows how far y has drifted from the true line, and the facts what becomes of it \
                 on a line a thousand times as long."
            }
            LineMethod::Midpoint => {
                "From a pixel of the line only two can follow: straight on, or slanted. The line passes above or below the midpoint between \
                 them; the decision variable D = 2·minor − major holds which, and is updated by one addition. All numbers are whole, so nothing \
                 drifts. The other octants differ only in the signs of the steps. Drag the ends around to see all eight. Where the line passes exactly \
                 between two pixels, D is 0 and the line goes straight on, so from its other end it takes the other pixel, outlined here. A tie \
                 rule that always decides as from the lesser end covers the same pixels both ways."
            }
            LineMethod::Exact => {
                "Ends need not be pixels. At every step along the longer axis the pixel nearest to the true line is taken; where floats are not \
                 sure, exact arithmetic decides. This is the truth that the others are measured against; a tie goes to the larger coordinate."
            }
            LineMethod::AreaBox | LineMethod::AreaPyramid | LineMethod::AreaCone => {
                "Stairs come from an all-or-nothing decision per pixel. Taken as a strip one pixel wide, the line covers each pixel in part, and \
                 that part becomes its darkness. A box counts all of the pixel alike; a pyramid or a cone weighs what is near the centre more and \
                 reaches into the neighbours, which makes lines smoother and a little wider."
            }
        }
    }

    pub(super) fn handles(&self) -> Vec<DVec2> {
        self.ends.iter().map(|end| *end + 0.5).collect()
    }

    pub(super) fn move_handle(&mut self, handle: usize, to: DVec2) {
        let place = to - 0.5;
        let whole = self.method == LineMethod::Midpoint && !self.clip;
        // Quarters of a pixel are easy to hit and show what real ends do.
        let place = if whole { place.round() } else { (place * 4.0).round() / 4.0 };
        if let Some(end) = self.ends.get_mut(handle) {
            *end = place;
        }
    }

    /// All methods that choose pixels, on a longer line of the same direction.
    pub(super) fn compare(&self) -> Comparison {
        const LONGER: f64 = 40.0;
        // Ends can be dragged far out of the grid, and one method looks at every pixel of the box.
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
            Rival { name: method.name(), error, time: time_of(|| run().len()) }
        });
        let task = format!("a line of {} × {} px", number(ends[1].x - 50.0, 0), number(ends[1].y - 50.0, 0));
        Comparison { task, error: "greatest distance from the line, px", rivals: rivals.collect(), note: None }
    }
}

/// The pixels that the strip of a line covers, with their share, row by row.
fn covered(ends: [DVec2; 2], weight: Weight) -> impl Iterator<Item = Cell> {
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

fn distance_steps([from, to]: [DVec2; 2]) -> Box<dyn Iterator<Item = Step>> {
    let mut line = distance_line(from, to, SIZE.0, SIZE.1);
    let mut found = 0;
    Box::new(std::iter::from_fn(move || {
        let before = line.probe();
        let pixel = line.next().map(|(x, y)| (i64::from(x), i64::from(y)))?;
        found += 1;
        let off = distance([from, to], pixel);
        let direction = (to - from).normalize();
        let foot = from + direction * direction.dot(DVec2::new(pixel.0 as f64, pixel.1 as f64) - from);
        let probe = line.probe().map_or("the end".to_owned(), |(x, y)| format!("({x}, {y})"));
        Some(Step {
            cells: vec![cell(pixel, Ink::Full)],
            marks: vec![Mark::Line(center(pixel), foot + 0.5, Tone::Focus)],
            says: format!(
                "Pixel ({}, {}) is {} px off the line: at most ½, so it belongs to it.",
                pixel.0,
                pixel.1,
                number(off, 3)
            ),
            state: vec![
                pair("distance", format!("{} px", number(off, 4))),
                pair("searched from", before.map_or(String::new(), |(x, y)| format!("({x}, {y})"))),
                pair("next looked at", probe),
                pair("found", found.to_string()),
            ],
        })
    }))
}

fn slope_steps([from, to]: [DVec2; 2], stepping: Stepping) -> Box<dyn Iterator<Item = Step>> {
    let Some(mut line) = slope_line(from, to, stepping) else { return Box::new(std::iter::empty()) };
    Box::new(std::iter::from_fn(move || {
        let (value, exact, steep) = (line.value()?, line.exact_value(), line.is_steep());
        let pixel = line.next()?;
        let (axis, across) = if steep { ("y", "x") } else { ("x", "y") };
        let major = if steep { pixel.1 } else { pixel.0 };
        let place = if steep { DVec2::new(value.into(), major as f64) } else { DVec2::new(major as f64, value.into()) };
        Some(Step {
            cells: vec![cell(pixel, Ink::Full)],
            marks: vec![Mark::Dot(place + 0.5, Tone::Focus)],
            says: format!(
                "At {axis} = {major} the line is at {across} = {}: pixel ({}, {}).",
                number(value.into(), 3),
                pixel.0,
                pixel.1
            ),
            state: vec![
                pair(across, number(value.into(), 7)),
                pair("true value", number(exact, 7)),
                pair("drift", format!("{} px", number(f64::from(value) - exact, 9))),
                pair("steps along", axis),
            ],
        })
    }))
}

/// How far the coordinate across is off before the last pixel of a line a thousand times as long, px.
fn drift_of_longer([from, to]: [DVec2; 2], stepping: Stepping) -> Option<f64> {
    const LONGER: f64 = 1_000.0;
    let mut line = slope_line(from, from + (to - from) * LONGER, stepping)?;
    let mut drift = 0.0;
    while let Some(value) = line.value() {
        drift = f64::from(value) - line.exact_value();
        line.next();
    }
    Some(drift)
}

fn midpoint_steps(mut line: MidpointLine, [from, to]: [DVec2; 2]) -> Box<dyn Iterator<Item = Step>> {
    let (first, last) = (nearest(from), nearest(to));
    let (width, height) = (first.0.abs_diff(last.0), first.1.abs_diff(last.1));
    let (right, down) = ((last.0 - first.0).signum() as f64, (last.1 - first.1).signum() as f64);
    Box::new(std::iter::from_fn(move || {
        let (decision, slanted) = (line.decision(), line.slants());
        let pixel = line.next()?;
        let ahead = if width >= height { DVec2::new(right, down / 2.0) } else { DVec2::new(right / 2.0, down) };
        let at_end = pixel == last;
        let marks = if at_end { Vec::new() } else { vec![Mark::Dot(center(pixel) + ahead, Tone::Focus)] };
        let why = match (at_end, slanted) {
            (true, _) => "the end.".to_owned(),
            (false, true) if decision == 0 => "D = 0, a tie: slanted on, as from the lesser end.".to_owned(),
            (false, true) => format!("D = {decision} > 0, the line passes beyond the midpoint: slanted on."),
            (false, false) => {
                format!("D = {} ≤ 0, the line does not pass the midpoint: straight on.", number(decision as f64, 0))
            }
        };
        Some(Step {
            cells: vec![cell(pixel, Ink::Full)],
            marks,
            says: format!("Pixel ({}, {}); {why}", pixel.0, pixel.1),
            state: vec![
                pair("D", number(decision as f64, 0)),
                pair("added if straight", number(2.0 * width.min(height) as f64, 0)),
                pair("added if slanted", number(2.0 * width.min(height) as f64 - 2.0 * width.max(height) as f64, 0)),
                pair("octant", octant(last.0 - first.0, last.1 - first.1)),
            ],
        })
    }))
}

/// The direction of a line as a compass would say it, y down.
fn octant(dx: i64, dy: i64) -> String {
    let steep = dy.abs() > dx.abs();
    let across = if dx >= 0 { "right" } else { "left" };
    let down = if dy >= 0 { "down" } else { "up" };
    if steep { format!("{down}, then {across}") } else { format!("{across}, then {down}") }
}

fn exact_steps([from, to]: [DVec2; 2]) -> Box<dyn Iterator<Item = Step>> {
    let Some(mut line) = real_line(from, to) else { return Box::new(std::iter::empty()) };
    Box::new(std::iter::from_fn(move || {
        let guess = line.minor();
        let steep = line.is_steep();
        let pixel = line.next()?;
        let (axis, across) = if steep { ("y", "x") } else { ("x", "y") };
        let minor = if steep { pixel.0 } else { pixel.1 };
        let half = if steep { DVec2::X / 2.0 } else { DVec2::Y / 2.0 };
        Some(Step {
            cells: vec![cell(pixel, Ink::Full)],
            marks: vec![Mark::Line(center(pixel) - half, center(pixel) + half, Tone::Focus)],
            says: format!(
                "The line passes between {across} = {minor} − ½ and {minor} + ½: pixel ({}, {}).",
                pixel.0, pixel.1
            ),
            state: vec![
                pair("looked for from", format!("{across} = {guess}")),
                pair("distance", format!("{} px", number(distance([from, to], pixel), 4))),
                pair("steps along", axis),
            ],
        })
    }))
}

fn area_steps(ends: [DVec2; 2], weight: Weight) -> Box<dyn Iterator<Item = Step>> {
    let mut sum = 0.0;
    Box::new(covered(ends, weight).map(move |found| {
        let share = if let Ink::Share(share) = found.ink { share } else { 1.0 };
        sum += share;
        let at = center((found.x, found.y));
        let radius = DVec2::splat(weight.radius_px());
        let mark = if weight == Weight::Cone {
            Mark::Ellipse(at, radius, Tone::Focus)
        } else {
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            Mark::Outline(corners.map(|corner| at + DVec2::from(corner) * radius).to_vec(), Tone::Focus)
        };
        Step {
            cells: vec![found],
            marks: vec![mark],
            says: format!("The strip covers {} of the filter of pixel ({}, {}).", number(share, 3), found.x, found.y),
            state: vec![pair("covered share", number(share, 6)), pair("sum so far", number(sum, 4))],
        }
    }))
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
    recording.fact("greatest distance from it", format!("{} px", number(greatest, 4)));
    let exact: Vec<_> = real_line(ends[0], ends[1]).into_iter().flatten().collect();
    let wrong = cells.iter().filter(|cell| !exact.contains(&(cell.x, cell.y))).count();
    recording.fact("not the nearest pixel", wrong.to_string());
}
