//! Parts of the rows that upscalers read and write.

use std::ops::Range;

use super::quads::Quad;
use crate::image::Rgba8;

/// Sixteen adjacent pixels of a row. The last block of a row may extend beyond its end.
#[derive(Clone, Copy)]
pub(super) struct RowBlock {
    /// Column of the first pixel.
    pub(super) from: usize,
    /// Index of the row.
    pub(super) y: u32,
}

/// Range of pixels of a row.
#[derive(Clone, PartialEq)]
pub(super) struct RowSpan {
    pub(super) columns: Range<usize>,
    /// Index of the row.
    pub(super) y: u32,
}

/// Row that an upscaler with history computes.
pub(super) struct OutputRow<'a> {
    /// Index of the row.
    pub(super) y: u32,
    /// Pixels of the picture.
    pub(super) pixels: &'a mut [Rgba8],
    /// History of the pixels for the next frame.
    pub(super) history: &'a mut [Quad],
}

impl<'a> OutputRow<'a> {
    /// Splits a band into rows of `width` px. The first of them has the index `first`.
    pub(super) fn split_band(
        first: u32,
        width: usize,
        pixels: &'a mut [Rgba8],
        history: &'a mut [Quad],
    ) -> impl Iterator<Item = Self> {
        let rows = pixels.chunks_exact_mut(width).zip(history.chunks_exact_mut(width));
        (first..).zip(rows).map(|(y, (pixels, history))| Self { y, pixels, history })
    }
}
