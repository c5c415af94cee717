//! Statistics of the 3 × 3 samples around each sample, to which the history is rectified.

use std::ops::Range;

use super::super::Rectification;
use super::super::quads::{self, Combination, Quad};
use super::super::sample_rows::padded_row;
use crate::math::lanes::*;

/// Statistics of 3 × 3 samples for every sample of a row. Rows are padded.
pub(super) struct Statistics {
    /// Rows and padded indices that they belong to.
    of: Option<([u32; 3], Range<usize>)>,
    /// Least and greatest, or sums and sums of squares, of three vertically adjacent samples.
    vertical: [Vec<Quad>; 2],
    /// The same for 3 × 3 samples.
    around: [Vec<Quad>; 2],
}

impl Statistics {
    pub(super) fn new(samples: u32) -> Self {
        Self {
            of: None,
            vertical: [padded_row(samples), padded_row(samples)],
            around: [padded_row(samples), padded_row(samples)],
        }
    }

    /// Computes the statistics that a rectification needs, from three decoded rows, given with their indices, for a range
    /// of padded indices.
    #[inline(always)]
    pub(super) fn fill<S: Simd>(
        &mut self,
        simd: S,
        by: Rectification,
        rows: [&[Quad]; 3],
        (index, range): ([u32; 3], &Range<usize>),
    ) {
        if by == Rectification::None || self.of.as_ref().is_some_and(|(held, read)| (*held, read) == (index, range)) {
            return;
        }
        let (read, centers) = (quads::whole_vectors(range), quads::whole_vectors(&(range.start + 1..range.end - 1)));
        let rows = rows.map(|row| &row[read.clone()]);
        let (of_rows, of_columns) = if by == Rectification::Variance {
            ([Combination::Sum, Combination::SumOfSquares], [Combination::Sum; 2])
        } else {
            ([Combination::Least, Combination::Greatest], [Combination::Least, Combination::Greatest])
        };
        for number in [0, 1] {
            let (vertical, around) = (&mut self.vertical[number], &mut self.around[number]);
            quads::combine(simd, rows, &mut vertical[read.clone()], of_rows[number]);
            quads::combine(simd, quads::around(vertical, &centers), &mut around[centers.clone()], of_columns[number]);
        }
        self.of = Some((index, range.clone()));
    }
}

/// Nearest samples of sixteen pixels.
pub(super) enum NearestSamples {
    /// Adjacent ones, of which the first has this padded index.
    Adjacent(usize),
    /// Any, given by padded indices.
    Any([usize; WIDE]),
}

impl Statistics {
    /// Returns the statistics around the nearest samples.
    #[inline(always)]
    fn of<S: Simd>(&self, simd: S, nearest: &NearestSamples) -> [[f32x16<S>; 3]; 2] {
        each!(row in [0, 1] => {
            let row = &self.around[row];
            let [y, co, cg, _] = match nearest {
                NearestSamples::Adjacent(first) => quads::columns(simd, quads::window(row, *first)),
                NearestSamples::Any(indices) => {
                    let mut all = [[0.0; 4]; WIDE];
                    for (quad, index) in all.iter_mut().zip(indices) {
                        *quad = row[*index];
                    }
                    quads::columns(simd, &all)
                }
            };
            [y, co, cg]
        })
    }

    /// Returns the history of sixteen pixels changed to agree with the samples around their nearest ones.
    #[inline(always)]
    pub(super) fn rectified<S: Simd>(
        &self,
        simd: S,
        past: [f32x16<S>; 3],
        by: Rectification,
        nearest: &NearestSamples,
    ) -> [f32x16<S>; 3] {
        if by == Rectification::None {
            return past;
        }
        let [first, second] = self.of(simd, nearest);
        match by {
            Rectification::None => past,
            Rectification::Clamp => each!(i in [0, 1, 2] => past[i].max(first[i]).min(second[i])),
            Rectification::Clip => {
                let middle = each!(i in [0, 1, 2] => (first[i] + second[i]) * 0.5);
                clipped(simd, past, middle, each!(i in [0, 1, 2] => (second[i] - first[i]) * 0.5))
            }
            Rectification::Variance => {
                let mean = each!(i in [0, 1, 2] => first[i] * (1.0 / 9.0));
                let deviation = each!(i in [0, 1, 2] => {
                    (second[i] * (1.0 / 9.0) - mean[i] * mean[i]).max(f32x16::splat(simd, 0.0)).sqrt()
                });
                clipped(simd, past, mean, deviation)
            }
        }
    }
}

/// Moves colours straight towards the middle of a box until they are inside. `half` is half of the size of the box.
#[inline(always)]
fn clipped<S: Simd>(simd: S, color: [f32x16<S>; 3], middle: [f32x16<S>; 3], half: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
    // Avoids a division by zero in boxes without extent; far below a step of 8-bit codes.
    const LEAST_HALF: f32 = 1e-6;
    let offset = each!(i in [0, 1, 2] => color[i] - middle[i]);
    let [y, co, cg] = each!(i in [0, 1, 2] => offset[i].abs() / half[i].max(f32x16::splat(simd, LEAST_HALF)));
    let one = f32x16::splat(simd, 1.0);
    let farthest = y.max(co).max(cg);
    let is_outside = farthest.simd_gt(one);
    let share = one / farthest.max(one);
    each!(i in [0, 1, 2] => is_outside.select(middle[i] + offset[i] * share, color[i]))
}
