//! Properties of the 3 × 3 samples around each sample of a row: range of colours, median luminance, thin features.

use std::ops::Range;

use super::super::planes::{Combination, Planes, combine, padded_row};
use super::super::quads::window;
use super::super::sample_rows::RowNeighbourhood;
use super::locks::{self, Contrast};
use crate::math::lanes::*;

/// Properties of the 3 × 3 samples around each sample of a row. Rows are padded.
pub(super) struct Surroundings {
    /// Rows and padded indices that they belong to.
    of: Option<([u32; 3], Range<usize>)>,
    /// Least or greatest of three vertically adjacent samples.
    vertical: Vec<f32>,
    /// Least and greatest of 3 × 3 samples.
    pub(super) range: [Planes; 2],
    /// Median of the luminances.
    pub(super) median: Vec<f32>,
    /// 1 where the middle sample belongs to a thin feature, otherwise 0.
    pub(super) thin: Vec<f32>,
}

impl Surroundings {
    pub(super) fn new(samples: u32) -> Self {
        Self {
            of: None,
            vertical: padded_row(samples),
            range: [0; 2].map(|_| [0; 4].map(|_| padded_row(samples))),
            median: padded_row(samples),
            thin: padded_row(samples),
        }
    }

    /// Computes the properties of the middle one of three rows.
    #[inline(always)]
    pub(super) fn fill<S: Simd>(&mut self, simd: S, contrast: Contrast, rows: RowNeighbourhood<'_>) {
        let RowNeighbourhood { index, range, planes } = rows;
        if self.of.as_ref().is_some_and(|(held, read)| (held, read) == (&index, &range)) {
            return;
        }
        let (start, centers) = (range.start, range.start + 1..range.end - 1);
        for (by, around) in [Combination::Least, Combination::Greatest].into_iter().zip(&mut self.range) {
            for (channel, around) in around.iter_mut().enumerate() {
                let rows = each!(row in [0, 1, 2] => &planes[row][channel][start..]);
                combine(simd, rows, &mut self.vertical, &range, by);
                let columns = each!(column in [0, 1, 2] => &self.vertical[start + column..]);
                combine(simd, columns, around, &centers, by);
            }
        }
        for first in centers.step_by(WIDE) {
            let [above, at, below] = each!(row in [0, 1, 2] => each!(by in [0, 1, 2] => {
                f32x16::load_array_ref(simd, window(&planes[row][0], first + by - 1))
            }));
            let [[a, b, c], [d, e, f], [g, h, i]] = [above, at, below];
            let luminances = [a, b, c, d, e, f, g, h, i];
            locks::median(&luminances).store_slice(&mut self.median[first..first + WIDE]);
            let is_thin = contrast.is_thin(simd, &luminances);
            let (one, zero) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, 0.0));
            is_thin.select(one, zero).store_slice(&mut self.thin[first..first + WIDE]);
        }
        self.of = Some((index, range));
    }
}
