//! Depths that the depth buffer stores, checked against exact arithmetic and against theory.
#![expect(clippy::print_stderr, reason = "prints what was checked, with figures")]

use crate::internal::cases;
use std::collections::BTreeMap;

use rasterscope::pipeline::depth::DepthScale;
use rasterscope::pipeline::depth_format::DepthEncoding;
use rasterscope::scene::DepthMapping;
use serde_json::Value;

/// Largest allowed error of a stored float, in ulps. Rounding to f32 contributes ½, and each of the three preceding
/// roundings in f64 contributes 2⁻²⁹, doubled because ulps are relative to the lower end of a power of two.
const MAX_ULP: f64 = 0.5 + 6.0 / (1 << 29) as f64;

/// Statistics of all cases of one depth mapping and encoding.
#[derive(Default)]
struct Figures {
    cases: usize,
    pairs: usize,
    ties: usize,
    inversions: usize,
    /// Largest error of stored floats, in ulps; `None` for integer encodings.
    max_ulp: Option<f64>,
}

fn mapping(case: &Value) -> DepthMapping {
    match case["mapping"].as_str() {
        Some("standard") => DepthMapping::STANDARD,
        Some("reversed") => DepthMapping::REVERSED,
        Some("reversed_inf") => DepthMapping::REVERSED_INFINITE,
        Some("linear") => DepthMapping::LINEAR,
        other => panic!("no such mapping: {other:?}"),
    }
}

fn encoding(case: &Value) -> DepthEncoding {
    match case["format"].as_str() {
        Some("f32") => DepthEncoding::F32,
        Some("unorm24") => DepthEncoding::Unorm24,
        Some("unorm16") => DepthEncoding::Unorm16,
        other => panic!("no such format: {other:?}"),
    }
}

fn numbers(list: &Value) -> Vec<f64> {
    serde_json::from_value(list.clone()).expect("a list of numbers")
}

/// Returns the spacing of f32 numbers at `value`.
fn ulp(value: f64) -> f64 {
    let float = value as f32;
    f64::from(float.next_up()) - f64::from(float)
}

#[test]
fn stored_depths_are_the_exact_ones_rounded_once() {
    let mut figures: BTreeMap<String, Figures> = BTreeMap::new();
    for cases::Sample { path, case, expected, .. } in cases::of_kinds(&["depth"]) {
        let (id, mapping, encoding) = (path.display(), mapping(&case), encoding(&case));
        let plane = |name: &str| case[name].as_f64().map_or(f32::INFINITY, |distance| distance as f32);
        let scale = DepthScale::perspective(mapping, encoding, plane("near"), plane("far"));
        let stored: Vec<f32> = numbers(&case["z"]).into_iter().map(|z| scale.stored(z as f32)).collect();
        let exact = numbers(&expected["depth"]);
        assert_eq!(stored.len(), exact.len(), "{id}");

        let ours = figures.entry(format!("{mapping:?} {encoding:?}")).or_default();
        for (stored, exact) in stored.iter().zip(exact) {
            assert!((0.0..=1.0).contains(stored), "{id}: {stored}");
            match encoding.largest_code() {
                None => {
                    let error = (f64::from(*stored) - exact).abs() / ulp(exact);
                    assert!(error <= MAX_ULP, "{id}: {stored} is {error} ulp from {exact}");
                    ours.max_ulp = Some(ours.max_ulp.unwrap_or_default().max(error));
                }
                Some(largest) => {
                    let code = (exact * f64::from(largest) + 0.5).floor();
                    assert_eq!(encoding.code(*stored).map(f64::from), Some(code), "{id}: {stored} for {exact}");
                }
            }
        }
        let steps: Vec<f32> = stored.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let ties = steps.iter().filter(|step| **step == 0.0).count();
        let inversions = steps.iter().filter(|step| (**step < 0.0) != mapping.is_reversed() && **step != 0.0).count();
        assert_eq!(inversions, 0, "{id}");
        assert_eq!(Some(ties as u64), expected["ideal"]["ties"].as_u64(), "{id}");
        ours.cases += 1;
        ours.pairs += steps.len();
        ours.ties += ties;
        ours.inversions += inversions;
    }
    for (name, Figures { cases, pairs, ties, inversions, max_ulp }) in figures {
        let error = max_ulp.map_or("every code exact".to_owned(), |error| format!("at most {error:.6} ulp off"));
        eprintln!("{name}: {cases} cases, {pairs} pairs, {ties} ties as ideal, {inversions} inversions, {error}");
    }
}

/// Returns the shares of ties and inversions among 200 000 pairs of distances z and z·(1 + gap). z is log-uniform
/// between the planes.
fn ties_and_inversions(scale: &DepthScale, reversed: bool, planes: [f32; 2], gap: f64) -> [f64; 2] {
    const PAIRS: u32 = 200_000;
    let mut random = fastrand::Rng::with_seed(25);
    let [near, far] = planes.map(f64::from);
    let mut counts = [0; 2];
    for _ in 0..PAIRS {
        let z = near * (far / (1.0 + gap) / near).powf(random.f64());
        let [a, b] = [z, z * (1.0 + gap)].map(|z| scale.stored(z as f32));
        counts[0] += u32::from(a == b);
        counts[1] += u32::from(if reversed { a < b } else { a > b });
    }
    counts.map(|count| f64::from(count) / f64::from(PAIRS))
}

/// Returns the share of ties that theory predicts for a standard depth buffer with uniform steps. Two depths that
/// differ by δ steps tie with probability 1 − δ if δ < 1, and δ(z) = c/z. The result is the mean of 1 − c/z over log z,
/// from c, or the near plane, to the far plane.
fn expected_ties(step: f64, [near, far]: [f32; 2], gap: f64) -> f64 {
    let [near, far] = [near, far].map(f64::from);
    let c = near * far / (far - near) * gap / (1.0 + gap) / step;
    let from = c.max(near);
    ((far / from).ln() - c * (1.0 / from - 1.0 / far)) / (far / near).ln()
}

/// Repeats the experiment of Upchurch and Desbrun, "Tightening the Precision of Perspective Rendering" (2012), for the
/// depth buffer: which formats still separate close surfaces.
#[test]
fn close_surfaces_tie_as_often_as_theory_says() {
    const PLANES: [f32; 2] = [0.1, 1e4];
    let share = |mapping, encoding, gap| {
        let scale = DepthScale::perspective(mapping, encoding, PLANES[0], PLANES[1]);
        let [ties, inversions] = ties_and_inversions(&scale, mapping.is_reversed(), PLANES, gap);
        eprintln!(
            "{mapping:?} {encoding:?}, gap {gap:e}: {:.2} % ties, {:.2} % inverted",
            ties * 1e2,
            inversions * 1e2
        );
        assert_eq!(inversions, 0.0, "{mapping:?} {encoding:?}");
        ties
    };
    // Floats in [0.5, 1) are spaced like integers of 24 bits, and distances below 2·near never tie.
    let step = |encoding: DepthEncoding| encoding.largest_code().map_or(1.0 / (1 << 24) as f64, |c| 1.0 / f64::from(c));
    for gap in [1e-3, 1e-4, 1e-5] {
        for encoding in [DepthEncoding::F32, DepthEncoding::Unorm24, DepthEncoding::Unorm16] {
            let expected = expected_ties(step(encoding), PLANES, gap);
            // Five standard deviations of a share of 200 000 pairs.
            let margin = 5.0 * (expected * (1.0 - expected) / 200_000.0).sqrt();
            let ties = share(DepthMapping::STANDARD, encoding, gap);
            assert!(
                (ties - expected).abs() < margin,
                "{encoding:?}, gap {gap:e}: {ties}, expected {expected} ± {margin}"
            );
        }
        // A relative difference of `gap` is many steps of a float, whose relative steps are at most 2⁻²³.
        for mapping in [DepthMapping::REVERSED, DepthMapping::REVERSED_INFINITE, DepthMapping::LINEAR] {
            assert_eq!(share(mapping, DepthEncoding::F32, gap), 0.0, "{mapping:?}");
        }
    }
    // The known results of the experiment.
    assert!((0.26..0.28).contains(&expected_ties(step(DepthEncoding::F32), PLANES, 1e-4)));
}
