//! The arithmetic of one fragment as a table. Steps move by line, by stage, or to the next flagged line, in both
//! directions.

pub(crate) mod panel;

mod table;

use std::collections::HashMap;
use std::sync::Arc;

use super::engine::View;
use crate::chain::Frame;
use crate::inspect::trace::{Direction, Notable, Trace, TraceStage};
use crate::inspect::{PixelReport, trace};

/// State of the table.
#[derive(Debug, Default)]
pub(crate) struct TraceView {
    /// Trace, and the inputs it was made from.
    made: Option<Made>,
    /// Whether each line of the trace has another value than in the previous trace, made for another pixel, recipe or
    /// view.
    changed: Vec<bool>,
    /// Index of the selected fragment; `None` means the visible one.
    fragment: Option<usize>,
    /// Index of the current line.
    pub(crate) line: usize,
    /// Filter: only lines that contain this text are listed.
    pub(crate) filter: String,
    /// Number of steps so far; lets the table scroll after a step.
    pub(crate) steps: u64,
}

/// Trace, and the inputs it was made from.
#[derive(Debug)]
struct Made {
    frame: Arc<Frame>,
    report: Arc<PixelReport>,
    trace: Arc<Trace>,
}

impl Made {
    /// Whether the trace describes the picked pixel of a view. Showing another buffer of the same frame keeps it valid.
    fn is_of(&self, view: &View) -> bool {
        let same = |report: &Arc<PixelReport>| Arc::ptr_eq(report, &self.report) || **report == *self.report;
        Arc::ptr_eq(&self.frame, &view.frame) && view.report.as_ref().is_some_and(same)
    }
}

/// Change of the table.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// Traces the picked pixel.
    Renew,
    /// Goes to this line.
    Line(usize),
    /// Moves by this many lines, backwards if negative.
    Step(i64),
    /// Goes to the next line with this flag, or with any flag, in a direction.
    Run(Option<Notable>, Direction),
    /// Goes to the next stage in a direction.
    Stage(Direction),
    /// Traces this fragment.
    Fragment(usize),
    /// Sets the filter of the listed lines.
    Filter(String),
}

impl TraceView {
    /// Returns the trace if it describes the picked pixel of `view`.
    pub(crate) fn trace(&self, view: Option<&View>) -> Option<&Arc<Trace>> {
        let view = view?;
        self.made.as_ref().filter(|made| made.is_of(view)).map(|made| &made.trace)
    }

    /// Returns the last trace, even if it is outdated: it stays on screen until the next one is ready.
    pub(crate) fn latest(&self) -> Option<&Arc<Trace>> {
        self.made.as_ref().map(|made| &made.trace)
    }

    /// Whether the value of a line differs from that in the previous trace.
    pub(crate) fn is_changed(&self, line: usize) -> bool {
        self.changed.get(line).copied().unwrap_or(false)
    }

    /// Applies a change. Returns it if it stepped through the table or selected a fragment; the table should then be
    /// visible.
    pub(crate) fn apply(&mut self, change: Change, view: Option<&View>) -> Option<Change> {
        if self.trace(view).is_none() {
            self.renew(view);
        }
        let trace = self.trace(view)?.clone();
        let before = self.line;
        match &change {
            Change::Renew => return None,
            Change::Filter(text) => {
                self.filter.clone_from(text);
                return None;
            }
            Change::Fragment(fragment) => {
                self.fragment = Some(*fragment);
                self.renew(view);
                return Some(change);
            }
            Change::Line(line) => {
                self.line = (*line).min(trace.lines.len().saturating_sub(1));
                return None;
            }
            Change::Step(step) => {
                let last = trace.lines.len().saturating_sub(1) as i64;
                self.line = (self.line as i64 + step).clamp(0, last) as usize;
            }
            Change::Run(kind, direction) => self.line = trace.next(before, *kind, *direction).unwrap_or(before),
            Change::Stage(direction) => self.line = trace.next_stage(before, *direction).unwrap_or(before),
        }
        self.steps += 1;
        Some(change)
    }

    /// Traces the picked pixel of a view. The current line stays the same if the new trace has it.
    fn renew(&mut self, view: Option<&View>) {
        let Some((view, report)) = view.and_then(|view| Some((view, view.report.as_ref()?))) else { return };
        let last = self.made.take();
        let same_pixel = last.as_ref().is_some_and(|last| (last.report.x, last.report.y) == (report.x, report.y));
        if !same_pixel {
            self.fragment = None;
        }
        let trace = Trace::of(&view.request.scene, &view.request.recipe, &view.frame, report, self.fragment);
        if let Some(last) = &last {
            self.changed = changes(&last.trace, &trace);
            self.line = counterpart(&last.trace, self.line, &trace);
        }
        self.made = Some(Made { frame: view.frame.clone(), report: report.clone(), trace: Arc::new(trace) });
    }
}

/// Returns a unique name for each line: stage, name, and the number of its occurrence. Equal names identify
/// corresponding lines of two traces.
fn names(trace: &Trace) -> impl Iterator<Item = (TraceStage, &str, usize)> {
    let mut seen: HashMap<(TraceStage, &str), usize> = HashMap::new();
    trace.lines.iter().map(move |line| {
        let count = seen.entry((line.stage, &line.what)).or_default();
        *count += 1;
        (line.stage, line.what.as_str(), *count)
    })
}

/// Returns for each line whether its value differs from that of the same line in the last trace.
fn changes(last: &Trace, trace: &Trace) -> Vec<bool> {
    let known: HashMap<_, &trace::TraceLine> = names(last).zip(&last.lines).collect();
    let differs = |(name, line): (_, &trace::TraceLine)| known.get(&name).is_none_or(|old| !is_same(old, line));
    names(trace).zip(&trace.lines).map(differs).collect()
}

fn is_same(old: &trace::TraceLine, new: &trace::TraceLine) -> bool {
    match (old.number(), new.number()) {
        (Some(a), Some(b)) => a.same_bits(b),
        _ => old.value == new.value,
    }
}

/// Returns the line of `trace` that corresponds to a line of the last trace.
fn counterpart(last: &Trace, line: usize, trace: &Trace) -> usize {
    let name = names(last).nth(line);
    let same = name.and_then(|name| names(trace).position(|other| other == name));
    same.unwrap_or(line).min(trace.lines.len().saturating_sub(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::Recipe;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;
    use crate::ui::engine::{Engine, Request, Shown};

    fn views(pixels: &[(u32, u32)]) -> Vec<View> {
        let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
        let mut engine = Engine::default();
        let request = |pick| Request {
            camera: scene.home,
            scene: scene.clone(),
            recipe: Recipe::default(),
            viewport: Viewport { width: 40, height: 30 },
            shown: Shown::Buffer(crate::inspect::Buffer::Color),
            triangle_limit: None,
            fragment_limit: None,
            look: crate::ui::look::Look::default(),
            pick: Some(pick),
        };
        pixels.iter().map(|pixel| engine.answer(request(*pixel))).collect()
    }

    #[test]
    fn stepping_stays_within_the_lines_and_follows_the_pick() {
        let [first, second] = &views(&[(20, 14), (21, 14)])[..] else { panic!("two views") };
        let mut table = TraceView::default();
        assert!(table.trace(Some(first)).is_none());
        assert_eq!(table.apply(Change::Step(3), Some(first)), Some(Change::Step(3)));
        let count = table.trace(Some(first)).unwrap().lines.len();
        assert!(table.line == 3 && count > 60, "{count}");
        table.apply(Change::Step(-9), Some(first));
        assert_eq!(table.line, 0);
        table.apply(Change::Step(i64::from(i32::MAX)), Some(first));
        assert_eq!(table.line, count - 1);
        let place = table.trace(Some(first)).unwrap().lines.iter().position(|l| l.what == "λ1 on the screen").unwrap();
        table.apply(Change::Line(place), Some(first));
        assert!(table.trace(Some(second)).is_none(), "it is of another pixel");
        table.apply(Change::Renew, Some(second));
        let trace = table.trace(Some(second)).unwrap();
        assert_eq!(trace.lines[table.line].what, "λ1 on the screen");
        assert!(table.is_changed(table.line), "a weight differs from pixel to pixel");
        assert!(!table.is_changed(0), "and the corner of the mesh does not");
    }

    #[test]
    fn another_buffer_of_the_same_frame_keeps_the_trace() {
        let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
        let mut engine = Engine::default();
        let mut request = Request {
            camera: scene.home,
            scene,
            recipe: Recipe::default(),
            viewport: Viewport { width: 40, height: 30 },
            shown: Shown::Buffer(crate::inspect::Buffer::Color),
            triangle_limit: None,
            fragment_limit: None,
            look: crate::ui::look::Look::default(),
            pick: Some((20, 14)),
        };
        let mut table = TraceView::default();
        let first = engine.answer(request.clone());
        table.apply(Change::Renew, Some(&first));
        request.shown = Shown::Intermediate(crate::inspect::Intermediate::Lambda0);
        let second = engine.answer(request.clone());
        assert!(table.trace(Some(&second)).is_some());
        assert!(second.captured.is_some() && second.range.is_some());
        request.recipe.pipeline.light.ambient = 0.9;
        let third = engine.answer(request);
        assert!(table.trace(Some(&third)).is_none(), "it is another frame");
    }

    #[test]
    fn running_stops_at_a_flag_or_stays() {
        let [view] = &views(&[(20, 14)])[..] else { panic!("one view") };
        let mut table = TraceView::default();
        table.apply(Change::Run(None, Direction::Forward), Some(view));
        let lines = &table.trace(Some(view)).unwrap().lines;
        assert!(table.line == 0 || !lines[table.line].flags.is_empty());
        table.apply(Change::Stage(Direction::Forward), Some(view));
        let at = table.line;
        table.apply(Change::Run(Some(Notable::NotFinite), Direction::Forward), Some(view));
        assert_eq!(table.line, at, "there is none");
    }
}
