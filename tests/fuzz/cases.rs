//! Fuzz target: numerical cases of every kind with mutated values, lists and fields.

use std::path::Path;

use fastrand::Rng;
use rasterscope::case::{Answer, Case, CaseOutcome, Control, Options, Task, solve};
use rasterscope::pipeline::settings::{Arithmetic, Choice, Rasterizer};
use serde_json::Value;

use crate::fuzz::driver::{Failure, Target};
use crate::fuzz::images::check_message;
use crate::fuzz::input::Input;
use crate::fuzz::{mutate, seeds};

/// Name of the input file that contains the case.
const FILE: &str = "case.json";

/// Name of the input file that names the rasterizer and the arithmetic.
const OPTIONS: &str = "options.txt";

/// A valid case of each kind, as JSON.
const SEEDS: [&str; 15] = [
    r#"{"id": "a", "kind": "tri_coverage", "width": 32, "height": 24, "rule": "top_left", "triangles": [[[1, 2], [30.5, 4], [7, 22.25]]]}"#,
    r#"{"id": "a", "kind": "poly_fill", "width": 32, "height": 24, "rule": "even_odd", "center": 0.5, "contours": [[[1, 1], [30, 2], [4, 20], [9, 0.5]], [[3, 3], [9, 3], [6, 9]]]}"#,
    r#"{"id": "a", "kind": "tri_attr", "vertices": [{"x": 0, "y": 0, "z": 0.5, "w": 1, "u": 0, "v": 0}, {"x": 64, "y": 0, "z": 0.75, "w": 2, "u": 1, "v": 0}, {"x": 0, "y": 64, "z": 0.5, "w": 3, "u": 0, "v": 1}], "eval": [[0, 0], [5, 53], [400, 7]]}"#,
    r#"{"id": "a", "kind": "coplanar_pair", "first": [{"x": 0, "y": 0, "z": 0.5, "w": 1, "u": 0, "v": 0}, {"x": 64, "y": 0, "z": 0.75, "w": 2, "u": 1, "v": 0}, {"x": 0, "y": 64, "z": 0.5, "w": 3, "u": 0, "v": 1}], "second": [{"x": 64, "y": 64, "z": 0.5, "w": 1, "u": 0, "v": 0}, {"x": 64, "y": 0, "z": 0.75, "w": 2, "u": 1, "v": 0}, {"x": 0, "y": 64, "z": 0.5, "w": 3, "u": 0, "v": 1}], "eval": [[0, 0], [5, 53]]}"#,
    r#"{"id": "a", "kind": "clip_tri", "width": 32, "height": 24, "triangles": [[[0, 0, 0, 0], [1, 0, 0.5, 1], [0, 1, 0.5, -1]], [[-1, -1, 0.25, 1], [3, -1, 0.5, 2], [0, 1, 0.75, 1]]]}"#,
    r#"{"id": "a", "kind": "tri_area", "width": 16, "height": 16, "triangle": [[-1000000, 8], [1000000, 8], [8, 1000000]]}"#,
    r#"{"id": "a", "kind": "line", "p0": [0, 0], "p1": [40, -19], "last_pixel": true}"#,
    r#"{"id": "a", "kind": "real_line", "p0": [20.5, 5.25], "p1": [4, -5.5]}"#,
    r#"{"id": "a", "kind": "distance_line", "width": 32, "height": 32, "p0": [0, 0.5], "p1": [25, 7]}"#,
    r#"{"id": "a", "kind": "circle", "c": [3, -2], "r": 7}"#,
    r#"{"id": "a", "kind": "ellipse", "c": [3, -2], "a": 9, "b": 4}"#,
    r#"{"id": "a", "kind": "region_fill", "grid": [[1, 1, 1, 1], [1, 0, 0, 1], [1, 0, 1, 0], [1, 1, 0, 0]], "seed": [1, 1], "mode": "boundary", "connectivity": 8, "new": 7, "boundary": 1}"#,
    r#"{"id": "a", "kind": "depth", "mapping": "standard", "format": "unorm24", "near": 1, "far": 1000, "z": [1, 1.5, 1.5001, 20, 999, 1000]}"#,
    r#"{"id": "a", "kind": "texture", "texels": [[0, 37, 74], [101, 151, 201]], "filter": "bilinear", "address": "wrap", "uv": [[0.5, 0.25], [-99.8, 1e9]]}"#,
    r#"{"id": "a", "kind": "upscale", "image": [[5, 200], [17, 0]], "scale": 2, "kernel": "mitchell", "phase": "center"}"#,
];

/// Fuzz target that solves mutated numerical cases.
pub(crate) struct Cases;

impl Target for Cases {
    fn name(&self) -> &'static str {
        "cases"
    }

    fn generate(&self, rng: &mut Rng) -> Input {
        let saved = seeds::files("cases", |suffix| suffix == "json");
        let text = if saved.is_empty() || rng.bool() {
            mutate::word(rng, &SEEDS).as_bytes()
        } else {
            &mutate::pick(rng, saved).1
        };
        let mut text = text.to_vec();
        if let Ok(mut case) = serde_json::from_slice::<Value>(&text) {
            mutate::json(rng, &mut case);
            mutate::shrink_sizes(&mut case);
            text = format!("{case:#}").into_bytes();
        }
        if rng.u8(..8) == 0 {
            mutate::bytes(rng, &mut text);
        }
        let [rasterizer, arithmetic] =
            [mutate::pick(rng, Rasterizer::ALL).id(), mutate::pick(rng, Arithmetic::ALL).id()];
        Input::file(FILE, text).with(OPTIONS, format!("{rasterizer}\n{arithmetic}\n"))
    }

    fn run(&self, folder: &Path) -> Result<(), Failure> {
        let options = options(&std::fs::read_to_string(folder.join(OPTIONS)).unwrap_or_default());
        let case = match Case::read(&folder.join(FILE)) {
            Ok(case) => case,
            Err(error) => return check_message(&error.to_string(), FILE),
        };
        let Some(result) = solve(&case, options, &Control::default()) else { return Ok(()) };
        if let Err(error) = serde_json::to_writer(std::io::sink(), &result) {
            return Err(Failure::Wrong(format!("result cannot be written: {error}")));
        }
        match &result.outcome {
            CaseOutcome::Answered(answer) => check(&case.task, answer),
            CaseOutcome::Refused { error } => check_message(error, ""),
        }
    }
}

/// Checks that spans and pixels of an answer lie within the picture of the case, and that areas are in [0, 1].
fn check(task: &Task, answer: &Answer) -> Result<(), Failure> {
    let (width, height, spans): (_, _, Vec<[u32; 3]>) = match (task, answer) {
        (Task::TriCoverage(case), Answer::TriCoverage(answer)) => {
            (case.width, case.height, answer.triangles.iter().flat_map(|triangle| triangle.spans.clone()).collect())
        }
        (Task::PolyFill(case), Answer::PolyFill(answer)) => (case.width, case.height, answer.spans.clone()),
        (Task::ClipTri(case), Answer::ClipTri(answer)) => {
            (case.width, case.height, answer.triangles.iter().flat_map(|triangle| triangle.spans.clone()).collect())
        }
        (Task::DistanceLine(case), Answer::DistanceLine(answer)) => {
            (case.width, case.height, answer.pixels.iter().map(|(x, y)| [*y, *x, x + 1]).collect())
        }
        (Task::TriArea(case), Answer::TriArea(answer)) => {
            if let Some((.., area)) = answer.area.iter().find(|(.., area)| !(0.0..=1.0 + 1e-9).contains(area)) {
                return Err(Failure::Wrong(format!("area: {area} of a pixel")));
            }
            (case.width, case.height, answer.area.iter().map(|(x, y, _)| [*y, *x, x + 1]).collect())
        }
        _ => return Ok(()),
    };
    match spans.iter().find(|[row, left, right]| *row >= height || left >= right || *right > width) {
        None => Ok(()),
        Some(span) => Err(Failure::Wrong(format!("span outside of the picture: {span:?} of {width} × {height}"))),
    }
}

/// Parses the ids of the rasterizer and the arithmetic, one per line; a missing one has its default.
fn options(text: &str) -> Options {
    let default = Options::default();
    Options {
        rasterizer: named(text).unwrap_or(default.rasterizer),
        arithmetic: named(text).unwrap_or(default.arithmetic),
    }
}

fn named<C: Choice>(text: &str) -> Option<C> {
    C::ALL.iter().copied().find(|choice| text.lines().any(|line| line == choice.id()))
}

#[test]
fn there_is_a_valid_case_of_every_kind() {
    for (kind, seed) in Task::KINDS.iter().zip(SEEDS) {
        let case = Case::parse(seed.as_bytes(), Path::new(FILE)).unwrap_or_else(|error| panic!("{kind}: {error}"));
        assert!(seed.contains(&format!("\"{kind}\"")), "{seed} instead of a case of the kind {kind}");
        let result = solve(&case, Options::default(), &Control::default()).expect("nothing cancels it");
        assert!(matches!(result.outcome, CaseOutcome::Answered(_)), "{result:?}");
    }
    assert_eq!(Task::KINDS.len(), SEEDS.len());
}
