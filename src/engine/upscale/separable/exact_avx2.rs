//! AVX2 version of [`super::exact`], 32 channel values at a time.
//!
//! For each block of eight pixels, a widened row holds first red and blue, then green and alpha. If the number of steps
//! D is a power of two, values are scaled so that an interpolated value has eight fractional bits. The 8-bit result is
//! then the upper byte of a 16-bit value: red and blue need only a shift, green and alpha only a mask. Between the rows
//! of a cell, values change by a constant, so each row costs only additions.

use std::arch::x86_64::{
    __m256i, _mm_cvtsi32_si128, _mm256_add_epi16, _mm256_and_si256, _mm256_maddubs_epi16, _mm256_mulhi_epu16,
    _mm256_mullo_epi16, _mm256_or_si256, _mm256_permutevar8x32_epi32, _mm256_set1_epi16, _mm256_shuffle_epi8,
    _mm256_sll_epi16, _mm256_slli_epi16, _mm256_srl_epi16, _mm256_srli_epi16, _mm256_sub_epi16,
};

use fearless_simd::{Avx2, kernel};

use super::cells::Pass;
use crate::image::Rgba8;
use crate::upscale::lanes::{
    Blocks, MAX_ROWS, SplitRows, load, load_codes, load_words, of_one_length, store, store_codes,
};
use crate::upscale::lattice::{Lattice, LatticePosition};
use crate::upscale::quads::window;

/// Maximum number of phase steps between samples: sums then fit in 16 bits, and a period has at most three blocks.
pub(super) const MAX_PHASES: u32 = 8;

/// Number of pixels in a block.
const BLOCK: usize = 8;

/// Eight pixels as 16-bit values: red and blue, then green and alpha.
type ExactBlock = [[i16; 16]; 2];

/// Horizontal and vertical pass for images of a fixed width.
pub(super) struct ExactAvx2 {
    avx2: Avx2,
    steps: u32,
    width: usize,
    /// Number of pixels of the first block that lie left of the image, so that the other blocks are stored at aligned
    /// addresses.
    skipped: usize,
    /// Number of padding samples before the first sample, for the pixels left of it.
    before: usize,
    /// Gather pattern of each block in a period.
    period: Vec<Gather>,
    /// Number of samples per period of gather patterns.
    samples_per_period: usize,
}

/// Gather pattern of a block: two runs of four samples, taken from eight adjacent ones.
struct Gather {
    /// Index of the first of the eight samples in the padded row, for the first period.
    start: usize,
    /// Indices of the samples of both runs among the eight samples.
    runs: [u32; 8],
    /// Byte shuffle that selects two samples per value: for red and blue, then for green and alpha.
    bytes: [[u8; 32]; 2],
    /// Weights of the two samples of each value, in phase steps.
    weights: [u8; 32],
}

impl Gather {
    /// Creates the pattern of the block that starts at pixel `first`. `before` is the number of padding samples left of
    /// the image.
    fn new(lattice: Lattice, first: i64, before: usize) -> Self {
        let starts = [first, first + 4].map(|at| lattice.place_beyond(at).cell);
        let apart = (starts[1] - starts[0]) as u32;
        let mut gather = Self {
            start: (starts[0] + before as i32) as usize,
            runs: [0, 1, 2, 3, apart, apart + 1, apart + 2, apart + 3],
            bytes: [[0; 32]; 2],
            weights: [0; 32],
        };
        for at in 0..8 {
            let LatticePosition { cell, phase } = lattice.place_beyond(first + at);
            // A sample beyond the run has weight zero, so any index will do.
            let from = (cell - starts[at as usize / 4]) as u8;
            let [one, next] = [from, (from + 1).min(3)];
            for channel in 0..4 {
                let value = 4 * at as usize + channel / 2 * 2;
                gather.bytes[channel % 2][value] = 4 * one + channel as u8;
                gather.bytes[channel % 2][value + 1] = 4 * next + channel as u8;
                gather.weights[value] = (lattice.phases() - phase) as u8;
                gather.weights[value + 1] = phase as u8;
            }
        }
        gather
    }
}

/// A widened row, and the padded samples it was computed from.
#[derive(Default)]
pub(super) struct ExactRow {
    padded: Vec<Rgba8>,
    wide: Vec<ExactBlock>,
}

impl ExactAvx2 {
    /// Prepares passes for images of `width` px. `pixels_to_alignment` is the number of pixels in each row before the
    /// first aligned address.
    pub(super) fn new(avx2: Avx2, lattice: Lattice, width: u32, pixels_to_alignment: usize) -> Self {
        let (pixels, samples) = lattice.scale.ratio();
        let skipped = (BLOCK - pixels_to_alignment % BLOCK) % BLOCK;
        let before = (-lattice.place_beyond(-(skipped as i64)).cell).max(0) as usize;
        // Number of blocks until the pattern repeats. If the lattice repeats every three pixels, a single block does
        // not hold a whole number of its periods.
        let blocks: usize = if pixels.is_multiple_of(3) { 3 } else { 1 };
        let first = |block: usize| (block * BLOCK) as i64 - skipped as i64;
        let period = (0..blocks).map(|block| Gather::new(lattice, first(block), before)).collect();
        let samples_per_period = blocks * BLOCK * samples as usize / pixels as usize;
        Self { avx2, steps: lattice.phases(), width: width as usize, skipped, before, period, samples_per_period }
    }

    /// Returns the number of bits by which widened values are shifted left; 0 if the result is computed by division.
    fn shift(&self) -> i32 {
        if self.steps.is_power_of_two() { 8 - 2 * self.steps.trailing_zeros() as i32 } else { 0 }
    }
}

impl Pass for ExactAvx2 {
    type Row = ExactRow;

    const TAPS: usize = 2;

    fn widen(&self, samples: &[Rgba8], row: &mut ExactRow) {
        let periods = (self.skipped + self.width).div_ceil(BLOCK * self.period.len());
        let padded = &mut row.padded;
        padded.clear();
        padded.resize(self.before, samples[0]);
        padded.extend_from_slice(samples);
        // In the block at the right border, a run of four samples may start after the last sample of the image.
        let length = padded.len().max((periods + 1) * self.samples_per_period) + 8;
        padded.resize(length, samples[samples.len() - 1]);
        row.wide.resize(periods * self.period.len(), ExactBlock::default());
        gather(self.avx2, &row.padded, self, &mut row.wide);
    }

    fn mix(&self, around: &[&ExactRow], phases: &[u32], rows: &mut [Rgba8]) {
        mix(self.avx2, self, [&around[0].wide, &around[1].wide], phases, rows);
    }
}

kernel! {
    /// Widens a row of padded samples to output pixels.
    fn gather(avx2: Avx2, padded: &[Rgba8], pass: &ExactAvx2, wide: &mut [ExactBlock]) {
        let shift = _mm_cvtsi32_si128(pass.shift());
        let blocks = pass.period.len();
        for (index, gather) in pass.period.iter().enumerate() {
            let (runs, weights) = (load_words(avx2, &gather.runs), load_codes(avx2, &gather.weights));
            let (even, odd) = (load_codes(avx2, &gather.bytes[0]), load_codes(avx2, &gather.bytes[1]));
            let mut rest = padded[gather.start..].as_flattened();
            for block in wide.chunks_exact_mut(blocks) {
                let samples = _mm256_permutevar8x32_epi32(load_codes(avx2, window(rest, 0)), runs);
                for (plane, bytes) in block[index].iter_mut().zip([even, odd]) {
                    let value = _mm256_maddubs_epi16(_mm256_shuffle_epi8(samples, bytes), weights);
                    store(avx2, _mm256_sll_epi16(value, shift), plane);
                }
                rest = &rest[4 * pass.samples_per_period..];
            }
        }
    }
}

/// Rounding parameters for the conversion of sums to 8-bit values.
#[derive(Clone, Copy)]
struct Rounding {
    /// One half in the unit of the sums.
    half: __m256i,
    /// Right shift that divides by the power-of-two part of D²; the factor 9 is divided separately.
    shift: i32,
}

/// Calls [`sweep`] with const arguments for the number of rows and the kind of rounding.
macro_rules! with_rows {
    ($count:expr, $divide:expr, ($($arg:expr),*)) => {
        match ($count, $divide) {
            (1, false) => sweep::<1, false>($($arg),*),
            (2, false) => sweep::<2, false>($($arg),*),
            (3, false) => sweep::<3, false>($($arg),*),
            (_, false) => sweep::<4, false>($($arg),*),
            (1, true) => sweep::<1, true>($($arg),*),
            (2, true) => sweep::<2, true>($($arg),*),
            (_, true) => sweep::<3, true>($($arg),*),
        }
    };
}

/// Vertical positions of output rows in a cell, in phase steps: steps per cell, position of the first row, and distance
/// between rows.
#[derive(Clone, Copy)]
struct PhaseSteps {
    of_cell: u32,
    first: u32,
    each: u32,
}

kernel! {
    /// Computes the output rows of a cell from the two surrounding widened rows.
    fn mix(avx2: Avx2, pass: &ExactAvx2, around: [&[ExactBlock]; 2], phases: &[u32], rows: &mut [Rgba8]) {
        let count = phases.len();
        let divide = !pass.steps.is_power_of_two();
        let one = if divide { pass.steps * pass.steps } else { 1 << 8 };
        let rounding = Rounding { half: _mm256_set1_epi16((one / 2) as i16), shift: (one / 9).trailing_zeros() as i32 };
        let each = phases.get(1).map_or(0, |second| second - phases[0]);
        let steps = PhaseSteps { of_cell: pass.steps, first: phases[0], each };
        let head = ((BLOCK - pass.skipped) % BLOCK).min(pass.width);
        let (first, blocks) = (usize::from(head > 0), (pass.width - head) / BLOCK);
        let SplitRows { heads, blocks: middles, tails } = SplitRows::new(rows, pass.width, head);
        with_rows!(count, divide, (avx2, around.map(|row| &row[first..]), steps, rounding, middles));
        let heads = heads.map(<[Rgba8]>::as_flattened_mut);
        for (block, skipped, ends) in [(0, pass.skipped, heads), (first + blocks, 0, tails)] {
            if ends[0].is_empty() {
                continue;
            }
            let mut aside = [[[0; 32]; 1]; MAX_ROWS];
            let into = aside.each_mut().map(<[_; 1]>::as_mut_slice);
            with_rows!(count, divide, (avx2, around.map(|row| &row[block..]), steps, rounding, into));
            for (row, codes) in ends.into_iter().zip(&aside) {
                let length = row.len();
                row.copy_from_slice(&codes[0][4 * skipped..][..length]);
            }
        }
    }
}

/// Computes all whole blocks in the `ROWS` output rows of a cell from the widened rows above and below it.
#[target_feature(enable = "avx2")]
#[inline(never)]
fn sweep<const ROWS: usize, const DIVIDE: bool>(
    avx2: Avx2,
    around: [&[ExactBlock]; 2],
    steps: PhaseSteps,
    rounding: Rounding,
    rows: [Blocks<'_>; MAX_ROWS],
) {
    /// 2¹⁶ / 9, rounded up: the upper 16 bits of a product with it are the quotient by 9, exact for every possible sum.
    const NINTH: i16 = 7282;
    let [row_0, row_1, row_2, row_3] = of_one_length(rows, ROWS);
    let blocks = row_0.len();
    let [above, below] = around;
    let (above, below) = (&above[..blocks], &below[..blocks]);
    let (of_cell, first) = (_mm256_set1_epi16(steps.of_cell as i16), _mm256_set1_epi16(steps.first as i16));
    let (each, ninth) = (_mm256_set1_epi16(steps.each as i16), _mm256_set1_epi16(NINTH));
    let shift = _mm_cvtsi32_si128(rounding.shift);
    let upper = _mm256_set1_epi16(0xff00_u16 as i16);
    // Returns the value in the first row of a cell, and its increment per row.
    let start = |block: usize, plane: usize| {
        let (a, b) = (load(avx2, &above[block][plane]), load(avx2, &below[block][plane]));
        let difference = _mm256_sub_epi16(b, a);
        let value = _mm256_add_epi16(_mm256_mullo_epi16(a, of_cell), rounding.half);
        (_mm256_add_epi16(value, _mm256_mullo_epi16(difference, first)), _mm256_mullo_epi16(difference, each))
    };
    let codes = |even, odd| {
        if DIVIDE {
            let even = _mm256_mulhi_epu16(_mm256_srl_epi16(even, shift), ninth);
            let odd = _mm256_mulhi_epu16(_mm256_srl_epi16(odd, shift), ninth);
            _mm256_or_si256(even, _mm256_slli_epi16::<8>(odd))
        } else {
            _mm256_or_si256(_mm256_srli_epi16::<8>(even), _mm256_and_si256(odd, upper))
        }
    };
    for block in 0..blocks {
        let ((mut even, even_growth), (mut odd, odd_growth)) = (start(block, 0), start(block, 1));
        store_codes(avx2, codes(even, odd), &mut row_0[block]);
        if ROWS > 1 {
            (even, odd) = (_mm256_add_epi16(even, even_growth), _mm256_add_epi16(odd, odd_growth));
            store_codes(avx2, codes(even, odd), &mut row_1[block]);
        }
        if ROWS > 2 {
            (even, odd) = (_mm256_add_epi16(even, even_growth), _mm256_add_epi16(odd, odd_growth));
            store_codes(avx2, codes(even, odd), &mut row_2[block]);
        }
        if ROWS > 3 {
            (even, odd) = (_mm256_add_epi16(even, even_growth), _mm256_add_epi16(odd, odd_growth));
            store_codes(avx2, codes(even, odd), &mut row_3[block]);
        }
    }
}
