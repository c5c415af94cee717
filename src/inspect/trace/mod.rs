//! The arithmetic of one fragment, written out line by line: from the corners of its triangle to the pixel that it is part of.
//!
//! Every value is the pipeline's own: its functions are called again on the same inputs, and where they keep a step to
//! themselves they were split, so that the drawing and the trace run the same code. Beside each value stands what the formula
//! comes to without any rounding ([`exact`]), computed from the very inputs of that line: what a line is off by is what that
//! line rounded, and nothing that was rounded before.
//!
//! Geometry is replayed for the one triangle alone, so that a trace costs the same in a scene of a million.

pub mod exact;

pub mod formula;

mod attributes;
mod coverage;
mod decimal;
mod depth;
mod finish;
mod geometry;
mod line;
mod number;
mod project;
mod shade;
mod subject;
mod text;
mod texture;
mod weights;

use serde::Serialize;

pub use line::{ExactText, Flag, Notable, Outcome, TraceLine, TraceStage};
pub use number::Number;

use line::Scribe;
use subject::Subject;

use super::pixel::PixelReport;
use crate::chain::{Frame, Recipe};
use crate::scene::{Scene, TriangleId};

/// The whole chain of one fragment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trace {
    /// The questioned pixel.
    pub pixel: [u32; 2],
    /// The drawn pixel that the fragment lies at: the questioned one if it was drawn itself.
    pub drawn_at: [u32; 2],
    /// Which of the fragments there, in drawing order; `None` where there is none.
    pub fragment: Option<usize>,
    /// How many there are.
    pub fragments: usize,
    /// The fragment's triangle.
    pub triangle: Option<TriangleId>,
    /// Name of the instance that it belongs to.
    pub instance: String,
    /// All lines, in the order of the pipeline.
    pub lines: Vec<TraceLine>,
}

impl Trace {
    /// Of a fragment of a replayed pixel, by its place among [`PixelReport::fragments`]; of the one that the pixel shows if none
    /// is named. Where no fragment is, the trace only tells how the pixel came about from what was drawn.
    pub fn of(scene: &Scene, recipe: &Recipe, frame: &Frame, report: &PixelReport, fragment: Option<usize>) -> Self {
        let fragment = fragment.filter(|index| *index < report.fragments.len()).or_else(|| main_fragment(report));
        let mut scribe = Scribe::new();
        let subject = fragment.and_then(|index| Subject::of(scene, recipe, frame, &report.fragments[index], report));
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

    /// The next line after `from`, or the one before, that has a flag of this kind, or any flag if none is named. Asides are
    /// no part of the pipeline and are passed over.
    pub fn next(&self, from: usize, kind: Option<Notable>, direction: Direction) -> Option<usize> {
        self.find(from, direction, |line| !line.aside && kind.map_or(!line.flags.is_empty(), |kind| line.has(kind)))
    }

    /// The first line of the next stage after that of `from`, or of the one before.
    pub fn next_stage(&self, from: usize, direction: Direction) -> Option<usize> {
        let stage = self.lines.get(from)?.stage;
        let place = self.find(from, direction, |line| line.stage != stage)?;
        let stage = self.lines[place].stage;
        self.lines.iter().position(|line| line.stage == stage)
    }

    fn find(&self, from: usize, direction: Direction, wanted: impl Fn(&TraceLine) -> bool) -> Option<usize> {
        let wanted = |place: &usize| wanted(&self.lines[*place]);
        match direction {
            Direction::Forward => (from + 1..self.lines.len()).find(wanted),
            Direction::Back => (0..from.min(self.lines.len())).rev().find(wanted),
        }
    }

    /// The lines of each stage that has any, in order.
    pub fn stages(&self) -> impl Iterator<Item = (TraceStage, &[TraceLine])> {
        self.lines.chunk_by(|a, b| a.stage == b.stage).filter_map(|lines| Some((lines.first()?.stage, lines)))
    }
}

/// Which way to step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Towards the pixel.
    Forward,
    /// Towards the mesh.
    Back,
}

/// The fragment that the pixel shows, or the last one there is.
fn main_fragment(report: &PixelReport) -> Option<usize> {
    let visible = report.visible();
    let place = visible.and_then(|visible| report.fragments.iter().position(|record| std::ptr::eq(record, visible)));
    place.or_else(|| report.fragments.len().checked_sub(1))
}

#[cfg(test)]
mod tests;
