//! Texels at eight or sixteen places at once: by the instructions for that where the processor has them, else one after the other.

use crate::math::lanes::*;

/// The texels at eight places.
///
/// # Panics
/// If one of the places lies outside of the texels.
#[inline(always)]
pub(super) fn gather<S: Simd>(simd: S, texels: &[u32], places: u32x8<S>) -> u32x8<S> {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = simd.level().as_avx2() {
        let places = u32x8::load_array(avx2, places.to_array());
        let texels: u32x8<_> = x86::gather(avx2, texels, places.into()).simd_into(avx2);
        return u32x8::load_array(simd, texels.to_array());
    }
    let places = places.to_array();
    u32x8::load_array(simd, each!(lane in [0, 1, 2, 3, 4, 5, 6, 7] => texels[places[lane] as usize]))
}

/// The texels at twice sixteen places, each with those after them.
///
/// # Panics
/// If one of the places, or the one after it, lies outside of the texels.
#[inline(always)]
pub(super) fn gather_pairs<S: Simd>(simd: S, texels: &[u32], places: [u32x16<S>; 2]) -> [[u32x16<S>; 2]; 2] {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = simd.level().as_avx512() {
        let [upper, lower] = each!(places in [places[0], places[1]] => u32x16::load_array(avx512, places.to_array()));
        let gathered = x86::gather_wide_pairs(avx512, texels, upper.into(), lower.into());
        return each!(i in [0, 1] => each!(texels in [gathered[2 * i], gathered[2 * i + 1]] => {
            let texels: u32x16<_> = texels.simd_into(avx512);
            u32x16::load_array(simd, texels.to_array())
        }));
    }
    each!(places in [places[0], places[1]] => {
        let (low, high) = places.split();
        let [low, high] = each!(places in [low, high] => gather_eight_pairs(simd, texels, places));
        [low[0].combine(high[0]), low[1].combine(high[1])]
    })
}

#[inline(always)]
fn gather_eight_pairs<S: Simd>(simd: S, texels: &[u32], places: u32x8<S>) -> [u32x8<S>; 2] {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = simd.level().as_avx2() {
        let places = u32x8::load_array(avx2, places.to_array());
        let (first, second) = x86::gather_pairs(avx2, texels, places.into());
        return each!(texels in [first, second] => {
            let texels: u32x8<_> = texels.simd_into(avx2);
            u32x8::load_array(simd, texels.to_array())
        });
    }
    let places = places.to_array();
    let (first, second) = halves(
        simd,
        each!(lane in [0, 1, 2, 3, 4, 5, 6, 7] => {
            let place = places[lane] as usize;
            u64::from(texels[place]) | u64::from(texels[place + 1]) << 32
        }),
    );
    [first, second]
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use fearless_simd::kernel;

    kernel! {
        /// Whether eight places are less than `end`, which must be positive; a greater one than can be told counts for less.
        #[inline]
        fn are_below(avx2: Avx2, places: __m256i, end: usize) -> bool {
            let greatest = _mm256_set1_epi32(end.min(i32::MAX as usize) as i32 - 1);
            _mm256_movemask_epi8(_mm256_cmpeq_epi32(_mm256_min_epu32(places, greatest), places)) == -1
        }
    }

    kernel! {
        #[inline]
        #[expect(unsafe_code, reason = "one test for eight reads, as for pairs")]
        pub(super) fn gather(avx2: Avx2, texels: &[u32], places: __m256i) -> __m256i {
            assert!(!texels.is_empty() && are_below(avx2, places, texels.len()), "all texels are within the texture");
            // SAFETY: every place is less than the number of texels, as was just made sure, and not negative as an i32.
            unsafe { _mm256_i32gather_epi32::<4>(texels.as_ptr().cast(), places) }
        }
    }

    kernel! {
        #[inline]
        #[expect(unsafe_code, reason = "one test for eight reads: fills are shaded an eighth faster than with a test for each")]
        pub(super) fn gather_pairs(avx2: Avx2, texels: &[u32], places: __m256i) -> (__m256i, __m256i) {
            assert!(texels.len() > 1 && are_below(avx2, places, texels.len() - 1), "all texels are within the texture");
            // So that the halves of what is read come out in the order of places: 0 1 4 5, 2 3 6 7.
            let ordered = _mm256_permute4x64_epi64::<0b11_01_10_00>(places);
            let (low, high) = (_mm256_castsi256_si128(ordered), _mm256_extracti128_si256::<1>(ordered));
            let start = texels.as_ptr().cast();
            // SAFETY: every place is less than that of the last texel, as was just made sure, and not negative as an i32, so
            // that it and the texel after it lie within the slice; the instruction asks for no alignment.
            let (low, high) = unsafe {
                (_mm256_i32gather_epi64::<4>(start, low), _mm256_i32gather_epi64::<4>(start, high))
            };
            let (low, high) = (_mm256_castsi256_ps(low), _mm256_castsi256_ps(high));
            (
                _mm256_castps_si256(_mm256_shuffle_ps::<0b10_00_10_00>(low, high)),
                _mm256_castps_si256(_mm256_shuffle_ps::<0b11_01_11_01>(low, high)),
            )
        }
    }

    kernel! {
        #[inline]
        #[expect(unsafe_code, reason = "one test for 32 reads, and an instruction for eight: fills are shaded a fifth faster than eight by eight")]
        pub(super) fn gather_wide_pairs(avx512: Avx512, texels: &[u32], upper: __m512i, lower: __m512i) -> [__m512i; 4] {
            let end = _mm512_set1_epi32(texels.len().saturating_sub(1).min(i32::MAX as usize) as i32);
            assert!(_mm512_cmpge_epu32_mask(_mm512_max_epu32(upper, lower), end) == 0, "all texels are within the texture");
            let eights = [
                _mm512_castsi512_si256(upper),
                _mm512_extracti64x4_epi64::<1>(upper),
                _mm512_castsi512_si256(lower),
                _mm512_extracti64x4_epi64::<1>(lower),
            ];
            let start = texels.as_ptr().cast();
            // SAFETY: every place is less than that of the last texel, as was just made sure, and not negative as an i32, so
            // that it and the texel after it lie within the slice; the instruction asks for no alignment.
            let [a, b, c, d] = unsafe {
                [
                    _mm512_i32gather_epi64::<4>(eights[0], start),
                    _mm512_i32gather_epi64::<4>(eights[1], start),
                    _mm512_i32gather_epi64::<4>(eights[2], start),
                    _mm512_i32gather_epi64::<4>(eights[3], start),
                ]
            };
            let even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
            let odd = _mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
            [
                _mm512_permutex2var_epi32(a, even, b),
                _mm512_permutex2var_epi32(a, odd, b),
                _mm512_permutex2var_epi32(c, even, d),
                _mm512_permutex2var_epi32(c, odd, d),
            ]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texels() -> Vec<u32> {
        (0..1000_u32).map(|i| i.wrapping_mul(2_654_435_761)).collect()
    }

    #[test]
    fn texels_are_those_at_their_places() {
        let texels = texels();
        let mut random = fastrand::Rng::with_seed(7);
        for lanes in Lanes::all() {
            for _ in 0..100 {
                let places: [u32; WIDE] = std::array::from_fn(|_| random.u32(0..999));
                let (one, pair) = on_lanes!(lanes, simd => {
                    let places = u32x16::load_array(simd, places);
                    let [[first, second], _] = gather_pairs(simd, &texels, [places, places]);
                    (gather(simd, &texels, places.split().1).to_array(), [first.to_array(), second.to_array()])
                });
                assert_eq!(pair[0], places.map(|place| texels[place as usize]));
                assert_eq!(pair[1], places.map(|place| texels[place as usize + 1]));
                assert_eq!(one, pair[0][LANES..]);
            }
        }
    }

    #[test]
    fn places_beyond_the_texels_are_refused() {
        let texels = texels();
        for lanes in Lanes::all() {
            for (place, pairs) in
                [(999, true), (1000, false), (1000, true), (u32::MAX, false), (i32::MAX as u32 + 1, true)]
            {
                let refused = std::panic::catch_unwind(|| {
                    on_lanes!(lanes, simd => {
                        let places = u32x8::load_array(simd, [0, 1, 2, 3, 4, 5, 6, place]);
                        if pairs {
                            gather_pairs(simd, &texels, [places.combine(places); 2])[0][0].to_array()[0]
                        } else {
                            gather(simd, &texels, places).to_array()[0]
                        }
                    })
                });
                assert!(refused.is_err(), "{place} of {} by {}", texels.len(), lanes.name());
            }
        }
    }
}
