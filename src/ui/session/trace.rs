//! The arithmetic of one fragment as a table, which can be stepped through by line, by stage, or to the next flagged
//! line, such as one with a NaN.

use std::collections::HashMap;
use std::sync::Arc;

use crate::chain::Frame;
use crate::inspect::PixelReport;
use crate::inspect::trace::{self, Notable, StepDirection, Trace, TraceStage};
use crate::ui::engine::RenderedView;
use crate::ui::session::Session;
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::WindowTask;
use crate::ui::session::workspace::Panel;

/// State of the table that traces the arithmetic of a fragment.
#[derive(Debug, Default)]
pub(crate) struct TraceView {
    /// Last trace, with the inputs from which it was computed.
    cached: Option<CachedTrace>,
    /// For each line, whether its value differs from the value in the previous trace. The previous trace belongs to
    /// another pixel, fragment, recipe or view.
    changed: Vec<bool>,
    /// Index of the selected fragment; `None` means the visible one.
    fragment: Option<usize>,
    /// Index of the current line of the trace.
    pub(crate) line: usize,
    /// Filter text: only lines that contain it are listed.
    pub(crate) filter: String,
    /// Number of steps so far. When it changes, the table scrolls to the current line.
    pub(crate) steps: u64,
}

/// Trace with the inputs from which it was computed.
#[derive(Debug)]
struct CachedTrace {
    frame: Arc<Frame>,
    report: Arc<PixelReport>,
    trace: Arc<Trace>,
}

impl CachedTrace {
    /// Whether the trace describes the picked pixel of a view. It remains valid if another buffer of the same frame is
    /// shown.
    fn is_of(&self, view: &RenderedView) -> bool {
        let same = |report: &Arc<PixelReport>| Arc::ptr_eq(report, &self.report) || **report == *self.report;
        Arc::ptr_eq(&self.frame, &view.frame) && view.report.as_ref().is_some_and(same)
    }
}

/// Change to the table of arithmetic steps.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum TraceChange {
    /// Traces the picked pixel again if the trace is outdated.
    Renew,
    /// Goes to the line with this index.
    Line(usize),
    /// Moves by this many lines, backwards if negative.
    Step(i64),
    /// Searches in this direction for the nearest line with this flag, and goes there; `None` stands for any flag.
    Run(Option<Notable>, StepDirection),
    /// Searches in this direction for the nearest line that belongs to another stage, and goes there.
    Stage(StepDirection),
    /// Traces the fragment with this index.
    Fragment(usize),
    /// Sets the text that the listed lines must contain.
    Filter(String),
}

impl TraceView {
    /// Returns the trace if it describes the picked pixel of `view`.
    pub(crate) fn trace(&self, view: Option<&RenderedView>) -> Option<&Arc<Trace>> {
        let view = view?;
        self.cached.as_ref().filter(|made| made.is_of(view)).map(|made| &made.trace)
    }

    /// Returns the last trace, even if it is outdated: it stays on screen until the next one is ready.
    pub(crate) fn latest(&self) -> Option<&Arc<Trace>> {
        self.cached.as_ref().map(|made| &made.trace)
    }

    /// Whether the value of a line differs from that in the previous trace.
    pub(crate) fn is_changed(&self, line: usize) -> bool {
        self.changed.get(line).copied().unwrap_or(false)
    }

    /// Applies a change. Returns the change if it stepped through the table or selected a fragment, so that the caller
    /// can show the table.
    pub(crate) fn apply(&mut self, change: TraceChange, view: Option<&RenderedView>) -> Option<TraceChange> {
        if self.trace(view).is_none() {
            self.retrace(view);
        }
        let trace = self.trace(view)?.clone();
        let before = self.line;
        match &change {
            TraceChange::Renew => return None,
            TraceChange::Filter(text) => {
                self.filter.clone_from(text);
                return None;
            }
            TraceChange::Fragment(fragment) => {
                self.fragment = Some(*fragment);
                self.retrace(view);
                return Some(change);
            }
            TraceChange::Line(line) => {
                self.line = (*line).min(trace.lines.len().saturating_sub(1));
                return None;
            }
            TraceChange::Step(step) => {
                let last = trace.lines.len().saturating_sub(1) as i64;
                self.line = (self.line as i64 + step).clamp(0, last) as usize;
            }
            TraceChange::Run(kind, direction) => self.line = trace.next(before, *kind, *direction).unwrap_or(before),
            TraceChange::Stage(direction) => self.line = trace.next_stage(before, *direction).unwrap_or(before),
        }
        self.steps += 1;
        Some(change)
    }

    /// Traces the picked pixel of a view. Keeps the current line if the new trace contains it.
    fn retrace(&mut self, view: Option<&RenderedView>) {
        let Some((view, report)) = view.and_then(|view| Some((view, view.report.as_ref()?))) else { return };
        let last = self.cached.take();
        let same_pixel = last.as_ref().is_some_and(|last| (last.report.x, last.report.y) == (report.x, report.y));
        if !same_pixel {
            self.fragment = None;
        }
        let trace = Trace::of(&view.request.scene, &view.request.recipe, &view.frame, report, self.fragment);
        if let Some(last) = &last {
            self.changed = changes(&last.trace, &trace);
            self.line = counterpart(&last.trace, self.line, &trace);
        }
        self.cached = Some(CachedTrace { frame: view.frame.clone(), report: report.clone(), trace: Arc::new(trace) });
    }
}

impl Feature for TraceView {
    type Change = TraceChange;

    fn apply(session: &mut Session, change: TraceChange) -> Option<WindowTask> {
        let Session { features, view, .. } = session;
        features.trace.apply(change, view.as_ref()).map(|_| WindowTask::ShowPanel(Panel::Calculation))
    }

    fn leave_scene(&mut self) {}
}

/// Returns a unique key for each line: stage, name, and the number of lines so far with this stage and name. Lines of
/// two traces correspond if their keys are equal.
fn names(trace: &Trace) -> impl Iterator<Item = (TraceStage, &str, usize)> {
    let mut seen: HashMap<(TraceStage, &str), usize> = HashMap::new();
    trace.lines.iter().map(move |line| {
        let count = seen.entry((line.stage, &line.what)).or_default();
        *count += 1;
        (line.stage, line.what.as_str(), *count)
    })
}

/// Returns, for each line, whether its value differs from that of the corresponding line in the previous trace.
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

/// Returns the index of the line in `trace` that corresponds to a line of the previous trace, or the same index if no
/// line corresponds.
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

    /// Returns the request for a small picture of a scene, with a picked pixel.
    fn request(pick: (u32, u32)) -> Request {
        let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
        Request {
            camera: scene.home,
            scene,
            recipe: Recipe::default(),
            sequence: None,
            is_replayed: false,
            viewport: Viewport { width: 40, height: 30 },
            shown: Shown::Buffer(crate::inspect::Buffer::Color),
            triangle_limit: None,
            fragment_limit: None,
            look: crate::ui::engine::Look::default(),
            pick: Some(pick),
        }
    }

    fn views(pixels: &[(u32, u32)]) -> Vec<RenderedView> {
        let (mut engine, first) = (Engine::default(), request(pixels[0]));
        pixels.iter().map(|pixel| engine.answer(Request { pick: Some(*pixel), ..first.clone() })).collect()
    }

    #[test]
    fn stepping_stays_within_the_lines_and_follows_the_pick() {
        let [first, second] = &views(&[(20, 14), (21, 14)])[..] else { panic!("two views") };
        let mut table = TraceView::default();
        assert!(table.trace(Some(first)).is_none());
        assert_eq!(table.apply(TraceChange::Step(3), Some(first)), Some(TraceChange::Step(3)));
        let count = table.trace(Some(first)).unwrap().lines.len();
        assert!(table.line == 3 && count > 60, "{count}");
        table.apply(TraceChange::Step(-9), Some(first));
        assert_eq!(table.line, 0);
        table.apply(TraceChange::Step(i64::from(i32::MAX)), Some(first));
        assert_eq!(table.line, count - 1);
        let place = table.trace(Some(first)).unwrap().lines.iter().position(|l| l.what == "λ1 on the screen").unwrap();
        table.apply(TraceChange::Line(place), Some(first));
        assert!(table.trace(Some(second)).is_none(), "the trace belongs to another pixel");
        table.apply(TraceChange::Renew, Some(second));
        let trace = table.trace(Some(second)).unwrap();
        assert_eq!(trace.lines[table.line].what, "λ1 on the screen");
        assert!(table.is_changed(table.line), "a weight differs from pixel to pixel");
        assert!(!table.is_changed(0), "the corner of the mesh is the same");
    }

    #[test]
    fn another_buffer_of_the_same_frame_keeps_the_trace() {
        let (mut engine, mut request) = (Engine::default(), request((20, 14)));
        let mut table = TraceView::default();
        let first = engine.answer(request.clone());
        table.apply(TraceChange::Renew, Some(&first));
        request.shown = Shown::Intermediate(crate::inspect::Intermediate::Lambda0);
        let second = engine.answer(request.clone());
        assert!(table.trace(Some(&second)).is_some());
        assert!(second.captured.is_some() && second.range.is_some());
        request.recipe.pipeline.light.ambient = 0.9;
        let third = engine.answer(request);
        assert!(table.trace(Some(&third)).is_none(), "the trace belongs to another frame");
    }

    #[test]
    fn running_stops_at_a_flag_or_does_not_move() {
        let [view] = &views(&[(20, 14)])[..] else { panic!("one view") };
        let mut table = TraceView::default();
        table.apply(TraceChange::Run(None, StepDirection::Forward), Some(view));
        let lines = &table.trace(Some(view)).unwrap().lines;
        assert!(table.line == 0 || !lines[table.line].flags.is_empty());
        table.apply(TraceChange::Stage(StepDirection::Forward), Some(view));
        let at = table.line;
        table.apply(TraceChange::Run(Some(Notable::NotFinite), StepDirection::Forward), Some(view));
        assert_eq!(table.line, at, "there is no such line");
    }
}
