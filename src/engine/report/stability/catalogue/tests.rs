use std::collections::BTreeSet;

use num_rational::BigRational;
use num_traits::Zero as _;

use super::*;
use crate::pipeline::settings::FillRule;
use crate::report::stability::case::Coverage;
use crate::report::stability::oracle::{ClipTriangle, ExactRegion, ScreenCorner, Snap, exact};
use crate::report::stability::spans::{HitCounts, pixel_count};

const SEED: u64 = 1;

/// Returns all cases of a family.
fn cases_of(family: Family) -> Vec<StabilityCase> {
    all().filter(|class| class.family == family).flat_map(|class| class.cases(SEED)).collect()
}

fn coverage_cases() -> impl Iterator<Item = (String, Coverage)> {
    let families = [Family::Coverage, Family::Mesh, Family::Throughput].into_iter();
    families.flat_map(cases_of).filter_map(|case| match case.body {
        Body::TriCoverage(coverage) => Some((case.id, coverage)),
        _ => None,
    })
}

/// Returns the triangles of all coverage cases whose id starts with `id`.
fn triangles_of(id: &str) -> Vec<[[f32; 2]; 3]> {
    let cases = coverage_cases().filter(|(case, _)| case.starts_with(id));
    cases.flat_map(|(_, coverage)| coverage.triangles).collect()
}

fn covered(corners: [[f32; 2]; 3], snap: Snap) -> u64 {
    pixel_count(
        &ExactRegion::triangle(corners, snap, FillRule::TopLeft)
            .spans(crate::pipeline::viewport::Viewport { width: 32, height: 32 }),
    )
}

#[test]
fn classes_have_unique_names_and_one_sentence_each() {
    let ids: BTreeSet<_> = all().map(|class| class.id).collect();
    assert_eq!(ids.len(), all().count());
    assert!(ids.len() >= 20, "only {} classes", ids.len());
    for class in all() {
        assert!(class.id.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{}", class.id);
        assert!(class.about.ends_with(['.', '?']) && class.about.len() > 60, "{}: {}", class.id, class.about);
        assert_eq!(by_id(class.id).map(|found| found.name), Some(class.name));
    }
    assert!(by_id("none").is_none());
    for family in Family::ALL {
        assert!(all().any(|class| class.family == family), "{}", family.name());
    }
}

#[test]
fn every_class_has_several_cases_that_depend_on_the_seed_alone() {
    for class in all() {
        let cases = class.cases(SEED);
        let parts: usize = cases.iter().map(StabilityCase::triangle_count).sum::<usize>().max(cases.len());
        assert!(cases.len() >= 3 || parts > 10, "{}: {} cases", class.id, cases.len());
        let again = class.cases(SEED);
        assert_eq!(format!("{again:?}"), format!("{cases:?}"), "{}", class.id);
        let other = class.cases(SEED + 1);
        assert_ne!(
            format!("{:?}", other.iter().map(|c| &c.body).collect::<Vec<_>>()),
            format!("{:?}", cases.iter().map(|c| &c.body).collect::<Vec<_>>()),
            "{}",
            class.id
        );
        let ids: BTreeSet<_> = cases.iter().map(|case| &case.id).collect();
        assert_eq!(ids.len(), cases.len(), "{}", class.id);
    }
}

#[test]
fn every_case_round_trips_as_json() {
    for case in all().flat_map(|class| class.cases(SEED)) {
        let read: StabilityCase = serde_json::from_str(&case.to_json()).unwrap_or_else(|e| panic!("{}: {e}", case.id));
        assert_eq!(format!("{read:?}"), format!("{case:?}"));
    }
}

#[test]
fn meshes_cover_every_pixel_exactly_once() {
    for (id, coverage) in coverage_cases().filter(|(_, coverage)| coverage.exactly_once) {
        let viewport = crate::pipeline::viewport::Viewport { width: coverage.width, height: coverage.height };
        for snap in [Snap::Unsnapped, Snap::Grid256] {
            let mut hits = HitCounts::none(viewport);
            for triangle in &coverage.triangles {
                hits.add(&ExactRegion::triangle(*triangle, snap, coverage.rule).spans(viewport));
            }
            assert_eq!((hits.cracks(), hits.doubles()), (0, 0), "{id} {snap:?}");
        }
    }
}

#[test]
fn near_ties_are_near_and_no_ties() {
    let misses = |corners: &[[f32; 2]; 3]| {
        let [open, closed] = [FillRule::Exclusive, FillRule::Inclusive].map(|rule| {
            let view = crate::pipeline::viewport::Viewport { width: 32, height: 32 };
            pixel_count(&ExactRegion::triangle(*corners, Snap::Unsnapped, rule).spans(view))
        });
        // Without the tiny offsets, some pixel centres lie exactly on an edge (ties); with the offsets, none does.
        let flattened = corners.map(|corner| corner.map(|c| if c.abs() < 1e-12 { 0.0 } else { c }));
        open == closed && covered(flattened, Snap::Unsnapped) != covered(*corners, Snap::Unsnapped)
    };
    let triangles = triangles_of("near-ties");
    let near = triangles.iter().filter(|t| misses(t)).count();
    assert!(near >= triangles.len() / 4, "{near} of {}", triangles.len());
}

#[test]
fn slivers_and_needles_vanish_when_snapped_and_are_there_when_not() {
    for class in ["slivers", "needles"] {
        let triangles = triangles_of(class);
        let lost = triangles.iter().filter(|t| covered(**t, Snap::Unsnapped) > 0 && covered(**t, Snap::Grid256) == 0);
        assert!(lost.count() > 3, "{class}");
    }
}

#[test]
fn degenerate_triangles_cover_nothing_or_next_to_it() {
    let all: u64 = triangles_of("degenerate").into_iter().map(|t| covered(t, Snap::Unsnapped)).sum();
    assert!(all <= 30, "{all} px");
    let tiny = triangles_of("tiny");
    let empty = tiny.iter().filter(|t| covered(**t, Snap::Unsnapped) == 0).count();
    assert!(empty * 2 > tiny.len() && empty < tiny.len(), "{empty} of {} are empty", tiny.len());
}

#[test]
fn triangles_in_clip_space_show_what_their_class_promises() {
    let (mut behind, mut seen, mut broken) = (0, 0, 0);
    for case in cases_of(Family::ClipSpace) {
        let viewport = case.viewport().unwrap();
        let Body::ClipTri(clip) = &case.body else { panic!("{} is of another kind", case.id) };
        for corners in &clip.triangles {
            let triangle = ClipTriangle::new(*corners, viewport);
            behind += u32::from(corners.iter().any(|c| c[3] <= 0.0));
            broken += u32::from(corners.iter().flatten().any(|c| !c.is_finite()));
            let spans = triangle.map(|t| t.region(FillRule::TopLeft).spans(viewport)).unwrap_or_default();
            seen += u32::from(!spans.is_empty());
        }
    }
    assert!(behind > 20 && seen > 20 && broken >= 12, "{behind} behind, {seen} seen, {broken} broken");
}

#[test]
fn samples_lie_inside_and_corners_on_the_grid() {
    let inside = |corners: &[ScreenCorner; 3], [column, row]: [u32; 2]| {
        let on_grid = corners.iter().flat_map(|c| [c.x, c.y]).all(|c| (c * 256.0).fract() == 0.0);
        on_grid
            && ExactRegion::triangle(corners.map(|c| [c.x, c.y]), Snap::Grid256, FillRule::TopLeft)
                .contains(column, row)
    };
    for case in cases_of(Family::Weights) {
        let (all_inside, samples) = match &case.body {
            Body::TriAttr(body) => (body.eval.iter().all(|p| inside(&body.vertices, *p)), body.eval.len()),
            Body::CoplanarPair(body) => {
                (body.eval.iter().all(|p| inside(&body.first, *p) && inside(&body.second, *p)), body.eval.len())
            }
            _ => panic!("{} is of another kind", case.id),
        };
        assert!(all_inside && samples > 0, "{}", case.id);
    }
}

#[test]
fn coplanar_triangles_lie_in_one_plane() {
    let point = |c: &ScreenCorner| [c.x, c.y, c.z].map(|value| exact(value).unwrap());
    let mut checked = 0;
    for case in by_id("coplanar").unwrap().cases(SEED) {
        let Body::CoplanarPair(pair) = &case.body else { panic!("{} is of another kind", case.id) };
        let [a, b, c] = pair.first.each_ref().map(point);
        for corner in &pair.second {
            let d = point(corner);
            let [u, v, w] = [&b, &c, &d].map(|p| [0, 1, 2].map(|axis| &p[axis] - &a[axis]));
            let volume: BigRational = (&u[1] * &v[2] - &u[2] * &v[1]) * &w[0]
                + (&u[2] * &v[0] - &u[0] * &v[2]) * &w[1]
                + (&u[0] * &v[1] - &u[1] * &v[0]) * &w[2];
            assert!(volume.is_zero(), "{}", case.id);
            checked += 1;
        }
    }
    assert!(checked >= 24);
}

#[test]
fn distances_ascend_between_their_planes() {
    let mut neighbours = 0;
    for case in cases_of(Family::Depth) {
        let Body::Depth(depth) = &case.body else { continue };
        assert!(depth.z.is_sorted_by(|a, b| a < b), "{}", case.id);
        assert!(depth.z.iter().all(|z| (depth.near..=depth.far.unwrap()).contains(z)), "{}", case.id);
        neighbours += depth.z.windows(2).filter(|pair| pair[1] / pair[0] < 1.0 + 3e-4).count();
    }
    assert!(neighbours > 500, "{neighbours}");
}
