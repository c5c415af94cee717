//! Triangle data for sixteen samples that belong to only a few triangles: data is loaded once per triangle and permuted
//! to its samples.

use super::record::{Record, TileBin, TriangleSource};
use super::slot::Slot;
use crate::math::lanes::*;

/// Maximum number of distinct triangles for which [`Few`] is used.
const FEW: usize = LANES;

/// Source of the triangle data for sixteen samples that belong to at most [`FEW`] distinct triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Few<'a> {
    records: [&'a Record; FEW],
    bin: &'a TileBin,
    slots: [u32; FEW],
    which: TriangleIndices,
}

/// Index of each sample's triangle in the list of distinct triangles.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct TriangleIndices([u32; WIDE]);

impl<'a> Few<'a> {
    /// Finds the distinct triangles of the samples selected by `mine`; all other samples are assigned an arbitrary one
    /// of these. Returns `None` if there are more than [`FEW`] triangles, or if the processor has no AVX-512.
    #[inline(always)]
    pub(super) fn find<S: Simd>(simd: S, entrants: &'a TileBin, slots: &[u32; WIDE], mine: u32) -> Option<Self> {
        let (slots, which) = distinct(simd, slots, mine)?;
        let records = each!(i in [0, 1, 2, 3, 4, 5, 6, 7] => entrants.record(Slot(slots[i])));
        Some(Self { records, bin: entrants, slots, which })
    }

    /// Looks up the quad of each sample's triangle in `rows`, which holds one quad per distinct triangle. Returns four
    /// vectors, one for each number of a quad.
    #[inline(always)]
    fn deal<S: Simd>(self, rows: [f32x4<S>; FEW]) -> [f32x16<S>; 4] {
        let simd = rows[0].simd;
        let which = u32x16::load_array_ref(simd, &self.which.0);
        #[cfg(target_arch = "x86_64")]
        if let Some(avx512) = simd.level().as_avx512() {
            let [low, high] = each!(i in [0, FEW / 2] => {
                let rows = rows[i].combine(rows[i + 1]).combine(rows[i + 2].combine(rows[i + 3]));
                f32x16::load_array(avx512, rows.to_array()).into()
            });
            let columns = x86::deal(avx512, [low, high], u32x16::load_array(avx512, which.to_array()).into());
            return each!(i in [0, 1, 2, 3] => {
                let column: f32x16<_> = columns[i].simd_into(avx512);
                f32x16::load_array(simd, column.to_array())
            });
        }
        let (rows, which) = (each!(i in [0, 1, 2, 3, 4, 5, 6, 7] => rows[i].to_array()), which.to_array());
        each!(column in [0, 1, 2, 3] => f32x16::from_fn(simd, |lane| rows[which[lane] as usize][column]))
    }
}

impl TriangleSource for Few<'_> {
    /// Prefetches the texels of every fifth sample. The texels of few triangles lie close together, so prefetching them
    /// for all samples takes longer than the cache misses that it avoids.
    const PREFETCH_STEP: Option<usize> = Some(5);

    #[inline(always)]
    fn quad<S: Simd>(self, simd: S, quad: usize) -> [f32x16<S>; 4] {
        self.deal(each!(i in [0, 1, 2, 3, 4, 5, 6, 7] => f32x4::load_array_ref(simd, &self.records[i].quads[quad])))
    }

    #[inline(always)]
    fn surface_quad<S: Simd>(self, simd: S, quad: usize) -> [f32x16<S>; 4] {
        self.deal(each!(i in [0, 1, 2, 3, 4, 5, 6, 7] => {
            f32x4::load_array_ref(simd, &self.bin.surface(Slot(self.slots[i])).quads[quad])
        }))
    }
}

/// Returns the distinct slots of the samples selected by `mine`, and the index of each sample's slot among them. All
/// other samples get an arbitrary index. Returns `None` if there are more than [`FEW`] slots, or without AVX-512.
#[inline(always)]
fn distinct<S: Simd>(simd: S, slots: &[u32; WIDE], mine: u32) -> Option<([u32; FEW], TriangleIndices)> {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = simd.level().as_avx512() {
        let any = u32x16::splat(avx512, slots[mine.trailing_zeros() as usize % WIDE]);
        let mine = mask32x16::from_bitmask(avx512, mine.into());
        let slots = mine.select(u32x16::load_array_ref(avx512, slots), any).into();
        let (firsts, earlier) = x86::firsts(avx512, slots);
        if firsts.count_ones() as usize > FEW {
            return None;
        }
        let (list, which) = x86::distinct(avx512, slots, firsts, earlier);
        let (list, which): (u32x16<_>, u32x16<_>) = (list.simd_into(avx512), which.simd_into(avx512));
        let list = list.to_array();
        return Some((each!(i in [0, 1, 2, 3, 4, 5, 6, 7] => list[i]), TriangleIndices(which.to_array())));
    }
    None
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use fearless_simd::kernel;

    kernel! {
        /// Returns the bit mask of the lanes whose number occurs for the first time, and for each lane the bit mask of
        /// the earlier lanes with the same number.
        #[inline]
        pub(super) fn firsts(avx512: Avx512, numbers: __m512i) -> (u16, __m512i) {
            let earlier = _mm512_conflict_epi32(numbers);
            (_mm512_testn_epi32_mask(earlier, earlier), earlier)
        }
    }

    kernel! {
        /// Returns the distinct numbers in the order of their first occurrence, and the index of each lane's number
        /// among them.
        #[inline]
        pub(super) fn distinct(avx512: Avx512, numbers: __m512i, firsts: u16, earlier: __m512i) -> (__m512i, __m512i) {
            let own = _mm512_setr_epi32(
                1, 1 << 1, 1 << 2, 1 << 3, 1 << 4, 1 << 5, 1 << 6, 1 << 7,
                1 << 8, 1 << 9, 1 << 10, 1 << 11, 1 << 12, 1 << 13, 1 << 14, 1 << 15,
            );
            // The lowest bit of `equal` marks the first occurrence. The index is the number of first occurrences before
            // it.
            let equal = _mm512_or_si512(earlier, own);
            let before = _mm512_andnot_si512(equal, _mm512_sub_epi32(equal, _mm512_set1_epi32(1)));
            let before = _mm512_and_si512(before, _mm512_set1_epi32(firsts.into()));
            (_mm512_maskz_compress_epi32(firsts, numbers), _mm512_popcnt_epi32(before))
        }
    }

    kernel! {
        /// Selects, for each of sixteen lanes, the row of four numbers with the index in `which`. Returns the four
        /// numbers in four registers. `rows` holds eight rows, four in each register.
        #[inline]
        pub(super) fn deal(avx512: Avx512, rows: [__m512; 2], which: __m512i) -> [__m512; 4] {
            let first = _mm512_slli_epi32::<2>(which);
            let [a, b, c] = [1, 2, 3].map(|column| _mm512_add_epi32(first, _mm512_set1_epi32(column)));
            [
                _mm512_permutex2var_ps(rows[0], first, rows[1]),
                _mm512_permutex2var_ps(rows[0], a, rows[1]),
                _mm512_permutex2var_ps(rows[0], b, rows[1]),
                _mm512_permutex2var_ps(rows[0], c, rows[1]),
            ]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::{Quad, SurfaceRecord};
    use super::*;

    /// Returns quads of consecutive numbers, starting at `first`.
    fn numbered<const N: usize>(first: usize) -> [Quad; N] {
        std::array::from_fn(|quad| std::array::from_fn(|i| (first + 4 * quad + i) as f32))
    }

    /// Returns a bin with the records of `count` triangles. All numbers in these records are different.
    fn entrants(count: usize) -> TileBin {
        let mut entrants = TileBin::default();
        for first in (0..count).step_by(LANES) {
            let records = entrants.eight_records(first).expect("the list grows");
            *records = std::array::from_fn(|lane| Record { quads: numbered((first + lane) * 100) });
            let surfaces = entrants.eight_surfaces(first).expect("the list grows");
            *surfaces = std::array::from_fn(|lane| SurfaceRecord { quads: numbered((first + lane) * 100 + 50) });
        }
        entrants
    }

    #[test]
    fn permuted_triangle_data_equals_data_loaded_per_sample() {
        let (entrants, mut random) = (entrants(40), fastrand::Rng::with_seed(11));
        let (mut few_times, mut many_times) = (0, 0);
        for round in 0..2000 {
            let some: [u32; WIDE] = std::array::from_fn(|_| random.u32(0..40) | random.u32(0..2) << 31);
            let different = 1 + round % WIDE;
            let slots: [u32; WIDE] = std::array::from_fn(|_| some[random.usize(0..different)]);
            let mine = if random.bool() { 0xFFFF } else { random.u32(0..1 << WIDE) };
            let of_mine = |lane: &usize| mine >> lane & 1 != 0;
            let mut known: Vec<u32> = (0..WIDE).filter(of_mine).map(|lane| slots[lane]).collect();
            known.sort_unstable();
            known.dedup();
            for lanes in Lanes::all() {
                let dealt = on_lanes!(lanes, simd => {
                    Few::find(simd, &entrants, &slots, mine).map(|few| {
                        [few.quad(simd, 0), few.quad(simd, 3), few.surface_quad(simd, 4)]
                            .map(|quad| quad.map(SimdBase::to_array))
                    })
                });
                let Some(dealt) = dealt else {
                    many_times += 1;
                    let is_able = matches!(Lanes::avx512(), Some(best) if best.name() == lanes.name());
                    assert!(!is_able || known.len() > FEW, "{} triangles by {}", known.len(), lanes.name());
                    continue;
                };
                few_times += 1;
                assert!(known.len() <= FEW);
                let many = entrants.many(&slots);
                let loaded = on_lanes!(lanes, simd => {
                    [many.quad(simd, 0), many.quad(simd, 3), many.surface_quad(simd, 4)]
                        .map(|quad| quad.map(SimdBase::to_array))
                });
                for (dealt, loaded) in dealt.as_flattened().iter().zip(loaded.as_flattened()) {
                    for lane in (0..WIDE).filter(of_mine) {
                        assert_eq!(dealt[lane], loaded[lane], "by {}", lanes.name());
                    }
                }
            }
        }
        assert!(many_times > 500 && (few_times > 500 || Lanes::avx512().is_none()), "{few_times}, {many_times}");
    }

    #[test]
    fn all_instruction_sets_permute_triangle_data_alike() {
        let mut random = fastrand::Rng::with_seed(12);
        let (entrants, slots) = (entrants(8), [0, 1, 2, 3, 4, 5, 6, 7]);
        for _ in 0..100 {
            let which: [u32; WIDE] = std::array::from_fn(|_| random.u32(0..FEW as u32));
            let records = std::array::from_fn(|i| entrants.record(Slot(slots[i])));
            let few = Few { records, bin: &entrants, slots, which: TriangleIndices(which) };
            for lanes in Lanes::all() {
                let dealt = on_lanes!(lanes, simd => few.quad(simd, 2).map(SimdBase::to_array));
                for (lane, triangle) in which.into_iter().enumerate() {
                    let quad = entrants.record(Slot(triangle)).quads[2];
                    assert_eq!(dealt.map(|column| column[lane]), quad, "by {}", lanes.name());
                }
            }
        }
    }
}
