//! 16-bit fixed-point arithmetic, 16 lanes at a time. [`rounded`] returns lanes in whatever order is fastest on the
//! processor; [`pairs`] restores the order.

use crate::math::lanes::*;

/// Multiplies two fixed-point numbers in units of 2⁻¹⁵, rounding halves up, like the `pmulhrsw` instruction.
pub(super) fn times_one(a: i16, b: i16) -> i16 {
    ((i32::from(a) * i32::from(b) + (1 << 14)) >> 15) as i16
}

/// Rounds floats to integers, ties to even; they must fit in 16 bits.
#[inline(always)]
pub(super) fn rounded<S: Simd>(numbers: f32x16<S>) -> i16x16<S> {
    let simd = numbers.simd;
    let (low, high) = numbers.split();
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = simd.level().as_avx2() {
        let [low, high] = each!(half in [low, high] => f32x8::load_array(avx2, half.to_array()).into());
        let words: i16x16<_> = x86::rounded(avx2, low, high).simd_into(avx2);
        return i16x16::load_array(simd, words.to_array());
    }
    let [low, high]: [i32x8<S>; 2] = each!(half in [low, high] => half.round_ties_even().to_int());
    low.saturating_narrow(high)
}

/// Interleaves two vectors in the order of [`rounded`]: the first eight pixels, then the others.
#[inline(always)]
pub(super) fn pairs<S: Simd>(one: i16x16<S>, other: i16x16<S>) -> [i16x16<S>; 2] {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = one.simd.level().as_avx2() {
        let simd = one.simd;
        let [one, other] = each!(words in [one, other] => i16x16::load_array(avx2, words.to_array()).into());
        let pairs = x86::pairs(avx2, one, other);
        return each!(half in [0, 1] => {
            let half: i16x16<_> = pairs[half].simd_into(avx2);
            i16x16::load_array(simd, half.to_array())
        });
    }
    let (low, high) = one.interleave(other);
    [low, high]
}

/// Multiplies 16 pairs of fixed-point numbers in units of 2⁻¹⁵; see [`times_one`].
#[inline(always)]
pub(super) fn times<S: Simd>(a: i16x16<S>, b: i16x16<S>) -> i16x16<S> {
    let simd = a.simd;
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = simd.level().as_avx2() {
        let [a, b] = each!(words in [a, b] => i16x16::load_array(avx2, words.to_array()).into());
        let product: i16x16<_> = x86::times(avx2, a, b).simd_into(avx2);
        return i16x16::load_array(simd, product.to_array());
    }
    let (low, high) = a.widening_mul(b);
    let [low, high] = each!(half in [low, high] => (half + (1 << 14)) >> 15);
    low.narrow(high)
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use fearless_simd::kernel;

    kernel! {
        #[inline]
        pub(super) fn rounded(avx2: Avx2, low: __m256, high: __m256) -> __m256i {
            _mm256_packs_epi32(_mm256_cvtps_epi32(low), _mm256_cvtps_epi32(high))
        }
    }

    kernel! {
        #[inline]
        pub(super) fn pairs(avx2: Avx2, one: __m256i, other: __m256i) -> [__m256i; 2] {
            [_mm256_unpacklo_epi16(one, other), _mm256_unpackhi_epi16(one, other)]
        }
    }

    kernel! {
        #[inline]
        pub(super) fn times(avx2: Avx2, a: __m256i, b: __m256i) -> __m256i {
            _mm256_mulhrs_epi16(a, b)
        }
    }
}
