//! SIMD on eight or sixteen lanes at a time, with an instruction set selected at run time.
//!
//! Kernels are written once, generic over [`Simd`], and compiled for AVX-512, for AVX2 and for the baseline of the
//! architecture. Sums, products, quotients, square roots and conversions are correctly rounded in all three, and none
//! uses fused multiply-add. All three therefore give bit-identical results.

#[cfg(target_arch = "x86_64")]
mod x86;

#[cfg(target_arch = "x86_64")]
use std::sync::LazyLock;

pub(crate) use fearless_simd::Level;
pub(crate) use fearless_simd::Simd;
pub(crate) use fearless_simd::f32x4;
pub(crate) use fearless_simd::f32x8;
pub(crate) use fearless_simd::f32x16;
pub(crate) use fearless_simd::f64x4;
pub(crate) use fearless_simd::f64x8;
pub(crate) use fearless_simd::i16x16;
pub(crate) use fearless_simd::i16x32;
pub(crate) use fearless_simd::i32x8;
pub(crate) use fearless_simd::i32x16;
pub(crate) use fearless_simd::mask16x32;
pub(crate) use fearless_simd::mask32x8;
pub(crate) use fearless_simd::mask32x16;
pub(crate) use fearless_simd::mask64x8;
pub(crate) use fearless_simd::prelude::*;
pub(crate) use fearless_simd::u8x32;
pub(crate) use fearless_simd::u8x64;
pub(crate) use fearless_simd::u16x32;
pub(crate) use fearless_simd::u32x4;
pub(crate) use fearless_simd::u32x8;
pub(crate) use fearless_simd::u32x16;
pub(crate) use fearless_simd::u64x2;
pub(crate) use fearless_simd::u64x8;

/// Instruction set that every processor of the architecture has: SSE2.
#[cfg(target_arch = "x86_64")]
pub(crate) type Baseline = fearless_simd::x86::Sse2;

/// Instruction set that every processor of the architecture has: plain scalar code.
#[cfg(not(target_arch = "x86_64"))]
pub(crate) type Baseline = fearless_simd::Fallback;

/// Returns the baseline of the architecture: SSE2. Single pixels need no more, and a kernel that is compiled for it alone
/// is compiled once.
#[cfg(target_arch = "x86_64")]
pub(crate) fn baseline() -> Baseline {
    Level::new().as_sse2().expect("every x86-64 processor has SSE2")
}

/// Returns the baseline of the architecture: plain scalar code.
#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn baseline() -> Baseline {
    Baseline::new()
}

/// Number of lanes that a kernel processes at a time.
pub(crate) const LANES: usize = 8;

/// Number of lanes that an `f32`-only kernel processes at a time. Processors with registers of sixteen floats then need
/// half as many instructions.
pub(crate) const WIDE: usize = 2 * LANES;

/// Numbers of the lanes.
pub(crate) const LANE_NUMBERS: [f32; WIDE] =
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// Returns the first `N` values of a slice, followed by copies of `missing` if there are fewer.
#[inline(always)]
pub(crate) fn padded<const N: usize, T: Copy>(values: &[T], missing: T) -> [T; N] {
    values.first_chunk().copied().unwrap_or_else(|| {
        let mut all = [missing; N];
        all[..values.len()].copy_from_slice(values);
        all
    })
}

/// Stores values in a slice, without those beyond its end.
#[inline(always)]
pub(crate) fn store_in<const N: usize, T: Copy>(slice: &mut [T], values: &[T; N]) {
    match slice.first_chunk_mut() {
        // Of constant length, so that the compiler calls no `memcpy`.
        Some(whole) => *whole = *values,
        None => slice.copy_from_slice(&values[..slice.len()]),
    }
}

/// Vector of eight `f32` lanes.
pub(crate) type F32<S> = f32x8<S>;

/// Vector of eight `f64` lanes.
pub(crate) type F64<S> = f64x8<S>;

/// SIMD instruction set that kernels run with, selected at run time.
#[derive(Clone, Copy, Debug)]
pub enum Lanes {
    /// AVX-512 with the extensions of Ice Lake, Zen 4 and later processors: eight doubles per register.
    #[cfg(target_arch = "x86_64")]
    Avx512(fearless_simd::x86::Avx512),
    /// AVX2: eight floats per register.
    #[cfg(target_arch = "x86_64")]
    Avx2(fearless_simd::x86::Avx2),
    /// Baseline of the architecture: SSE2, or plain scalar code.
    Baseline(Baseline),
}

impl Lanes {
    /// Returns the best instruction set that this processor supports.
    pub fn best() -> Self {
        Self::avx512().or_else(Self::avx2).unwrap_or_else(Self::baseline)
    }

    /// Returns all instruction sets that this processor supports, best first.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        [Self::avx512(), Self::avx2(), Some(Self::baseline())].into_iter().flatten()
    }

    /// Returns each of [`Lanes::all`] twice: without hardware gathers (`false`) and with them (`true`).
    #[cfg(test)]
    pub(crate) fn all_with_and_without_gathers() -> impl Iterator<Item = (Self, bool)> {
        Self::all().flat_map(|lanes| [(lanes, false), (lanes, true)])
    }

    /// Returns AVX-512, or `None` if this processor does not support it.
    pub(crate) fn avx512() -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        return Level::new().as_avx512().map(Self::Avx512);
        #[cfg(not(target_arch = "x86_64"))]
        return None;
    }

    /// Returns AVX2, or `None` if this processor does not support it.
    pub fn avx2() -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        return Level::new().as_avx2().map(Self::Avx2);
        #[cfg(not(target_arch = "x86_64"))]
        return None;
    }

    /// Returns the baseline of the architecture.
    pub fn baseline() -> Self {
        Self::Baseline(baseline())
    }

    /// Returns the display name of the instruction set.
    pub(crate) fn name(self) -> &'static str {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(_) => "AVX-512",
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(_) => "AVX2",
            Self::Baseline(_) => "baseline",
        }
    }
}

/// Returns whether kernels should use hardware gathers: `true` on x86-64 processors except AMD's. Gathers are faster
/// than scalar loads on Intel processors with AVX-512. AMD processors load the elements one by one, each more slowly
/// than a scalar load: on Zen 4, frames drawn with gathers take 1.1 to 1.4 times as long.
#[inline(always)]
pub(crate) fn gathers_are_fast() -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        static ARE_QUICK: LazyLock<bool> = LazyLock::new(|| {
            let leaf = std::arch::x86_64::__cpuid(0);
            [leaf.ebx, leaf.edx, leaf.ecx].map(u32::to_le_bytes).as_flattened() != b"AuthenticAMD"
        });
        *ARE_QUICK
    }
    #[cfg(not(target_arch = "x86_64"))]
    false
}

/// Runs `$body` with `$simd` bound to the instruction set of `$lanes`. Every function called in `$body` that computes
/// on lanes must be `#[inline(always)]`.
macro_rules! on_lanes {
    ($lanes:expr, $simd:ident => $body:expr) => {
        match $lanes {
            #[cfg(target_arch = "x86_64")]
            $crate::math::lanes::Lanes::Avx512($simd) => $crate::math::lanes::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $body,
            ),
            #[cfg(target_arch = "x86_64")]
            $crate::math::lanes::Lanes::Avx2($simd) => $crate::math::lanes::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $body,
            ),
            $crate::math::lanes::Lanes::Baseline($simd) => $body,
        }
    };
}

pub(crate) use on_lanes;

/// Evaluates `$body` for each of the listed items and returns an array of the results. Used instead of `map`, whose
/// closure the compiler might fail to compile for the selected instruction set.
macro_rules! each {
    ($item:pat in [$($value:expr),+ $(,)?] => $body:expr) => {
        [$({ let $item = $value; $body }),+]
    };
}

pub(crate) use each;

/// Widens eight floats to doubles, without rounding.
#[inline(always)]
pub(crate) fn widen<S: Simd>(simd: S, x: F32<S>) -> F64<S> {
    let (low, high) = simd.widen_f32x8(x);
    simd.combine_f64x4(low, high)
}

/// Rounds eight doubles to the nearest floats.
#[inline(always)]
pub(crate) fn narrow<S: Simd>(simd: S, x: F64<S>) -> F32<S> {
    let (low, high) = simd.split_f64x8(x);
    simd.narrow_f64x4(low, high)
}

/// Converts eight integers to doubles, without rounding.
#[inline(always)]
pub(crate) fn doubles_of<S: Simd>(simd: S, numbers: i32x8<S>) -> F64<S> {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = simd.level().as_avx2() {
        let [low, high] = x86::doubles_of(avx2, i32x8::load_array(avx2, numbers.to_array()).into());
        let [low, high]: [f64x4<_>; 2] = [low.simd_into(avx2), high.simd_into(avx2)];
        let [low, high] = each!(half in [low, high] => f64x4::load_array(simd, half.to_array()));
        return low.combine(high);
    }
    let numbers = numbers.to_array();
    F64::load_array(simd, each!(i in [0, 1, 2, 3, 4, 5, 6, 7] => f64::from(numbers[i])))
}

/// Converts sixteen integers below 2³¹ to floats. Treats them as signed, because few processors have instructions that
/// convert unsigned integers.
#[inline(always)]
pub(crate) fn float_of<S: Simd>(numbers: u32x16<S>) -> f32x16<S> {
    numbers.bitcast::<i32x16<S>>().to_float()
}

/// Truncates sixteen floats in [0, 2³¹) toward zero. Converts to signed integers, for the same reason as [`float_of`].
#[inline(always)]
pub(crate) fn whole_part<S: Simd>(numbers: f32x16<S>) -> u32x16<S> {
    numbers.to_int::<i32x16<S>>().bitcast()
}

/// Returns the entries of a table at sixteen indices modulo 32.
#[inline(always)]
pub(crate) fn entries_of_32<S: Simd>(simd: S, table: &[u32; 32], indices: u32x16<S>) -> u32x16<S> {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = simd.level().as_avx512() {
        let halves = each!(first in [0, WIDE] => u32x16::from_slice(avx512, &table[first..first + WIDE]).into());
        let indices = u32x16::load_array(avx512, indices.to_array()).into();
        let entries: u32x16<_> = x86::entries_of_32(avx512, halves, indices).simd_into(avx512);
        return u32x16::load_array(simd, entries.to_array());
    }
    let (indices, mut entries) = (indices.to_array(), [0; WIDE]);
    for lane in 0..WIDE {
        entries[lane] = table[indices[lane] as usize % table.len()];
    }
    u32x16::load_array(simd, entries)
}

/// Splits eight 64-bit numbers into their lower and upper 32 bits.
#[inline(always)]
pub(crate) fn halves<S: Simd>(simd: S, numbers: [u64; LANES]) -> (u32x8<S>, u32x8<S>) {
    let [first, second, third, fourth] = each!((i, j) in [(0, 1), (2, 3), (4, 5), (6, 7)] => {
        u64x2::load_array(simd, [numbers[i], numbers[j]]).bitcast::<u32x4<S>>()
    });
    let ((a, b), (c, d)) = (first.deinterleave(second), third.deinterleave(fourth));
    (a.combine(c), b.combine(d))
}

/// Transposes eight rows of four floats into four columns.
#[inline(always)]
pub(crate) fn transpose_quads<S: Simd>([a, b, c, d, e, f, g, h]: [f32x4<S>; LANES]) -> [F32<S>; 4] {
    transpose_halves([a.combine(e), b.combine(f), c.combine(g), d.combine(h)])
}

/// Transposes four columns of eight floats into eight rows.
#[inline(always)]
pub(crate) fn rows_of_quads<S: Simd>(columns: [F32<S>; 4]) -> [f32x4<S>; LANES] {
    let [(a, e), (b, f), (c, g), (d, h)] = {
        let rows = transpose_halves(columns);
        each!(i in [0, 1, 2, 3] => rows[i].split())
    };
    [a, b, c, d, e, f, g, h]
}

/// Transposes sixteen rows of four floats into four columns.
#[inline(always)]
pub(crate) fn transpose_wide<S: Simd>(r: [f32x4<S>; WIDE]) -> [f32x16<S>; 4] {
    transpose_quarters(each!(i in [0, 1, 2, 3] => r[i].combine(r[i + 4]).combine(r[i + 8].combine(r[i + 12]))))
}

/// Returns four vectors: vector `i` holds the lanes `i`, `i + 4`, `i + 8` and `i + 12`, each four times.
#[inline(always)]
pub(crate) fn repeat_each<S: Simd>(simd: S, numbers: f32x16<S>) -> [f32x16<S>; 4] {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = simd.level().as_avx512() {
        let repeated = x86::repeat_each(avx512, f32x16::load_array(avx512, numbers.to_array()).into());
        return each!(i in [0, 1, 2, 3] => {
            let repeated: f32x16<_> = repeated[i].simd_into(avx512);
            f32x16::load_array(simd, repeated.to_array())
        });
    }
    let numbers = numbers.to_array();
    each!(i in [0, 1, 2, 3] => {
        let [a, b, c, d] = each!(place in [i, i + 4, i + 8, i + 12] => f32x4::splat(simd, numbers[place]));
        a.combine(b).combine(c.combine(d))
    })
}

/// Transposes each of the four quarters of four rows as a 4 × 4 matrix.
#[inline(always)]
pub(crate) fn transpose_quarters<S: Simd>(rows: [f32x16<S>; 4]) -> [f32x16<S>; 4] {
    let simd = rows[0].simd;
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = simd.level().as_avx512() {
        let rows = each!(i in [0, 1, 2, 3] => f32x16::load_array(avx512, rows[i].to_array()).into());
        let columns = x86::transpose_quarters(avx512, rows);
        return each!(i in [0, 1, 2, 3] => {
            let column: f32x16<_> = columns[i].simd_into(avx512);
            f32x16::load_array(simd, column.to_array())
        });
    }
    let halves = each!(i in [0, 1, 2, 3] => rows[i].split());
    let low = transpose_halves([halves[0].0, halves[1].0, halves[2].0, halves[3].0]);
    let high = transpose_halves([halves[0].1, halves[1].1, halves[2].1, halves[3].1]);
    each!(i in [0, 1, 2, 3] => low[i].combine(high[i]))
}

/// Transposes the lower halves of four rows as a 4 × 4 matrix, and likewise the upper halves.
#[inline(always)]
pub(crate) fn transpose_halves<S: Simd>(rows: [F32<S>; 4]) -> [F32<S>; 4] {
    let simd = rows[0].simd;
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = simd.level().as_avx2() {
        let rows = each!(i in [0, 1, 2, 3] => f32x8::load_array(avx2, rows[i].to_array()).into());
        let columns = x86::transpose_halves(avx2, rows);
        return each!(i in [0, 1, 2, 3] => {
            let column: f32x8<_> = columns[i].simd_into(avx2);
            F32::load_array(simd, column.to_array())
        });
    }
    let halves = each!(i in [0, 1, 2, 3] => rows[i].split());
    let low = transpose([halves[0].0, halves[1].0, halves[2].0, halves[3].0]);
    let high = transpose([halves[0].1, halves[1].1, halves[2].1, halves[3].1]);
    each!(i in [0, 1, 2, 3] => low[i].combine(high[i]))
}

#[inline(always)]
fn transpose<S: Simd>([a, b, c, d]: [f32x4<S>; 4]) -> [f32x4<S>; 4] {
    let ((ac0, ac1), (bd0, bd1)) = (a.interleave(c), b.interleave(d));
    let ((w, x), (y, z)) = (ac0.interleave(bd0), ac1.interleave(bd1));
    [w, x, y, z]
}

/// Clamps doubles to the range from `least` to `greatest`, as `f64::clamp` does. NaN must not occur.
#[inline(always)]
pub(crate) fn clamp_f64<S: Simd>(x: F64<S>, least: f64, greatest: f64) -> F64<S> {
    x.max(least).min(greatest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_columns_change_places() {
        let rows: [[f32; 4]; WIDE] = std::array::from_fn(|row| std::array::from_fn(|column| (row * 4 + column) as f32));
        let column = |column: usize| rows.map(|row| row[column]);
        for lanes in Lanes::all() {
            let (eight, sixteen, back, repeated) = on_lanes!(lanes, simd => {
                let r = each!(i in [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15] => f32x4::load_array(simd, rows[i]));
                let columns = transpose_quads([r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7]]);
                let back = rows_of_quads(columns);
                let wide = transpose_wide(r);
                let repeated = repeat_each(simd, wide[0]);
                (
                    columns.map(SimdBase::to_array),
                    wide.map(SimdBase::to_array),
                    back.map(SimdBase::to_array),
                    repeated.map(SimdBase::to_array),
                )
            });
            for i in 0..4 {
                assert_eq!(sixteen[i], column(i), "by {}", lanes.name());
                assert_eq!(eight[i], column(i)[..LANES], "by {}", lanes.name());
                let expected: [f32; WIDE] = std::array::from_fn(|lane| column(0)[i + lane / 4 * 4]);
                assert_eq!(repeated[i], expected, "by {}", lanes.name());
            }
            assert_eq!(back, rows[..LANES], "by {}", lanes.name());
        }
    }

    #[test]
    fn integers_are_doubles_too() {
        let numbers = [0, 1, -1, i32::MAX, i32::MIN, 123_456_789, -16_777_217, 255];
        for lanes in Lanes::all() {
            let doubles = on_lanes!(lanes, simd => doubles_of(simd, i32x8::load_array(simd, numbers)).to_array());
            assert_eq!(doubles, numbers.map(f64::from), "by {}", lanes.name());
        }
    }
}
