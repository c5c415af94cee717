//! Statistics of the 3 × 3 samples around each sample, to which the history is rectified.

use std::ops::Range;

use super::Rectification;
use super::planes::{Combination, SampleLanes, combine, padded_row};
use super::sample_rows::RowNeighbourhood;
use crate::math::lanes::*;

/// Statistics of 3 × 3 samples for every sample of a row. Rows are padded.
pub(super) struct Statistics {
    /// Rows and padded indices that they belong to.
    of: Option<([u32; 3], Range<usize>)>,
    /// Least or greatest, sum or sum of squares, of three vertically adjacent samples.
    vertical: Vec<f32>,
    /// Least and greatest of 3 × 3 samples, or middles of boxes and reciprocals of half their sizes, for Y, Co and Cg.
    around: [[Vec<f32>; 3]; 2],
}

impl Statistics {
    pub(super) fn new(samples: u32) -> Self {
        Self { of: None, vertical: padded_row(samples), around: [0; 2].map(|_| [0; 3].map(|_| padded_row(samples))) }
    }

    /// Computes the statistics that a rectification needs.
    #[inline(always)]
    pub(super) fn fill<S: Simd>(&mut self, simd: S, by: Rectification, rows: RowNeighbourhood<'_>) {
        let RowNeighbourhood { index, range, planes } = rows;
        if by == Rectification::None || self.of.as_ref().is_some_and(|(held, read)| (held, read) == (&index, &range)) {
            return;
        }
        let (start, centers) = (range.start, range.start + 1..range.end - 1);
        let (of_rows, of_columns) = if by == Rectification::Variance {
            ([Combination::Sum, Combination::SumOfSquares], [Combination::Sum; 2])
        } else {
            ([Combination::Least, Combination::Greatest], [Combination::Least, Combination::Greatest])
        };
        for (number, around) in self.around.iter_mut().enumerate() {
            for (channel, around) in around.iter_mut().enumerate() {
                let rows = each!(row in [0, 1, 2] => &planes[row][channel][start..]);
                combine(simd, rows, &mut self.vertical, &range, of_rows[number]);
                let columns = each!(by in [0, 1, 2] => &self.vertical[start + by..]);
                combine(simd, columns, around, &centers, of_columns[number]);
            }
        }
        if matches!(by, Rectification::Clip | Rectification::Variance) {
            let length = centers.len().next_multiple_of(WIDE);
            let [firsts, seconds] = &mut self.around;
            for (first, second) in firsts.iter_mut().zip(seconds) {
                let [first, second] = [first, second].map(|numbers| &mut numbers[centers.start..][..length]);
                find_boxes(simd, by, first, second);
            }
        }
        self.of = Some((index, range));
    }
}

impl Statistics {
    /// Returns the history of sixteen pixels changed to agree with the samples around their nearest ones.
    #[inline(always)]
    pub(super) fn rectified<S: Simd>(
        &self,
        simd: S,
        past: [f32x16<S>; 3],
        by: Rectification,
        nearest: &SampleLanes<S>,
    ) -> [f32x16<S>; 3] {
        if by == Rectification::None {
            return past;
        }
        let [first, second] = self.range(simd, nearest);
        match by {
            Rectification::None => past,
            Rectification::Clamp => each!(i in [0, 1, 2] => past[i].max(first[i]).min(second[i])),
            Rectification::Clip | Rectification::Variance => clipped(simd, past, first, second),
        }
    }

    /// Returns both statistics around the samples nearest to sixteen pixels; the least and the greatest if the
    /// rectification is [`Rectification::Clamp`].
    #[inline(always)]
    pub(super) fn range<S: Simd>(&self, simd: S, nearest: &SampleLanes<S>) -> [[f32x16<S>; 3]; 2] {
        each!(number in [0, 1] => each!(channel in [0, 1, 2] => nearest.read(simd, &self.around[number][channel])))
    }
}

/// Replaces the least and the greatest samples, or their sums and sums of squares, by the middles of boxes and the
/// reciprocals of half their sizes.
#[inline(always)]
fn find_boxes<S: Simd>(simd: S, by: Rectification, firsts: &mut [f32], seconds: &mut [f32]) {
    /// Avoids a division by zero in boxes without extent; far below a step of 8-bit codes.
    const LEAST_HALF: f32 = 1e-6;
    let chunks = firsts.as_chunks_mut::<WIDE>().0.iter_mut().zip(seconds.as_chunks_mut::<WIDE>().0);
    for (firsts, seconds) in chunks {
        let [first, second] = each!(numbers in [&*firsts, &*seconds] => f32x16::load_array_ref(simd, numbers));
        let (middle, half) = if by == Rectification::Variance {
            let mean = first * (1.0 / 9.0);
            (mean, (second * (1.0 / 9.0) - mean * mean).max(f32x16::splat(simd, 0.0)).sqrt())
        } else {
            ((first + second) * 0.5, (second - first) * 0.5)
        };
        middle.store_array(firsts);
        (f32x16::splat(simd, 1.0) / half.max(f32x16::splat(simd, LEAST_HALF))).store_array(seconds);
    }
}

/// Moves colours straight towards the middle of a box until they are inside. `inverse_half` is the reciprocal of half of the
/// size of the box.
#[inline(always)]
fn clipped<S: Simd>(
    simd: S,
    color: [f32x16<S>; 3],
    middle: [f32x16<S>; 3],
    inverse_half: [f32x16<S>; 3],
) -> [f32x16<S>; 3] {
    let offset = each!(i in [0, 1, 2] => color[i] - middle[i]);
    let [y, co, cg] = each!(i in [0, 1, 2] => offset[i].abs() * inverse_half[i]);
    let one = f32x16::splat(simd, 1.0);
    let farthest = y.max(co).max(cg);
    let is_outside = farthest.simd_gt(one);
    let share = one / farthest.max(one);
    each!(i in [0, 1, 2] => is_outside.select(middle[i] + offset[i] * share, color[i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::upscale::planes::Planes;

    #[test]
    fn colours_outside_a_box_are_moved_to_its_border() {
        const AT: usize = 8;
        let mut random = fastrand::Rng::with_seed(5);
        let rows = [0; 3].map(|_| [0; 4].map(|_| padded_row(20).iter().map(|_| random.f32()).collect()));
        // Middle of the box around one sample, and half of its size.
        let expected = |by: Rectification, channel: usize| {
            let nine =
                || rows.iter().flat_map(move |row: &Planes| row[channel][AT - 1..AT + 2].iter().map(|v| f64::from(*v)));
            if by == Rectification::Clip {
                let (least, greatest) = (nine().fold(f64::MAX, f64::min), nine().fold(f64::MIN, f64::max));
                return [(least + greatest) / 2.0, (greatest - least) / 2.0];
            }
            let mean = nine().sum::<f64>() / 9.0;
            [mean, (nine().map(|value| (value - mean).powi(2)).sum::<f64>() / 9.0).sqrt()]
        };
        for (lanes, by) in
            Lanes::all().flat_map(|lanes| [(lanes, Rectification::Clip), (lanes, Rectification::Variance)])
        {
            let [[middle, half], [co, _], [cg, _]] = [0, 1, 2].map(|channel| expected(by, channel));
            let mut statistics = Statistics::new(20);
            let found = on_lanes!(lanes, simd => {
                statistics.fill(simd, by, RowNeighbourhood { index: [0, 1, 2], range: 0..24, planes: rows.each_ref() });
                let past = each!(number in [4.0, co, cg] => f32x16::splat(simd, number as f32));
                statistics.rectified(simd, past, by, &SampleLanes::Adjacent(AT)).map(|numbers| numbers.to_array()[0])
            });
            for (found, expected) in found.into_iter().zip([middle + half, co, cg]) {
                assert!((f64::from(found) - expected).abs() < 1e-5, "{by:?} {}: {found}, not {expected}", lanes.name());
            }
        }
    }
}
