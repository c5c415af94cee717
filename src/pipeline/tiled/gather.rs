//! Texels at several places at once: by the instructions for that where the processor has fast ones, else one after the other.

use crate::math::lanes::*;
use crate::scene::Column;

/// Which texels sixteen samples read, and how near each sample is to the right and to the lower ones.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct Taps {
    /// Places of texels; of quads that of the first texel, and for those in linear light of the one below it.
    pub(super) index: [[u32; WIDE]; 4],
    pub(super) right: [f32; WIDE],
    pub(super) down: [f32; WIDE],
}

/// The texels at as many places as a register holds.
///
/// # Panics
/// If one of the places lies outside of the texels, or there are fewer.
#[inline(always)]
pub(super) fn gather<S: Simd>(simd: S, texels: &[Column], places: &[u32]) -> S::u32s {
    let places = &places[..S::u32s::LEN];
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = simd.level().as_avx512() {
        let texels: u32x16<_> =
            x86::gather(avx512, texels, u32x16::from_slice(avx512, places).into()).simd_into(avx512);
        return S::u32s::from_slice(simd, &texels.to_array());
    }
    S::u32s::from_fn(simd, |lane| texels[places[lane] as usize][0])
}

/// The upper left, upper right, lower left and lower right texels of as many samples as a register holds, from `first` on.
///
/// Where no instruction gathers them quickly they are read one by one: AVX2 has one, but many processors take as long for it as
/// for single reads, and those that had to be kept from leaking what they gather (CVE-2022-40982) several times as long.
///
/// # Panics
/// If a quad lies outside of the texels.
#[inline(always)]
pub(super) fn quads<S: Simd>(simd: S, texels: &[Column], taps: &Taps, first: usize) -> [S::u32s; 4] {
    let [left, lower_left, right, lower_right] = columns(simd, texels, taps, first);
    [left, right, lower_left, lower_right]
}

/// The same, column by column.
#[inline(always)]
fn columns<S: Simd>(simd: S, texels: &[Column], taps: &Taps, first: usize) -> [S::u32s; 4] {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = simd.level().as_avx512() {
        let gathered = x86::gather_quads(avx512, texels, u32x16::load_array_ref(avx512, &taps.index[0]).into());
        return each!(texels in [gathered[0], gathered[1], gathered[2], gathered[3]] => {
            let texels: u32x16<_> = texels.simd_into(avx512);
            S::u32s::from_slice(simd, &texels.to_array())
        });
    }
    let places = &taps.index[0][first..];
    if S::u32s::LEN == LANES {
        let rows = each!((low, high) in [(0, 4), (1, 5), (2, 6), (3, 7)] => {
            let [low, high] = each!(lane in [low, high] => {
                u32x4::from_slice(simd, quad_at(texels, places[lane]).as_flattened())
            });
            low.combine(high).bitcast::<F32<S>>()
        });
        let columns = transpose_halves(rows);
        return each!(column in [0, 1, 2, 3] => {
            S::u32s::from_slice(simd, &columns[column].bitcast::<u32x8<S>>().to_array())
        });
    }
    let mut columns = [[0; WIDE]; 4];
    for lane in 0..S::u32s::LEN {
        let [[a, b], [c, d]] = quad_at(texels, places[lane]);
        for (column, texel) in columns.iter_mut().zip([a, b, c, d]) {
            column[lane] = texel;
        }
    }
    each!(column in [0, 1, 2, 3] => S::u32s::from_slice(simd, &columns[column][..S::u32s::LEN]))
}

/// Two by two texels: the left ones, the right ones. Each place is tested by itself: to test eight of them in a register, and
/// to take them out of it, takes longer.
#[inline(always)]
fn quad_at(texels: &[Column], place: u32) -> [Column; 2] {
    let place = place as usize;
    assert!(place + 1 < texels.len(), "all texels are within the texture");
    [texels[place], texels[place + 1]]
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use fearless_simd::kernel;

    use crate::scene::Column;

    kernel! {
        #[inline]
        #[expect(unsafe_code, reason = "one test and one instruction for sixteen reads")]
        pub(super) fn gather(avx512: Avx512, texels: &[Column], places: __m512i) -> __m512i {
            let end = _mm512_set1_epi32(texels.len().min(i32::MAX as usize) as i32);
            assert!(_mm512_cmpge_epu32_mask(places, end) == 0, "all texels are within the texture");
            // SAFETY: every place is less than the number of texels, as was just made sure, and not negative as an i32.
            unsafe { _mm512_i32gather_epi32::<8>(places, texels.as_ptr().cast()) }
        }
    }

    kernel! {
        /// The left texels, those below them, the right ones, those below them.
        #[inline]
        #[expect(unsafe_code, reason = "one test for 32 reads, and an instruction for eight: of pairs, fills were shaded a fifth faster than eight by eight")]
        pub(super) fn gather_quads(avx512: Avx512, texels: &[Column], places: __m512i) -> [__m512i; 4] {
            let end = _mm512_set1_epi32(texels.len().saturating_sub(1).min(i32::MAX as usize) as i32);
            assert!(_mm512_cmpge_epu32_mask(places, end) == 0, "all texels are within the texture");
            let (low, high) = (_mm512_castsi512_si256(places), _mm512_extracti64x4_epi64::<1>(places));
            let left = texels.as_ptr();
            // SAFETY: every place is less than the last one, as was just made sure, and not negative as an i32, so that it and the
            // one after it lie within the slice; the instruction asks for no alignment.
            let [a, b, c, d] = unsafe {
                let right = left.add(1);
                [
                    _mm512_i32gather_epi64::<8>(low, left.cast()),
                    _mm512_i32gather_epi64::<8>(high, left.cast()),
                    _mm512_i32gather_epi64::<8>(low, right.cast()),
                    _mm512_i32gather_epi64::<8>(high, right.cast()),
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

    /// The quads at as many places as a register holds, the way these lanes read them.
    #[inline(always)]
    fn quads_at<S: Simd>(simd: S, texels: &[Column], places: &[u32; WIDE]) -> [Vec<u32>; 4] {
        let taps = Taps { index: [*places; 4], ..Taps::default() };
        quads(simd, texels, &taps, WIDE - S::u32s::LEN).map(|texels| texels.as_slice().to_vec())
    }

    fn texels() -> Vec<Column> {
        (0..1000_u32).map(|i| [i.wrapping_mul(2_654_435_761), !i]).collect()
    }

    #[test]
    fn texels_are_those_at_their_places() {
        let texels = texels();
        let mut random = fastrand::Rng::with_seed(7);
        for lanes in Lanes::all() {
            for _ in 0..100 {
                let places: [u32; WIDE] = std::array::from_fn(|_| random.u32(0..999));
                let (one, quads) = on_lanes!(lanes, simd => {
                    let one = gather(simd, &texels, &places).as_slice().to_vec();
                    (one, quads_at(simd, &texels, &places))
                });
                let count = one.len();
                let expected = |places: &[u32], right: usize, down: usize| -> Vec<u32> {
                    places.iter().map(|place| texels[*place as usize + right][down]).collect()
                };
                assert_eq!(one, expected(&places[..count], 0, 0), "by {}", lanes.name());
                let places = &places[WIDE - count..];
                let of_quads = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(right, down)| expected(places, right, down));
                assert_eq!(quads, of_quads, "by {}", lanes.name());
            }
        }
    }

    #[test]
    fn places_beyond_the_texels_are_refused() {
        let texels = texels();
        for lanes in Lanes::all() {
            for (place, of_quad) in
                [(999, true), (1000, false), (1000, true), (u32::MAX, false), (i32::MAX as u32 + 1, true)]
            {
                let refused = std::panic::catch_unwind(|| {
                    on_lanes!(lanes, simd => {
                        let mut places = [0; WIDE];
                        places[if of_quad { WIDE - 1 } else { 3 }] = place;
                        if of_quad {
                            quads_at(simd, &texels, &places)[0][0]
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
