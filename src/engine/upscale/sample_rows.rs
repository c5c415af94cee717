//! Decoded rows of samples, shared by the output rows that read them.

use std::ops::Range;

use super::planes::{PAD, Planes, padded_row};
use super::row_parts::RowSpan;
use super::ycocg::YCoCg;
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;

/// Three adjacent sample rows, decoded and padded.
pub(super) struct DecodedRows {
    rows: [DecodedRow; 3],
}

/// Three adjacent rows of decoded samples.
pub(super) struct RowNeighbourhood<'a> {
    /// Indices of the rows.
    pub(super) index: [u32; 3],
    /// Range of padded indices that is decoded.
    pub(super) range: Range<usize>,
    /// Decoded samples of each row.
    pub(super) planes: [&'a Planes; 3],
}

/// One decoded row, and the span that it holds, in padded indices.
struct DecodedRow {
    holds: Option<RowSpan>,
    planes: Planes,
}

impl DecodedRows {
    /// Returns the buffer for rows of `samples` samples, which holds none yet.
    pub(super) fn new(samples: u32) -> Self {
        Self { rows: [0, 1, 2].map(|_| DecodedRow { holds: None, planes: [0; 4].map(|_| padded_row(samples)) }) }
    }

    /// Makes sure that a span of a sample row is decoded. Its columns are padded indices.
    #[inline(always)]
    pub(super) fn fill<S: Simd>(&mut self, simd: S, colors: YCoCg, samples: &Image<Rgba8>, span: &RowSpan) {
        let DecodedRow { holds, planes } = &mut self.rows[span.y as usize % 3];
        if holds.as_ref() == Some(span) {
            return;
        }
        let range = &span.columns;
        let codes = samples.row(span.y);
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
        *holds = Some(span.clone());
    }

    /// Returns three padded rows, of which the range of padded indices must be decoded.
    #[inline(always)]
    pub(super) fn three(&self, index: [u32; 3], range: Range<usize>) -> RowNeighbourhood<'_> {
        RowNeighbourhood { index, range, planes: index.map(|index| self.row(index)) }
    }

    /// Returns a padded row, of which the indices of the last [`Self::fill`] are decoded.
    pub(super) fn row(&self, index: u32) -> &Planes {
        &self.rows[index as usize % 3].planes
    }
}
