//! What an algorithm did, step by step: pixels that it set, what it knew at that moment, and the true shape beside.

use std::time::{Duration, Instant};

use glam::DVec2;

/// Steps that are kept of one run; what comes after is counted as cut off.
pub const MAX_STEPS: usize = 20_000;

/// What a pixel is filled with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ink {
    /// Set.
    Full,
    /// Partly covered: from 0, the paper, to 1, set.
    Share(f64),
    /// A wall of the given picture.
    Wall,
    /// One of several things, by its number.
    Group(usize),
    /// On the positive or the negative side of something.
    Side(bool),
    /// A colour of its own, sRGB.
    Color([u8; 3]),
}

/// A pixel and its ink.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Column; may lie outside of the grid.
    pub x: i64,
    /// Row.
    pub y: i64,
    /// What it is filled with.
    pub ink: Ink,
}

/// A cell that is set.
pub fn cell((x, y): (i64, i64), ink: Ink) -> Cell {
    Cell { x, y, ink }
}

/// What a mark says by its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// The true shape.
    Ideal,
    /// What helps to see.
    Weak,
    /// What this step looks at.
    Focus,
    /// The first of two compared things.
    A,
    /// The second of two.
    B,
    /// One of several things, by its number.
    Group(usize),
}

/// Geometry over the pixels, in px: pixel (i, j) fills the square from (i, j) to (i + 1, j + 1).
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A straight line.
    Line(DVec2, DVec2, Tone),
    /// A closed outline.
    Outline(Vec<DVec2>, Tone),
    /// An ellipse by its centre and its half axes.
    Ellipse(DVec2, DVec2, Tone),
    /// A small disc.
    Dot(DVec2, Tone),
    /// Words, centred.
    Text(DVec2, String, Tone),
}

/// One step of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Step {
    /// Pixels that it set.
    pub cells: Vec<Cell>,
    /// What it looked at.
    pub marks: Vec<Mark>,
    /// One sentence: what it did.
    pub says: String,
    /// What the algorithm knew, as names and values.
    pub state: Vec<(String, String)>,
}

/// A run on a small input.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Columns and rows of the grid.
    pub size: (u32, u32),
    /// Pixels of the given picture.
    pub ground: Vec<Cell>,
    /// The true shape.
    pub figure: Vec<Mark>,
    /// What was done, in order.
    pub steps: Vec<Step>,
    /// What is true of the whole run, as names and values.
    pub facts: Vec<(String, String)>,
    /// Whether there were more than [`MAX_STEPS`].
    pub cut_off: bool,
}

impl Recording {
    /// An empty grid.
    pub fn new(size: (u32, u32)) -> Self {
        Self { size, ..Self::default() }
    }

    /// Takes the steps of a run, at most [`MAX_STEPS`].
    pub fn collect(&mut self, steps: impl Iterator<Item = Step>) {
        let mut steps = steps;
        self.steps.extend(steps.by_ref().take(MAX_STEPS - self.steps.len()));
        self.cut_off |= self.steps.len() == MAX_STEPS && steps.next().is_some();
    }

    /// Adds what is true of the whole run.
    pub fn fact(&mut self, name: &str, value: impl Into<String>) {
        self.facts.push((name.to_owned(), value.into()));
    }

    /// The pixels after the first `steps` steps, in the order in which they were set; later ones lie over earlier ones.
    pub fn cells(&self, steps: usize) -> impl Iterator<Item = &Cell> {
        let done = &self.steps[..steps.min(self.steps.len())];
        self.ground.iter().chain(done.iter().flat_map(|step| &step.cells))
    }

    /// The geometry after the first `steps` steps: the true shape, and what the last of them looked at.
    pub fn marks(&self, steps: usize) -> impl Iterator<Item = &Mark> {
        let last = steps.min(self.steps.len()).checked_sub(1).map(|last| &self.steps[last]);
        self.figure.iter().chain(last.into_iter().flat_map(|step| &step.marks))
    }
}

/// A name and a value, both as text.
pub fn pair(name: &str, value: impl Into<String>) -> (String, String) {
    (name.to_owned(), value.into())
}

/// A number with a fixed number of decimals and a true minus sign.
pub fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    // What rounds to nothing has no sign.
    if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
        return text.trim_start_matches('-').to_owned();
    }
    text.replace('-', "−")
}

/// Length of a run: the shortest of a few rounds, each as many runs as take [`ROUND`].
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

/// A way to do the same, with its error against the truth and its time.
#[derive(Clone, Debug, PartialEq)]
pub struct Rival {
    /// Its name.
    pub name: &'static str,
    /// How wrong it is, in the unit that the comparison names.
    pub error: f64,
    /// Time of one run.
    pub time: Duration,
}

/// Several ways to do the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// What was run.
    pub task: String,
    /// What `error` of the rivals means, with its unit.
    pub error: &'static str,
    /// The ways.
    pub rivals: Vec<Rival>,
    /// What they say together, in one sentence.
    pub note: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_kept_up_to_a_bound_and_no_step_is_lost_before() {
        for (count, cut_off) in [(5, false), (MAX_STEPS, false), (MAX_STEPS + 1, true)] {
            let mut recording = Recording::new((4, 4));
            recording.collect((0..count).map(|_| Step::default()));
            assert_eq!((recording.steps.len(), recording.cut_off), (count.min(MAX_STEPS), cut_off));
        }
    }

    #[test]
    fn numbers_have_true_minus_signs_and_no_minus_zero() {
        assert_eq!([-1.25, -0.001, 0.0, 2.0].map(|v| number(v, 2)), ["−1.25", "0.00", "0.00", "2.00"]);
    }
}
