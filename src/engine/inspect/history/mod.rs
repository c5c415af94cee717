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

/// Returns the triangles without a fragment at the drawn pixel of a report, the most relevant causes first. The survey
/// must belong to the same frame.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::run;
    use crate::inspect::explain;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::{Camera, builtin};

    #[test]
    fn the_most_relevant_causes_come_first() {
        let scene = builtin::by_id("cubes").unwrap().build();
        // Near and far plane leave a thin slice of the cubes, so that both cut something away at many pixels.
        let near = scene.home.eye.distance(scene.home.target);
        let camera = Camera { near, far: 1.02 * near, ..scene.home };
        let (recipe, viewport) = (Recipe::default(), Viewport { width: 40, height: 28 });
        let frame = run(&scene, &camera, &recipe, viewport, &mut ());
        let survey = Survey::of(&scene, &recipe, &frame);
        let mut unsorted = 0;
        for pixel in (0..viewport.height).flat_map(|y| (0..viewport.width).map(move |x| (x, y))) {
            let report = explain(&scene, &recipe, &frame, &survey, pixel).unwrap();
            assert!(report.absent.is_sorted_by_key(|absent| absent.cause), "{pixel:?}");
            let dropped = survey.dropped_at(&scene, &recipe, &frame, pixel);
            unsorted += usize::from(!dropped.is_sorted_by_key(|absent| absent.cause));
        }
        assert!(unsorted > 20, "without sorting, {unsorted} pixels fail");
    }
}
