//! Validates the oracle of the stability report against answers of an independent oracle, which was written in another
//! language and uses other arithmetic.
#![expect(clippy::print_stderr, reason = "prints what was checked")]

use crate::internal::cases;
use crate::internal::samples;
use std::collections::BTreeSet;

use crate::internal::cases::Origin;
use rasterscope::pipeline::raster::Span;
use rasterscope::pipeline::settings::FillRule;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::report::stability::case::{AttributeCase, Body, ClipSpace, Coverage, DepthCase, StabilityCase};
use rasterscope::report::stability::catalogue;
use rasterscope::report::stability::oracle::{
    ClipTriangle, ExactRegion, Snap, approximate, exact_depth, exact_sample, ideal_code,
};
use rasterscope::report::stability::spans::HitCounts;
use rasterscope::report::stability::sweep::DEFAULT_SEED;
use serde_json::Value;

/// Relative tolerance for the stored answers, which are rounded to the nearest f64; the oracle under test divides
/// differently.
const FROZEN: f64 = 1e-15;

/// Returns the cases of a kind whose class starts with `prefix`, each with its origin and its answer.
fn cases_of(kind: &str, prefix: &str) -> Vec<(Origin, StabilityCase, Value)> {
    let all = cases::of_kinds(&[kind]).into_iter();
    let wanted = all.filter(|sample| sample.case["class"].as_str().is_some_and(|class| class.starts_with(prefix)));
    let read = |sample: cases::Sample| {
        let case = serde_json::from_value(sample.case);
        (sample.origin, case.unwrap_or_else(|e| panic!("{}: {e}", sample.path.display())), sample.expected)
    };
    wanted.map(read).collect()
}

fn spans(answer: &Value) -> Vec<Span> {
    let rows: Vec<[u32; 3]> = serde_json::from_value(answer.clone()).expect("spans");
    rows.into_iter().map(|[row, left, right]| Span { row, left, right }).collect()
}

fn pixels(spans: &[Span]) -> BTreeSet<[u32; 2]> {
    spans.iter().flat_map(|s| (s.left..s.right).map(|x| [x, s.row])).collect()
}

fn numbers(row: &Value) -> Vec<f64> {
    serde_json::from_value(row.clone()).expect("a row of numbers")
}

#[track_caller]
fn assert_near(id: &str, ours: f64, theirs: f64) {
    assert!((ours - theirs).abs() <= FROZEN * theirs.abs().max(1e-290), "{id}: {ours:e} is not {theirs:e}");
}

fn check_coverage(id: &str, case: &Coverage, answer: &Value) {
    let viewport = Viewport { width: case.width, height: case.height };
    for (name, snap) in [("none", Snap::Unsnapped), ("8", Snap::Grid256)] {
        let mut hits = HitCounts::none(viewport);
        let theirs = answer["spans"][name].as_array().expect("one list of spans per triangle");
        assert_eq!(theirs.len(), case.triangles.len());
        for (triangle, theirs) in case.triangles.iter().zip(theirs) {
            let ours = ExactRegion::triangle(*triangle, snap, case.rule).spans(viewport);
            assert_eq!(ours, spans(theirs), "{id} {snap:?} {triangle:?}");
            hits.add(&ours);
        }
        if case.exactly_once {
            let theirs = &answer["exactly_once"][name];
            assert_eq!(
                [hits.cracks(), hits.doubles()].map(Value::from),
                [theirs["cracks"].clone(), theirs["double"].clone()]
            );
        }
    }
    if let Some(theirs) = answer.get("borderline") {
        let regions: Vec<_> =
            case.triangles.iter().map(|t| ExactRegion::triangle(*t, Snap::Unsnapped, case.rule)).collect();
        check_borderline(id, &regions, viewport, theirs);
    }
}

fn check_borderline(id: &str, regions: &[ExactRegion], viewport: Viewport, theirs: &Value) {
    let all = (0..viewport.height).flat_map(|y| (0..viewport.width).map(move |x| [x, y]));
    let ours: BTreeSet<_> = all.filter(|[x, y]| regions.iter().any(|r| r.is_borderline(*x, *y))).collect();
    assert_eq!(ours, pixels(&spans(theirs)), "{id}");
}

fn check_clip_space(id: &str, case: &ClipSpace, answer: &Value) {
    let viewport = Viewport { width: case.width, height: case.height };
    let triangles: Vec<_> = case.triangles.iter().map(|t| ClipTriangle::new(*t, viewport)).collect();
    let region = |t: &Option<ClipTriangle>| t.as_ref().map(|t| t.region(FillRule::TopLeft)).unwrap_or_default();
    let regions: Vec<_> = triangles.iter().map(region).collect();
    for (index, region) in regions.iter().enumerate() {
        assert_eq!(region.spans(viewport), spans(&answer["spans"][index]), "{id} triangle {index}");
    }
    check_borderline(id, &regions, viewport, &answer["borderline"]);
    for row in answer["attr"].as_array().expect("rows of weights") {
        let row = numbers(row);
        let triangle = triangles[row[0] as usize].as_ref().expect("it covers a pixel");
        let (weights, depth) = triangle.at(row[1] as u32, row[2] as u32).expect("the pixel is covered");
        for (ours, theirs) in weights.iter().chain([&depth]).zip(&row[3..]) {
            assert_near(id, approximate(ours), *theirs);
        }
    }
}

fn check_attributes(id: &str, case: &AttributeCase, answer: &Value) {
    let rows = answer["pixels"].as_array().expect("rows of attributes");
    assert_eq!(rows.len(), case.eval.len());
    for ([x, y], row) in case.eval.iter().zip(rows) {
        let row = numbers(row);
        assert_eq!([row[0] as u32, row[1] as u32], [*x, *y]);
        let sample = exact_sample(&case.vertices, *x, *y).expect("a triangle with area");
        let ours = sample.affine.iter().chain(&sample.perspective).chain([&sample.depth]).chain(&sample.uv);
        for (ours, theirs) in ours.zip(&row[2..]) {
            assert_near(id, approximate(ours), *theirs);
        }
    }
}

fn check_depth(id: &str, case: &DepthCase, answer: &Value) {
    let exact = |z: &f32| exact_depth(case.mapping, case.near, case.far, *z).expect("a distance between the planes");
    let ours: Vec<_> = case.z.iter().map(exact).collect();
    for (ours, theirs) in ours.iter().zip(numbers(&answer["depth"])) {
        assert_near(id, approximate(ours), theirs);
    }
    let codes: Vec<_> = ours.iter().map(|value| ideal_code(case.format, value)).collect();
    let ties = codes.windows(2).filter(|pair| pair[0] == pair[1]).count();
    assert_eq!(Value::from(ties), answer["ideal"]["ties"], "{id}");
}

/// Checks all cases of a kind whose class starts with `prefix`. There must be at least `own` cases of the project, and
/// at least `external` ones if there are external samples.
fn check(kind: &str, prefix: &str, own: usize, external: usize) {
    let all = cases_of(kind, prefix);
    for (_, case, answer) in &all {
        match &case.body {
            Body::TriCoverage(body) => check_coverage(&case.id, body, answer),
            Body::ClipTri(body) => check_clip_space(&case.id, body, answer),
            Body::TriAttr(body) => check_attributes(&case.id, body, answer),
            Body::Depth(body) => check_depth(&case.id, body, answer),
            Body::CoplanarPair(_) | Body::DepthPairs(_) => panic!("{}: there are no answers to this", case.id),
        }
    }
    eprintln!("{} cases of {prefix}… agree", all.len());
    let count = |wanted: Origin| all.iter().filter(|(origin, ..)| *origin == wanted).count();
    let wanted_external = if samples::external().is_some() { external } else { 0 };
    for (origin, wanted) in [(Origin::Own, own), (Origin::External, wanted_external)] {
        assert!(count(origin) >= wanted, "only {} cases of {prefix}…: {origin:?}", count(origin));
    }
}

#[test]
fn single_triangles_cover_the_same_pixels() {
    check("tri_coverage", "cov_", 17, 138);
}

#[test]
fn meshes_cover_the_same_pixels() {
    check("tri_coverage", "mesh_", 5, 37);
}

#[test]
fn triangles_in_clip_space_show_the_same_pixels_weights_and_depths() {
    check("clip_tri", "clip", 9, 34);
}

#[test]
fn weights_depth_and_attributes_are_the_same() {
    check("tri_attr", "attr_", 8, 60);
}

#[test]
fn ideal_depth_buffers_hold_the_same_depths() {
    check("depth", "depth", 15, 42);
}

#[test]
fn the_catalogue_can_be_opened_as_case_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("case.json");
    let mut opened = 0;
    // Cases that are not finite, pairs of triangles and random pairs exist only in the report.
    for class in catalogue::all().filter(|class| !["not-finite", "coplanar", "depth-published"].contains(&class.id)) {
        for case in class.cases(DEFAULT_SEED) {
            std::fs::write(&path, case.to_json()).expect("a file");
            let read = rasterscope::case::Case::read(&path);
            assert_eq!(read.map(|read| read.id).map_err(|e| e.to_string()), Ok(case.id));
            opened += 1;
        }
    }
    assert!(opened > 200, "{opened}");
}
