//! Measurement of clip-space triangles: pixels, weights and depths after clipping and projection.

use std::collections::BTreeMap;

use super::MeasureOutcome;
use crate::pipeline::raster::Span;
use crate::pipeline::settings::FillRule;
use crate::pipeline::viewport::Viewport;
use crate::report::stability::case::ClipSpace;
use crate::report::stability::metric::{Measures, Metric};
use crate::report::stability::oracle::{ClipTriangle, ExactRegion, error};
use crate::report::stability::spans::{difference, pixel_count};
use crate::report::stability::subject::ClipFragment;

/// Maximum number of fragments per triangle whose weights and depth are compared. More would take too long, because
/// exact rational arithmetic is slow.
const COMPARED: usize = 48;

/// Expected result of one triangle.
#[derive(Clone, Debug)]
pub(crate) struct ExpectedTriangle {
    triangle: Option<ClipTriangle>,
    region: ExactRegion,
    spans: Vec<Span>,
}

impl ExpectedTriangle {
    /// Returns the number of pixels that the triangle covers.
    pub(super) fn pixels(&self) -> u64 {
        pixel_count(&self.spans)
    }
}

pub(super) fn expected(case: &ClipSpace) -> Vec<ExpectedTriangle> {
    let viewport = Viewport { width: case.width, height: case.height };
    let decide = |corners: &[[f32; 4]; 3]| {
        let triangle = ClipTriangle::new(*corners, viewport);
        let region = triangle.as_ref().map(|t| t.region(FillRule::TopLeft)).unwrap_or_default();
        let spans = region.spans(viewport);
        ExpectedTriangle { triangle, region, spans }
    };
    case.triangles.iter().map(decide).collect()
}

/// Compares the fragments of each triangle with the expected ones.
pub(super) fn evaluate(
    expected: &[ExpectedTriangle],
    viewport: Viewport,
    answers: &[Vec<ClipFragment>],
) -> MeasureOutcome {
    let mut measures = Measures::default();
    let mut culprits = Vec::new();
    for (index, (right, fragments)) in expected.iter().zip(answers).enumerate() {
        let one = evaluate_one(right, viewport, fragments);
        if one.get(Metric::WrongStrict) > Some(0.0) || one.get(Metric::NotFinite) > Some(0.0) {
            culprits.push(index);
        }
        measures.join(&one);
    }
    MeasureOutcome::new(measures, culprits)
}

fn evaluate_one(right: &ExpectedTriangle, viewport: Viewport, fragments: &[ClipFragment]) -> Measures {
    let mut hits: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for fragment in fragments {
        *hits.entry(fragment.pixel).or_default() += 1;
    }
    let given: Vec<Span> = hits.keys().map(|[x, row]| Span { row: *row, left: *x, right: x + 1 }).collect();
    let wrong = difference(&right.spans, &given);
    let pixels = || wrong.iter().flat_map(|s| (s.left..s.right).map(|x| (x, s.row)));
    let inside = |(x, y): &(u32, u32)| *x < viewport.width && *y < viewport.height;
    let strict = pixels().filter(|p| !inside(p) || !right.region.is_borderline(p.0, p.1)).count();
    let doubles = hits.values().filter(|count| **count > 1).count();
    let mut measures = Measures::default()
        .with(Metric::Pixels, right.pixels() as f64)
        .with(Metric::WrongUnsnapped, pixel_count(&wrong) as f64)
        .with(Metric::WrongStrict, strict as f64)
        .with(Metric::Doubles, doubles as f64)
        .with(Metric::NotFinite, 0.0);
    if let Some(triangle) = &right.triangle {
        let step = fragments.len().div_ceil(COMPARED).max(1);
        for fragment in fragments.iter().step_by(step) {
            compare(triangle, &right.region, fragment, &mut measures);
        }
    }
    measures
}

/// Compares the weights and the depth of a fragment with the exact values. Skips fragments outside the triangle or too
/// close to its border.
fn compare(triangle: &ClipTriangle, region: &ExactRegion, fragment: &ClipFragment, measures: &mut Measures) {
    let [x, y] = fragment.pixel;
    if !region.contains(x, y) || region.is_borderline(x, y) {
        return;
    }
    let Some((weights, depth)) = triangle.at(x, y) else { return };
    measures.note(Metric::Samples, 1.0);
    let pairs = fragment.weights.iter().zip(&weights).map(|(given, right)| (Metric::WeightError, given, right));
    for (metric, given, right) in pairs.chain([(Metric::DepthError, &fragment.depth, &depth)]) {
        if given.is_finite() {
            measures.note(metric, error(*given, right));
        } else {
            measures.note(Metric::NotFinite, 1.0);
        }
    }
    let negative = fragment.weights.iter().any(|weight| *weight < 0.0);
    measures.note(Metric::NegativeWeights, u32::from(negative).into());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::stability::oracle::approximate;

    const VIEW: Viewport = Viewport { width: 16, height: 16 };

    /// Returns a case of two triangles: a floor with one vertex behind the eye, and a triangle whose coordinates are
    /// all zero.
    fn case() -> ClipSpace {
        let floor = [[-4.0, -1.0, 5.0, 5.1], [4.0, -1.0, 5.0, 5.1], [0.0, -1.0, -2.0, -1.9]];
        ClipSpace { width: 16, height: 16, triangles: vec![floor, [[0.0; 4]; 3]] }
    }

    /// Returns the expected fragments, rounded to f64.
    fn fragments(right: &ExpectedTriangle) -> Vec<ClipFragment> {
        let Some(triangle) = &right.triangle else { return Vec::new() };
        let pixels = right.spans.iter().flat_map(|s| (s.left..s.right).map(|x| [x, s.row]));
        let fragment = |pixel: [u32; 2]| {
            let (weights, depth) = triangle.at(pixel[0], pixel[1]).unwrap();
            ClipFragment { pixel, weights: weights.map(|w| approximate(&w)), depth: approximate(&depth) }
        };
        pixels.map(fragment).collect()
    }

    #[test]
    fn the_right_answer_has_no_fault_but_rounding() {
        let right = expected(&case());
        let answers: Vec<_> = right.iter().map(fragments).collect();
        let outcome = evaluate(&right, VIEW, &answers);
        let measures = outcome.measures.unwrap();
        assert!(measures.get(Metric::Pixels) > Some(50.0), "{measures:?}");
        for metric in [Metric::WrongUnsnapped, Metric::WrongStrict, Metric::Doubles, Metric::NotFinite] {
            assert_eq!(measures.get(metric), Some(0.0), "{metric:?}");
        }
        assert!(measures.get(Metric::WeightError).unwrap() < 1e-15);
        assert!(outcome.culprits.is_empty());
    }

    #[test]
    fn pixels_out_of_place_and_wrong_weights_are_found() {
        let right = expected(&case());
        let mut answers: Vec<_> = right.iter().map(fragments).collect();
        let (first, last) = (answers[0][0], answers[0].len() - 1);
        answers[0].push(first);
        answers[0][last].pixel = [0, 0];
        for fragment in &mut answers[0] {
            fragment.weights[0] += 0.25;
            fragment.depth = f64::NAN;
        }
        answers[1].push(ClipFragment { pixel: [9, 9], ..first });
        let outcome = evaluate(&right, VIEW, &answers);
        let measures = outcome.measures.unwrap();
        assert_eq!(measures.get(Metric::Doubles), Some(1.0));
        assert!(
            measures.get(Metric::WrongStrict) >= Some(2.0),
            "in the sky, and where there is no triangle: {measures:?}"
        );
        assert!((measures.get(Metric::WeightError).unwrap() - 0.25).abs() < 1e-15);
        assert!(measures.get(Metric::NotFinite) > Some(10.0));
        assert_eq!(outcome.culprits, [0, 1]);
    }
}
