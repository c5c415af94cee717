//! Comparison of the engine's results for one test case with the exact results.
//!
//! [`Expected`] holds the exact results, computed once per case. [`answer`] runs the engine in one of its
//! configurations and compares the results. For each kind of case, a function computes [`Measures`] from the expected
//! and the actual results.

mod clip_space;

mod coverage;

mod depth;

mod samples;

use std::panic::{AssertUnwindSafe, catch_unwind};

use serde::{Deserialize, Serialize};

use super::case::{Body, StabilityCase};
use super::column::ReportColumn;
use super::metric::Measures;
use super::oracle::Snap;
use super::subject::{self, Interpolator};
use clip_space::ExpectedTriangle;
use coverage::ExpectedCoverage;
pub(crate) use depth::only_pair;

/// Exact results for all parts of a test case.
#[derive(Clone, Debug)]
pub(crate) enum Expected {
    /// Expected pixels of each triangle.
    Coverage(ExpectedCoverage),
    /// Expected regions, weights and depths of each triangle.
    ClipSpace(Vec<ExpectedTriangle>),
    /// Expected weights, depths and attributes, one entry per triangle.
    Samples(Vec<samples::ExpectedSamples>),
    /// Marker for depth cases: exact depths depend on the format, so the comparison computes them.
    Depth,
}

/// Outcome of comparing the engine's results for one test case with the exact ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct MeasureOutcome {
    /// Measured errors; `None` if the engine produced no result.
    pub(crate) measures: Option<Measures>,
    /// Indices of the parts of the case (see [`StabilityCase::only`]) that show the fault; empty for the whole case.
    pub(crate) culprits: Vec<usize>,
}

impl MeasureOutcome {
    fn new(measures: Measures, culprits: Vec<usize>) -> Self {
        // Joining with empty measures computes the derived metrics.
        let mut complete = Measures::default();
        complete.join(&measures);
        Self { measures: Some(complete), culprits }
    }

    fn refused() -> Self {
        Self { measures: None, culprits: Vec::new() }
    }
}

impl Expected {
    /// Computes the exact results for a test case.
    pub(crate) fn new(case: &StabilityCase) -> Self {
        match &case.body {
            Body::TriCoverage(body) => Self::Coverage(ExpectedCoverage::new(body)),
            Body::ClipTri(body) => Self::ClipSpace(clip_space::expected(body)),
            Body::TriAttr(body) => Self::Samples(vec![samples::expected(&body.vertices, &body.eval)]),
            Body::CoplanarPair(body) => {
                Self::Samples([&body.first, &body.second].map(|t| samples::expected(t, &body.eval)).into())
            }
            Body::Depth(_) | Body::DepthPairs(_) => Self::Depth,
        }
    }

    /// Returns the number of pixels, samples or depths in the exact result.
    pub(crate) fn units(&self, case: &StabilityCase) -> u64 {
        match (self, &case.body) {
            (Self::Coverage(expected), _) => expected.pixels(Snap::Unsnapped),
            (Self::ClipSpace(triangles), _) => triangles.iter().map(ExpectedTriangle::pixels).sum(),
            (Self::Samples(triangles), _) => triangles.iter().map(|samples| samples.len() as u64).sum(),
            (Self::Depth, Body::Depth(body)) => body.z.len() as u64,
            (Self::Depth, Body::DepthPairs(body)) => 2 * u64::from(body.pairs),
            (Self::Depth, _) => 0,
        }
    }
}

/// Runs the engine on a case in the configuration `column` and compares the results with `expected`. Returns `None` if
/// the configuration does not apply to this kind of case.
pub(crate) fn answer(case: &StabilityCase, expected: &Expected, column: ReportColumn) -> Option<MeasureOutcome> {
    let measured = match (&case.body, expected, column) {
        (Body::TriCoverage(body), Expected::Coverage(expected), ReportColumn::Coverage(by)) => attempt(|| {
            let viewport = case.viewport()?;
            let answers: Vec<_> = body.triangles.iter().map(|t| subject::cover(by, *t, body.rule, viewport)).collect();
            Some(coverage::evaluate(body, expected, by.declared_snap(), &answers))
        }),
        (Body::ClipTri(body), Expected::ClipSpace(expected), ReportColumn::Coverage(by)) => attempt(|| {
            let viewport = case.viewport()?;
            let answers: Vec<_> = body.triangles.iter().map(|t| subject::draw(by, *t, viewport)).collect();
            Some(clip_space::evaluate(expected, viewport, &answers))
        }),
        (Body::TriAttr(body), Expected::Samples(expected), ReportColumn::Weights(by)) => attempt(|| {
            let triangle = Interpolator::new(by, &body.vertices)?;
            let answers = body.eval.iter().map(|[x, y]| triangle.at(*x, *y)).collect();
            Some(samples::evaluate(expected, &[answers]))
        }),
        (Body::CoplanarPair(body), Expected::Samples(expected), ReportColumn::Weights(by)) => attempt(|| {
            let triangles = [Interpolator::new(by, &body.first)?, Interpolator::new(by, &body.second)?];
            let answers = triangles.map(|t| body.eval.iter().map(|[x, y]| t.at(*x, *y)).collect());
            Some(samples::evaluate(expected, &answers))
        }),
        (Body::Depth(body), _, ReportColumn::Depth(format)) => attempt(|| Some(depth::distances(body, format))),
        (Body::DepthPairs(body), _, ReportColumn::Depth(format)) => attempt(|| Some(depth::pairs(body, format))),
        _ => return None,
    };
    Some(measured.unwrap_or_else(MeasureOutcome::refused))
}

/// Returns the result of `ask`, or `None` if the engine panics, so that one case cannot abort the report.
fn attempt<T>(ask: impl FnOnce() -> Option<T>) -> Option<T> {
    catch_unwind(AssertUnwindSafe(ask)).ok().flatten()
}
