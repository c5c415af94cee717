//! Decoded rows of samples, shared by the output rows that read them.

use std::ops::Range;

use super::planes::{PAD, Planes, padded_row};
use super::ycocg::YCoCg;
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;

/// Three adjacent sample rows, decoded and padded.
pub(super) struct DecodedRows {
    rows: [DecodedRow; 3],
}

/// One decoded row, and what it holds: the index of the row, and the padded indices.
struct DecodedRow {
    holds: Option<(u32, Range<usize>)>,
    planes: Planes,
}

impl DecodedRows {
    /// Returns the buffer for rows of `samples` samples, which holds none yet.
    pub(super) fn new(samples: u32) -> Self {
        Self { rows: [0, 1, 2].map(|_| DecodedRow { holds: None, planes: [0; 4].map(|_| padded_row(samples)) }) }
    }

    /// Makes sure that a range of padded indices of sample row `index` is decoded.
    #[inline(always)]
    pub(super) fn fill<S: Simd>(
        &mut self,
        simd: S,
        colors: YCoCg,
        samples: &Image<Rgba8>,
        (index, range): (u32, &Range<usize>),
    ) {
        let DecodedRow { holds, planes } = &mut self.rows[index as usize % 3];
        if holds.as_ref().is_some_and(|(row, held)| (*row, held) == (index, range)) {
            return;
        }
        let codes = samples.row(index);
        let inside = PAD..PAD + codes.len();
        let own = range.start.max(inside.start)..range.end.min(inside.end);
        colors.decode_row(simd, &codes[own.start - PAD..own.end - PAD], planes, own.start);
        for padding in [range.start..inside.start, inside.end..range.end] {
            for place in padding {
                let decoded = colors.decoded(codes[(place.max(PAD) - PAD).min(codes.len() - 1)]);
                for (plane, number) in planes.iter_mut().zip(decoded) {
                    plane[place] = number;
                }
            }
        }
        *holds = Some((index, range.clone()));
    }

    /// Returns a padded row, of which the indices of the last [`Self::fill`] are decoded.
    pub(super) fn row(&self, index: u32) -> &Planes {
        &self.rows[index as usize % 3].planes
    }
}
