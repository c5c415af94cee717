//! AVX2 version of [`super::fixed`], 16 values at a time.
//!
//! Widened rows are stored in the order that packing two registers into one register of 8-bit values requires: pixels
//! 0, 1, 4, 5 of each block of eight, then 2, 3, 6, 7. A widened row starts with the first pixel of a cell. In a
//! centred lattice, this pixel lies left of the image.
//!
//! Arrays of registers are filled by loops: a closure passed to a standard library function would be compiled without
//! the AVX2 feature and called once per register.

mod cell;

mod gather;

mod mix;

mod widen;

use std::arch::x86_64::{_mm256_add_epi16, _mm256_cvtepu8_epi16, _mm256_set1_epi16, _mm256_slli_epi16};
use std::array;

use fearless_simd::{Avx2, kernel};

use self::gather::GatherTable;
use self::mix::{Cell, mix_four, mix_six};
use self::widen::{Widening, gather_by_four, gather_by_six, widen_by_four, widen_by_six};
use super::cells::Pass;
use super::fixed::{POINT, PhaseWeights, value_of};
use crate::image::Rgba8;
use crate::upscale::Upscaling;
use crate::upscale::lanes::{load_bytes, store};
use crate::upscale::lattice::Lattice;

/// Number of pixels in a block.
const BLOCK: usize = 8;

/// Number of samples widened at a time.
const GROUP: usize = 4;

/// Maximum number of channel values read for a group: the values of its own samples and of the six samples around it.
const WINDOW: usize = 4 * (6 + GROUP);

/// Eight pixels in two registers, in the order of a widened row.
type Block = [[i16; 16]; 2];

/// Returns the storage location of pixel `at` in a widened row: block, register, and index of its first value.
#[inline]
fn slot(at: usize) -> (usize, usize, usize) {
    (at / BLOCK, at / 2 % 2, at / 4 % 2 * 8 + at % 2 * 4)
}

/// Horizontal and vertical pass for images on a lattice, with `H` pairs of taps along each axis.
pub(super) struct FixedAvx2<'a, const H: usize> {
    avx2: Avx2,
    phases: &'a [PhaseWeights<H>],
    lattice: Lattice,
    deringing: bool,
    width: usize,
    /// Index of the cell at which widened rows start; `skipped` is the number of pixels that these rows have left of
    /// the image.
    first_cell: i32,
    skipped: usize,
    /// For each pixel of a period, its cell relative to the first cell of the period, and its phase.
    period: Vec<(usize, u32)>,
    /// Table for the horizontal pass if a group of samples has no whole number of periods.
    gathered: Option<GatherTable<H>>,
}

/// A widened row, and the padded samples it was computed from.
#[derive(Default)]
pub(super) struct Row {
    padded: Vec<i16>,
    wide: Vec<Block>,
}

impl<'a, const H: usize> FixedAvx2<'a, H> {
    /// Prepares passes for images of `width` px, at least one. `pixels_to_alignment` is the number of pixels in each
    /// row before the first aligned address.
    pub(super) fn new(
        avx2: Avx2,
        phases: &'a [PhaseWeights<H>],
        how: Upscaling,
        width: u32,
        pixels_to_alignment: usize,
    ) -> Self {
        let lattice = how.lattice();
        let (pixels, samples) = lattice.scale.ratio();
        let mut first_cell = lattice.place(0).cell;
        let mut skipped = (1_i64..).take_while(|back| lattice.place_beyond(-back).cell == first_cell).count();
        // Moves the start to the left by a whole number of cells, if this aligns all blocks after the first.
        let wanted = (BLOCK - pixels_to_alignment % BLOCK) % BLOCK;
        let cells = wanted.checked_sub(skipped).filter(|px| samples == 1 && px.is_multiple_of(pixels as usize));
        if let Some(px) = cells {
            first_cell -= (px / pixels as usize) as i32;
            skipped = wanted;
        }
        let places = (0..i64::from(pixels)).map(|at| lattice.place_beyond(at - skipped as i64));
        let period: Vec<_> = places.map(|place| ((place.cell - first_cell) as usize, place.phase)).collect();
        let (deringing, width) = (how.deringing(), width as usize);
        let gathered = (!GROUP.is_multiple_of(samples as usize)).then(|| {
            let period: Vec<_> = period.iter().map(|(cell, at)| (*cell, &phases[*at as usize])).collect();
            GatherTable::new(&period, samples as usize, deringing)
        });
        Self { avx2, phases, lattice, deringing, width, first_cell, skipped, period, gathered }
    }

    /// Converts samples to fixed point and pads them with copies of the border samples.
    fn pad(&self, samples: &[Rgba8], padded: &mut Vec<i16>) {
        let before = (H as i32 - 1 - self.first_cell) as usize;
        let cells = self.groups() * GROUP;
        // The last block may read samples beyond the last group.
        padded.resize((before + cells + BLOCK).max(before + samples.len()) * 4 + WINDOW, 0);
        let (left, rest) = padded.as_chunks_mut::<4>().0.split_at_mut(before);
        let (middle, right) = rest.split_at_mut(samples.len());
        left.fill(samples[0].map(value_of));
        right.fill(samples[samples.len() - 1].map(value_of));
        centre(self.avx2, samples.as_flattened(), middle.as_flattened_mut());
    }

    /// Returns the number of groups of [`GROUP`] samples in a row.
    fn groups(&self) -> usize {
        let (pixels, samples) = self.lattice.scale.ratio();
        ((self.skipped + self.width) * samples as usize).div_ceil(pixels as usize).div_ceil(GROUP)
    }
}

kernel! {
    /// Converts 8-bit values to fixed point.
    fn centre(avx2: Avx2, codes: &[u8], values: &mut [i16]) {
        let (blocks, rest) = codes.as_chunks::<16>();
        let (into, rest_into) = values.as_chunks_mut::<16>();
        let middle = _mm256_set1_epi16(value_of(0));
        for (codes, values) in blocks.iter().zip(into) {
            let wide = _mm256_slli_epi16::<{ POINT as i32 }>(_mm256_cvtepu8_epi16(load_bytes(avx2, codes)));
            store(avx2, _mm256_add_epi16(wide, middle), values);
        }
        for (code, value) in rest.iter().zip(rest_into) {
            *value = value_of(*code);
        }
    }
}

/// Implements the passes for each number of taps, because functions of `kernel!` take no type parameters.
macro_rules! passes {
    ($h:literal, $gather:ident, $widen:ident, $mix:ident) => {
        impl Pass for FixedAvx2<'_, $h> {
            type Row = Row;

            const TAPS: usize = 2 * $h;

            fn widen(&self, samples: &[Rgba8], row: &mut Row) {
                self.pad(samples, &mut row.padded);
                if let Some(table) = &self.gathered {
                    row.wide.resize((self.skipped + self.width).div_ceil(BLOCK), Block::default());
                    return $gather(self.avx2, &row.padded, table, &mut row.wide);
                }
                let (_, samples_per_period) = self.lattice.scale.ratio();
                let period: Vec<_> = self.period.iter().map(|(cell, at)| (*cell, &self.phases[*at as usize])).collect();
                let pixels = self.groups() * GROUP / samples_per_period as usize * period.len();
                row.wide.resize(pixels.div_ceil(BLOCK), Block::default());
                let samples_per_period = samples_per_period as usize;
                let widening = Widening { period: &period, samples_per_period, deringing: self.deringing };
                $widen(self.avx2, &row.padded, &widening, &mut row.wide);
            }

            fn mix(&self, around: &[&Row], phases: &[u32], rows: &mut [Rgba8]) {
                let phases: Vec<_> = phases.iter().map(|at| &self.phases[*at as usize]).collect();
                let low = array::from_fn(|k| around[k].wide.as_slice());
                let high = array::from_fn(|k| around[2 * $h - 1 - k].wide.as_slice());
                let cell = Cell { low, high, phases: &phases, skipped: self.skipped, deringing: self.deringing };
                $mix(self.avx2, &cell, rows);
            }
        }
    };
}

passes!(2, gather_by_four, widen_by_four, mix_four);
passes!(3, gather_by_six, widen_by_six, mix_six);
