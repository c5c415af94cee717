//! Operations on lanes in instructions of AVX2 and AVX-512 that the compiler does not find by itself.

use std::arch::x86_64::*;

use fearless_simd::kernel;

kernel! {
    /// Transposes both 128-bit halves at once, each as [`super::transpose`] does.
    #[inline]
    pub(super) fn transpose_halves(avx2: Avx2, rows: [__m256; 4]) -> [__m256; 4] {
        let [a, b, c, d] = rows;
        let (ac0, ac1) = (_mm256_unpacklo_ps(a, c), _mm256_unpackhi_ps(a, c));
        let (bd0, bd1) = (_mm256_unpacklo_ps(b, d), _mm256_unpackhi_ps(b, d));
        [
            _mm256_unpacklo_ps(ac0, bd0),
            _mm256_unpackhi_ps(ac0, bd0),
            _mm256_unpacklo_ps(ac1, bd1),
            _mm256_unpackhi_ps(ac1, bd1),
        ]
    }
}

kernel! {
    /// Transposes all four 128-bit quarters at once, each as [`super::transpose`] does.
    #[inline]
    pub(super) fn transpose_quarters(avx512: Avx512, rows: [__m512; 4]) -> [__m512; 4] {
        let [a, b, c, d] = rows;
        let (ac0, ac1) = (_mm512_unpacklo_ps(a, c), _mm512_unpackhi_ps(a, c));
        let (bd0, bd1) = (_mm512_unpacklo_ps(b, d), _mm512_unpackhi_ps(b, d));
        [
            _mm512_unpacklo_ps(ac0, bd0),
            _mm512_unpackhi_ps(ac0, bd0),
            _mm512_unpacklo_ps(ac1, bd1),
            _mm512_unpackhi_ps(ac1, bd1),
        ]
    }
}

kernel! {
    /// Repeats lanes as [`super::repeat_each`] does.
    #[inline]
    pub(super) fn repeat_each(avx512: Avx512, numbers: __m512) -> [__m512; 4] {
        [
            _mm512_permute_ps::<0b00_00_00_00>(numbers),
            _mm512_permute_ps::<0b01_01_01_01>(numbers),
            _mm512_permute_ps::<0b10_10_10_10>(numbers),
            _mm512_permute_ps::<0b11_11_11_11>(numbers),
        ]
    }
}

kernel! {
    /// Returns the entries of a table, given as two halves, as [`super::entries_of_32`] does.
    #[inline]
    pub(super) fn entries_of_32(avx512: Avx512, halves: [__m512i; 2], indices: __m512i) -> __m512i {
        _mm512_permutex2var_epi32(halves[0], indices, halves[1])
    }
}

kernel! {
    /// Converts eight integers to doubles in two halves, as [`super::doubles_of`] does.
    #[inline]
    pub(super) fn doubles_of(avx2: Avx2, numbers: __m256i) -> [__m256d; 2] {
        [
            _mm256_cvtepi32_pd(_mm256_castsi256_si128(numbers)),
            _mm256_cvtepi32_pd(_mm256_extracti128_si256::<1>(numbers)),
        ]
    }
}
