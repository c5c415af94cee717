//! Measurement of covered pixels against the expected ones.

use super::MeasureOutcome;
use crate::pipeline::raster::Span;
use crate::pipeline::viewport::Viewport;
use crate::report::stability::case::Coverage;
use crate::report::stability::metric::{Measures, Metric};
use crate::report::stability::oracle::{ExactRegion, Snap};
use crate::report::stability::spans::{HitCounts, difference, pixel_count};

/// Maximum number of triangles that are reported as the cause of a fault.
const MAX_CULPRITS: usize = 4;

/// Expected pixels of each triangle.
#[derive(Clone, Debug)]
pub(crate) struct ExpectedCoverage {
    unsnapped: Vec<Vec<Span>>,
    snapped: Vec<Vec<Span>>,
}

impl ExpectedCoverage {
    pub(super) fn new(case: &Coverage) -> Self {
        let viewport = Viewport { width: case.width, height: case.height };
        let of =
            |snap| case.triangles.iter().map(|t| ExactRegion::triangle(*t, snap, case.rule).spans(viewport)).collect();
        Self { unsnapped: of(Snap::Unsnapped), snapped: of(Snap::Grid256) }
    }

    /// Returns the expected pixels of each triangle, with its vertices snapped as `snap` specifies.
    fn at(&self, snap: Snap) -> &[Vec<Span>] {
        match snap {
            Snap::Unsnapped => &self.unsnapped,
            Snap::Grid256 => &self.snapped,
        }
    }

    /// Returns the number of covered pixels, summed over all triangles.
    pub(super) fn pixels(&self, snap: Snap) -> u64 {
        self.at(snap).iter().map(|spans| pixel_count(spans)).sum()
    }
}

/// Compares the spans of each triangle with the expected ones. `snap` is the vertex snapping of the tested
/// configuration.
pub(super) fn evaluate(
    case: &Coverage,
    expected: &ExpectedCoverage,
    snap: Snap,
    answers: &[Vec<Span>],
) -> MeasureOutcome {
    let wrong_pixels = |snap: Snap| -> Vec<u64> {
        let pairs = expected.at(snap).iter().zip(answers);
        pairs.map(|(right, given)| pixel_count(&difference(right, given))).collect()
    };
    let (wrong, wrong_unsnapped) = (wrong_pixels(snap), wrong_pixels(Snap::Unsnapped));
    let mut measures = Measures::default()
        .with(Metric::Pixels, expected.pixels(Snap::Unsnapped) as f64)
        .with(Metric::Wrong, wrong.iter().sum::<u64>() as f64)
        .with(Metric::WrongUnsnapped, wrong_unsnapped.iter().sum::<u64>() as f64);
    let mut culprits = worst(&wrong);
    if case.exactly_once {
        let mut hits = HitCounts::none(Viewport { width: case.width, height: case.height });
        answers.iter().for_each(|spans| hits.add(spans));
        let (cracks, doubles) = (hits.cracks() as f64, hits.doubles() as f64);
        measures.note(Metric::Cracks, cracks);
        measures.note(Metric::Doubles, doubles);
        measures.note(Metric::Seams, cracks + doubles);
        if let Some(fault) = hits.first_fault() {
            culprits = around(fault, expected.at(snap), answers);
        }
    }
    if culprits.is_empty() {
        culprits = worst(&wrong_unsnapped);
    }
    MeasureOutcome::new(measures, culprits)
}

/// Returns the indices of up to [`MAX_CULPRITS`] triangles, those with the most wrong pixels first.
fn worst(wrong: &[u64]) -> Vec<usize> {
    let mut indices: Vec<usize> = (0..wrong.len()).filter(|index| wrong[*index] > 0).collect();
    indices.sort_by_key(|index| std::cmp::Reverse(wrong[*index]));
    indices.truncate(MAX_CULPRITS);
    indices
}

/// Returns the indices of up to [`MAX_CULPRITS`] triangles that cover a pixel or should cover it.
fn around((column, row): (u32, u32), expected: &[Vec<Span>], answers: &[Vec<Span>]) -> Vec<usize> {
    let holds = |spans: &Vec<Span>| spans.iter().any(|s| s.row == row && (s.left..s.right).contains(&column));
    let touching =
        (0..expected.len()).filter(|index| holds(&expected[*index]) || answers.get(*index).is_some_and(holds));
    touching.take(MAX_CULPRITS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::settings::FillRule;

    fn case(triangles: Vec<[[f32; 2]; 3]>, exactly_once: bool) -> Coverage {
        Coverage { width: 8, height: 8, rule: FillRule::TopLeft, triangles, exactly_once }
    }

    /// Returns a case of a square that fills the image, split into two triangles along a diagonal through pixel
    /// centres.
    fn square() -> Coverage {
        let [a, b, c, d] = [[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [0.0, 8.0]];
        case(vec![[a, b, c], [a, c, d]], true)
    }

    fn judged(case: &Coverage, snap: Snap, answers: &[Vec<Span>]) -> (Measures, Vec<usize>) {
        let outcome = evaluate(case, &ExpectedCoverage::new(case), snap, answers);
        (outcome.measures.unwrap(), outcome.culprits)
    }

    #[test]
    fn the_right_answer_has_no_fault() {
        let case = square();
        let (measures, culprits) = judged(&case, Snap::Unsnapped, &ExpectedCoverage::new(&case).unsnapped);
        assert_eq!(measures.get(Metric::Pixels), Some(64.0));
        for metric in [Metric::Wrong, Metric::WrongUnsnapped, Metric::Cracks, Metric::Doubles, Metric::Seams] {
            assert_eq!(measures.get(metric), Some(0.0), "{metric:?}");
        }
        assert!(culprits.is_empty());
    }

    #[test]
    fn cracks_double_hits_and_wrong_pixels_are_told_apart() {
        let case = square();
        let mut answers = ExpectedCoverage::new(&case).unsnapped;
        // The second triangle omits its first pixel on row 7 and covers a pixel of the first triangle on row 3.
        let omitted = answers[1].iter_mut().find(|s| s.row == 7).unwrap();
        omitted.left += 1;
        answers[1].push(Span { row: 3, left: 6, right: 7 });
        let (measures, culprits) = judged(&case, Snap::Unsnapped, &answers);
        assert_eq!(
            [Metric::Wrong, Metric::Cracks, Metric::Doubles, Metric::Seams].map(|m| measures.get(m)),
            [2.0, 1.0, 1.0, 2.0].map(Some)
        );
        assert_eq!(culprits, [0, 1], "both touch the first fault, which is the double hit");
    }

    #[test]
    fn snapping_errors_count_only_against_unsnapped_corners() {
        // The left edge lies slightly to the right of the centres of column 2. After snapping, it passes through these
        // centres and owns them.
        let case = case(vec![[[2.500_5, -4.0], [6.0, 4.0], [2.500_5, 12.0]], [[1.0; 2]; 3]], false);
        let snapped = ExpectedCoverage::new(&case).snapped;
        let (declared, culprits) = judged(&case, Snap::Grid256, &snapped);
        assert_eq!(declared.get(Metric::Wrong), Some(0.0));
        assert_eq!((declared.get(Metric::WrongUnsnapped), culprits), (Some(8.0), vec![0]));
        assert_eq!(declared.get(Metric::Cracks), None);
        let (undeclared, _) = judged(&case, Snap::Unsnapped, &snapped);
        assert_eq!(undeclared.get(Metric::Wrong), Some(8.0));
    }
}
