//! Vertical pass: computes the output rows of a cell from the widened rows around it.

use std::arch::x86_64::{_mm256_packus_epi16, _mm256_set1_epi16, _mm256_srai_epi16};

use fearless_simd::{Avx2, kernel};

use super::super::fixed::{BIAS, POINT, PhaseWeights};
use super::cell::{CellStructure, CellWeights, First, TapPairs, places, shape_of, with_shape};
use super::{BLOCK, Block};
use crate::image::Rgba8;
use crate::upscale::lanes::{Blocks, MAX_ROWS, SplitRows, load, of_one_length, store_codes};

/// Widened rows before and after a cell, both outermost first.
type Rows<'a, const H: usize> = ([&'a [Block]; H], [&'a [Block]; H]);

/// Computes whole blocks in all output rows of a cell from the surrounding widened rows.
#[target_feature(enable = "avx2")]
#[inline(never)]
fn sweep<const H: usize, const FIRST: u8, const PAIRS: usize, const MIDDLE: bool>(
    avx2: Avx2,
    (mut low, mut high): Rows<'_, H>,
    weights: &CellWeights<H>,
    rows: [Blocks<'_>; MAX_ROWS],
) {
    let bias = _mm256_set1_epi16(BIAS);
    let count = usize::from(FIRST != First::None as u8) + 2 * PAIRS + usize::from(MIDDLE);
    let [first, second, third, fourth] = of_one_length(rows, count);
    let blocks = first.len();
    for k in 0..H {
        (low[k], high[k]) = (&low[k][..blocks], &high[k][..blocks]);
    }
    let codes =
        |a, b| _mm256_packus_epi16(_mm256_srai_epi16::<{ POINT as i32 }>(a), _mm256_srai_epi16::<{ POINT as i32 }>(b));
    for block in 0..blocks {
        let mut values = [[bias; MAX_ROWS]; 2];
        for half in 0..2 {
            let (mut before, mut after) = ([bias; H], [bias; H]);
            for k in 0..H {
                before[k] = load(avx2, &low[k][block][half]);
                after[k] = load(avx2, &high[k][block][half]);
            }
            values[half] = places::<H, FIRST, PAIRS, MIDDLE>(&TapPairs::new(before, after), weights, bias);
        }
        let [[a0, a1, a2, a3], [b0, b1, b2, b3]] = values;
        store_codes(avx2, codes(a0, b0), &mut first[block]);
        if count > 1 {
            store_codes(avx2, codes(a1, b1), &mut second[block]);
        }
        if count > 2 {
            store_codes(avx2, codes(a2, b2), &mut third[block]);
        }
        if count > 3 {
            store_codes(avx2, codes(a3, b3), &mut fourth[block]);
        }
    }
}

/// Inputs for the output rows of one cell: the surrounding widened rows, and the phases of the rows.
pub(super) struct Cell<'a, const H: usize> {
    pub(super) low: [&'a [Block]; H],
    pub(super) high: [&'a [Block]; H],
    pub(super) phases: &'a [&'a PhaseWeights<H>],
    /// Number of pixels that the widened rows have left of the image.
    pub(super) skipped: usize,
    pub(super) deringing: bool,
}

/// Computes the output rows of a cell: together if there is a kernel for their arrangement, otherwise one by one.
#[target_feature(enable = "avx2")]
fn mix<const H: usize>(avx2: Avx2, cell: &Cell<'_, H>, rows: &mut [Rgba8]) {
    let width = rows.len() / cell.phases.len();
    if let Some(shape) = shape_of(cell.phases) {
        mix_shape(avx2, cell, shape, rows);
        return;
    }
    for (phase, row) in cell.phases.chunks_exact(1).zip(rows.chunks_exact_mut(width)) {
        let first = if phase[0].is_copy() { First::Copy } else { First::Weighted };
        let shape = CellStructure { first, pairs: 0, middle: false };
        mix_shape(avx2, &Cell { phases: phase, ..*cell }, shape, row);
    }
}

/// Computes output rows whose arrangement has a kernel. Blocks inside the image are stored directly, blocks at its
/// borders via a temporary buffer.
#[target_feature(enable = "avx2")]
#[inline(never)]
fn mix_shape<const H: usize>(avx2: Avx2, cell: &Cell<'_, H>, shape: CellStructure, rows: &mut [Rgba8]) {
    let weights = &CellWeights::new(cell.phases, shape, cell.deringing);
    let count = cell.phases.len();
    let width = rows.len() / count;
    let head = if cell.skipped == 0 { 0 } else { (BLOCK - cell.skipped).min(width) };
    let blocks = (width - head) / BLOCK;
    let first_block = usize::from(head > 0);
    let SplitRows { heads, blocks: middles, tails } = SplitRows::new(rows, width, head);
    let from = |block: usize| -> Rows<'_, H> {
        let (mut low, mut high) = (cell.low, cell.high);
        for k in 0..H {
            (low[k], high[k]) = (&low[k][block..], &high[k][block..]);
        }
        (low, high)
    };
    let mut aside = [[[0; 32]; 1]; MAX_ROWS];
    if head > 0 {
        with_shape!(shape, sweep::<H>(avx2, from(0), weights, aside.each_mut().map(<[_; 1]>::as_mut_slice)));
        for (row, codes) in heads.into_iter().zip(&aside) {
            let length = 4 * row.len();
            row.as_flattened_mut().copy_from_slice(&codes[0][4 * cell.skipped..][..length]);
        }
    }
    with_shape!(shape, sweep::<H>(avx2, from(first_block), weights, middles));
    if !tails[0].is_empty() {
        let rows = from(first_block + blocks);
        with_shape!(shape, sweep::<H>(avx2, rows, weights, aside.each_mut().map(<[_; 1]>::as_mut_slice)));
        for (row, codes) in tails.into_iter().zip(&aside) {
            let length = row.len();
            row.copy_from_slice(&codes[0][..length]);
        }
    }
}

kernel! {
    pub(super) fn mix_four(avx2: Avx2, cell: &Cell<'_, 2>, rows: &mut [Rgba8]) {
        mix(avx2, cell, rows);
    }
}

kernel! {
    pub(super) fn mix_six(avx2: Avx2, cell: &Cell<'_, 3>, rows: &mut [Rgba8]) {
        mix(avx2, cell, rows);
    }
}
