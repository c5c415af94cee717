//! The history of a pixel: its fragments, and the triangles without a fragment there, each with its reason.
//!
//! A replay records only the fragments of a pixel. Most questions are about triangles without a fragment: they are
//! back-facing, clipped by the near plane, or miss the pixel's centre by a hundredth of a pixel. A [`Survey`] runs the
//! geometry stages of a frame again and stores the triangles that they dropped. [`explain`] combines the survey and the
//! rasterized triangles for one pixel.

mod clipped;

mod near_miss;

mod survey;

pub(super) use near_miss::px;
pub use survey::Survey;

use std::collections::BTreeSet;

use serde::Serialize;

use super::depth::DepthRecord;
use super::hits::seam_fault_at;
use super::pixel::{FragmentRecord, PixelReport, replayed};
use super::verdict::verdict;
use crate::chain::{Frame, Recipe};
use crate::image::Rgba8;
use crate::pipeline::settings::{Choice, choice};
use crate::scene::{Scene, TriangleId};

choice! {
    /// Outcome of a triangle at a pixel. The history of the pixel can be filtered by these outcomes.
    pub Kind {
        Passed = "passed", "Passed", "Fragments that were written, whether or not they are still visible.";
        Failed = "failed", "Failed", "Fragments that failed the depth test or the alpha test.";
        Culled = "culled", "Culled", "Triangles that would cover the pixel but were removed earlier: by culling, for zero area, or by the triangle slider.";
        Clipped = "clipped", "Clipped", "Triangles clipped here by the near or far plane, and triangles with a NaN or infinite corner.";
        Missed = "missed", "Missed", "Triangles near the pixel that do not cover its centre: the nearest 40, nearest first.";
    }
}

impl Kind {
    /// Returns [`Kind::Passed`] for a fragment that was written, otherwise [`Kind::Failed`].
    pub fn of(fragment: &FragmentRecord) -> Self {
        if fragment.outcome.is_written() { Self::Passed } else { Self::Failed }
    }

    /// Returns the number of fragments and absent triangles with this outcome in a report.
    pub fn count(self, report: &PixelReport) -> usize {
        let fragments = report.fragments.iter().filter(|fragment| Self::of(fragment) == self);
        fragments.count() + report.absent.iter().filter(|absent| absent.cause.kind() == self).count()
    }
}

/// Colour and depth of a sample before or after a fragment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SampleState {
    /// Colour of the sample (sRGB codes).
    pub color: Rgba8,
    /// Stored depth of the sample; `None` without a depth buffer.
    pub depth: Option<DepthRecord>,
}

/// Reason why a triangle has no fragment at a pixel. The order is the order of display, the most relevant cause first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// The triangle covers the pixel but is back-facing, and back faces are culled.
    BackFacing,
    /// The triangle covers the pixel but is front-facing, and front faces are culled.
    FrontFacing,
    /// The triangle would cover the pixel, but lies in front of the near plane there.
    NearPlane,
    /// The triangle covers the pixel but comes after the last drawn triangle.
    NotDrawnYet,
    /// The pixel's centre lies on an edge that the fill rule does not assign to the triangle.
    Tie,
    /// The pixel's centre lies inside the triangle, but the rasterizer skips the pixel because of its algorithm or
    /// because of rounding.
    Skipped,
    /// The triangle would cover the pixel, but lies beyond the far plane there.
    FarPlane,
    /// A corner of the triangle is NaN or infinite, so the triangle is not drawn at any pixel.
    NotFinite,
    /// The triangle passes through the pixel's centre, but its corners are collinear after snapping.
    ZeroArea,
    /// The pixel's centre lies outside the triangle.
    Missed,
}

impl Cause {
    /// Returns the display name of the cause, in one to three words.
    pub fn name(self) -> &'static str {
        match self {
            Self::BackFacing => "back-facing",
            Self::FrontFacing => "front-facing",
            Self::NearPlane => "near plane",
            Self::NotDrawnYet => "not drawn yet",
            Self::Tie => "edge tie",
            Self::Skipped => "skipped",
            Self::FarPlane => "far plane",
            Self::NotFinite => "not finite",
            Self::ZeroArea => "zero area",
            Self::Missed => "missed",
        }
    }

    /// Returns the outcome of a triangle that is absent from a pixel for this reason.
    pub fn kind(self) -> Kind {
        match self {
            Self::BackFacing | Self::FrontFacing | Self::ZeroArea | Self::NotDrawnYet => Kind::Culled,
            Self::NearPlane | Self::FarPlane | Self::NotFinite => Kind::Clipped,
            Self::Tie | Self::Skipped | Self::Missed => Kind::Missed,
        }
    }
}

/// A triangle without a fragment at a pixel, and the reason.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Absent {
    /// Triangle that has no fragment at the pixel.
    pub triangle: TriangleId,
    /// Name of the instance that the triangle belongs to.
    pub instance: String,
    /// Index of the triangle in the list of rasterized triangles; `None` if it was dropped earlier.
    pub submission: Option<usize>,
    /// Reason why the triangle has no fragment, for filters and sorting.
    pub cause: Cause,
    /// Reason as one sentence with the decisive number. The subject, the triangle, is omitted: the text begins with
    /// “covers”, “misses” or a similar verb.
    pub reason: String,
    /// Corners that determine coverage, in px; `None` if the triangle has no position on the screen.
    pub corners_px: Option<[[f32; 2]; 3]>,
    /// Distance from the pixel's centre to the triangle, in px; `None` if the triangle was not rasterized. In fixed
    /// point, this is the distance to the triangle with snapped corners, and only the final root and quotient are
    /// rounded.
    pub distance_px: Option<f64>,
    /// Edge function values at the pixel's centre, in the unit of the arithmetic; `None` if the triangle was not
    /// rasterized.
    pub edges: Option<[f64; 3]>,
}

/// Replays pixel (x, y) of a frame like [`super::inspect`], and adds the triangles without a fragment there, with
/// reasons. Returns `None` outside the picture. The survey must belong to the same frame.
pub fn explain(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    survey: &Survey,
    (x, y): (u32, u32),
) -> Option<PixelReport> {
    let mut report = replayed(scene, recipe, frame, x, y)?;
    if report.fault.is_none() && frame.is_drawn(x, y) {
        report.fault =
            survey.seams().and_then(|seams| seam_fault_at(scene, recipe, frame, seams, report.drawn_at.into()));
    }
    let there: BTreeSet<TriangleId> = report.fragments.iter().map(|fragment| fragment.triangle).collect();
    let drawn_at = (report.drawn_at[0], report.drawn_at[1]);
    report.absent = survey.dropped_at(scene, recipe, frame, drawn_at);
    report.absent.extend(near_miss::at(scene, recipe, frame, drawn_at, &there));
    report.absent.sort_by_key(|absent| absent.cause);
    report.verdict = verdict(&report, scene, recipe, frame);
    Some(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::run;
    use crate::inspect::FragmentOutcome;
    use crate::pipeline::settings::{FillRule, Rasterizer};
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    const VIEW: Viewport = Viewport { width: 40, height: 28 };

    fn reports(id: &str, recipe: &Recipe) -> (Frame, Vec<PixelReport>) {
        let scene = builtin::by_id(id).unwrap().build();
        let frame = run(&scene, &scene.home, recipe, VIEW, &mut ());
        let survey = Survey::of(&scene, recipe, &frame);
        let pixels = (0..VIEW.height).flat_map(|y| (0..VIEW.width).map(move |x| (x, y)));
        let reports = pixels.filter_map(|pixel| explain(&scene, recipe, &frame, &survey, pixel)).collect();
        (frame, reports)
    }

    #[test]
    fn each_fragment_starts_from_the_previous_state_and_the_last_state_is_the_frame() {
        for id in ["stained-glass", "interpenetrating"] {
            let (frame, reports) = reports(id, &Recipe::default());
            for report in &reports {
                let mut now = report.clear;
                for fragment in &report.fragments {
                    assert_eq!(fragment.before, now, "{id} ({}, {})", report.x, report.y);
                    assert!(fragment.outcome.is_written() || fragment.after == fragment.before);
                    now = fragment.after;
                }
                assert_eq!(now, report.last());
                assert_eq!((now.color, now.depth), (frame.image().at(report.x, report.y), report.final_depth));
            }
            assert!(
                reports.iter().any(|r| r.fragments.iter().any(|f| f.outcome == FragmentOutcome::Overwritten)),
                "{id}"
            );
        }
    }

    #[test]
    fn a_centre_on_an_edge_without_owner_is_reported_as_a_tie() {
        let mut recipe = Recipe::default();
        recipe.pipeline.fill_rule = FillRule::Exclusive;
        let (_, reports) = reports("shared-edges", &recipe);
        let tie = reports.iter().find(|r| r.fragments.is_empty() && r.absent.iter().any(|a| a.cause == Cause::Tie));
        let verdict = &tie.unwrap().verdict;
        assert!(verdict.contains("(value 0), which the fill rule “Exclusive” does not assign to it"), "{verdict}");
    }

    #[test]
    fn pixels_skipped_by_a_published_rasterizer_are_reported_with_its_name() {
        let mut recipe = Recipe::default();
        recipe.pipeline.rasterizer = Rasterizer::BoundingBoxPublished;
        let (_, reports) = reports("triangle", &recipe);
        let skipped = reports.iter().flat_map(|r| &r.absent).find(|a| a.cause == Cause::Skipped).unwrap();
        assert!(skipped.reason.contains("skipped by “Bounding box (as published)”"), "{}", skipped.reason);
    }

    #[test]
    fn with_default_settings_near_misses_have_a_negative_edge_and_are_sorted() {
        for id in ["slivers", "cubes"] {
            let (_, reports) = reports(id, &Recipe::default());
            let mut count = 0;
            for report in &reports {
                let missed: Vec<_> = report.absent.iter().filter(|a| a.cause == Cause::Missed).collect();
                count += missed.len();
                assert!(missed.is_sorted_by_key(|a| a.distance_px), "{id}");
                for miss in missed {
                    let edges = miss.edges.unwrap();
                    assert!(edges.iter().any(|edge| *edge < 0.0) && miss.distance_px > Some(0.0), "{id} {miss:?}");
                }
                assert!(report.absent.iter().all(|a| a.cause != Cause::Skipped), "{id}");
                assert!(report.absent.iter().all(|a| report.fragments.iter().all(|f| f.triangle != a.triangle)));
            }
            assert!(count > 1000, "{id} {count}");
        }
    }
}
