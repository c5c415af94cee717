//! Trace of the arithmetic of one fragment, line by line, from the vertices of its triangle to the final pixel.
//!
//! Every value is the pipeline's own: the trace calls the pipeline's functions again on the same inputs, and
//! intermediate values come from the code that draws the frame. Next to each value is the exact result of its formula
//! ([`exact`]) for the inputs of that line. The difference is therefore the rounding error of that line alone, without
//! earlier errors.
//!
//! Geometry is replayed for one triangle only, so the cost of a trace does not depend on the size of the scene.

pub(crate) mod exact;

pub(crate) mod formula;

mod attributes;
mod coverage;
mod decimal;
mod depth;
mod finish;
mod geometry;
mod inputs;
mod line;
mod motion;
mod names;
mod number;
mod project;
mod shade;
mod subject;
mod text;
mod texture;
mod weights;

use serde::Serialize;

pub use line::Notable;
pub use line::TraceLine;
pub use line::TraceStage;
pub use number::Number;

use line::TraceRecorder;
use subject::TracedFragment;

use super::pixel::PixelReport;
use crate::chain::{Frame, Recipe};
use crate::scene::{Scene, TriangleId};

/// Trace of the arithmetic of one fragment, from the mesh to the final pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trace {
    /// Column and row of the inspected pixel in the full picture.
    pub pixel: [u32; 2],
    /// Column and row of the drawn pixel that contains the fragment; equal to `pixel` if the inspected pixel was drawn.
    pub(crate) drawn_at: [u32; 2],
    /// Index of the fragment among those of the drawn pixel, in drawing order; `None` if the pixel has no fragments.
    pub fragment: Option<usize>,
    /// Number of fragments at the drawn pixel.
    pub fragments: usize,
    /// Triangle that produced the fragment; `None` if there is no fragment.
    pub triangle: Option<TriangleId>,
    /// Name of the instance that contains the triangle; empty if there is no fragment.
    pub(crate) instance: String,
    /// Lines of the trace, in pipeline order.
    pub lines: Vec<TraceLine>,
}

impl Trace {
    /// Traces a fragment of a replayed pixel. `fragment` is an index into [`PixelReport::fragments`]. `None` selects
    /// the visible fragment, or the last fragment if none is visible. If the pixel has no fragments, the trace contains
    /// only the steps from drawn samples to the pixel.
    ///
    /// # Examples
    /// ```
    /// # use rasterscope_engine::chain::{Recipe, run};
    /// # use rasterscope_engine::pipeline::viewport::Viewport;
    /// # use rasterscope_engine::scene::builtin;
    /// #
    /// # let scene = builtin::by_id("interpenetrating").unwrap().build();
    /// # let (recipe, viewport) = (Recipe::default(), Viewport { width: 64, height: 36 });
    /// # let frame = run(&scene, &scene.home, &recipe, viewport, &mut ());
    /// use rasterscope_engine::inspect::trace::Number;
    /// use rasterscope_engine::inspect::{Trace, inspect};
    ///
    /// let report = inspect(&scene, &recipe, &frame, 32, 18).unwrap();
    /// let trace = Trace::of(&scene, &recipe, &frame, &report, None);
    /// assert_eq!(trace.triangle, report.visible().map(|fragment| fragment.triangle));
    ///
    /// // The last line is the blue channel of the finished pixel.
    /// let line = trace.lines.last().unwrap();
    /// assert_eq!(line.number(), Some(Number::U8(report.color[2])));
    /// ```
    pub fn of(scene: &Scene, recipe: &Recipe, frame: &Frame, report: &PixelReport, fragment: Option<usize>) -> Self {
        let fragment = fragment.filter(|index| *index < report.fragments.len()).or_else(|| main_fragment(report));
        let mut scribe = TraceRecorder::new();
        let subject =
            fragment.and_then(|index| TracedFragment::of(scene, recipe, frame, &report.fragments[index], report));
        if let Some(subject) = &subject {
            let corners = geometry::write(subject, &mut scribe);
            project::write(subject, &corners, &mut scribe);
            coverage::write(subject, &mut scribe);
            weights::write(subject, &mut scribe);
            depth::write(subject, &mut scribe);
            attributes::write(subject, &mut scribe);
            if subject.record.shading.is_some() || subject.record.alpha.is_some() {
                texture::write(subject, &mut scribe);
                shade::write(subject, &mut scribe);
            }
            motion::write(subject, recipe, &mut scribe);
        }
        finish::write(recipe, frame, report, &mut scribe);
        let record = fragment.map(|index| &report.fragments[index]);
        Self {
            pixel: [report.x, report.y],
            drawn_at: report.drawn_at,
            fragment,
            fragments: report.fragments.len(),
            triangle: record.map(|record| record.triangle),
            instance: record.map_or_else(String::new, |record| record.instance.clone()),
            lines: scribe.finish(),
        }
    }

    /// Returns the index of the nearest line before or after line `from` that has the flag `kind`; `None` as `kind`
    /// accepts any flag. Skips asides, because they are not part of the pipeline.
    pub fn next(&self, from: usize, kind: Option<Notable>, direction: StepDirection) -> Option<usize> {
        self.find(from, direction, |line| !line.aside && kind.map_or(!line.flags.is_empty(), |kind| line.has(kind)))
    }

    /// Returns the index of the first line of the stage that precedes or follows the stage of line `from`.
    pub fn next_stage(&self, from: usize, direction: StepDirection) -> Option<usize> {
        let stage = self.lines.get(from)?.stage;
        let place = self.find(from, direction, |line| line.stage != stage)?;
        let stage = self.lines[place].stage;
        self.lines.iter().position(|line| line.stage == stage)
    }

    fn find(&self, from: usize, direction: StepDirection, wanted: impl Fn(&TraceLine) -> bool) -> Option<usize> {
        let wanted = |place: &usize| wanted(&self.lines[*place]);
        match direction {
            StepDirection::Forward => (from + 1..self.lines.len()).find(wanted),
            StepDirection::Back => (0..from.min(self.lines.len())).rev().find(wanted),
        }
    }

    /// Returns each stage that has lines, with these lines, in pipeline order.
    pub(crate) fn stages(&self) -> impl Iterator<Item = (TraceStage, &[TraceLine])> {
        self.lines.chunk_by(|a, b| a.stage == b.stage).filter_map(|lines| Some((lines.first()?.stage, lines)))
    }
}

/// Direction of a step through the lines of a trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepDirection {
    /// Forwards, towards the final pixel.
    Forward,
    /// Backwards, towards the mesh.
    Back,
}

/// Returns the index of the visible fragment, or of the last fragment if none is visible.
fn main_fragment(report: &PixelReport) -> Option<usize> {
    let visible = report.visible();
    let place = visible.and_then(|visible| report.fragments.iter().position(|record| std::ptr::eq(record, visible)));
    place.or_else(|| report.fragments.len().checked_sub(1))
}

#[cfg(test)]
mod tests;
