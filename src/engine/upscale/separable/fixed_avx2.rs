//! AVX2 version of [`super::fixed`], 16 values at a time.
//!
//! Widened rows are stored in the order that packing two registers into one register of 8-bit values requires: pixels
//! 0, 1, 4, 5 of each block of eight, then 2, 3, 6, 7. A widened row starts with the first pixel of a cell. In a
//! centred lattice, this pixel lies left of the image.
//!
//! Arrays of registers are filled by loops: a closure passed to a standard library function would be compiled without
//! the AVX2 feature and called once per register.

use std::arch::x86_64::{
    __m256i, _mm256_add_epi16, _mm256_cvtepu8_epi16, _mm256_max_epi16, _mm256_min_epi16, _mm256_mulhrs_epi16,
    _mm256_packus_epi16, _mm256_permute2x128_si256, _mm256_set1_epi16, _mm256_setzero_si256, _mm256_slli_epi16,
    _mm256_srai_epi16, _mm256_sub_epi16, _mm256_unpackhi_epi64, _mm256_unpacklo_epi64,
};
use std::array;

use fearless_simd::{Avx2, kernel};

use super::cells::Pass;
use super::fixed::{BIAS, POINT, PhaseWeights, value_of};
use super::gather_avx2::{self, GatherTable};
use crate::image::Rgba8;
use crate::upscale::Upscaling;
use crate::upscale::lanes::{Blocks, MAX_ROWS, SplitRows, load, load_bytes, of_one_length, store, store_codes};
use crate::upscale::lattice::Lattice;
use crate::upscale::quads::window;

/// Number of pixels in a block.
pub(super) const BLOCK: usize = 8;

/// Number of samples widened at a time.
const GROUP: usize = 4;

/// Maximum number of channel values read for a group: the values of its own samples and of the six samples around it.
const WINDOW: usize = 4 * (6 + GROUP);

/// Eight pixels in two registers, in the order of a widened row.
pub(super) type Block = [[i16; 16]; 2];

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

/// Arrangement of the output positions in a cell, in order: an optional unpaired first one, then mirrored pairs around
/// an optional middle one.
#[derive(Clone, Copy)]
struct CellStructure {
    first: First,
    pairs: usize,
    middle: bool,
}

/// Kind of the unpaired first output position in a cell.
#[derive(Clone, Copy, PartialEq, Eq)]
enum First {
    None,
    Copy,
    Weighted,
}

/// Weights of the output positions in a cell, broadcast to registers.
struct CellWeights<const H: usize> {
    first: [[__m256i; H]; 2],
    first_mirrored: bool,
    pairs: [[[__m256i; H]; 2]; 2],
    middle: [__m256i; H],
    deringing: bool,
}

/// Returns the arrangement of the output positions in a cell, or `None` if there is no kernel for it.
fn shape_of<const H: usize>(phases: &[&PhaseWeights<H>]) -> Option<CellStructure> {
    let mirrored = |rest: &[&PhaseWeights<H>]| {
        let count = rest.len();
        (0..count / 2).all(|i| rest[i].mirrors(rest[count - 1 - i]))
            && (count.is_multiple_of(2) || rest[count / 2].is_middle())
    };
    let (first, rest) = if mirrored(phases) {
        (First::None, phases)
    } else {
        (if phases[0].is_copy() { First::Copy } else { First::Weighted }, &phases[1..])
    };
    mirrored(rest).then_some(CellStructure { first, pairs: rest.len() / 2, middle: rest.len() % 2 == 1 })
}

#[target_feature(enable = "avx2")]
#[inline]
fn spread<const H: usize>(weights: [i16; H]) -> [__m256i; H] {
    let mut spread = [_mm256_setzero_si256(); H];
    for (register, weight) in spread.iter_mut().zip(weights) {
        *register = _mm256_set1_epi16(weight);
    }
    spread
}

impl<const H: usize> CellWeights<H> {
    #[target_feature(enable = "avx2")]
    #[inline]
    fn new(phases: &[&PhaseWeights<H>], shape: CellStructure, deringing: bool) -> Self {
        let zero = [_mm256_setzero_si256(); H];
        let rest = &phases[usize::from(shape.first != First::None)..];
        let both = |phase: &PhaseWeights<H>| [spread(phase.even), spread(phase.odd)];
        Self {
            first: both(phases[0]),
            first_mirrored: phases[0].mirrored,
            pairs: array::from_fn(|pair| if pair < shape.pairs { both(rest[pair]) } else { [zero; 2] }),
            middle: rest.get(shape.pairs).map_or(zero, |phase| spread(phase.even)),
            deringing,
        }
    }
}

/// Computes the dot product of two or three terms, each product rounded to the unit of the sum.
#[target_feature(enable = "avx2")]
#[inline]
fn dot<const H: usize>(weights: &[__m256i; H], values: &[__m256i; H]) -> __m256i {
    let first = _mm256_mulhrs_epi16(values[0], weights[0]);
    let sum = _mm256_add_epi16(first, _mm256_mulhrs_epi16(values[1], weights[1]));
    if H == 2 { sum } else { _mm256_add_epi16(sum, _mm256_mulhrs_epi16(values[H - 1], weights[H - 1])) }
}

/// Samples around an output position: sums and differences of symmetric pairs, outermost first, and the inner two
/// samples.
struct TapPairs<const H: usize> {
    sums: [__m256i; H],
    differences: [__m256i; H],
    inner: (__m256i, __m256i),
}

impl<const H: usize> TapPairs<H> {
    /// Combines the samples before a position (`low`) and after it (`high`), both outermost first.
    #[target_feature(enable = "avx2")]
    #[inline]
    fn new(low: [__m256i; H], high: [__m256i; H]) -> Self {
        let mut around = Self { sums: low, differences: low, inner: (low[H - 1], high[H - 1]) };
        for k in 0..H {
            around.sums[k] = _mm256_add_epi16(low[k], high[k]);
            around.differences[k] = _mm256_sub_epi16(low[k], high[k]);
        }
        around
    }

    /// Loads the samples around a group of adjacent positions. The first of these samples has index `cell` in the
    /// window.
    #[target_feature(enable = "avx2")]
    #[inline]
    fn group(avx2: Avx2, values: &[i16; WINDOW], cell: usize) -> Self {
        let (mut low, mut high) = ([_mm256_setzero_si256(); H], [_mm256_setzero_si256(); H]);
        for k in 0..H {
            low[k] = load(avx2, window(values, 4 * (cell + k)));
            high[k] = load(avx2, window(values, 4 * (cell + 2 * H - 1 - k)));
        }
        Self::new(low, high)
    }

    /// Clamps a value that includes `bias` to the range of the inner two samples, if `deringing` is set.
    #[target_feature(enable = "avx2")]
    #[inline]
    fn keep(&self, value: __m256i, bias: __m256i, deringing: bool) -> __m256i {
        if !deringing {
            return value;
        }
        let (a, b) = (_mm256_add_epi16(self.inner.0, bias), _mm256_add_epi16(self.inner.1, bias));
        _mm256_min_epi16(_mm256_max_epi16(value, _mm256_min_epi16(a, b)), _mm256_max_epi16(a, b))
    }
}

/// Returns the interpolated values at all output positions of a cell, plus `bias`. The code has no loops, because the
/// compiler would keep the values of a loop in memory instead of in registers.
#[target_feature(enable = "avx2")]
#[inline]
fn places<const H: usize, const FIRST: u8, const PAIRS: usize, const MIDDLE: bool>(
    around: &TapPairs<H>,
    weights: &CellWeights<H>,
    bias: __m256i,
) -> [__m256i; MAX_ROWS] {
    let keep = |value| around.keep(value, bias, weights.deringing);
    let first = if FIRST == First::Copy as u8 {
        _mm256_add_epi16(around.inner.0, bias)
    } else if FIRST == First::Weighted as u8 {
        let even = _mm256_add_epi16(bias, dot(&weights.first[0], &around.sums));
        let odd = dot(&weights.first[1], &around.differences);
        keep(if weights.first_mirrored { _mm256_sub_epi16(even, odd) } else { _mm256_add_epi16(even, odd) })
    } else {
        bias
    };
    let pair = |index: usize| {
        let even = _mm256_add_epi16(bias, dot(&weights.pairs[index][0], &around.sums));
        let odd = dot(&weights.pairs[index][1], &around.differences);
        (keep(_mm256_add_epi16(even, odd)), keep(_mm256_sub_epi16(even, odd)))
    };
    let (outer_low, outer_high) = if PAIRS > 0 { pair(0) } else { (bias, bias) };
    let (inner_low, inner_high) = if PAIRS > 1 { pair(1) } else { (bias, bias) };
    let middle = if MIDDLE { keep(_mm256_add_epi16(bias, dot(&weights.middle, &around.sums))) } else { bias };
    match (FIRST == First::None as u8, PAIRS, MIDDLE) {
        (true, 2, _) => [outer_low, inner_low, inner_high, outer_high],
        (true, 1, _) => [outer_low, outer_high, bias, bias],
        (true, _, _) => [middle, bias, bias, bias],
        (false, 1, true) => [first, outer_low, middle, outer_high],
        (false, 1, false) => [first, outer_low, outer_high, bias],
        (false, _, _) => [first, middle, bias, bias],
    }
}

/// Calls a function with the const arguments of a [`CellStructure`].
macro_rules! with_shape {
    ($shape:expr, $call:ident::<$h:ident>($($arg:expr),*)) => {
        match ($shape.first, $shape.pairs, $shape.middle) {
            (First::Copy, 0, true) => $call::<$h, { First::Copy as u8 }, 0, true>($($arg),*),
            (First::Copy, 1, false) => $call::<$h, { First::Copy as u8 }, 1, false>($($arg),*),
            (First::Copy, 1, true) => $call::<$h, { First::Copy as u8 }, 1, true>($($arg),*),
            (First::Copy, _, _) => $call::<$h, { First::Copy as u8 }, 0, false>($($arg),*),
            (First::Weighted, 0, true) => $call::<$h, { First::Weighted as u8 }, 0, true>($($arg),*),
            (First::Weighted, 1, false) => $call::<$h, { First::Weighted as u8 }, 1, false>($($arg),*),
            (First::Weighted, 1, true) => $call::<$h, { First::Weighted as u8 }, 1, true>($($arg),*),
            (First::Weighted, _, _) => $call::<$h, { First::Weighted as u8 }, 0, false>($($arg),*),
            (First::None, 1, false) => $call::<$h, { First::None as u8 }, 1, false>($($arg),*),
            (First::None, 2, _) => $call::<$h, { First::None as u8 }, 2, false>($($arg),*),
            (First::None, _, _) => $call::<$h, { First::None as u8 }, 0, true>($($arg),*),
        }
    };
}

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

/// Widened rows before and after a cell, both outermost first.
type Rows<'a, const H: usize> = ([&'a [Block]; H], [&'a [Block]; H]);

/// Widens groups of samples by a factor of 2 or 4. All cells have the same arrangement of output positions.
#[target_feature(enable = "avx2")]
#[inline(never)]
fn widen_cells<const H: usize, const FIRST: u8, const PAIRS: usize, const MIDDLE: bool>(
    avx2: Avx2,
    padded: &[i16],
    weights: &CellWeights<H>,
    wide: &mut [Block],
) {
    let zero = _mm256_setzero_si256();
    let lead = if FIRST == First::None as u8 { 0 } else { 1 };
    let count = lead + 2 * PAIRS + usize::from(MIDDLE);
    for (group, blocks) in wide.chunks_exact_mut(count / 2).enumerate() {
        let around: &[i16; WINDOW] = window(padded, 4 * GROUP * group);
        let of = places::<H, FIRST, PAIRS, MIDDLE>(&TapPairs::group(avx2, around, 0), weights, zero);
        // `one` has the first two output positions of samples 0 and 2 of the group, one sample in each 128-bit half.
        // `next` has those of samples 1 and 3.
        let (one, next) = (_mm256_unpacklo_epi64(of[0], of[1]), _mm256_unpackhi_epi64(of[0], of[1]));
        if let [block] = blocks {
            store(avx2, one, &mut block[0]);
            store(avx2, next, &mut block[1]);
        } else if let [first, second] = blocks {
            let (one_on, next_on) = (_mm256_unpacklo_epi64(of[2], of[3]), _mm256_unpackhi_epi64(of[2], of[3]));
            store(avx2, _mm256_permute2x128_si256::<0x20>(one, next), &mut first[0]);
            store(avx2, _mm256_permute2x128_si256::<0x20>(one_on, next_on), &mut first[1]);
            store(avx2, _mm256_permute2x128_si256::<0x31>(one, next), &mut second[0]);
            store(avx2, _mm256_permute2x128_si256::<0x31>(one_on, next_on), &mut second[1]);
        }
    }
}

/// Returns the interpolated values at one position between samples.
#[target_feature(enable = "avx2")]
#[inline]
fn place<const H: usize>(phase: &PhaseWeights<H>, around: &TapPairs<H>, deringing: bool) -> __m256i {
    if phase.is_copy() {
        return around.inner.0;
    }
    let (even, odd) = (dot(&spread(phase.even), &around.sums), dot(&spread(phase.odd), &around.differences));
    let sum = if phase.mirrored { _mm256_sub_epi16(even, odd) } else { _mm256_add_epi16(even, odd) };
    around.keep(sum, _mm256_setzero_si256(), deringing)
}

/// Returns the storage location of pixel `at` in a widened row: block, register, and index of its first value.
#[inline]
pub(super) fn slot(at: usize) -> (usize, usize, usize) {
    (at / BLOCK, at / 2 % 2, at / 4 % 2 * 8 + at % 2 * 4)
}

/// Widens groups of samples for lattices with any period.
#[target_feature(enable = "avx2")]
fn widen_any<const H: usize>(avx2: Avx2, padded: &[i16], widening: &Widening<'_, H>, wide: &mut [Block]) {
    let Widening { period, samples_per_period, deringing } = *widening;
    let pixels_per_group = GROUP / samples_per_period * period.len();
    for group in 0..wide.len() * BLOCK / pixels_per_group {
        let around: &[i16; WINDOW] = window(padded, 4 * GROUP * group);
        for (index, (cell, phase)) in period.iter().enumerate() {
            let mut values = [0; 16];
            store(avx2, place(phase, &TapPairs::group(avx2, around, *cell), deringing), &mut values);
            for (repeat, of_sample) in values.chunks_exact(4 * samples_per_period).enumerate() {
                let (block, register, first) = slot(group * pixels_per_group + repeat * period.len() + index);
                wide[block][register][first..first + 4].copy_from_slice(&of_sample[..4]);
            }
        }
    }
}

/// Parameters for widening a row of samples.
struct Widening<'a, const H: usize> {
    period: &'a [(usize, &'a PhaseWeights<H>)],
    samples_per_period: usize,
    deringing: bool,
}

#[target_feature(enable = "avx2")]
fn widen<const H: usize>(avx2: Avx2, padded: &[i16], widening: &Widening<'_, H>, wide: &mut [Block]) {
    let Widening { period, samples_per_period, deringing } = *widening;
    let phases: [&PhaseWeights<H>; MAX_ROWS] = array::from_fn(|at| period[at.min(period.len() - 1)].1);
    let phases = &phases[..period.len()];
    match shape_of(phases).filter(|_| samples_per_period == 1 && matches!(period.len(), 2 | 4)) {
        Some(shape) => {
            let weights = CellWeights::new(phases, shape, deringing);
            with_shape!(shape, widen_cells::<H>(avx2, padded, &weights, wide));
        }
        None => widen_any(avx2, padded, widening, wide),
    }
}

kernel! {
    fn gather_by_four(avx2: Avx2, padded: &[i16], table: &GatherTable<2>, wide: &mut [Block]) {
        gather_avx2::widen(avx2, padded, table, wide);
    }
}

kernel! {
    fn gather_by_six(avx2: Avx2, padded: &[i16], table: &GatherTable<3>, wide: &mut [Block]) {
        gather_avx2::widen(avx2, padded, table, wide);
    }
}

kernel! {
    fn widen_by_four(avx2: Avx2, padded: &[i16], widening: &Widening<'_, 2>, wide: &mut [Block]) {
        widen(avx2, padded, widening, wide);
    }
}

kernel! {
    fn widen_by_six(avx2: Avx2, padded: &[i16], widening: &Widening<'_, 3>, wide: &mut [Block]) {
        widen(avx2, padded, widening, wide);
    }
}

/// Inputs for the output rows of one cell: the surrounding widened rows, and the phases of the rows.
struct Cell<'a, const H: usize> {
    low: [&'a [Block]; H],
    high: [&'a [Block]; H],
    phases: &'a [&'a PhaseWeights<H>],
    /// Number of pixels that the widened rows have left of the image.
    skipped: usize,
    deringing: bool,
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
    fn mix_four(avx2: Avx2, cell: &Cell<'_, 2>, rows: &mut [Rgba8]) {
        mix(avx2, cell, rows);
    }
}

kernel! {
    fn mix_six(avx2: Avx2, cell: &Cell<'_, 3>, rows: &mut [Rgba8]) {
        mix(avx2, cell, rows);
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
