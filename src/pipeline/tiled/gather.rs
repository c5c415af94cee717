//! Texels at several places at once: by the instructions for that where the processor has fast ones, else one after the other.

use crate::math::lanes::*;

/// Which texels sixteen samples read, and how near each sample is to the right and to the lower ones.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct Taps {
    /// Places of texels; of pairs those of the upper and of the lower row.
    pub(super) index: [[u32; WIDE]; 4],
    /// The pairs themselves, where they are read ahead.
    pub(super) pairs: [Pairs; 2],
    pub(super) right: [f32; WIDE],
    pub(super) down: [f32; WIDE],
}

/// The texels at as many places as a register holds.
///
/// # Panics
/// If one of the places lies outside of the texels, or there are fewer.
#[inline(always)]
pub(super) fn gather<S: Simd>(simd: S, texels: &[u32], places: &[u32]) -> S::u32s {
    let places = &places[..S::u32s::LEN];
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = simd.level().as_avx512() {
        let texels: u32x16<_> =
            x86::gather(avx512, texels, u32x16::from_slice(avx512, places).into()).simd_into(avx512);
        return S::u32s::from_slice(simd, &texels.to_array());
    }
    S::u32s::from_fn(simd, |lane| texels[places[lane] as usize])
}

/// Sixteen texels, each with the one after it, in the order of [`slot_of`].
pub(super) type Pairs = [[u32; 2]; WIDE];

/// Where the pair of a lane is kept: so that lanes find the first four of each half of a register in order.
const fn slot_of(lane: usize) -> usize {
    lane & !0b110 | (lane & 0b100) >> 1 | (lane & 0b010) << 1
}

/// Whether pairs are better read by [`read_pairs`] before they are asked for: where no instruction gathers them quickly.
///
/// AVX2 has one, but many processors take as long for it as for single reads, and those that had to be kept from leaking what
/// they gather (CVE-2022-40982) several times as long.
#[inline(always)]
pub(super) fn reads_ahead<S: Simd>(simd: S) -> bool {
    #[cfg(target_arch = "x86_64")]
    return simd.level().as_avx512().is_none();
    #[cfg(not(target_arch = "x86_64"))]
    return true;
}

/// Reads the pairs of many samples and does nothing else, so that as many reads as possible are under way at a time.
///
/// # Panics
/// If one of the places, or the one after it, lies outside of the texels.
#[inline(always)]
#[expect(
    unsafe_code,
    reason = "one test for all reads: a picture that is all texture is drawn an eighth faster than with a test for each"
)]
pub(super) fn read_pairs<S: Simd>(simd: S, texels: &[u32], all: &mut [Taps]) {
    let mut farthest = u32x16::splat(simd, 0);
    for Taps { index: [upper, lower, ..], .. } in &*all {
        let [upper, lower] = each!(row in [upper, lower] => u32x16::load_array_ref(simd, row));
        farthest = farthest.max(upper.max(lower));
    }
    // Lengths are below 2³²: texture sizes are limited.
    let last = texels.len().saturating_sub(1) as u32;
    assert!(farthest.simd_lt(last).all_true(), "all texels are within the texture");
    for Taps { index: [upper, lower, ..], pairs, .. } in all {
        for (places, pairs) in [upper, lower].into_iter().zip(pairs) {
            for lane in 0..WIDE {
                let place = places[lane] as usize;
                // SAFETY: the place is less than that of the last texel, as was just made sure of the farthest one, so that it
                // and the texel after it lie within the slice; an array asks for no other alignment than its items do.
                pairs[slot_of(lane)] = unsafe { texels.as_ptr().add(place).cast::<[u32; 2]>().read() };
            }
        }
    }
}

/// The first and the second texels of as many pairs as a register holds, from `first` on.
#[inline(always)]
pub(super) fn split_pairs<S: Simd>(simd: S, pairs: &Pairs, first: usize) -> [S::u32s; 2] {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = simd.level().as_avx2()
        && S::u32s::LEN == LANES
    {
        let (a, b) = pairs[first..first + LANES].as_flattened().split_at(LANES);
        let [a, b] = each!(half in [a, b] => u32x8::from_slice(avx2, half));
        let (first, second) = x86::split(avx2, a.into(), b.into());
        return each!(texels in [first, second] => {
            let texels: u32x8<_> = texels.simd_into(avx2);
            S::u32s::from_slice(simd, &texels.to_array())
        });
    }
    let mut halves = [[0; WIDE]; 2];
    for lane in 0..S::u32s::LEN {
        let [left, right] = pairs[slot_of(first + lane)];
        (halves[0][lane], halves[1][lane]) = (left, right);
    }
    each!(half in [0, 1] => S::u32s::from_slice(simd, &halves[half][..S::u32s::LEN]))
}

/// The texels at twice as many places as a register holds, each with the one after it, by instructions for that; none where there
/// are no such instructions, and pairs are read ahead.
///
/// # Panics
/// If one of the places, or the one after it, lies outside of the texels, or there are fewer.
#[inline(always)]
pub(super) fn gather_pairs<S: Simd>(simd: S, texels: &[u32], places: [&[u32; WIDE]; 2]) -> Option<[[S::u32s; 2]; 2]> {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = simd.level().as_avx512() {
        let [upper, lower] = each!(i in [0, 1] => u32x16::load_array_ref(avx512, places[i]));
        let gathered = x86::gather_wide_pairs(avx512, texels, upper.into(), lower.into());
        return Some(each!(i in [0, 1] => each!(texels in [gathered[2 * i], gathered[2 * i + 1]] => {
            let texels: u32x16<_> = texels.simd_into(avx512);
            S::u32s::from_slice(simd, &texels.to_array())
        })));
    }
    None
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use fearless_simd::kernel;

    kernel! {
        #[inline]
        #[expect(unsafe_code, reason = "one test and one instruction for sixteen reads")]
        pub(super) fn gather(avx512: Avx512, texels: &[u32], places: __m512i) -> __m512i {
            let end = _mm512_set1_epi32(texels.len().min(i32::MAX as usize) as i32);
            assert!(_mm512_cmpge_epu32_mask(places, end) == 0, "all texels are within the texture");
            // SAFETY: every place is less than the number of texels, as was just made sure, and not negative as an i32.
            unsafe { _mm512_i32gather_epi32::<4>(places, texels.as_ptr().cast()) }
        }
    }

    kernel! {
        /// Every second number from the first and from the second on, of four and four of each half.
        #[inline]
        pub(super) fn split(avx2: Avx2, a: __m256i, b: __m256i) -> (__m256i, __m256i) {
            let (a, b) = (_mm256_castsi256_ps(a), _mm256_castsi256_ps(b));
            (
                _mm256_castps_si256(_mm256_shuffle_ps::<0b10_00_10_00>(a, b)),
                _mm256_castps_si256(_mm256_shuffle_ps::<0b11_01_11_01>(a, b)),
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

    /// The pairs at as many places as a register holds, the way these lanes read them.
    #[inline(always)]
    fn pairs<S: Simd>(simd: S, texels: &[u32], places: &[u32; WIDE]) -> [Vec<u32>; 2] {
        let pairs = if let Some([pairs, _]) = gather_pairs(simd, texels, [places, places]) {
            pairs
        } else {
            // Those that are looked at come last.
            let mut all = [Taps::default(), Taps { index: [*places; 4], ..Taps::default() }];
            read_pairs(simd, texels, &mut all);
            split_pairs(simd, &all[1].pairs[1], WIDE - S::u32s::LEN)
        };
        pairs.map(|texels| texels.as_slice().to_vec())
    }

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
                let (one, [first, second]) = on_lanes!(lanes, simd => {
                    let one = gather(simd, &texels, &places).as_slice().to_vec();
                    (one, pairs(simd, &texels, &places))
                });
                let count = one.len();
                let expected = |places: &[u32], next: usize| -> Vec<u32> {
                    places.iter().map(|place| texels[*place as usize + next]).collect()
                };
                assert_eq!(one, expected(&places[..count], 0), "by {}", lanes.name());
                // Where pairs are read ahead those of the last register are looked at.
                let places = &places[WIDE - count..];
                assert_eq!([first, second], [0, 1].map(|next| expected(places, next)), "by {}", lanes.name());
            }
        }
    }

    #[test]
    fn places_beyond_the_texels_are_refused() {
        let texels = texels();
        for lanes in Lanes::all() {
            for (place, of_pair) in
                [(999, true), (1000, false), (1000, true), (u32::MAX, false), (i32::MAX as u32 + 1, true)]
            {
                let refused = std::panic::catch_unwind(|| {
                    on_lanes!(lanes, simd => {
                        let mut places = [0; WIDE];
                        places[3] = place;
                        if of_pair {
                            pairs(simd, &texels, &places)[0][0]
                        } else {
                            gather(simd, &texels, &places).as_slice()[0]
                        }
                    })
                });
                assert!(refused.is_err(), "{place} of {} by {}", texels.len(), lanes.name());
            }
        }
    }
}
