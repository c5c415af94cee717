//! Recorded steps of the line methods, with the numbers that decide each pixel.

use glam::DVec2;

use super::{SIZE, center, covered, distance, nearest};
use crate::antialias::weight::Weight;
use crate::flat2d::distance_line::distance_line;
use crate::flat2d::line::MidpointLine;
use crate::flat2d::real_line::real_line;
use crate::flat2d::slope_line::{Stepping, slope_line};
use crate::lab::recording::{Ink, Mark, RecordedStep, Tone, cell, number, pair};

pub(super) fn distance_steps([from, to]: [DVec2; 2]) -> Box<dyn Iterator<Item = RecordedStep>> {
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
        Some(RecordedStep {
            cells: vec![cell(pixel, Ink::Full)],
            marks: vec![Mark::Line(center(pixel), foot + 0.5, Tone::Focus)],
            description: format!(
                "Pixel ({}, {}) is {} px away from the line, at most ½: it is drawn.",
                pixel.0,
                pixel.1,
                number(off, 3)
            ),
            state: vec![
                pair("distance", format!("{} px", number(off, 4))),
                pair("search start", before.map_or(String::new(), |(x, y)| format!("({x}, {y})"))),
                pair("next tested", probe),
                pair("pixels so far", found.to_string()),
            ],
        })
    }))
}

pub(super) fn slope_steps([from, to]: [DVec2; 2], stepping: Stepping) -> Box<dyn Iterator<Item = RecordedStep>> {
    let Some(mut line) = slope_line(from, to, stepping) else { return Box::new(std::iter::empty()) };
    Box::new(std::iter::from_fn(move || {
        let (value, exact, steep) = (line.value()?, line.exact_value(), line.is_steep());
        let pixel = line.next()?;
        let (axis, across) = if steep { ("y", "x") } else { ("x", "y") };
        let major = if steep { pixel.1 } else { pixel.0 };
        let place = if steep { DVec2::new(value.into(), major as f64) } else { DVec2::new(major as f64, value.into()) };
        Some(RecordedStep {
            cells: vec![cell(pixel, Ink::Full)],
            marks: vec![Mark::Dot(place + 0.5, Tone::Focus)],
            description: format!(
                "At {axis} = {major} the line is at {across} = {}: pixel ({}, {}).",
                number(value.into(), 3),
                pixel.0,
                pixel.1
            ),
            state: vec![
                pair(across, number(value.into(), 7)),
                pair("exact value", number(exact, 7)),
                pair("drift", format!("{} px", number(f64::from(value) - exact, 9))),
                pair("steps along", axis),
            ],
        })
    }))
}

/// Returns the rounding error, in pixels, that accumulates along a line 1000 times as long. It is the error of the
/// coordinate along the shorter axis at the last pixel.
pub(super) fn drift_of_longer([from, to]: [DVec2; 2], stepping: Stepping) -> Option<f64> {
    const LONGER: f64 = 1_000.0;
    let mut line = slope_line(from, from + (to - from) * LONGER, stepping)?;
    let mut drift = 0.0;
    while let Some(value) = line.value() {
        drift = f64::from(value) - line.exact_value();
        line.next();
    }
    Some(drift)
}

pub(super) fn midpoint_steps(mut line: MidpointLine, [from, to]: [DVec2; 2]) -> Box<dyn Iterator<Item = RecordedStep>> {
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
            (false, true) if decision == 0 => "D = 0, a tie: diagonal step, as from the smaller x.".to_owned(),
            (false, true) => format!("D = {decision} > 0, the line passes beyond the midpoint: diagonal step."),
            (false, false) => {
                format!("D = {} ≤ 0, the line does not pass the midpoint: straight step.", number(decision as f64, 0))
            }
        };
        Some(RecordedStep {
            cells: vec![cell(pixel, Ink::Full)],
            marks,
            description: format!("Pixel ({}, {}); {why}", pixel.0, pixel.1),
            state: vec![
                pair("D", number(decision as f64, 0)),
                pair("added if straight", number(2.0 * width.min(height) as f64, 0)),
                pair("added if diagonal", number(2.0 * width.min(height) as f64 - 2.0 * width.max(height) as f64, 0)),
                pair("octant", octant(last.0 - first.0, last.1 - first.1)),
            ],
        })
    }))
}

/// Describes in words the octant of a direction with y pointing down, for example "right, then down".
fn octant(dx: i64, dy: i64) -> String {
    let steep = dy.abs() > dx.abs();
    let across = if dx >= 0 { "right" } else { "left" };
    let down = if dy >= 0 { "down" } else { "up" };
    if steep { format!("{down}, then {across}") } else { format!("{across}, then {down}") }
}

pub(super) fn exact_steps([from, to]: [DVec2; 2]) -> Box<dyn Iterator<Item = RecordedStep>> {
    let Some(mut line) = real_line(from, to) else { return Box::new(std::iter::empty()) };
    Box::new(std::iter::from_fn(move || {
        let guess = line.minor();
        let steep = line.is_steep();
        let pixel = line.next()?;
        let (axis, across) = if steep { ("y", "x") } else { ("x", "y") };
        let minor = if steep { pixel.0 } else { pixel.1 };
        let half = if steep { DVec2::X / 2.0 } else { DVec2::Y / 2.0 };
        Some(RecordedStep {
            cells: vec![cell(pixel, Ink::Full)],
            marks: vec![Mark::Line(center(pixel) - half, center(pixel) + half, Tone::Focus)],
            description: format!(
                "The line passes between {across} = {minor} − ½ and {minor} + ½: pixel ({}, {}).",
                pixel.0, pixel.1
            ),
            state: vec![
                pair("search start", format!("{across} = {guess}")),
                pair("distance", format!("{} px", number(distance([from, to], pixel), 4))),
                pair("steps along", axis),
            ],
        })
    }))
}

pub(super) fn area_steps(ends: [DVec2; 2], weight: Weight) -> Box<dyn Iterator<Item = RecordedStep>> {
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
        RecordedStep {
            cells: vec![found],
            marks: vec![mark],
            description: format!(
                "The strip covers {} of the filter around pixel ({}, {}).",
                number(share, 3),
                found.x,
                found.y
            ),
            state: vec![pair("covered share", number(share, 6)), pair("sum so far", number(sum, 4))],
        }
    }))
}
