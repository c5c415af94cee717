//! The history of a pixel beyond its fragments: the triangles without a fragment there, each with its reason.
//!
//! A replay records only the fragments of a pixel. Most questions are about triangles without a fragment: they are
//! back-facing, clipped by the near plane, or miss the pixel's centre by a hundredth of a pixel. A [`Survey`] runs the
//! geometry stages of a frame again and stores the triangles that they dropped. [`absent`] combines the survey and the
//! rasterized triangles for one pixel.

mod clipped;

mod near_miss;

mod survey;

pub(super) use near_miss::px;
pub use survey::Survey;

use std::collections::BTreeSet;

use super::pixel::{Absent, PixelReport};
use crate::chain::{Frame, Recipe};
use crate::scene::{Scene, TriangleId};

/// Returns the triangles without a fragment at the drawn pixel of a report, sorted by reason. The survey must belong to
/// the same frame.
pub(super) fn absent(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    survey: &Survey,
    report: &PixelReport,
) -> Vec<Absent> {
    let there: BTreeSet<TriangleId> = report.fragments.iter().map(|fragment| fragment.triangle).collect();
    let drawn_at = report.drawn_at.into();
    let mut absent = survey.dropped_at(scene, recipe, frame, drawn_at);
    absent.extend(near_miss::at(scene, recipe, frame, drawn_at, &there));
    absent.sort_by_key(|absent| absent.cause);
    absent
}
