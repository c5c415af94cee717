//! Properties of the 3 × 3 samples around each sample of a row: range of colours, median luminance, thin features.

use std::ops::Range;

use super::super::quads::{self, Combination, Quad};
use super::super::sample_rows::padded_row;
use super::locks::{self, Contrast};
use crate::math::lanes::*;

/// Properties of the 3 × 3 samples around each sample of a row. Rows are padded.
pub(super) struct Surroundings {
    /// Rows and padded indices that they belong to.
    of: Option<([u32; 3], Range<usize>)>,
    /// Least and greatest of three vertically adjacent samples.
    vertical: [Vec<Quad>; 2],
    /// Least and greatest of 3 × 3 samples.
    pub(super) range: [Vec<Quad>; 2],
    /// Median of the luminances.
    pub(super) median: Vec<f32>,
    /// 1 where the middle sample belongs to a thin feature, otherwise 0.
    pub(super) thin: Vec<f32>,
}

impl Surroundings {
    pub(super) fn new(samples: u32) -> Self {
        let length = padded_row(samples).len();
        Self {
            of: None,
            vertical: [0, 1].map(|_| padded_row(samples)),
            range: [0, 1].map(|_| padded_row(samples)),
            median: vec![0.0; length],
            thin: vec![0.0; length],
        }
    }

    /// Computes the properties from three decoded rows, given with their indices, for a range of padded indices.
    #[inline(always)]
    pub(super) fn fill<S: Simd>(
        &mut self,
        simd: S,
        contrast: Contrast,
        rows: [&[Quad]; 3],
        (index, range): ([u32; 3], &Range<usize>),
    ) {
        if self.of.as_ref().is_some_and(|(held, read)| (*held, read) == (index, range)) {
            return;
        }
        let centers = range.start + 1..range.end - 1;
        let (read, around) = (quads::whole_vectors(range), quads::whole_vectors(&centers));
        let runs = rows.map(|row| &row[read.clone()]);
        for (number, by) in [Combination::Least, Combination::Greatest].into_iter().enumerate() {
            let vertical = &mut self.vertical[number];
            quads::combine(simd, runs, &mut vertical[read.clone()], by);
            quads::combine(simd, quads::around(vertical, &around), &mut self.range[number][around.clone()], by);
        }
        for first in centers.step_by(WIDE) {
            let [above, at, below] = each!(row in [0, 1, 2] => each!(by in [0, 1, 2] => {
                let [y, ..] = quads::columns(simd, quads::window(rows[row], first + by - 1));
                y
            }));
            let [[a, b, c], [d, e, f], [g, h, i]] = [above, at, below];
            let luminances = [a, b, c, d, e, f, g, h, i];
            locks::median(&luminances).store_slice(&mut self.median[first..first + WIDE]);
            let is_thin = contrast.is_thin(simd, &luminances);
            let (one, zero) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, 0.0));
            is_thin.select(one, zero).store_slice(&mut self.thin[first..first + WIDE]);
        }
        self.of = Some((index, range.clone()));
    }
}
