//! Patches: rectangles of a tile's samples that are shaded together.

use super::layout::BLOCK;
use crate::math::lanes::LANES;

/// Rectangle of samples in a tile: rows of a block, or of several adjacent blocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    /// Index of the first column, within the tile.
    pub(super) column: usize,
    /// Number of the patch's columns that lie within the picture.
    pub(super) count: usize,
    /// Index of the first row, within the tile.
    pub(super) first: usize,
    /// Index one past the last row, within the tile.
    pub(super) end: usize,
    /// Bit mask of the samples to shade, one bit per column of a block. The same mask applies to every row of every
    /// block.
    pub(super) mine: u32,
}

impl Patch {
    /// Splits the patch horizontally into blocks.
    pub(super) fn blocks(self) -> impl Iterator<Item = Self> {
        let columns = (self.column..self.column + self.count).step_by(BLOCK);
        columns.map(move |column| Self { column, count: (self.column + self.count - column).min(BLOCK), ..self })
    }
}

/// Bit mask of all eight samples in a row of a block.
pub(super) const ALL: u32 = (1 << LANES) - 1;
