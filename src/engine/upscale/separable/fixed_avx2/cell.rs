//! Values at the output positions of a cell: the arithmetic that both passes share.

use std::arch::x86_64::{
    __m256i, _mm256_add_epi16, _mm256_max_epi16, _mm256_min_epi16, _mm256_mulhrs_epi16, _mm256_set1_epi16,
    _mm256_setzero_si256, _mm256_sub_epi16,
};
use std::array;

use fearless_simd::Avx2;

use super::super::fixed::PhaseWeights;
use super::WINDOW;
use crate::upscale::lanes::{MAX_ROWS, load};
use crate::upscale::quads::window;

/// Arrangement of the output positions in a cell, in order: an optional unpaired first one, then mirrored pairs around
/// an optional middle one.
#[derive(Clone, Copy)]
pub(super) struct CellStructure {
    pub(super) first: First,
    pub(super) pairs: usize,
    pub(super) middle: bool,
}

/// Kind of the unpaired first output position in a cell.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum First {
    None,
    Copy,
    Weighted,
}

/// Weights of the output positions in a cell, broadcast to registers.
pub(super) struct CellWeights<const H: usize> {
    first: [[__m256i; H]; 2],
    first_mirrored: bool,
    pairs: [[[__m256i; H]; 2]; 2],
    middle: [__m256i; H],
    deringing: bool,
}

/// Returns the arrangement of the output positions in a cell, or `None` if there is no kernel for it.
pub(super) fn shape_of<const H: usize>(phases: &[&PhaseWeights<H>]) -> Option<CellStructure> {
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
pub(super) fn spread<const H: usize>(weights: [i16; H]) -> [__m256i; H] {
    let mut spread = [_mm256_setzero_si256(); H];
    for (register, weight) in spread.iter_mut().zip(weights) {
        *register = _mm256_set1_epi16(weight);
    }
    spread
}

impl<const H: usize> CellWeights<H> {
    #[target_feature(enable = "avx2")]
    #[inline]
    pub(super) fn new(phases: &[&PhaseWeights<H>], shape: CellStructure, deringing: bool) -> Self {
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
pub(super) fn dot<const H: usize>(weights: &[__m256i; H], values: &[__m256i; H]) -> __m256i {
    let first = _mm256_mulhrs_epi16(values[0], weights[0]);
    let sum = _mm256_add_epi16(first, _mm256_mulhrs_epi16(values[1], weights[1]));
    if H == 2 { sum } else { _mm256_add_epi16(sum, _mm256_mulhrs_epi16(values[H - 1], weights[H - 1])) }
}

/// Samples around an output position: sums and differences of symmetric pairs, outermost first, and the inner two
/// samples.
pub(super) struct TapPairs<const H: usize> {
    pub(super) sums: [__m256i; H],
    pub(super) differences: [__m256i; H],
    pub(super) inner: (__m256i, __m256i),
}

impl<const H: usize> TapPairs<H> {
    /// Combines the samples before a position (`low`) and after it (`high`), both outermost first.
    #[target_feature(enable = "avx2")]
    #[inline]
    pub(super) fn new(low: [__m256i; H], high: [__m256i; H]) -> Self {
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
    pub(super) fn group(avx2: Avx2, values: &[i16; WINDOW], cell: usize) -> Self {
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
    pub(super) fn keep(&self, value: __m256i, bias: __m256i, deringing: bool) -> __m256i {
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
pub(super) fn places<const H: usize, const FIRST: u8, const PAIRS: usize, const MIDDLE: bool>(
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

pub(super) use with_shape;
