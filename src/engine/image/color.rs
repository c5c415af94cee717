//! Conversion between sRGB codes and linear light (IEC 61966-2-1).

use std::sync::LazyLock;

use glam::Vec3;

use crate::math::lanes::*;

/// Lookup tables for fast conversion between sRGB codes and linear light. Loops should keep one reference, because each
/// call to [`Tables::get`] costs as much as a table lookup.
#[derive(Debug)]
pub(crate) struct Tables {
    /// Linear light, in [0, 1], of each 8-bit sRGB code.
    pub(crate) linear_of_code: [f32; 256],
    /// Each 8-bit code as a float, 0 to 255.
    pub(crate) code: [f32; 256],
    /// Table from which [`Tables::encode`] finds the code of a linear value with a single read. Each entry belongs to a
    /// bucket: 2¹⁵ consecutive `f32` values, numbered from 0 by their offsets. The entry is c · 2¹⁶ + (2¹⁶ − n), where
    /// c is the code of the value at offset 0. n is the offset of the first value with code c + 1, or 2¹⁵ if the bucket
    /// has no such value. The code of a value is the sum of the entry and the value's offset, shifted right by 16: from
    /// offset n on, the addition carries into bit 16.
    buckets: Box<[u32; BUCKETS]>,
}

/// Bit pattern of 2⁻¹³ as an `f32`, the start of the first bucket. Smaller linear values have code 0, because code 1
/// begins at 0.5 / 255 / 12.92 = 1.5 · 10⁻⁴ > 2⁻¹³.
const MIN_BITS: u32 = 0x3900_0000;

/// Right shift that turns the bits of an `f32`, less [`MIN_BITS`], into the index of a bucket. There are 2⁸ buckets per
/// octave, so a bucket is at most 0.4 % wide. Every code covers a wider range, so a bucket contains at most one
/// threshold between codes.
const BUCKET_SHIFT: u32 = 15;

/// Number of `f32` values in a bucket.
const FLOATS_PER_BUCKET: u32 = 1 << BUCKET_SHIFT;

/// Number of fractional bits of the fixed-point code in a bucket's entry.
const CODE_SHIFT: u32 = BUCKET_SHIFT + 1;

/// Number of buckets up to the bucket of the value 1, rounded up to a power of two so that masking an index makes it
/// valid.
const BUCKETS: usize = (((0x3F80_0000 - MIN_BITS) >> BUCKET_SHIFT) as usize + 1).next_power_of_two();

static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    let threshold = |code: usize| match code {
        0 => 0.0,
        256 => f32::INFINITY,
        _ => decode((code as f32 - 0.5) / 255.0),
    };
    let thresholds: [f32; 257] = std::array::from_fn(threshold);
    Tables {
        linear_of_code: std::array::from_fn(|code| decode(code as f32 / 255.0)),
        code: std::array::from_fn(|code| code as f32),
        buckets: Box::new(std::array::from_fn(|bucket| {
            let bits = MIN_BITS + bucket as u32 * FLOATS_PER_BUCKET;
            let code = thresholds.partition_point(|t| *t <= f32::from_bits(bits)).clamp(1, 256) - 1;
            // If the next code begins beyond the bucket, no offset in the bucket reaches `next`.
            let next = (thresholds[code + 1].to_bits() - bits).min(FLOATS_PER_BUCKET);
            ((code as u32 + 1) << CODE_SHIFT) - next
        })),
    }
});

impl Tables {
    /// Returns the shared instance, computed on first use.
    pub(crate) fn get() -> &'static Self {
        &TABLES
    }

    /// Returns the 8-bit sRGB code nearest to a linear value, which is clamped to [0, 1]; returns 0 for NaN.
    ///
    /// The result is exact: the code is found by comparing with the thresholds between codes, not by approximating a
    /// power function.
    #[inline]
    pub(crate) fn encode(&self, linear: f32) -> u8 {
        let clamped = if linear > 0.0 { linear.min(1.0) } else { 0.0 };
        let above = clamped.to_bits().saturating_sub(MIN_BITS);
        ((self.buckets[(above >> BUCKET_SHIFT) as usize] + above % FLOATS_PER_BUCKET) >> CODE_SHIFT) as u8
    }

    /// Returns the 8-bit sRGB codes of sixteen linear values, identical to the results of [`Self::encode`].
    #[inline(always)]
    pub(crate) fn encode_lanes<S: Simd>(&self, simd: S, linear: f32x16<S>) -> u32x16<S> {
        self.encode_lanes_by(simd, gathers_are_fast(), linear)
    }

    /// Implements [`Self::encode_lanes`]. `by_gathers` selects gather instructions, if available, instead of scalar
    /// loads.
    #[inline(always)]
    fn encode_lanes_by<S: Simd>(&self, simd: S, by_gathers: bool, linear: f32x16<S>) -> u32x16<S> {
        let zero = f32x16::splat(simd, 0.0);
        let clamped = linear.simd_gt(zero).select(linear.min(1.0), zero);
        let above = clamped.bitcast::<u32x16<S>>().max(MIN_BITS) - MIN_BITS;
        (self.entries(simd, by_gathers, above >> BUCKET_SHIFT) + (above & (FLOATS_PER_BUCKET - 1))) >> CODE_SHIFT
    }
}

impl Tables {
    /// Returns the values of `table` at sixteen indices, each of which must be less than 256.
    #[inline(always)]
    pub(crate) fn lookup<S: Simd>(simd: S, table: &[f32; 256], codes: u32x16<S>) -> f32x16<S> {
        Self::lookup_by(simd, gathers_are_fast(), table, codes)
    }

    /// Implements [`Tables::lookup`]. `by_gathers` selects gather instructions, if available, instead of scalar loads.
    #[inline(always)]
    fn lookup_by<S: Simd>(simd: S, by_gathers: bool, table: &[f32; 256], codes: u32x16<S>) -> f32x16<S> {
        #[cfg(target_arch = "x86_64")]
        if by_gathers && let Some(avx512) = simd.level().as_avx512() {
            let codes = u32x16::load_array(avx512, codes.to_array());
            return f32x16::load_array(simd, x86::lookup(avx512, table, codes.into()));
        }
        let (codes, mut found) = (codes.to_array(), [0.0; WIDE]);
        for lane in 0..WIDE {
            found[lane] = table[codes[lane] as usize % table.len()];
        }
        f32x16::load_array(simd, found)
    }

    /// Returns the values of `self.buckets` at sixteen indices. `by_gathers` selects gather instructions, if available.
    #[inline(always)]
    fn entries<S: Simd>(&self, simd: S, by_gathers: bool, bucket: u32x16<S>) -> u32x16<S> {
        #[cfg(target_arch = "x86_64")]
        if by_gathers && let Some(avx512) = simd.level().as_avx512() {
            let bucket = u32x16::load_array(avx512, bucket.to_array());
            return u32x16::load_array(simd, x86::entries(avx512, &self.buckets, bucket.into()));
        }
        let (bucket, mut found) = (bucket.to_array(), [0; WIDE]);
        for lane in 0..WIDE {
            found[lane] = self.buckets[bucket[lane] as usize % BUCKETS];
        }
        u32x16::load_array(simd, found)
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use fearless_simd::prelude::*;
    use fearless_simd::{f32x16, kernel, u32x16};

    use super::BUCKETS;

    kernel! {
        #[inline]
        #[expect(unsafe_code, reason = "one instruction for 16 reads: gathering over frames takes a tenth less time")]
        pub(super) fn lookup(avx512: Avx512, table: &[f32; 256], codes: __m512i) -> [f32; 16] {
            let codes = _mm512_and_si512(codes, _mm512_set1_epi32(255));
            // SAFETY: a code masked with 255 is at most 255, and the table has 256 entries.
            let found: f32x16<_> = unsafe { _mm512_i32gather_ps::<4>(codes, table.as_ptr()) }.simd_into(avx512);
            found.to_array()
        }
    }

    kernel! {
        #[inline]
        #[expect(unsafe_code, reason = "one instruction for 16 reads: gathering over frames takes a fifth less time")]
        pub(super) fn entries(avx512: Avx512, buckets: &[u32; BUCKETS], bucket: __m512i) -> [u32; 16] {
            let bucket = _mm512_and_si512(bucket, _mm512_set1_epi32(BUCKETS as i32 - 1));
            // SAFETY: an index masked with `BUCKETS` − 1 is less than `BUCKETS`, because that is a power of two.
            let found: u32x16<_> = unsafe { _mm512_i32gather_epi32::<4>(bucket, buckets.as_ptr().cast()) }.simd_into(avx512);
            found.to_array()
        }
    }
}

/// Converts an sRGB-encoded value to linear light; both are in [0, 1].
pub fn decode(srgb: f32) -> f32 {
    if srgb <= 0.04045 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
}

/// Converts a linear value to an sRGB-encoded value; both are in [0, 1].
///
/// # Examples
/// ```
/// use rasterscope_engine::image::color::{decode, decode_byte, encode, quantize};
///
/// // Half of the light has sRGB code 188, not 128.
/// assert_eq!(quantize(encode(0.5)), 188);
/// assert!((decode(188.0 / 255.0) - 0.5).abs() < 0.01);
///
/// // Every code survives the round trip.
/// for code in 0..=255 {
///     assert_eq!(quantize(encode(decode_byte(code))), code);
/// }
/// ```
pub fn encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Converts an 8-bit sRGB code to linear light, in [0, 1].
pub fn decode_byte(code: u8) -> f32 {
    TABLES.linear_of_code[code as usize]
}

/// Converts a value in [0, 1] to an 8-bit code, rounding half up. Clamps values out of range; returns 0 for NaN.
#[inline]
pub fn quantize(value: f32) -> u8 {
    (value * 255.0 + 0.5) as u8
}

/// Converts a colour from sRGB-encoded channels to linear light, both in [0, 1].
pub(crate) fn decode_rgb(srgb: Vec3) -> Vec3 {
    Vec3::new(decode(srgb.x), decode(srgb.y), decode(srgb.z))
}

/// Signal colour of marks on a picture, which hardly any picture contains: changed pixels, and the triangle drawn last.
pub const SIGNAL: [u8; 4] = [0xFF, 0x2E, 0xD1, 0xFF];

/// Returns the luma of a colour given as sRGB codes, with the Rec. 709 weights, in [0, 255].
pub fn luma([r, g, b, _]: [u8; 4]) -> f32 {
    0.2126 * f32::from(r) + 0.7152 * f32::from(g) + 0.0722 * f32::from(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encode_byte(linear: f32) -> u8 {
        TABLES.encode(linear)
    }

    /// Returns the smallest linear value whose nearest sRGB code is `code`.
    fn least_of_code(code: u8) -> f32 {
        decode((f32::from(code) - 0.5) / 255.0)
    }

    #[test]
    fn codes_change_at_their_thresholds() {
        for code in 1..=255 {
            let least = least_of_code(code);
            assert_eq!([encode_byte(least.next_down()), encode_byte(least)], [code - 1, code]);
        }
    }

    #[test]
    fn simd_lanes_encode_like_scalar_code_around_every_threshold() {
        let tables = Tables::get();
        let thresholds = (1..=255).map(least_of_code);
        let around = thresholds.flat_map(|threshold| [threshold.next_down(), threshold, threshold.next_up()]);
        let odd = [0.0, -0.0, -1.0, 1.0, 2.0, f32::MIN_POSITIVE, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
        let values: Vec<f32> = around.chain(odd).collect();
        for (lanes, by_gathers) in Lanes::all_with_and_without_gathers() {
            for some in values.chunks(WIDE) {
                let mut padded = [0.5; WIDE];
                padded[..some.len()].copy_from_slice(some);
                let codes = on_lanes!(lanes, simd => {
                    tables.encode_lanes_by(simd, by_gathers, f32x16::load_array(simd, padded)).to_array()
                });
                assert_eq!(codes, padded.map(|value| u32::from(tables.encode(value))), "{} {padded:?}", lanes.name());
            }
        }
    }

    #[test]
    fn every_lane_looks_up_its_own_code() {
        let tables = Tables::get();
        for (lanes, by_gathers) in Lanes::all_with_and_without_gathers() {
            for first in 0..=255_u32 {
                let codes: [u32; WIDE] = std::array::from_fn(|lane| (first + 37 * lane as u32) % 256);
                let found = on_lanes!(lanes, simd => {
                    let codes = u32x16::load_array(simd, codes);
                    Tables::lookup_by(simd, by_gathers, &tables.linear_of_code, codes).to_array()
                });
                assert_eq!(found, codes.map(|code| tables.linear_of_code[code as usize]), "{}", lanes.name());
            }
        }
    }

    #[test]
    fn every_code_survives_a_round_trip() {
        for code in 0..=255 {
            assert_eq!(encode_byte(decode_byte(code)), code);
        }
    }

    #[test]
    fn the_table_agrees_with_the_formula() {
        for i in 0..=100_000 {
            let linear = i as f32 / 100_000.0;
            let exact = encode(linear) * 255.0;
            let code = f32::from(encode_byte(linear));
            assert!((code - exact).abs() <= 0.5001, "{linear}: {code} against {exact}");
        }
    }

    #[test]
    fn values_outside_are_clamped() {
        assert_eq!([encode_byte(-1.0), encode_byte(2.0), encode_byte(f32::NAN)], [0, 255, 0]);
        assert_eq!([quantize(-1.0), quantize(2.0), quantize(f32::NAN)], [0, 255, 0]);
    }
}
