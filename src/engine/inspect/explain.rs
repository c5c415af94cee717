//! Explanation of a pixel: its replay with the verdict, and with the triangles that have no fragment there.

use super::history::{self, Survey};
use super::hits::seam_fault_at;
use super::pixel::{PixelReport, replayed};
use super::verdict::verdict;
use crate::chain::{Frame, Recipe};
use crate::scene::Scene;

/// Replays pixel (x, y) of a frame and explains its colour. Returns `None` outside the picture.
///
/// # Examples
/// ```
/// use rasterscope_engine::chain::{Recipe, run};
/// use rasterscope_engine::inspect::{FragmentOutcome, inspect};
/// # use rasterscope_engine::pipeline::viewport::Viewport;
/// # use rasterscope_engine::scene::builtin;
///
/// let scene = builtin::by_id("interpenetrating").unwrap().build();
/// let (recipe, viewport) = (Recipe::default(), Viewport { width: 64, height: 36 });
/// let frame = run(&scene, &scene.home, &recipe, viewport, &mut ());
///
/// // Both triangles cover the pixel, and the one drawn last is nearer.
/// let report = inspect(&scene, &recipe, &frame, 32, 18).unwrap();
/// assert_eq!(report.color, frame.image().at(32, 18));
/// assert_eq!(report.fragments.len(), 2);
/// assert_eq!(report.fragments[0].outcome, FragmentOutcome::Overwritten);
/// assert_eq!(report.fragments[1].outcome, FragmentOutcome::Visible);
/// ```
pub fn inspect(scene: &Scene, recipe: &Recipe, frame: &Frame, x: u32, y: u32) -> Option<PixelReport> {
    let mut report = replayed(scene, recipe, frame, x, y)?;
    report.verdict = verdict(&report, scene, recipe, frame);
    Some(report)
}

/// Replays pixel (x, y) of a frame like [`inspect`], and adds the triangles without a fragment there, with
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
    report.absent = history::absent(scene, recipe, frame, survey, &report);
    report.verdict = verdict(&report, scene, recipe, frame);
    Some(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::run;
    use crate::inspect::FragmentOutcome;
    use crate::inspect::pixel::Cause;
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
