//! The history of a pixel: besides its fragments also the triangles that have none there, each with its own reason.
//!
//! A replay tells what came to a pixel. Most questions are about what did not: a triangle that turns its back, one that the
//! near plane cut away, one whose edge passes the pixel's centre by a hundredth of a pixel. A [`Survey`] runs the geometry
//! stages once more for a frame and keeps what they dropped; [`explain`] asks it, and the triangles that were rasterized,
//! about one pixel.

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
    /// What became of a triangle at a pixel, in the groups that its history is filtered by.
    Kind {
        Passed = "passed", "Passed", "Fragments that were written, whether they are still seen or not.";
        Failed = "failed", "Failed", "Fragments that lost the depth test, and those whose alpha says that they are not there.";
        Culled = "culled", "Culled", "Triangles that would cover the pixel, but were dropped before: for the side that they show, for having no area, or by the triangle slider.";
        Clipped = "clipped", "Clipped", "Triangles that the near or the far plane cuts away here, and those with a corner that is not finite.";
        Missed = "missed", "Missed", "Triangles that come near and do not cover the pixel's centre: the nearest 40, the nearest first.";
    }
}

impl Kind {
    /// The group of a fragment.
    pub fn of(fragment: &FragmentRecord) -> Self {
        if fragment.outcome.is_written() { Self::Passed } else { Self::Failed }
    }

    /// How many entries of a report belong to the group.
    pub fn count(self, report: &PixelReport) -> usize {
        let fragments = report.fragments.iter().filter(|fragment| Self::of(fragment) == self);
        fragments.count() + report.absent.iter().filter(|absent| absent.cause.kind() == self).count()
    }
}

/// Colour and depth of a sample at one moment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SampleState {
    /// Its colour (sRGB codes).
    pub color: Rgba8,
    /// What the depth buffer holds; `None` without one.
    pub depth: Option<DepthRecord>,
}

/// Why a triangle has no fragment at a pixel. The order is that of telling: the first is what a person should look at first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// It covers the pixel, turns its back, and back faces are culled.
    BackFacing,
    /// It covers the pixel, faces the viewer, and front faces are culled.
    FrontFacing,
    /// It would cover the pixel closer to the eye than the near plane.
    NearPlane,
    /// It covers the pixel, and comes after the last triangle that is drawn.
    NotDrawnYet,
    /// The pixel's centre lies on an edge, which the fill rule does not give to it.
    Tie,
    /// The pixel's centre lies inside, yet the rasterizer, or rounding, leaves it out.
    LeftOut,
    /// It would cover the pixel beyond the far plane.
    FarPlane,
    /// A corner is not a finite number, so it is never drawn, here or elsewhere.
    NotFinite,
    /// It passes the pixel's centre, and its corners fell onto one line when they were snapped.
    ZeroArea,
    /// The pixel's centre lies outside.
    Missed,
}

impl Cause {
    /// What a person calls it, in a word or two.
    pub fn name(self) -> &'static str {
        match self {
            Self::BackFacing => "back-facing",
            Self::FrontFacing => "front-facing",
            Self::NearPlane => "near plane",
            Self::NotDrawnYet => "not drawn yet",
            Self::Tie => "edge tie",
            Self::LeftOut => "left out",
            Self::FarPlane => "far plane",
            Self::NotFinite => "not finite",
            Self::ZeroArea => "zero area",
            Self::Missed => "missed",
        }
    }

    /// The group that it belongs to.
    pub fn kind(self) -> Kind {
        match self {
            Self::BackFacing | Self::FrontFacing | Self::ZeroArea | Self::NotDrawnYet => Kind::Culled,
            Self::NearPlane | Self::FarPlane | Self::NotFinite => Kind::Clipped,
            Self::Tie | Self::LeftOut | Self::Missed => Kind::Missed,
        }
    }
}

/// A triangle that has no fragment at a pixel, and why.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Absent {
    /// Triangle of the scene.
    pub triangle: TriangleId,
    /// Name of the instance that it belongs to.
    pub instance: String,
    /// Position in the list of rasterized triangles, if it got that far.
    pub submission: Option<usize>,
    /// Why, in a word.
    pub cause: Cause,
    /// Why, in one sentence with the number that decided. It begins with “covers”, “misses” or the like: the triangle is
    /// the subject.
    pub reason: String,
    /// Corners on the screen in px, as coverage was decided or would have been; none where it has no place there.
    pub corners_px: Option<[[f32; 2]; 3]>,
    /// Distance from the pixel's centre to the triangle in px, where that is outside. Between the snapped corners in fixed
    /// point: then numerator and denominator are exact integers, and only root and quotient are rounded.
    pub distance_px: Option<f64>,
    /// Edge values at the pixel's centre, in the unit of the arithmetic, where the triangle was rasterized.
    pub edges: Option<[f64; 3]>,
}

/// Replays pixel (x, y) of a frame as [`super::inspect`] does, and tells also which triangles have no fragment there, and
/// why. `None` outside of the picture. The survey must be of the same frame.
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
    use crate::inspect::Outcome;
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
    fn each_fragment_begins_where_the_last_one_ended_and_the_last_is_the_frame() {
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
            assert!(reports.iter().any(|r| r.fragments.iter().any(|f| f.outcome == Outcome::Overwritten)), "{id}");
        }
    }

    #[test]
    fn a_centre_on_an_edge_that_nobody_owns_is_told_as_a_tie() {
        let mut recipe = Recipe::default();
        recipe.pipeline.fill_rule = FillRule::Exclusive;
        let (_, reports) = reports("shared-edges", &recipe);
        let tie = reports.iter().find(|r| r.fragments.is_empty() && r.absent.iter().any(|a| a.cause == Cause::Tie));
        let verdict = &tie.unwrap().verdict;
        assert!(verdict.contains("(value 0), which the fill rule “Exclusive” does not give to it"), "{verdict}");
    }

    #[test]
    fn what_a_published_rasterizer_leaves_out_is_told_by_its_name() {
        let mut recipe = Recipe::default();
        recipe.pipeline.rasterizer = Rasterizer::BoundingBoxPublished;
        let (_, reports) = reports("triangle", &recipe);
        let left_out = reports.iter().flat_map(|r| &r.absent).find(|a| a.cause == Cause::LeftOut).unwrap();
        assert!(left_out.reason.contains("left out by “Bounding box (as published)”"), "{}", left_out.reason);
    }

    #[test]
    fn with_sound_settings_every_near_miss_has_a_negative_edge_and_they_come_sorted() {
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
                assert!(report.absent.iter().all(|a| a.cause != Cause::LeftOut), "{id}");
                assert!(report.absent.iter().all(|a| report.fragments.iter().all(|f| f.triangle != a.triangle)));
            }
            assert!(count > 1000, "{id} {count}");
        }
    }
}
