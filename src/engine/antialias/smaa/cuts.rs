//! Areas that smoothed edges cut off at the edges of a band of rows.

use super::area::CutAreas;
use super::edges::{MARGIN, words_of};

/// Areas at the top edges, or at the left edges, of the pixels of consecutive rows.
#[derive(Default)]
pub(super) struct Cuts {
    /// Number of words per row.
    words: usize,
    /// A bit for every edge that cuts off an area of the pixel before it.
    before: Vec<u64>,
    /// A bit for every edge that cuts off an area of the pixel after it.
    after: Vec<u64>,
    /// Areas by bit, valid where a bit is set. Reusing this buffer for the next picture avoids page faults.
    areas: Vec<CutAreas>,
}

/// Areas of one row.
#[derive(Clone, Copy)]
pub(super) struct CutRow<'a> {
    /// Bits of the edges that cut off an area of the pixel before them. Bit [`MARGIN`] belongs to the first pixel.
    pub(super) before: &'a [u64],
    /// Bits of the edges that cut off an area of the pixel after them.
    pub(super) after: &'a [u64],
    areas: &'a [CutAreas],
}

impl Cuts {
    /// Forgets all areas and makes room for `rows` rows of `width` px.
    pub(super) fn clear(&mut self, width: usize, rows: usize) {
        self.words = words_of(width);
        for bits in [&mut self.before, &mut self.after] {
            bits.clear();
            bits.resize(rows * self.words, 0);
        }
        if self.areas.len() < rows * self.words * 64 {
            self.areas.resize(rows * self.words * 64, CutAreas::default());
        }
    }

    /// Sets the areas at the edge of column `x`, which has none.
    #[inline(always)]
    pub(super) fn set(&mut self, x: usize, row: usize, areas: CutAreas) {
        let bit = row * self.words * 64 + x + MARGIN;
        self.before[bit / 64] |= u64::from(areas.before != 0.0) << (bit % 64);
        self.after[bit / 64] |= u64::from(areas.after != 0.0) << (bit % 64);
        self.areas[bit] = areas;
    }

    /// Removes the areas at the edge of column `x`, if it has any.
    #[inline(always)]
    pub(super) fn remove(&mut self, x: usize, row: usize) {
        let bit = row * self.words * 64 + x + MARGIN;
        self.before[bit / 64] &= !(1 << (bit % 64));
        self.after[bit / 64] &= !(1 << (bit % 64));
    }

    /// Returns the areas of a row.
    pub(super) fn row(&self, row: usize) -> CutRow<'_> {
        let [before, after] = [&self.before, &self.after].map(|bits| &bits[row * self.words..][..self.words]);
        CutRow { before, after, areas: &self.areas[row * self.words * 64..][..self.words * 64] }
    }
}

impl CutRow<'_> {
    /// Returns the area that the edge of a bit cuts off the pixel before it.
    #[inline(always)]
    pub(super) fn before(&self, bit: usize) -> f32 {
        where_set(self.before, bit, self.areas[bit].before)
    }

    /// Returns the area that the edge of a bit cuts off the pixel after it.
    #[inline(always)]
    pub(super) fn after(&self, bit: usize) -> f32 {
        where_set(self.after, bit, self.areas[bit].after)
    }
}

/// Returns `area` if a bit is set, else zero. Without a branch, which would be mispredicted at every other edge.
#[inline(always)]
fn where_set(bits: &[u64], bit: usize, area: f32) -> f32 {
    f32::from_bits(area.to_bits() & 0u32.wrapping_sub((bits[bit / 64] >> (bit % 64)) as u32 & 1))
}
