//! Measurement of weights, depth and attributes at pixel centres.

use super::MeasureOutcome;
use crate::report::stability::metric::{Measures, Metric};
use crate::report::stability::oracle::{ExactSample, ScreenCorner, error, exact_sample, ulps};
use crate::report::stability::subject::Sampled;

/// Texture width by which errors of texture coordinates are multiplied to convert them to texels.
const TEXTURE_WIDTH: f64 = 1024.0;

/// Expected values at each evaluated pixel; `None` where the triangle has no area.
pub(super) type ExpectedSamples = Vec<Option<ExactSample>>;

pub(super) fn expected(corners: &[ScreenCorner; 3], eval: &[[u32; 2]]) -> ExpectedSamples {
    eval.iter().map(|[column, row]| exact_sample(corners, *column, *row)).collect()
}

/// Compares the samples of one or two triangles with the expected ones. Two triangles must be coplanar; their depths
/// should be equal.
pub(super) fn evaluate(expected: &[ExpectedSamples], answers: &[Vec<Sampled>]) -> MeasureOutcome {
    let mut all = Measures::default();
    let mut worst = (0.0, None);
    let count = answers.first().map_or(0, Vec::len);
    for index in 0..count {
        let mut here = Measures::default();
        for (right, given) in expected.iter().zip(answers) {
            if let (Some(Some(right)), Some(given)) = (right.get(index), given.get(index)) {
                here.join(&compare(right, given));
            }
        }
        let depths: Vec<f64> = answers.iter().filter_map(|given| Some(given.get(index)?.depth)).collect();
        if let [first, second] = depths[..] {
            here.note(Metric::Flips, u32::from(first != second).into());
        }
        let badness = badness(&here);
        if badness > worst.0 {
            worst = (badness, Some(index));
        }
        all.join(&here);
    }
    MeasureOutcome::new(all, worst.1.into_iter().collect())
}

/// Returns the severity of a sample's faults as a sort key. Non-finite values weigh most, then differing depths, then
/// errors of weights and texture coordinates, then depth errors.
fn badness(measures: &Measures) -> f64 {
    /// Weight of each non-finite value in the sort key. Exceeds any finite error.
    const NO_NUMBER: f64 = 1e300;
    /// Weight of differing depths in the sort key. Exceeds any relevant error of a weight, and any relevant error of a
    /// texture coordinate in texels.
    const FLIP: f64 = 1e9;
    let value = |metric| measures.get(metric).unwrap_or(0.0);
    value(Metric::NotFinite) * NO_NUMBER
        + value(Metric::Flips) * FLIP
        + value(Metric::WeightError)
        + value(Metric::UvTexels)
        + value(Metric::DepthUlp) * 1e-6
}

fn compare(right: &ExactSample, given: &Sampled) -> Measures {
    let broken = given.numbers().filter(|number| !number.is_finite()).count();
    let mut measures = Measures::default().with(Metric::Samples, 1.0).with(Metric::NotFinite, broken as f64);
    let affine = given.affine.iter().zip(&right.affine).map(|(given, right)| (Metric::AffineError, *given, right));
    let weights =
        given.weights.iter().zip(&right.perspective).map(|(given, right)| (Metric::WeightError, *given, right));
    for (metric, given, right) in affine.chain(weights).filter(|(_, given, _)| given.is_finite()) {
        measures.note(metric, error(given, right));
    }
    if given.depth.is_finite() {
        measures.note(Metric::DepthUlp, ulps(given.depth, &right.depth));
    }
    for (given, right) in given.uv.iter().zip(&right.uv).filter(|(given, _)| given.is_finite()) {
        measures.note(Metric::UvTexels, error(*given, right) * TEXTURE_WIDTH);
    }
    let sum = given.weights.iter().sum::<f64>();
    if sum.is_finite() {
        measures.note(Metric::SumError, (sum - 1.0).abs());
    }
    let negative = given.weights.iter().any(|weight| *weight < 0.0);
    measures.note(Metric::NegativeWeights, u32::from(negative).into());
    measures
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::stability::oracle::approximate;

    fn corners() -> [ScreenCorner; 3] {
        let at = |x, y, z, w| ScreenCorner { x, y, z, w, uv: [x * 100.0, y] };
        [at(1.0, 0.5, 0.25, 1.0), at(9.0, 2.25, 0.5, 4.0), at(3.5, 8.0, 0.75, 0.5)]
    }

    fn rounded(right: &ExactSample) -> Sampled {
        let near = |values: &[_; 3]| values.each_ref().map(approximate);
        Sampled {
            affine: near(&right.affine),
            weights: near(&right.perspective),
            depth: approximate(&right.depth),
            uv: right.uv.each_ref().map(approximate),
        }
    }

    fn right_and_rounded() -> (ExpectedSamples, Vec<Sampled>) {
        let right = expected(&corners(), &[[4, 3], [3, 4], [4, 2]]);
        let given = right.iter().flatten().map(rounded).collect();
        (right, given)
    }

    #[test]
    fn the_right_answer_has_no_fault_but_rounding() {
        let (right, given) = right_and_rounded();
        let measures = evaluate(&[right], &[given]).measures.unwrap();
        assert_eq!(measures.get(Metric::Samples), Some(3.0));
        assert!(measures.get(Metric::WeightError).unwrap() < 1e-15);
        assert!(measures.get(Metric::UvTexels).unwrap() < 1e-10);
        assert!(measures.get(Metric::DepthUlp).unwrap() < 1e-6);
        assert_eq!((measures.get(Metric::NotFinite), measures.get(Metric::Flips)), (Some(0.0), None));
    }

    #[test]
    fn each_error_is_found_where_it_is() {
        let (right, given) = right_and_rounded();
        let mut wrong = given.clone();
        wrong[1].weights[2] -= 2.0;
        wrong[1].uv[0] += 0.5;
        let outcome = evaluate(std::slice::from_ref(&right), std::slice::from_ref(&wrong));
        let measures = outcome.measures.unwrap();
        let near = |metric, value: f64| (measures.get(metric).unwrap() - value).abs() < 1e-9;
        assert!(near(Metric::WeightError, 2.0) && near(Metric::SumError, 2.0) && near(Metric::UvTexels, 512.0));
        assert_eq!((measures.get(Metric::NegativeWeights), outcome.culprits), (Some(1.0), vec![1]));
        wrong[2].affine = [f64::NAN; 3];
        let outcome = evaluate(&[right], &[wrong]);
        assert_eq!((outcome.measures.unwrap().get(Metric::NotFinite), outcome.culprits), (Some(3.0), vec![2]));
    }

    #[test]
    fn two_triangles_of_one_plane_flip_where_their_depths_differ() {
        let (right, given) = right_and_rounded();
        let mut other = given.clone();
        other[0].depth += 1e-12;
        let both = [right.clone(), right];
        let outcome = evaluate(&both, &[given, other]);
        let measures = outcome.measures.unwrap();
        assert_eq!((measures.get(Metric::Flips), measures.get(Metric::Samples)), (Some(1.0), Some(6.0)));
        assert_eq!(outcome.culprits, [0], "the sample that shows it");
    }
}
