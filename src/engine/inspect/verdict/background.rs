//! Explanation of a pixel that shows the background: its fragments were rejected, or no triangle covers it.

use super::count_triangles;
use crate::inspect::history::px;
use crate::inspect::pixel::{Absent, Cause, FragmentOutcome, FragmentRecord};

/// Explains a pixel whose fragments are all invisible. If the pixel has no fragments, names the most relevant triangle
/// that does not cover it, if known.
pub(super) fn verdict(fragments: &[FragmentRecord], absent: &[Absent]) -> String {
    let with = |outcome| count_triangles(fragments.iter().filter(|f| f.outcome == outcome));
    match (with(FragmentOutcome::DepthRejected), with(FragmentOutcome::AlphaRejected)) {
        (0, 0) => absence(absent),
        (1, 0) => "Background: the only triangle here failed the depth test.".to_owned(),
        (lost, 0) => format!("Background: all {lost} triangles here failed the depth test."),
        (0, 1) => "Background: the only triangle here failed the alpha test.".to_owned(),
        (0, gone) => format!("Background: all {gone} triangles here failed the alpha test."),
        (lost, gone) => {
            format!("Background: of the triangles here, {lost} failed the depth test and {gone} the alpha test.")
        }
    }
}

/// Explains why a pixel has no fragments. `absent` must be in the order of [`Cause`].
fn absence(absent: &[Absent]) -> String {
    let there = absent.iter().filter(|a| !matches!(a.cause, Cause::NotFinite | Cause::Missed));
    let nearest = absent.iter().find(|a| a.cause == Cause::Missed);
    if let Some(first) = there.clone().next() {
        let more = match there.filter(|a| a.cause == first.cause).count() - 1 {
            0 => String::new(),
            count => format!(" And {count} more for the same reason."),
        };
        return format!("Background: {} {}.{more}", name(first), without_area(&first.reason));
    }
    let never: Vec<_> = absent.iter().filter(|a| a.cause == Cause::NotFinite).collect();
    let unseen = match never.as_slice() {
        [] => String::new(),
        [only] => format!(" But {} {}.", name(only), only.reason),
        [first, ..] => format!(
            " But {} triangles have a NaN or infinite corner and are never drawn; the first is {}.",
            never.len(),
            name(first)
        ),
    };
    match nearest.and_then(|nearest| Some((nearest, nearest.distance_px?))) {
        Some((nearest, distance)) => {
            let distance = px(distance);
            format!(
                "Background: the nearest triangle, {} of “{}”, misses by {distance} px.{unseen}",
                nearest.triangle.0, nearest.instance
            )
        }
        None => format!("Background: no triangle covers this pixel's centre.{unseen}"),
    }
}

/// Returns `reason` without the triangle area in parentheses at its end, which matters only in the pixel history.
fn without_area(reason: &str) -> &str {
    reason.split_once(" (doubled area").map_or(reason, |(words, _)| words)
}

fn name(absent: &Absent) -> String {
    format!("triangle {} of “{}”", absent.triangle.0, absent.instance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::TriangleId;

    fn absent(triangle: u32, cause: Cause, reason: &str, distance_px: Option<f64>) -> Absent {
        Absent {
            triangle: TriangleId(triangle),
            instance: "wall".into(),
            submission: None,
            cause,
            reason: reason.into(),
            corners_px: None,
            distance_px,
            edges: None,
        }
    }

    #[test]
    fn culled_triangles_are_reported_before_near_misses() {
        let near = absent(9, Cause::Missed, "misses", Some(0.0039));
        let back = absent(12, Cause::BackFacing, "covers it, but is back-facing (doubled area 7 > 0)", None);
        assert_eq!(
            absence(&[back.clone(), near.clone()]),
            "Background: triangle 12 of “wall” covers it, but is back-facing."
        );
        let both = [back.clone(), absent(13, Cause::BackFacing, "", None), absent(2, Cause::NearPlane, "", None)];
        assert!(absence(&both).ends_with("is back-facing. And 1 more for the same reason."));
        assert_eq!(absence(&[near]), "Background: the nearest triangle, 9 of “wall”, misses by 0.0039 px.");
    }

    #[test]
    fn triangles_that_are_never_drawn_are_reported_last() {
        let never = absent(3, Cause::NotFinite, "has a NaN corner", None);
        assert_eq!(
            absence(std::slice::from_ref(&never)),
            "Background: no triangle covers this pixel's centre. But triangle 3 of “wall” has a NaN corner."
        );
        assert!(absence(&[never.clone(), never]).contains("2 triangles have a NaN or infinite corner"));
    }
}
