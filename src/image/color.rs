//! sRGB codes and linear light (IEC 61966-2-1).

use std::sync::LazyLock;

use glam::Vec3;

use crate::math::lanes::*;

/// The tables behind fast conversion. Loops hold on to one reference: asking for it each time costs as much as a lookup.
#[derive(Debug)]
pub struct Tables {
    /// Linear light of each code.
    pub linear_of_code: [f32; 256],
    /// Each code as a float.
    pub code: [f32; 256],
    /// Of each bucket of linear values the code of the least one, and in the upper half the bits of the least value that has
    /// the next code.
    buckets: Box<[u64; BUCKETS]>,
}

/// Linear values below 2⁻¹³ have code 0: half a code is 0.5 / 255 / 12.92 = 1.5 · 10⁻⁴ > 2⁻¹³.
const LEAST_BITS: u32 = 0x3900_0000;

/// Buckets per octave are 2⁸: 0.4 % wide, narrower than any code, so a bucket holds one threshold at most.
const BUCKET_SHIFT: u32 = 15;

/// Buckets up to that of 1, and more up to a power of two, so that a masked number is known to be one of them.
const BUCKETS: usize = (((0x3F80_0000 - LEAST_BITS) >> BUCKET_SHIFT) as usize + 1).next_power_of_two();

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
            let least = f32::from_bits(LEAST_BITS + ((bucket as u32) << BUCKET_SHIFT));
            let code = thresholds.partition_point(|t| *t <= least).clamp(1, 256) - 1;
            code as u64 | u64::from(thresholds[code + 1].to_bits()) << 32
        })),
    }
});

impl Tables {
    /// The one instance.
    pub fn get() -> &'static Self {
        &TABLES
    }

    /// The 8-bit sRGB code nearest to linear light; clamps, and gives 0 for NaN.
    ///
    /// Exact: the code is found by comparing with the thresholds between codes, not by an approximated power.
    #[inline]
    pub fn encode(&self, linear: f32) -> u8 {
        let clamped = if linear > 0.0 { linear.min(1.0) } else { 0.0 };
        let entry = self.buckets[clamped.to_bits().saturating_sub(LEAST_BITS) as usize >> BUCKET_SHIFT];
        entry as u8 + u8::from(clamped >= f32::from_bits((entry >> 32) as u32))
    }

    /// [`Self::encode`] for eight values.
    #[inline(always)]
    pub fn encode_lanes<S: Simd>(&self, simd: S, linear: F32<S>) -> u32x8<S> {
        let zero = F32::splat(simd, 0.0);
        let clamped = linear.simd_gt(zero).select(linear.min(1.0), zero);
        let bits = clamped.bitcast::<u32x8<S>>();
        let bucket = ((bits.max(LEAST_BITS) - LEAST_BITS) >> BUCKET_SHIFT).to_array();
        let entries = each!(lane in [0, 1, 2, 3, 4, 5, 6, 7] => self.buckets[bucket[lane] as usize % BUCKETS]);
        let (code, next) = halves(simd, entries);
        let one = clamped.simd_ge(next.bitcast::<F32<S>>()).select(u32x8::splat(simd, 1), u32x8::splat(simd, 0));
        code + one
    }
}

/// Linear light of an sRGB value in [0, 1].
pub fn decode(srgb: f32) -> f32 {
    if srgb <= 0.04045 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
}

/// sRGB value of linear light in [0, 1].
pub fn encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Linear light of an 8-bit sRGB code.
pub fn decode_byte(code: u8) -> f32 {
    TABLES.linear_of_code[code as usize]
}

/// The 8-bit sRGB code nearest to linear light; see [`Tables::encode`].
pub fn encode_byte(linear: f32) -> u8 {
    TABLES.encode(linear)
}

/// The 8-bit code of a value in [0, 1], rounded half up; clamps, and gives 0 for NaN.
#[inline]
pub fn quantize(value: f32) -> u8 {
    (value * 255.0 + 0.5) as u8
}

/// Linear light of a colour given in sRGB values.
pub fn decode_rgb(srgb: Vec3) -> Vec3 {
    Vec3::new(decode(srgb.x), decode(srgb.y), decode(srgb.z))
}

/// Luma of sRGB codes by the Rec. 709 weights, in [0, 255].
pub fn luma([r, g, b, _]: [u8; 4]) -> f32 {
    0.2126 * f32::from(r) + 0.7152 * f32::from(g) + 0.0722 * f32::from(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_encode_as_one_by_one_at_every_threshold_and_on_its_sides() {
        let tables = Tables::get();
        let thresholds = tables.buckets.iter().map(|entry| f32::from_bits((entry >> 32) as u32));
        let around = thresholds.flat_map(|threshold| [threshold.next_down(), threshold, threshold.next_up()]);
        let odd = [0.0, -0.0, -1.0, 1.0, 2.0, f32::MIN_POSITIVE, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
        let values: Vec<f32> = around.chain(odd).collect();
        for lanes in Lanes::all() {
            for eight in values.chunks(LANES) {
                let mut padded = [0.5; LANES];
                padded[..eight.len()].copy_from_slice(eight);
                let codes =
                    on_lanes!(lanes, simd => tables.encode_lanes(simd, F32::load_array(simd, padded)).to_array());
                assert_eq!(codes, padded.map(|value| u32::from(tables.encode(value))), "{} {padded:?}", lanes.name());
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
