//! Recorded run of an algorithm: the pixels set and the algorithm's state at each step, and the true shape.

use std::time::{Duration, Instant};

use glam::DVec2;

/// Maximum number of recorded steps of one run; further steps are cut off.
pub(crate) const MAX_STEPS: usize = 20_000;

/// Content of a pixel, which determines its display colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ink {
    /// Pixel that is fully set.
    Full,
    /// Partly covered pixel, with its coverage from 0 (empty) to 1 (fully set).
    Share(f64),
    /// Pixel of a wall in the input picture.
    Wall,
    /// Pixel of one of several groups, by index.
    Group(usize),
    /// Pixel on the positive (`true`) or negative side of an edge or curve.
    Side(bool),
    /// Pixel of an explicit colour, sRGB-encoded.
    Color([u8; 3]),
}

/// Pixel of the grid with its content.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InkedPixel {
    /// Column in the grid; may lie outside the grid.
    pub x: i64,
    /// Row in the grid; may lie outside the grid.
    pub y: i64,
    /// Content of the pixel, which determines its display colour.
    pub ink: Ink,
}

/// Creates a pixel from its column and row and its content.
pub(crate) fn cell((x, y): (i64, i64), ink: Ink) -> InkedPixel {
    InkedPixel { x, y, ink }
}

/// Role of a mark, which determines its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// Exact shape that the algorithm approximates.
    Ideal,
    /// Auxiliary geometry, drawn faintly.
    Weak,
    /// Focus of the current step.
    Focus,
    /// First of two items that are compared.
    A,
    /// Second of two items that are compared.
    B,
}

/// Geometry drawn over the pixels, in pixels: pixel (i, j) fills the square from (i, j) to (i + 1, j + 1).
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// Straight line between two points.
    Line(DVec2, DVec2, Tone),
    /// Closed polygon outline.
    Outline(Vec<DVec2>, Tone),
    /// Ellipse with its centre and semi-axes.
    Ellipse(DVec2, DVec2, Tone),
    /// Small disc.
    Dot(DVec2, Tone),
    /// Text, centred at a point.
    Text(DVec2, String, Tone),
}

/// Recorded step of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedStep {
    /// Pixels set by the step.
    pub cells: Vec<InkedPixel>,
    /// Geometry that the step examined.
    pub(crate) marks: Vec<Mark>,
    /// Description of the step, in one sentence.
    pub description: String,
    /// State of the algorithm, as names and values.
    pub state: Vec<(String, String)>,
}

/// Recorded run of an algorithm on a small input.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Number of columns and rows of the grid.
    pub size: (u32, u32),
    /// Pixels of the input picture. The pixels set by the steps are drawn over them.
    pub(crate) ground: Vec<InkedPixel>,
    /// Geometry of the exact shape that the algorithm approximates.
    pub(crate) figure: Vec<Mark>,
    /// Recorded steps, in order.
    pub steps: Vec<RecordedStep>,
    /// Results of the whole run, as names and values.
    pub facts: Vec<(String, String)>,
    /// Whether the run had more than [`MAX_STEPS`] steps.
    pub cut_off: bool,
}

impl Recording {
    /// Creates a recording of an empty grid.
    pub(crate) fn new(size: (u32, u32)) -> Self {
        Self { size, ..Self::default() }
    }

    /// Appends the steps of a run until the recording has [`MAX_STEPS`].
    pub(crate) fn collect(&mut self, steps: impl Iterator<Item = RecordedStep>) {
        let mut steps = steps;
        self.steps.extend(steps.by_ref().take(MAX_STEPS - self.steps.len()));
        self.cut_off |= self.steps.len() == MAX_STEPS && steps.next().is_some();
    }

    /// Appends a result of the whole run.
    pub(crate) fn fact(&mut self, name: &str, value: impl Into<String>) {
        self.facts.push((name.to_owned(), value.into()));
    }

    /// Returns the pixels after the first `steps` steps in drawing order; later pixels are drawn over earlier ones.
    pub fn cells(&self, steps: usize) -> impl Iterator<Item = &InkedPixel> {
        let done = &self.steps[..steps.min(self.steps.len())];
        self.ground.iter().chain(done.iter().flat_map(|step| &step.cells))
    }

    /// Returns the marks to draw after the first `steps` steps: the true shape, and the marks of the last of these
    /// steps.
    pub fn marks(&self, steps: usize) -> impl Iterator<Item = &Mark> {
        let last = steps.min(self.steps.len()).checked_sub(1).map(|last| &self.steps[last]);
        self.figure.iter().chain(last.into_iter().flat_map(|step| &step.marks))
    }
}

/// Returns a pair of a name and a value, both as text.
pub(crate) fn pair(name: &str, value: impl Into<String>) -> (String, String) {
    (name.to_owned(), value.into())
}

/// Formats a number with `decimals` decimals and a typographic minus sign (U+2212).
pub(crate) fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    // Values that round to zero have no sign.
    if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
        return text.trim_start_matches('-').to_owned();
    }
    text.replace('-', "−")
}

/// Measures the duration of one run. Each of 3 rounds repeats the run for at least 0.4 ms and takes the mean; the
/// result is the smallest mean.
pub fn time_of(mut run: impl FnMut() -> usize) -> Duration {
    const ROUND: Duration = Duration::from_micros(400);
    const ROUNDS: usize = 3;
    let round = || {
        let (begin, mut runs) = (Instant::now(), 0);
        while begin.elapsed() < ROUND {
            std::hint::black_box(run());
            runs += 1;
        }
        begin.elapsed() / runs
    };
    std::iter::repeat_with(round).take(ROUNDS).min().unwrap_or_default()
}

/// Error and run time of one method.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodResult {
    /// Display name of the method.
    pub name: &'static str,
    /// Error against the reference, in the unit that [`MethodComparison::error`] states.
    pub error: f64,
    /// Measured duration of one run.
    pub time: Duration,
}

/// Comparison of several methods for the same task.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodComparison {
    /// Description of the task that all methods solve.
    pub task: String,
    /// Meaning of the methods' `error`, with its unit.
    pub error: &'static str,
    /// Results of the compared methods.
    pub methods: Vec<MethodResult>,
    /// Summary of the comparison in one sentence, if it has one.
    pub note: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_recorded_up_to_the_limit() {
        for (count, cut_off) in [(5, false), (MAX_STEPS, false), (MAX_STEPS + 1, true)] {
            let mut recording = Recording::new((4, 4));
            recording.collect((0..count).map(|_| RecordedStep::default()));
            assert_eq!((recording.steps.len(), recording.cut_off), (count.min(MAX_STEPS), cut_off));
        }
    }

    #[test]
    fn numbers_have_true_minus_signs_and_no_minus_zero() {
        assert_eq!([-1.25, -0.001, 0.0, 2.0].map(|v| number(v, 2)), ["−1.25", "0.00", "0.00", "2.00"]);
    }
}
