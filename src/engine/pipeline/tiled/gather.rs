//! Loads of texels at several indices at once: with hardware gathers where these are fast, otherwise with scalar loads.

use crate::math::lanes::*;

/// Texture taps of sixteen samples: indices of the texels that they read, and bilinear weights.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct Taps {
    /// Indices of up to four texels per sample. For quads, the first array has the upper left texels, and the others
    /// are unused.
    pub(super) index: [[u32; WIDE]; 4],
    /// Bilinear weights of the right texels, in [0, 1].
    pub(super) right: [f32; WIDE],
    /// Bilinear weights of the lower texels, in [0, 1].
    pub(super) down: [f32; WIDE],
}

/// Loads one texel for each lane of a register, at the indices in `places`. Uses AVX-512 gathers if `by_gathers` is
/// `true` and they are available, otherwise scalar loads.
///
/// # Panics
///
/// Panics if an index is out of bounds, or if there are fewer indices than lanes.
#[inline(always)]
pub(super) fn gather<S: Simd>(simd: S, by_gathers: bool, texels: &[u32], places: &[u32]) -> S::u32s {
    let places = &places[..S::u32s::LEN];
    #[cfg(target_arch = "x86_64")]
    if by_gathers && let Some(avx512) = simd.level().as_avx512() {
        let texels: u32x16<_> =
            x86::gather(avx512, texels, u32x16::from_slice(avx512, places).into()).simd_into(avx512);
        return S::u32s::from_slice(simd, &texels.to_array());
    }
    S::u32s::from_fn(simd, |lane| texels[places[lane] as usize])
}

/// Loads one quad of texels for each lane of a register. Returns the upper left, upper right, lower left and lower
/// right texels. `places` has the index of each upper left texel in `upper`. `lower` holds the texels one row below at
/// the same indices.
///
/// Uses AVX-512 gathers if `by_gathers` is `true` and they are available, otherwise scalar loads. The gather of AVX2 is
/// not used: on many processors it is as slow as scalar loads, and several times slower on those with the mitigation
/// for CVE-2022-40982.
///
/// # Panics
///
/// Panics if a quad is out of bounds.
#[inline(always)]
pub(super) fn quads<S: Simd>(simd: S, by_gathers: bool, [upper, lower]: [&[u32]; 2], places: &[u32]) -> [S::u32s; 4] {
    // Makes the lengths equal, so that one bounds check covers both rows.
    let rows = [&upper[..lower.len()], lower];
    #[cfg(target_arch = "x86_64")]
    if by_gathers && let Some(avx512) = simd.level().as_avx512() {
        let [upper, lower] = each!(row in [0, 1] => {
            x86::gather_pairs(avx512, rows[row], u32x16::from_slice(avx512, &places[..WIDE]).into())
        });
        return each!(texels in [upper[0], upper[1], lower[0], lower[1]] => {
            let texels: u32x16<_> = texels.simd_into(avx512);
            S::u32s::from_slice(simd, &texels.to_array())
        });
    }
    if S::u32s::LEN == WIDE {
        let corners = transpose_wide(each!(lane in [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15] => {
            u32x4::from_slice(simd, &quad_at(rows, places[lane])).bitcast::<f32x4<S>>()
        }));
        return each!(corner in [0, 1, 2, 3] => {
            S::u32s::from_slice(simd, &corners[corner].bitcast::<u32x16<S>>().to_array())
        });
    }
    if S::u32s::LEN == LANES {
        let halves = each!((low, high) in [(0, 4), (1, 5), (2, 6), (3, 7)] => {
            let [low, high] = each!(lane in [low, high] => {
                u32x4::from_slice(simd, &quad_at(rows, places[lane]))
            });
            low.combine(high).bitcast::<F32<S>>()
        });
        let corners = transpose_halves(halves);
        return each!(corner in [0, 1, 2, 3] => {
            S::u32s::from_slice(simd, &corners[corner].bitcast::<u32x8<S>>().to_array())
        });
    }
    let mut corners = [[0; WIDE]; 4];
    for lane in 0..S::u32s::LEN {
        let quad = quad_at(rows, places[lane]);
        for (corner, texel) in corners.iter_mut().zip(quad) {
            corner[lane] = texel;
        }
    }
    each!(corner in [0, 1, 2, 3] => S::u32s::from_slice(simd, &corners[corner][..S::u32s::LEN]))
}

/// Returns the quad of texels at an index: two texels of a row and the two below. Each index is checked on its own,
/// because checking eight in a register and extracting them takes longer.
#[inline(always)]
fn quad_at([upper, lower]: [&[u32]; 2], place: u32) -> [u32; 4] {
    let place = place as usize;
    assert!(place + 1 < upper.len() && place + 1 < lower.len(), "all texels are within the texture");
    [upper[place], upper[place + 1], lower[place], lower[place + 1]]
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use fearless_simd::kernel;

    kernel! {
        #[inline]
        #[expect(unsafe_code, reason = "one bounds check and one instruction for 16 reads")]
        pub(super) fn gather(avx512: Avx512, texels: &[u32], places: __m512i) -> __m512i {
            let end = _mm512_set1_epi32(texels.len().min(i32::MAX as usize) as i32);
            assert!(_mm512_cmpge_epu32_mask(places, end) == 0, "all texels are within the texture");
            // SAFETY: every index is less than the number of texels, as asserted above, and not negative as an i32.
            unsafe { _mm512_i32gather_epi32::<4>(places, texels.as_ptr().cast()) }
        }
    }

    kernel! {
        /// Returns the texels at sixteen indices, and their right neighbours.
        #[inline]
        #[expect(unsafe_code, reason = "one bounds check for 16 reads: fills are shaded a fifth faster than eight at a time")]
        pub(super) fn gather_pairs(avx512: Avx512, texels: &[u32], places: __m512i) -> [__m512i; 2] {
            let end = _mm512_set1_epi32(texels.len().saturating_sub(1).min(i32::MAX as usize) as i32);
            assert!(_mm512_cmpge_epu32_mask(places, end) == 0, "all texels are within the texture");
            let (low, high) = (_mm512_castsi512_si256(places), _mm512_extracti64x4_epi64::<1>(places));
            // SAFETY: every index is less than the index of the last texel, as asserted above, and not negative as an
            // i32. This texel and the next one therefore lie within the slice; the instruction requires no alignment.
            let (low, high) = unsafe {
                let texels = texels.as_ptr().cast();
                (_mm512_i32gather_epi64::<4>(low, texels), _mm512_i32gather_epi64::<4>(high, texels))
            };
            let left = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
            let right = _mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
            [_mm512_permutex2var_epi32(low, left, high), _mm512_permutex2var_epi32(low, right, high)]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance between adjacent rows, in texels.
    const STRIDE: usize = 100;

    fn texels() -> Vec<u32> {
        (0..1000_u32).map(|i| i.wrapping_mul(2_654_435_761)).collect()
    }

    /// Loads one quad for each lane of a register with [`quads`], and converts the four registers to lists.
    #[inline(always)]
    fn quads_at<S: Simd>(simd: S, by_gathers: bool, texels: &[u32], places: &[u32]) -> [Vec<u32>; 4] {
        quads(simd, by_gathers, [texels, &texels[STRIDE..]], places).map(|texels| texels.as_slice().to_vec())
    }

    /// Returns the index of the last lane of a register.
    fn last_lane(lanes: Lanes) -> usize {
        #[inline(always)]
        fn last<S: Simd>(_: S) -> usize {
            S::u32s::LEN - 1
        }
        on_lanes!(lanes, simd => last(simd))
    }

    #[test]
    fn gathers_return_the_texels_at_their_indices() {
        let texels = texels();
        let mut random = fastrand::Rng::with_seed(7);
        for (lanes, by_gathers) in Lanes::all_with_and_without_gathers() {
            for _ in 0..100 {
                let places: [u32; WIDE] = std::array::from_fn(|_| random.u32(0..899));
                let (one, quads) = on_lanes!(lanes, simd => {
                    let one = gather(simd, by_gathers, &texels, &places).as_slice().to_vec();
                    (one, quads_at(simd, by_gathers, &texels, &places))
                });
                let expected = |beyond: usize| -> Vec<u32> {
                    places[..one.len()].iter().map(|place| texels[*place as usize + beyond]).collect()
                };
                assert_eq!(one, expected(0), "by {}", lanes.name());
                assert_eq!(quads, [0, 1, STRIDE, STRIDE + 1].map(expected), "by {}", lanes.name());
            }
        }
    }

    #[test]
    fn indices_beyond_the_texels_panic() {
        let texels = texels();
        let cases = [(899, true), (1000, false), (u32::MAX, true), (u32::MAX, false), (i32::MAX as u32 + 1, true)];
        for (lanes, by_gathers) in Lanes::all_with_and_without_gathers() {
            for (place, of_quad) in cases {
                for lane in [0, last_lane(lanes)] {
                    let mut places = [0; WIDE];
                    places[lane] = place;
                    let refused = std::panic::catch_unwind(|| {
                        on_lanes!(lanes, simd => {
                            if of_quad {
                                quads_at(simd, by_gathers, &texels, &places)[0][0]
                            } else {
                                gather(simd, by_gathers, &texels, &places).as_slice()[0]
                            }
                        })
                    });
                    assert!(refused.is_err(), "{place} of {} by {}", texels.len(), lanes.name());
                }
            }
        }
    }
}
