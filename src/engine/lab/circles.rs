//! Circles and ellipses on a coarse grid.

use std::collections::HashSet;

use glam::DVec2;

use super::recording::{
    Ink, InkedPixel, Mark, MethodComparison, MethodResult, RecordedStep, Recording, Tone, cell, number, pair, time_of,
};
use crate::flat2d::circle::midpoint_circle;
use crate::flat2d::circle_forms::{angles_without_gaps, explicit_circle, parametric_circle};
use crate::flat2d::ellipse::midpoint_ellipse;
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Algorithm that draws a circle or an ellipse.
    pub CircleMethod {
        Midpoint = "midpoint", "Midpoint circle",
            "Integers only: computes one octant and mirrors it into the other seven.";
        Explicit = "explicit", "Explicit, y = ±√(r² − x²)",
            "One square root per column, one pixel above and one below: gaps where the circle is steep.";
        Parametric = "parametric", "Parametric, (r cos φ, r sin φ)",
            "Equal angles, small enough to leave no gaps: sine and cosine per pixel, and some pixels twice.";
        Ellipse = "ellipse", "Midpoint ellipse",
            "The midpoint method with two half axes: computes one quadrant, first its flat part, then its steep part.";
    }
}

/// Size of the grid, in columns and rows.
const SIZE: (u32, u32) = (41, 31);

/// Longest semi-axis that can be set by dragging, in pixels.
const LARGEST: i32 = 60;

/// Input and settings of the lab page on circles and ellipses.
#[derive(Clone, Debug, PartialEq)]
pub struct CircleLesson {
    /// Column and row of the centre pixel.
    pub(crate) center: (i32, i32),
    /// Horizontal and vertical semi-axes, in pixels; the first is also the radius of a circle.
    pub(crate) half: (u32, u32),
    /// Selected algorithm.
    pub method: CircleMethod,
    /// Whether the grid shows which pixels lie inside the circle.
    pub sides: bool,
}

impl Default for CircleLesson {
    fn default() -> Self {
        Self { center: (20, 15), half: (12, 8), method: CircleMethod::Midpoint, sides: false }
    }
}

impl CircleLesson {
    /// Returns the semi-axes of the drawn circle or ellipse, in pixels.
    fn axes(&self) -> (u32, u32) {
        if self.method == CircleMethod::Ellipse { self.half } else { (self.half.0, self.half.0) }
    }

    fn middle(&self) -> DVec2 {
        DVec2::new(f64::from(self.center.0) + 0.5, f64::from(self.center.1) + 0.5)
    }

    fn pixels(&self, center: (i32, i32), (width, height): (u32, u32)) -> Box<dyn Iterator<Item = (i64, i64)>> {
        match self.method {
            CircleMethod::Midpoint => Box::new(midpoint_circle(center, width)),
            CircleMethod::Explicit => Box::new(explicit_circle(center, width)),
            CircleMethod::Parametric => Box::new(parametric_circle(center, width, angles_without_gaps(width))),
            CircleMethod::Ellipse => Box::new(midpoint_ellipse(center, width, height)),
        }
    }

    fn steps(&self) -> Box<dyn Iterator<Item = RecordedStep> + '_> {
        match self.method {
            CircleMethod::Midpoint => Box::new(self.circle_steps()),
            CircleMethod::Ellipse => Box::new(self.ellipse_steps()),
            CircleMethod::Explicit | CircleMethod::Parametric => Box::new(self.plain_steps()),
        }
    }

    fn circle_steps(&self) -> impl Iterator<Item = RecordedStep> {
        let mut walk = midpoint_circle(self.center, self.half.0);
        let middle = self.middle();
        std::iter::from_fn(move || {
            let pixel = walk.next()?;
            let (x, y) = walk.octant()?;
            let octant = octant_of(pixel.0 - i64::from(self.center.0), pixel.1 - i64::from(self.center.1));
            let decision = walk.decision();
            let (word, sign) =
                if decision >= 0 { ("outside", "≥ 0: y decreases") } else { ("inside", "< 0: y stays") };
            let ahead = DVec2::new(x as f64 + 1.0, y as f64 - 0.5);
            Some(RecordedStep {
                cells: vec![cell(pixel, Ink::Group(octant))],
                marks: vec![Mark::Dot(middle + ahead, Tone::Focus)],
                description: format!(
                    "Point ({x}, {y}), mirrored into octant {}: the next midpoint lies {word}, D = {} {sign}.",
                    octant + 1,
                    number(decision as f64, 0)
                ),
                state: vec![
                    pair("point in the octant", format!("({x}, {y})")),
                    pair("D", number(decision as f64, 0)),
                    pair(
                        "next point",
                        if decision >= 0 { format!("({}, {})", x + 1, y - 1) } else { format!("({}, {y})", x + 1) },
                    ),
                    pair("F(x, y)", number((x * x + y * y) as f64 - f64::from(self.half.0).powi(2), 0)),
                ],
            })
        })
    }

    fn ellipse_steps(&self) -> impl Iterator<Item = RecordedStep> {
        let mut walk = midpoint_ellipse(self.center, self.half.0, self.half.1);
        std::iter::from_fn(move || {
            let pixel = walk.next()?;
            let (x, y) = walk.quadrant()?;
            let flat = walk.is_flat();
            let (straight, diagonal) = (walk.right_or_diagonal(), walk.diagonal_or_down());
            let middle = self.middle() + DVec2::new(x as f64, y as f64);
            let ahead =
                [DVec2::new(1.0, -0.5), DVec2::new(0.5, -1.0)].map(|ahead| Mark::Dot(middle + ahead, Tone::Focus));
            let next = match (straight < 0, diagonal < 0) {
                (true, _) => "the upper midpoint lies inside: step right",
                (false, true) => "the upper midpoint lies outside, the left one inside: step right and down",
                (false, false) => "both midpoints lie outside: step down",
            };
            Some(RecordedStep {
                cells: vec![cell(pixel, Ink::Group(usize::from(!flat)))],
                marks: ahead.to_vec(),
                description: format!("Point ({x}, {y}) of the quadrant; {next}."),
                state: vec![
                    pair("point in the quadrant", format!("({x}, {y})")),
                    pair("part", if flat { "flat" } else { "steep" }),
                    pair("4 F at (x + 1, y − ½)", number(straight as f64, 0)),
                    pair("4 F at (x + ½, y − 1)", number(diagonal as f64, 0)),
                ],
            })
        })
    }

    fn plain_steps(&self) -> impl Iterator<Item = RecordedStep> {
        let mut seen = HashSet::new();
        let parametric = self.method == CircleMethod::Parametric;
        let (center, radius) = (self.center, f64::from(self.half.0));
        self.pixels(self.center, self.axes()).enumerate().map(move |(place, pixel)| {
            let (x, y) = (pixel.0 - i64::from(center.0), pixel.1 - i64::from(center.1));
            let again = !seen.insert(pixel);
            let how = if parametric {
                format!("angle {} of {}", place + 1, angles_without_gaps(radius as u32))
            } else {
                format!(
                    "√({} − {}) = {}",
                    number(radius * radius, 0),
                    x * x,
                    number((radius * radius - (x * x) as f64).sqrt(), 3)
                )
            };
            RecordedStep {
                cells: vec![cell(pixel, Ink::Full)],
                marks: Vec::new(),
                description: format!(
                    "{how} gives pixel ({x}, {y}) relative to the centre{}.",
                    if again { ", again" } else { "" }
                ),
                state: vec![pair("pixels so far", seen.len().to_string()), pair("visits", (place + 1).to_string())],
            }
        })
    }

    pub(super) fn record(&self) -> Recording {
        let mut recording = Recording::new(SIZE);
        let (width, height) = self.axes();
        let radii = DVec2::new(width.into(), height.into());
        if self.sides {
            let inside = |x: u32, y: u32| {
                let place = DVec2::new(x.into(), y.into()) + 0.5 - self.middle();
                (place / radii).length_squared() < 1.0
            };
            let places = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)));
            recording.ground.extend(places.map(|(x, y)| cell((x.into(), y.into()), Ink::Side(inside(x, y)))));
        }
        recording.figure.push(Mark::Ellipse(self.middle(), radii, Tone::Ideal));
        recording.collect(self.steps());
        let cells: Vec<_> = recording.steps.iter().flat_map(|step| step.cells.clone()).collect();
        let distinct: HashSet<_> = cells.iter().map(|cell| (cell.x, cell.y)).collect();
        recording.fact("pixels", distinct.len().to_string());
        recording.fact("drawn more than once", (cells.len() - distinct.len()).to_string());
        if width > 0 && height > 0 {
            let off = greatest_distance(&cells, self.center, radii);
            recording.fact("greatest distance", format!("{} px", number(off, 4)));
        }
        recording
    }

    pub(super) fn walk(&self) -> usize {
        self.pixels(self.center, self.axes()).count()
    }

    pub(super) fn explanation(&self) -> &'static str {
        match self.method {
            CircleMethod::Midpoint => {
                "The implicit form F(x, y) = x² + y² − r² is negative inside and positive outside. Starting at (0, r), \
                 x grows by one per step; the sign of F at the midpoint between the two candidate pixels decides \
                 whether y decreases. The decision variable D holds this value as an integer and changes by 2x + 3 or \
                 2(x − y) + 5. The octant ends at the diagonal; the other seven, each in its own colour, are mirror \
                 images."
            }
            CircleMethod::Explicit => {
                "The explicit form gives one y for each x. It is accurate where the circle is flat; where it is steep, \
                 one step in x spans several rows and leaves gaps. A square root per column also costs far more than \
                 the additions of the midpoint circle."
            }
            CircleMethod::Parametric => {
                "The parametric form advances an angle φ around the circle. Steps of 1/r are small enough to leave no \
                 gaps, but some pixels are then drawn twice. A parametric form is easy to follow along the curve; an \
                 implicit form decides on which side of the curve a point lies; an explicit form is simple, but leaves \
                 gaps where the curve is steep."
            }
            CircleMethod::Ellipse => {
                "An ellipse has fourfold symmetry instead of eightfold. The sign of F(x, y) = b²x² + a²y² − a²b² at \
                 the next two midpoints selects the step: right, right and down, or down. Where the ellipse is flatter \
                 than 45°, x grows at every step; where it is steeper, y decreases at every step. The colours show the \
                 two parts."
            }
        }
    }

    pub(super) fn handles(&self) -> Vec<DVec2> {
        let right = self.middle() + DVec2::X * f64::from(self.half.0);
        let mut handles = vec![self.middle(), right];
        if self.method == CircleMethod::Ellipse {
            handles.push(self.middle() + DVec2::Y * f64::from(self.half.1));
        }
        handles
    }

    pub(super) fn move_handle(&mut self, handle: usize, to: DVec2) {
        let place = (to - 0.5).round().as_ivec2();
        let axis = |length: i32| length.abs().clamp(0, LARGEST) as u32;
        match handle {
            0 => self.center = (place.x.clamp(0, SIZE.0 as i32 - 1), place.y.clamp(0, SIZE.1 as i32 - 1)),
            1 => self.half.0 = axis(place.x - self.center.0),
            _ => self.half.1 = axis(place.y - self.center.1),
        }
    }

    /// Compares all algorithms on a circle with 100 times the chosen radius.
    pub(super) fn compare(&self) -> MethodComparison {
        let radius = self.half.0.max(1) * 100;
        let rivals = CircleMethod::ALL.iter().map(|method| {
            let lesson = Self { method: *method, ..self.clone() };
            let run = || lesson.pixels((0, 0), (radius, radius));
            let cells: Vec<_> = run().map(|pixel| cell(pixel, Ink::Full)).collect();
            let error = greatest_distance(&cells, (0, 0), DVec2::splat(radius.into()));
            MethodResult { name: method.name(), error, time: time_of(|| run().count()) }
        });
        let task = format!("a circle of radius {radius} px");
        MethodComparison { task, error: "greatest distance from the circle, px", methods: rivals.collect(), note: None }
    }
}

/// Returns the index of the octant that contains a pixel, from 0 to 7, clockwise on the screen from the positive x
/// axis. Pixels on a diagonal belong to the octant along the x axis. x = 0 counts as right, and y = 0 as below.
fn octant_of(x: i64, y: i64) -> usize {
    let steep = y.abs() > x.abs();
    match (x >= 0, y >= 0) {
        (true, true) => usize::from(steep),
        (false, true) => 3 - usize::from(steep),
        (false, false) => 4 + usize::from(steep),
        (true, false) => 7 - usize::from(steep),
    }
}

/// Returns the greatest distance of a pixel in `cells` from an ellipse, in pixels. The distance is exact for circles
/// and a first-order approximation for other ellipses.
fn greatest_distance(cells: &[InkedPixel], center: (i32, i32), radii: DVec2) -> f64 {
    let off = |cell: &InkedPixel| {
        let place = DVec2::new((cell.x - i64::from(center.0)) as f64, (cell.y - i64::from(center.1)) as f64);
        let level = (place / radii).length();
        if radii.x == radii.y {
            return (level - 1.0).abs() * radii.x;
        }
        let gradient = (place / (radii * radii)).length() / level.max(f64::MIN_POSITIVE);
        (level - 1.0).abs() / gradient.max(f64::MIN_POSITIVE)
    };
    cells.iter().map(off).fold(0.0, f64::max)
}
