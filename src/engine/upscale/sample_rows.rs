//! Decoded rows of samples, shared by the output rows that read them.

use std::ops::Range;

use super::quads::Quad;
use super::ycocg::YCoCg;
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;

/// Number of copies of the first sample of a row before it, and of the last one behind it.
pub(super) const PAD: usize = 2;

/// Three adjacent sample rows, decoded and padded: sample `i` is at index `i + PAD`.
pub(super) struct DecodedRows {
    rows: [DecodedRow; 3],
}

/// One decoded row, and what it holds: the index of the row, and the padded indices.
struct DecodedRow {
    holds: Option<(u32, Range<usize>)>,
    quads: Vec<Quad>,
}

/// Returns a buffer for a padded row of samples, or of numbers about them. A vector can be loaded from every index.
pub(super) fn padded_row(samples: u32) -> Vec<Quad> {
    vec![[0.0; 4]; samples as usize + 2 * PAD + WIDE]
}

impl DecodedRows {
    /// Returns the buffer for rows of `samples` samples, which holds none yet.
    pub(super) fn new(samples: u32) -> Self {
        Self { rows: [0, 1, 2].map(|_| DecodedRow { holds: None, quads: padded_row(samples) }) }
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
        let DecodedRow { holds, quads } = &mut self.rows[index as usize % 3];
        if holds.as_ref().is_some_and(|(row, held)| (*row, held) == (index, range)) {
            return;
        }
        let codes = samples.row(index);
        let inside = PAD..PAD + codes.len();
        let own = range.start.max(inside.start)..range.end.min(inside.end);
        colors.decode_row(simd, &codes[own.start - PAD..own.end - PAD], &mut quads[own]);
        for padding in [range.start..inside.start, inside.end..range.end] {
            for place in padding {
                quads[place] = colors.decoded(codes[(place.max(PAD) - PAD).min(codes.len() - 1)]);
            }
        }
        *holds = Some((index, range.clone()));
    }

    /// Returns a padded row, of which the indices of the last [`Self::fill`] are decoded.
    pub(super) fn row(&self, index: u32) -> &[Quad] {
        &self.rows[index as usize % 3].quads
    }
}
