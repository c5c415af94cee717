//! Rows of samples with their luma, and rows of edge weights, kept while output rows read them.

use std::array;

use super::kernel::{DIRECTIONS, edges};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::upscale::runs::{BEYOND, MARGIN};

/// Weights of luma: Rec. 709.
pub(super) const LUMA: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Number of rows of samples before an output row, besides that at or before it.
pub(super) const BEFORE: i32 = 2;

/// Number of rows of samples after an output row.
const AFTER: i32 = 3;

/// Number of rows of samples that are kept: at least those around an output row.
const KEPT: usize = 8;

/// A row of samples with margins.
#[derive(Default)]
pub(super) struct SampleRow {
    /// Luma of the samples, from 0 to 1.
    pub(super) luma: Vec<f32>,
    /// Samples in packed RGBA, with red in the lowest byte.
    pub(super) packed: Vec<u32>,
}

impl SampleRow {
    /// Reads the samples, and repeats the border samples in the margins.
    fn read(&mut self, samples: &[Rgba8]) {
        let length = MARGIN + samples.len() + MARGIN + BEYOND;
        self.packed.resize(length, 0);
        self.luma.resize(length, 0.0);
        let (before, rest) = self.packed.split_at_mut(MARGIN);
        let (own, after) = rest.split_at_mut(samples.len());
        own.iter_mut().zip(samples).for_each(|(word, sample)| *word = u32::from_le_bytes(*sample));
        before.fill(u32::from_le_bytes(samples[0]));
        after.fill(u32::from_le_bytes(samples[samples.len() - 1]));
        for (luma, word) in self.luma.iter_mut().zip(&self.packed) {
            let [red, green, blue] = [*word & 255, *word >> 8 & 255, *word >> 16 & 255].map(|code| code as i32 as f32);
            *luma = (LUMA[0] * red + LUMA[1] * green + LUMA[2] * blue) * (1.0 / 255.0);
        }
    }
}

/// Edge weights of a row of samples, one row per direction.
type EdgeRow = [Vec<f32>; DIRECTIONS];

/// Rows around the current output row. Sample rows outside the image repeat its first or last row.
pub(super) struct Rows<'a> {
    drawn: &'a Image<Rgba8>,
    samples: [SampleRow; KEPT],
    edges: [EdgeRow; 2],
    /// Index of the next sample row to read, and of the next row of edge weights to compute.
    next: [i32; 2],
}

impl<'a> Rows<'a> {
    pub(super) fn new(drawn: &'a Image<Rgba8>) -> Self {
        Self { drawn, samples: Default::default(), edges: Default::default(), next: [i32::MIN; 2] }
    }

    /// Reads the rows around cell `cell`, which must not lie above that of the previous call.
    #[inline(always)]
    pub(super) fn advance<S: Simd>(&mut self, simd: S, cell: i32) {
        let last = self.drawn.height() as i32 - 1;
        self.next = [self.next[0].max(cell - BEFORE), self.next[1].max(cell)];
        for row in self.next[0]..=cell + AFTER {
            self.samples[slot(row)].read(self.drawn.row(row.clamp(0, last) as u32));
        }
        for row in self.next[1]..=cell + 1 {
            let around = [row - 1, row, row + 1].map(|row| self.samples[slot(row)].luma.as_slice());
            fill_edges(simd, around, &mut self.edges[row.rem_euclid(2) as usize]);
        }
        self.next = [cell + AFTER + 1, cell + 2];
    }

    /// Returns the six rows of samples around cell `cell`.
    pub(super) fn around(&self, cell: i32) -> [&SampleRow; 6] {
        array::from_fn(|tap| &self.samples[slot(cell - BEFORE + tap as i32)])
    }

    /// Returns the edge weights of the rows `cell` and `cell` + 1.
    pub(super) fn edges(&self, cell: i32) -> [&EdgeRow; 2] {
        [cell, cell + 1].map(|row| &self.edges[row.rem_euclid(2) as usize])
    }
}

fn slot(row: i32) -> usize {
    row.rem_euclid(KEPT as i32) as usize
}

/// Computes the edge weights of a row from its luma and that of the rows above and below.
#[inline(always)]
fn fill_edges<S: Simd>(simd: S, around: [&[f32]; 3], row: &mut EdgeRow) {
    let length = around[0].len();
    for weights in row.iter_mut() {
        weights.resize(length, 0.0);
    }
    let mut at = MARGIN - LANES;
    while at + WIDE < length {
        let patch = each!(luma in [around[0], around[1], around[2]] => {
            each!(from in [at - 1, at, at + 1] => f32x16::from_slice(simd, &luma[from..from + WIDE]))
        });
        let weights = edges(simd, patch);
        for direction in 0..DIRECTIONS {
            weights[direction].store_slice(&mut row[direction][at..at + WIDE]);
        }
        at += WIDE;
    }
}
