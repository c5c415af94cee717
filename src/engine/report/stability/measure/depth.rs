//! Measurement of depth buffers: errors of stored depths, and pairs of distances whose order is lost.

use std::cmp::Ordering;

use super::MeasureOutcome;
use crate::pipeline::settings::DepthFormat;
use crate::report::stability::case::{DepthCase, DepthPairs};
use crate::report::stability::metric::{Measures, Metric};
use crate::report::stability::oracle::{exact_depth, ideal_code};
use crate::report::stability::subject::{DepthBuffer, distance, meaning};

/// Tangent of half the field of view of the random views, which is about 53°.
const TANGENT: f64 = 0.5;

/// Counts a pair of stored depths, also as a tie or an inversion if it is one. `first` must belong to the smaller
/// distance. Returns [`Ordering::Less`] if the depths are in the correct order, `Equal` for a tie and `Greater` for an
/// inversion.
fn note_order(first: f64, second: f64, reversed: bool, measures: &mut Measures) -> Ordering {
    let order = if reversed { second.total_cmp(&first) } else { first.total_cmp(&second) };
    measures.note(Metric::Pairs, 1.0);
    measures.note(Metric::Ties, u32::from(order == Ordering::Equal).into());
    measures.note(Metric::Inversions, u32::from(order == Ordering::Greater).into());
    order
}

/// Stores every distance of a case in a depth buffer, and measures the errors of the stored depths.
pub(super) fn distances(case: &DepthCase, format: DepthFormat) -> MeasureOutcome {
    let buffer = DepthBuffer::new(format, case.near, case.far.unwrap_or(f32::MAX));
    evaluate(case, format, &case.z.iter().map(|z| buffer.stored(*z)).collect::<Vec<_>>())
}

/// Compares the stored depths with the exact ones, and each stored depth with that of the next distance.
fn evaluate(case: &DepthCase, format: DepthFormat, stored: &[f64]) -> MeasureOutcome {
    let (mapping, storage) = meaning(format);
    let right: Vec<_> = case.z.iter().map(|z| exact_depth(mapping, case.near, case.far, *z)).collect();
    let mut measures = Measures::default();
    let mut worst = (0.0, Vec::new());
    for (index, (stored, right)) in stored.iter().zip(&right).enumerate() {
        measures.note(Metric::NotFinite, u32::from(!stored.is_finite()).into());
        measures.note(Metric::OutOfRange, u32::from(stored.is_finite() && !(0.0..=1.0).contains(stored)).into());
        let Some(right) = right.as_ref().filter(|_| stored.is_finite()) else { continue };
        let error = storage.error(*stored, right);
        measures.note(Metric::DepthUlp, error);
        if error > worst.0 {
            worst = (error, vec![index]);
        }
    }
    let mut confused = None;
    for (index, pair) in stored.windows(2).enumerate() {
        let order = note_order(pair[0], pair[1], mapping.is_reversed(), &mut measures);
        // An inversion is worse than any tie.
        if order == Ordering::Greater || (order == Ordering::Equal && confused.is_none()) {
            confused = Some(vec![index, index + 1]);
        }
    }
    let ideal: Vec<_> = right.iter().map(|right| right.as_ref().map(|right| ideal_code(storage, right))).collect();
    measures.note(Metric::IdealTies, ideal.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64);
    MeasureOutcome::new(measures, confused.unwrap_or(worst.1))
}

/// Stores the depths of random pairs of points, and counts the ties and inversions.
pub(super) fn pairs(case: &DepthPairs, format: DepthFormat) -> MeasureOutcome {
    let buffer = DepthBuffer::new(format, case.near, case.far);
    let reversed = meaning(format).0.is_reversed();
    let mut measures = Measures::default();
    let mut culprit = None;
    for (index, pair) in pair_distances(case).enumerate() {
        let [first, second] = pair.map(|distance| buffer.stored(distance));
        let is_broken = !first.is_finite() || !second.is_finite();
        measures.note(Metric::NotFinite, u32::from(is_broken).into());
        let order = note_order(first, second, reversed, &mut measures);
        // Keep the first of the worst pairs.
        let badness = if is_broken { 3 } else { order as i8 + 1 };
        if badness > culprit.map_or(0, |(badness, _)| badness) {
            culprit = Some((badness, index));
        }
    }
    MeasureOutcome::new(measures, culprit.map(|(_, index)| index).into_iter().collect())
}

/// Returns the pair with this index as a case of two distances, or `None` if the index is out of range.
pub(crate) fn only_pair(case: &DepthPairs, index: usize) -> Option<DepthCase> {
    let DepthPairs { mapping, format, near, far, .. } = *case;
    let pair = pair_distances(case).nth(index)?;
    Some(DepthCase { mapping, format, near, far: Some(far), z: pair.to_vec() })
}

/// Returns the distances of all pairs of points. The distances of each pair are computed with its own random view
/// matrix.
fn pair_distances(case: &DepthPairs) -> impl Iterator<Item = [f32; 2]> {
    let mut random = fastrand::Rng::with_seed(case.seed);
    (0..case.pairs).map(move |_| {
        let (row, points) = sight(&mut random, case);
        points.map(|point| distance(row, point))
    })
}

/// Returns a random view, and two points on one line of sight at distances z and z · (1 + gap). The view is given by
/// the matrix row that computes the distance. Each coordinate of the eye is between −1 and 1.
fn sight(random: &mut fastrand::Rng, case: &DepthPairs) -> ([f32; 4], [[f32; 3]; 2]) {
    let mut signed = || random.f64() * 2.0 - 1.0;
    let eye = [signed(), signed(), signed()];
    let forward = loop {
        let [x, y, z] = [signed(), signed(), signed()];
        let length = (x * x + y * y + z * z).sqrt();
        if (0.1..=1.0).contains(&length) {
            break [x / length, y / length, z / length];
        }
    };
    // A random vector; its component along the view axis is removed below.
    let aside = [signed(), signed(), signed()].map(|a| a * TANGENT);
    let along = dot(aside, forward);
    let direction = [0, 1, 2].map(|axis| aside[axis] + forward[axis] * (1.0 - along));
    let (near, far) = (f64::from(case.near), f64::from(case.far) / (1.0 + case.gap));
    let nearer = near * (far / near).powf(random.f64());
    let point = |z: f64| [0, 1, 2].map(|axis| (eye[axis] + direction[axis] * z) as f32);
    let [x, y, z] = forward.map(|f| f as f32);
    ([x, y, z, -dot(forward, eye) as f32], [point(nearer), point(nearer * (1.0 + case.gap))])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::stability::oracle::{DepthMapping, DepthStorage, approximate};

    fn case(z: Vec<f32>) -> DepthCase {
        DepthCase { mapping: DepthMapping::Standard, format: DepthStorage::F32, near: 1.0, far: Some(100.0), z }
    }

    #[test]
    fn values_in_order_are_not_lost_and_nearly_right_ones_nearly_so() {
        let case = case(vec![1.5, 2.0, 70.0, 99.0]);
        let right = case.z.iter().map(|z| exact_depth(DepthMapping::Standard, 1.0, Some(100.0), *z).unwrap());
        let stored: Vec<f64> = right.map(|right| f64::from(approximate(&right) as f32)).collect();
        let measures = evaluate(&case, DepthFormat::F32, &stored).measures.unwrap();
        assert!(measures.get(Metric::DepthUlp).unwrap() <= 0.5);
        assert_eq!(
            [Metric::Pairs, Metric::Lost, Metric::OutOfRange].map(|m| measures.get(m)),
            [3.0, 0.0, 0.0].map(Some)
        );
    }

    #[test]
    fn ties_inversions_and_strays_are_counted() {
        let case = case(vec![1.5, 2.0, 70.0, 99.0]);
        let outcome = evaluate(&case, DepthFormat::F32, &[0.25, 0.25, 0.125, 1.5]);
        let measures = outcome.measures.unwrap();
        let expected =
            [(Metric::Ties, 1.0), (Metric::Inversions, 1.0), (Metric::OutOfRange, 1.0), (Metric::IdealTies, 0.0)];
        for (metric, value) in expected {
            assert_eq!(measures.get(metric), Some(value), "{metric:?}");
        }
        assert_eq!(outcome.culprits, [1, 2], "the inversion");
        let reversed = evaluate(&case, DepthFormat::ReversedF32, &[0.5, 0.25, 0.125, f64::NAN]).measures.unwrap();
        assert_eq!((reversed.get(Metric::NotFinite), reversed.get(Metric::Ties)), (Some(1.0), Some(0.0)));
    }

    #[test]
    fn random_pairs_are_at_the_distances_asked_for() {
        let case = DepthPairs {
            mapping: DepthMapping::Standard,
            format: DepthStorage::F32,
            near: 0.1,
            far: 1e4,
            gap: 1e-3,
            pairs: 1,
            seed: 1,
        };
        let mut random = fastrand::Rng::with_seed(1);
        let (mut near, mut far) = (0, 0);
        for _ in 0..2000 {
            let (row, points) = sight(&mut random, &case);
            let exactly = |p: [f32; 3]| dot([0, 1, 2].map(|i| row[i].into()), p.map(f64::from)) + f64::from(row[3]);
            let [first, second] = points.map(exactly);
            assert!((second / first - 1.001).abs() < 1e-4, "{first} {second}");
            assert!(first > 0.0999 && second < 1.0001e4, "{first} {second}");
            near += u32::from(first < 1.0);
            far += u32::from(first > 1e3);
        }
        assert!(near.abs_diff(400) < 100 && far.abs_diff(400) < 100, "a fifth each: {near} {far}");
    }
}
