//! Tests of properties that all lab pages share, and of expected results of single pages.

use std::collections::HashSet;

use super::recording::{Ink, Mark, Recording, Tone};
use super::*;
use crate::flat2d::line::midpoint_line;
use crate::lab::lines::LineMethod;
use crate::lab::polygons::{PolygonMethod, PolygonPreset};
use crate::lab::primitives::{PrimitiveKind, VertexPreset};
use crate::lab::sampling::{SamplingMethod, SamplingScene};
use crate::lab::seed_fills::{FillOrder, Neighbours, Paint, SeedFillPreset};
use crate::lab::triangles::TriangleView;
use crate::pipeline::settings::{FillRule, Rasterizer};

fn fact<'a>(recording: &'a Recording, name: &str) -> &'a str {
    let found = recording.facts.iter().find(|(known, _)| known == name);
    &found.unwrap_or_else(|| panic!("no {name} in {:?}", recording.facts)).1
}

fn pixels(recording: &Recording) -> HashSet<(i64, i64)> {
    recording.steps.iter().flat_map(|step| &step.cells).map(|cell| (cell.x, cell.y)).collect()
}

#[test]
fn every_page_has_steps_with_a_description_and_a_state() {
    for page in Page::ALL {
        let lesson = Lesson::new(*page);
        assert_eq!(lesson.page(), *page);
        let recording = lesson.record();
        assert!(recording.steps.len() > 5, "{page:?}");
        for step in &recording.steps {
            assert!(step.description.ends_with('.') && !step.state.is_empty(), "{page:?}: {step:?}");
        }
        assert!(lesson.explanation().len() > 150 && lesson.walk() > 0 && !recording.facts.is_empty(), "{page:?}");
        assert!(!lesson.explanation().contains("  "), "{page:?}");
        let all = recording.cells(usize::MAX).count();
        assert!(recording.cells(1).count() < all && recording.cells(0).count() == recording.ground.len());
        let drawing = drawing::drawing(&recording, recording.steps.len());
        assert!(drawing.shapes.len() > all / 2);
    }
}

#[test]
fn handles_move_to_where_they_are_dragged_and_never_break_a_page() {
    let mut random = fastrand::Rng::with_seed(11);
    for page in Page::ALL {
        let mut lesson = Lesson::new(*page);
        for _ in 0..60 {
            let handles = lesson.handles();
            let handle = random.usize(0..handles.len());
            let to = DVec2::new(f64::from(random.i32(-10..50)) + 0.5, f64::from(random.i32(-10..40)) + 0.5);
            lesson.move_handle(handle, to);
            let recording = lesson.record();
            assert!(recording.steps.iter().all(|step| !step.description.is_empty()));
        }
    }
}

#[test]
fn all_line_methods_show_the_line_between_whole_ends() {
    let expected: HashSet<_> = midpoint_line((3, 4), (31, 16)).collect();
    for method in LineMethod::ALL.iter().filter(|method| method.weight().is_none()) {
        let recording = LineLesson { method: *method, ..LineLesson::default() }.record();
        let found = pixels(&recording);
        let beside = found.difference(&expected).count();
        assert!(beside <= 2 || *method == LineMethod::Distance, "{method:?}: {beside}");
    }
    let drift = |method| {
        fact(&LineLesson { method, ..LineLesson::default() }.record(), "drift at 1000 × the length").replace('−', "-")
    };
    let px = |method| drift(method).trim_end_matches(" px").parse::<f64>().unwrap().abs();
    assert!(px(LineMethod::Addition) > 5.0 * px(LineMethod::Intersection), "{}", drift(LineMethod::Addition));
    let open = LineLesson { last_pixel: false, ..LineLesson::default() }.record();
    assert_eq!(pixels(&open).len() + 1, expected.len());
    for method in [LineMethod::AreaBox, LineMethod::AreaPyramid, LineMethod::AreaCone] {
        let recording = LineLesson { method, ..LineLesson::default() }.record();
        let sum: f64 = fact(&recording, "sum of shares").parse().unwrap();
        let length = DVec2::new(28.0, 12.0).length();
        assert!((sum / length - 1.0).abs() < 0.02, "{method:?}: {sum} of {length}");
    }
}

#[test]
fn pixels_that_the_other_direction_covers_are_outlined_unless_ties_do_not_depend_on_it() {
    // The line moves two columns per row, so every other column is a tie.
    let ends = [DVec2::new(4.0, 6.0), DVec2::new(24.0, 16.0)];
    let plain = LineLesson { ends, ..LineLesson::default() };
    let outlines = |lesson: &LineLesson| {
        lesson.record().figure.iter().filter(|mark| matches!(mark, Mark::Outline(_, Tone::A))).count()
    };
    let differing = |lesson: &LineLesson| fact(&lesson.record(), "pixels that differ when reversed").to_owned();
    assert_eq!((outlines(&plain), differing(&plain).as_str()), (10, "10"));
    let independent = LineLesson { direction_independent: true, ..plain };
    assert_eq!((outlines(&independent), differing(&independent).as_str()), (0, "0"));
    let back = LineLesson { ends: [ends[1], ends[0]], ..independent.clone() };
    assert_eq!(pixels(&independent.record()), pixels(&back.record()));
    assert!(back.record().steps.iter().any(|step| step.description.contains("a tie: diagonal step")));
}

#[test]
fn fills_reach_the_connected_region_only_with_the_right_connectivity() {
    for preset in SeedFillPreset::ALL {
        let (grid, seed) = preset.grid();
        for neighbours in Neighbours::ALL {
            let lesson = SeedFillLesson { grid: grid.clone(), seed, neighbours: *neighbours, ..Default::default() };
            let errors: Vec<_> = lesson.compare().methods.iter().map(|rival| rival.error).collect();
            let (right, wrong) = match neighbours {
                Neighbours::Four => (&errors[..2], &errors[2..]),
                Neighbours::Eight => (&errors[2..], &errors[..2]),
            };
            assert_eq!(right, [0.0, 0.0], "{preset:?} {neighbours:?}");
            let depends = matches!(preset, SeedFillPreset::DiagonalWall | SeedFillPreset::DiagonalRegion);
            assert_eq!(wrong.iter().all(|error| *error > 0.0), depends, "{preset:?} {neighbours:?}: {errors:?}");
        }
    }
}

#[test]
fn a_fan_fails_on_a_concave_outline_and_ear_clipping_does_not() {
    let errors = |preset: VertexPreset| {
        let lesson = PrimitiveLesson { vertices: preset.vertices(), kind: PrimitiveKind::Polygon };
        let comparison = Lesson::Primitives(lesson).compare().unwrap();
        comparison.methods.iter().map(|rival| rival.error).collect::<Vec<_>>()
    };
    assert_eq!(errors(VertexPreset::Ring), [0.0, 0.0]);
    let concave = errors(VertexPreset::Concave);
    assert!(concave[0] > 100.0 && concave[1] == 0.0, "{concave:?}");
    assert!(!Lesson::Primitives(PrimitiveLesson::default()).compare_is_possible());
}

#[test]
fn a_picture_becomes_the_input_of_the_pages_that_take_one() {
    let picture = Image::from_fn(60, 40, |x, _| if x < 30 { [0, 0, 0, 255] } else { [255, 255, 255, 255] });
    for page in Page::ALL {
        let mut lesson = Lesson::new(*page);
        let before = lesson.clone();
        let takes = matches!(page, Page::SeedFill | Page::Sampling);
        assert_eq!((lesson.set_picture(&picture), lesson != before), (takes, takes), "{page:?}");
    }
    let mut sampling = SamplingLesson { method: SamplingMethod::Point, ..SamplingLesson::default() };
    sampling.set_picture(&picture);
    // Half of the picture is black and half is white, so the sum is half the number of pixels. No pixel contains both
    // colours until the centre moves by a fraction of a pixel.
    assert_eq!(fact(&sampling.record(), "sum of the picture"), "864.00");
    assert_eq!(fact(&sampling.record(), "root mean square error"), "0.00000");
    sampling.middle.x += 0.25;
    assert_eq!(
        (fact(&sampling.record(), "sum of the picture"), fact(&sampling.record(), "true sum")),
        ("864.00", "855.00")
    );
}

#[test]
fn a_mask_is_listed_row_by_row() {
    for (method, side) in [(SamplingMethod::Blur, 3), (SamplingMethod::Motion, 5)] {
        let recording = SamplingLesson { method, ..SamplingLesson::default() }.record();
        let rows: Vec<_> = recording.facts.iter().filter(|(name, _)| name.starts_with("mask, row ")).collect();
        assert_eq!(rows.len(), side, "{method:?}");
        assert!(rows.iter().all(|(_, terms)| terms.matches('×').count() == side), "{method:?}: {rows:?}");
    }
}

#[test]
fn a_line_without_length_is_recorded_without_nan() {
    for method in LineMethod::ALL {
        for clip in [false, true] {
            let lesson = LineLesson { ends: [DVec2::new(7.0, 9.0); 2], method: *method, clip, ..LineLesson::default() };
            let recording = format!("{:?}", lesson.record());
            assert!(!recording.contains("NaN"), "{method:?}: {recording}");
        }
    }
}

#[test]
fn blur_is_compared_with_points_at_equal_time() {
    for scene in [SamplingScene::Edge, SamplingScene::ZonePlate, SamplingScene::Picture] {
        let comparison = SamplingLesson { scene, ..SamplingLesson::default() }.compare();
        assert!(comparison.note.is_some_and(|note| note.starts_with("At equal time: ")), "{scene:?}");
    }
}

#[test]
fn a_clipped_line_stays_in_its_frame() {
    let ends = [DVec2::new(-20.0, -3.0), DVec2::new(60.0, 30.0)];
    let clipped = LineLesson { ends, clip: true, ..LineLesson::default() }.record();
    let found = pixels(&clipped);
    assert!(!found.is_empty() && found.iter().all(|(x, y)| (4..32).contains(x) && (4..18).contains(y)), "{found:?}");
    let beside = LineLesson { ends: [DVec2::ZERO, DVec2::X * 9.0], clip: true, ..LineLesson::default() }.record();
    assert!(beside.steps.is_empty() && fact(&beside, "pixels").contains("misses"));
}

#[test]
fn the_middle_of_the_star_is_inside_by_one_rule_only() {
    let has_middle = |method| {
        let lesson = PolygonLesson { contours: PolygonPreset::Star.contours(), method, ..PolygonLesson::default() };
        pixels(&lesson.record()).contains(&(16, 12))
    };
    assert!(!has_middle(PolygonMethod::EvenOdd) && has_middle(PolygonMethod::NonZero));
}

#[test]
fn corners_are_added_to_the_nearest_side_and_removed_by_their_handle() {
    let mut lesson = PolygonLesson { contours: PolygonPreset::Hole.contours(), ..PolygonLesson::default() };
    lesson.add_corner(DVec2::new(16.0, 1.0));
    assert_eq!(lesson.contours[0][1], DVec2::new(16.0, 1.0));
    lesson.remove_corner(1);
    assert_eq!(lesson.contours, PolygonPreset::Hole.contours());
    (0..8).for_each(|_| lesson.remove_corner(0));
    assert!(lesson.contours.is_empty());
    assert_eq!(lesson.record().steps.len(), 0);
    lesson.add_corner(DVec2::ONE);
    lesson.add_contour();
    assert_eq!(lesson.contours.iter().map(Vec::len).collect::<Vec<_>>(), [1, 3]);
}

#[test]
fn both_failures_of_seed_fill_are_presets() {
    let filled = |preset: SeedFillPreset, neighbours| {
        let (grid, seed) = preset.grid();
        let [spans, by_pixels] = [FillOrder::Spans, FillOrder::Pixels].map(|order| {
            let lesson = SeedFillLesson { grid: grid.clone(), seed, neighbours, order, ..SeedFillLesson::default() };
            pixels(&lesson.record())
        });
        assert_eq!(spans, by_pixels);
        (spans, grid)
    };
    let (four, grid) = filled(SeedFillPreset::DiagonalWall, Neighbours::Four);
    let (eight, _) = filled(SeedFillPreset::DiagonalWall, Neighbours::Eight);
    let paper = grid.pixels().iter().filter(|paint| **paint == Paint::Paper).count();
    assert!(four.iter().all(|(x, y)| x + y < 22) && eight.len() == paper, "leaks");
    let (four, grid) = filled(SeedFillPreset::DiagonalRegion, Neighbours::Four);
    let (eight, _) = filled(SeedFillPreset::DiagonalRegion, Neighbours::Eight);
    let paper = grid.pixels().iter().filter(|paint| **paint == Paint::Paper).count();
    assert!(four.len() < paper / 2 && eight.len() == paper, "misses: {} and {} of {paper}", four.len(), eight.len());
}

#[test]
fn a_shared_side_is_drawn_once_by_sound_rules_and_not_by_others() {
    // The shared side runs from (25.5, 7.5) to (9.5, 23.5) and passes through a pixel centre in every row.
    let mut lesson = TriangleLesson::default();
    lesson.corners[2] = DVec2::new(9.5, 23.5);
    let reported = |rule| {
        let recording = TriangleLesson { rule, ..lesson.clone() }.record();
        [fact(&recording, "drawn twice"), fact(&recording, "missed on the shared edge")]
            .map(|n| n.parse::<u32>().unwrap())
    };
    assert_eq!(reported(FillRule::TopLeft), [0, 0]);
    assert!(reported(FillRule::Inclusive)[0] > 10 && reported(FillRule::Exclusive)[1] > 10);
}

#[test]
fn comparisons_find_errors_only_in_inexact_methods() {
    for page in Page::ALL {
        let Some(comparison) = Lesson::new(*page).compare() else { continue };
        assert!(comparison.methods.len() > 2, "{page:?}");
        assert!(
            comparison.methods.iter().all(|rival| rival.error.is_finite() && !rival.time.is_zero()),
            "{comparison:?}"
        );
    }
    let error =
        |comparison: &MethodComparison, name: &str| comparison.methods.iter().find(|r| r.name == name).unwrap().error;
    let lines = Lesson::new(Page::Lines).compare().unwrap();
    assert!(error(&lines, LineMethod::Exact.name()) <= 0.5 && error(&lines, LineMethod::Midpoint.name()) <= 0.5);
    let triangles = Lesson::new(Page::Triangles).compare().unwrap();
    for rasterizer in Rasterizer::correct() {
        assert_eq!(error(&triangles, rasterizer.name()), 0.0, "{rasterizer:?}");
    }
    assert!(error(&triangles, Rasterizer::ScanlinePublished.name()) > 0.0);
    let polygons = Lesson::new(Page::Polygons).compare().unwrap();
    assert_eq!(error(&polygons, "Active edges"), 0.0);
    let sampling = Lesson::new(Page::Sampling).compare().unwrap();
    let by = |method: SamplingMethod| error(&sampling, method.name());
    assert!(
        by(SamplingMethod::AreaBox) < by(SamplingMethod::Grid) && by(SamplingMethod::Grid) < by(SamplingMethod::Point)
    );
}

#[test]
fn the_compared_line_has_a_limited_length() {
    let of = |ends| LineLesson { ends, ..LineLesson::default() }.compare().task;
    assert_eq!(of([DVec2::new(3.0, 4.0), DVec2::new(31.0, 16.0)]), "a line of 1120 × 480 px");
    assert_eq!(of([DVec2::ZERO, DVec2::new(25.0, 100.0)]), "a line of 500 × 2000 px");
}

#[test]
fn sides_and_weights_of_a_triangle_are_those_of_its_edge_functions() {
    let lesson = TriangleLesson { view: TriangleView::EdgeB, ..TriangleLesson::default() };
    let recording = lesson.record();
    let positive: HashSet<_> =
        recording.ground.iter().filter(|cell| cell.ink == Ink::Side(true)).map(|cell| (cell.x, cell.y)).collect();
    assert!(pixels(&recording).is_subset(&positive) && positive.len() > pixels(&recording).len());
    let rows = TriangleLesson { view: TriangleView::Rows, ..TriangleLesson::default() }.record();
    let greatest: f64 = fact(&rows, "greatest difference").replace('−', "-").parse().unwrap();
    assert!(greatest < 1e-6, "{greatest}");
}

#[test]
fn a_wheel_that_turns_by_a_spoke_a_frame_seems_to_stand() {
    let scene = SamplingScene::Wheel;
    let lesson = SamplingLesson { scene, turns_per_frame: 0.125, ..SamplingLesson::default() };
    let recording = lesson.record();
    assert_eq!(fact(&recording, "apparent turns"), "0.000");
    assert_eq!(recording.steps[0].cells, recording.steps[1].cells);
    let backwards = SamplingLesson { turns_per_frame: 0.115, ..lesson }.record();
    assert_eq!(fact(&backwards, "apparent turns"), "−0.010");
}
