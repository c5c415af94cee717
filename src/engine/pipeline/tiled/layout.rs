//! Layout of the picture in tiles, and of a tile in blocks of samples.

use std::ops::Range;

use crate::math::lanes::LANES;

/// Width and height of a tile, in samples of the packed picture.
pub(super) const TILE: usize = 64;

/// Number of samples in a tile.
pub(super) const TILE_SAMPLES: usize = TILE * TILE;

/// Width and height of a block, in samples of the packed picture: one sample per lane.
pub(super) const BLOCK: usize = LANES;

/// Number of blocks in a row and in a column of a tile.
pub(super) const BLOCKS: usize = TILE / BLOCK;

/// Distance between adjacent rows of samples in the memory of a tile. Rows may be read and written up to eight samples
/// beyond the last block.
pub(super) const STRIDE: usize = TILE + LANES;

/// Number of rows of samples in the memory of a tile. One row is extra, because narrow triangles are drawn two rows at
/// a time.
pub(super) const ROWS: usize = TILE + 1;

/// Number of tiles in a row and in a column of the packed picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TileGrid {
    pub(super) columns: usize,
    pub(super) rows: usize,
}

impl TileGrid {
    /// Returns the tiles of a picture with this width and height, in samples.
    pub(super) fn covering((width, height): (u32, u32)) -> Self {
        Self { columns: (width as usize).div_ceil(TILE), rows: (height as usize).div_ceil(TILE) }
    }

    /// Returns the number of tiles.
    pub(super) fn count(self) -> usize {
        self.columns * self.rows
    }

    /// Returns the place of the tile in a column and row of the grid.
    pub(super) fn place(self, column: usize, row: usize) -> TilePlace {
        TilePlace { column, row, number: row * self.columns + column }
    }
}

/// Place of a tile in the picture.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TilePlace {
    /// Column, counted in tiles.
    pub(super) column: usize,
    /// Row, counted in tiles.
    pub(super) row: usize,
    /// Index of the tile, counted row by row.
    pub(super) number: usize,
}

impl TilePlace {
    /// Returns the column and row of a sample in the packed picture.
    #[inline(always)]
    pub(super) fn packed(self, sample: SamplePlace) -> (u32, u32) {
        ((self.column * TILE + sample.column) as u32, (self.row * TILE + sample.row) as u32)
    }
}

/// Number of columns and rows of a tile that lie within the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileSize {
    pub(super) columns: usize,
    pub(super) rows: usize,
}

/// Place of a sample in its tile.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SamplePlace {
    pub(super) column: usize,
    pub(super) row: usize,
}

impl SamplePlace {
    /// Returns the place of the sample with an index, counted row by row.
    #[inline(always)]
    pub(super) fn of(index: usize) -> Self {
        Self { column: index % TILE, row: index / TILE }
    }

    /// Returns the index of the sample, counted row by row.
    #[inline(always)]
    pub(super) fn index(self) -> usize {
        self.row * TILE + self.column
    }

    /// Returns the index of the sample in the memory of a tile, whose rows are [`STRIDE`] samples apart.
    #[inline(always)]
    pub(super) fn memory_index(self) -> usize {
        self.row * STRIDE + self.column
    }
}

/// Block of a tile, given by its column and row in blocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub(super) column: usize,
    pub(super) row: usize,
}

impl Block {
    /// Returns the block with an index, counted row by row.
    #[inline(always)]
    pub(super) fn new(index: usize) -> Self {
        Self { column: index % BLOCKS, row: index / BLOCKS }
    }

    /// Returns the block that contains a sample.
    #[inline(always)]
    pub(super) fn around(sample: SamplePlace) -> Self {
        Self { column: sample.column / BLOCK, row: sample.row / BLOCK }
    }

    /// Returns the index of the block in the tile, counted row by row.
    #[inline(always)]
    pub(super) fn index(self) -> usize {
        self.row * BLOCKS + self.column
    }

    /// Returns the column of the block's first sample in the tile.
    #[inline(always)]
    pub(super) fn first_column(self) -> usize {
        self.column * BLOCK
    }

    /// Returns the rows of the tile that the block spans.
    #[inline(always)]
    pub(super) fn rows(self) -> Range<usize> {
        self.row * BLOCK..(self.row + 1) * BLOCK
    }
}
