//! Numerical cases, solved as by `rasterscope case` and checked against answers in exact arithmetic.
#![expect(clippy::print_stderr, reason = "prints how many cases were checked")]

use crate::internal::cases;
use std::collections::HashSet;

use crate::internal::cases::Sample;
use rasterscope::case::{Answer, Case, CaseOutcome, Control, Options, solve};
use rasterscope::pipeline::settings::{Arithmetic, Rasterizer};
use serde::de::DeserializeOwned;
use serde_json::Value;

/// Returns the answer to a case. Panics if the case is refused.
fn answer(sample: &Sample, options: Options) -> Answer {
    match outcome(sample, options) {
        CaseOutcome::Answered(answer) => answer,
        CaseOutcome::Refused { error } => panic!("{} refused: {error}", sample.path.display()),
    }
}

fn outcome(sample: &Sample, options: Options) -> CaseOutcome {
    let case = Case::read(&sample.path).unwrap_or_else(|error| panic!("{error}"));
    let result = solve(&case, options, &Control::default()).expect("nothing cancels it");
    assert_eq!(sample.case["id"], result.id);
    result.outcome
}

fn value<T: DeserializeOwned>(value: &Value) -> T {
    serde_json::from_value(value.clone()).unwrap_or_else(|error| panic!("{error}: {value}"))
}

/// Checks the answers to all cases of a kind, and prints the number of cases. Panics if a case is refused.
fn check_all(kind: &str, check: impl Fn(&Sample, Answer)) {
    let samples = cases::of_kinds(&[kind]);
    for sample in &samples {
        check(sample, answer(sample, Options::default()));
    }
    eprintln!("{} {kind} cases checked", samples.len());
}

fn set<T: std::hash::Hash + Eq + Copy + std::fmt::Debug>(list: &[T]) -> HashSet<T> {
    let set: HashSet<_> = list.iter().copied().collect();
    assert_eq!(set.len(), list.len(), "a pixel comes twice in {list:?}");
    set
}

/// Arithmetics with exact decisions, each with the key of its answers in the samples and the fraction bits of snapped
/// corners.
const EXACT: [(Arithmetic, &str, Option<u32>); 2] =
    [(Arithmetic::Exact, "none", None), (Arithmetic::Fixed, "8", Some(8))];

/// Returns the pixels of spans [row, first column, one past the last column]. Panics if a pixel is covered twice.
fn pixels(spans: &[[u32; 3]]) -> HashSet<(u32, u32)> {
    set(&spans.iter().flat_map(|[y, left, right]| (*left..*right).map(|x| (x, *y))).collect::<Vec<_>>())
}

#[test]
fn triangles_cover_the_exact_samples_by_every_sound_algorithm() {
    let samples = cases::of_kinds(&["tri_coverage"]);
    for sample in &samples {
        for (arithmetic, key, bits) in EXACT {
            // Answers of wide pictures are stored for unsnapped corners only.
            let Some(exact) = sample.expected["spans"].get(key) else { continue };
            let exact: Vec<Vec<[u32; 3]>> = value(exact);
            for rasterizer in Rasterizer::correct() {
                let options = Options { rasterizer, arithmetic };
                let Answer::TriCoverage(coverage) = answer(sample, options) else { panic!() };
                assert_eq!(coverage.snap_bits, bits);
                for (ours, exact) in coverage.triangles.iter().zip(&exact) {
                    assert_eq!(pixels(&ours.spans), pixels(exact), "{} {options:?}", sample.path.display());
                }
                assert_eq!(coverage.triangles.len(), exact.len());
            }
        }
    }
    eprintln!("{} tri_coverage cases checked by five algorithms in two kinds of arithmetic", samples.len());
}

#[test]
fn triangles_in_clip_space_cover_what_lies_clearly_inside() {
    let samples = cases::of_kinds(&["clip_tri"]);
    for sample in &samples {
        let exact: Vec<Vec<[u32; 3]>> = value(&sample.expected["spans"]);
        let borderline = pixels(&value::<Vec<[u32; 3]>>(&sample.expected["borderline"]));
        for (arithmetic, ..) in EXACT {
            for rasterizer in Rasterizer::correct() {
                let options = Options { rasterizer, arithmetic };
                let Answer::ClipTri(clipped) = answer(sample, options) else { panic!() };
                assert_eq!(clipped.triangles.len(), exact.len());
                for (ours, exact) in clipped.triangles.iter().zip(&exact) {
                    let (ours, exact) = (pixels(&ours.spans), pixels(exact));
                    let wrong: Vec<_> = ours.symmetric_difference(&exact).filter(|p| !borderline.contains(p)).collect();
                    assert!(wrong.is_empty(), "{} {options:?}: {wrong:?}", sample.path.display());
                }
                assert!(clipped.attr.iter().all(|a| [a.3, a.4, a.5, a.6].iter().all(|v| v.is_finite())));
            }
        }
    }
    eprintln!("{} clip_tri cases checked by five algorithms in two kinds of arithmetic", samples.len());
}

#[test]
fn weights_are_within_rounding_of_the_exact_ones() {
    // Edge function, area, reciprocal, product and sum: some roundings of numbers up to 1.
    const ROUNDINGS: f64 = 8.0 / 16_777_216.0;
    check_all("tri_attr", |sample, answer| {
        let Answer::TriAttr(attributes) = answer else { panic!() };
        let exact: Vec<[f64; 11]> = value(&sample.expected["pixels"]);
        assert_eq!(attributes.pixels.len(), exact.len());
        for (ours, exact) in attributes.pixels.iter().zip(&exact) {
            let weights = ours.affine_weights.iter().chain(&ours.perspective_weights);
            let off = weights.zip(&exact[2..8]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off <= ROUNDINGS, "{}: {off:e} at {:?}", sample.path.display(), ours.pixel);
        }
    });
}

#[test]
fn polygons_cover_the_exact_samples_as_given_and_snapped() {
    let samples = cases::of_kinds(&["poly_fill"]);
    for sample in &samples {
        for (arithmetic, key, bits) in EXACT {
            let Answer::PolyFill(polygon) = answer(sample, Options { arithmetic, ..Options::default() }) else {
                panic!()
            };
            let exact: Vec<[u32; 3]> = value(&sample.expected["spans"][key]);
            assert_eq!((polygon.spans, polygon.snap_bits), (exact, bits), "{} {arithmetic:?}", sample.path.display());
        }
    }
    eprintln!("{} poly_fill cases checked twice", samples.len());
}

#[test]
fn lines_are_those_of_the_midpoint_rule() {
    check_all("line", |sample, answer| {
        let Answer::Line(line) = answer else { panic!() };
        assert_eq!(line.pixels, value::<Vec<(i64, i64)>>(&sample.expected["pixels"]), "{}", sample.path.display());
    });
}

#[test]
fn real_lines_take_the_nearest_pixel_at_every_step() {
    check_all("real_line", |sample, answer| {
        let Answer::RealLine(line) = answer else { panic!() };
        let pixels = set(&line.pixels);
        let alternatives: Vec<Vec<(i64, i64)>> = value(&sample.expected["pixels"]);
        assert_eq!(pixels.len(), alternatives.len(), "{}", sample.path.display());
        for nearest in alternatives {
            let taken = nearest.iter().filter(|pixel| pixels.contains(pixel)).count();
            assert_eq!(taken, 1, "{}: of {nearest:?}", sample.path.display());
        }
    });
}

#[test]
fn lines_by_distance_are_closed() {
    check_all("distance_line", |sample, answer| {
        let Answer::DistanceLine(line) = answer else { panic!() };
        let inside: Vec<(u32, u32)> = value(&sample.expected["must"]);
        let on_border: Vec<(u32, u32)> = value(&sample.expected["tie"]);
        assert_eq!(set(&line.pixels), set(&[inside, on_border].concat()), "{}", sample.path.display());
    });
}

#[test]
fn circles_have_the_nearest_pixels_each_once() {
    check_all("circle", |sample, answer| {
        let Answer::Circle(circle) = answer else { panic!() };
        let exact: Vec<(i64, i64)> = value(&sample.expected["pixels"]);
        assert_eq!(set(&circle.pixels), set(&exact), "{}", sample.path.display());
    });
}

#[test]
fn regions_are_filled_to_their_borders() {
    check_all("region_fill", |sample, answer| {
        let Answer::RegionFill(region) = answer else { panic!() };
        assert_eq!(region.grid, value::<Vec<Vec<i64>>>(&sample.expected["grid"]), "{}", sample.path.display());
    });
}

#[test]
fn areas_are_right_to_the_last_bit() {
    check_all("tri_area", |sample, answer| {
        let Answer::TriArea(triangle) = answer else { panic!() };
        let mut areas = triangle.area;
        areas.sort_by_key(|(x, y, _)| (*x, *y));
        assert_eq!(areas, value::<Vec<(u32, u32, f64)>>(&sample.expected["area"]), "{}", sample.path.display());
    });
}

/// Tolerance of a filtered texture value, in codes: rounding of texture coordinates and weights to f32.
const TEXTURE_TOLERANCE: f64 = 1e-3;

#[test]
fn textures_read_as_the_exact_mixture() {
    check_all("texture", |sample, answer| {
        let Answer::Texture(texture) = answer else { panic!() };
        let exact: Vec<f64> = value(&sample.expected["values"]);
        assert_eq!(texture.values.len(), exact.len());
        for (index, (found, exact)) in texture.values.iter().zip(exact).enumerate() {
            let path = sample.path.display();
            assert!((found - exact).abs() < TEXTURE_TOLERANCE, "{path}: value {index} is {found}, not {exact}");
        }
    });
}

/// Tolerance of an upscaled value, in codes: rounding of the weights to f32, for values up to 255.
const UPSCALE_TOLERANCE: f64 = 1e-4;

/// Tolerance of an upscaled code against the exact value: half a code for rounding, and the error of fixed-point
/// weights.
const CODE_TOLERANCE: f64 = 0.6;

#[test]
fn enlarged_pictures_are_the_exact_ones() {
    let samples = cases::of_kinds(&["upscale"]);
    for sample in &samples {
        let path = sample.path.display();
        let CaseOutcome::Answered(Answer::Upscale(picture)) = outcome(sample, Options::default()) else {
            panic!("{path} is not answered");
        };
        let exact: Vec<Vec<f64>> = value(&sample.expected["values"]);
        assert_eq!((picture.values.len(), picture.codes.len()), (exact.len(), exact.len()), "{path}");
        for ((values, codes), exact) in picture.values.iter().zip(&picture.codes).zip(&exact) {
            assert_eq!((values.len(), codes.len()), (exact.len(), exact.len()), "{path}");
            for ((value, code), exact) in values.iter().zip(codes).zip(exact) {
                assert!((value - exact).abs() < UPSCALE_TOLERANCE, "{path}: {value}, not {exact}");
                let error = (f64::from(*code) - exact.clamp(0.0, 255.0)).abs();
                assert!(error < CODE_TOLERANCE, "{path}: code {code} for {exact}");
            }
        }
    }
    eprintln!("{} upscale cases checked", samples.len());
}
