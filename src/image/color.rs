//! sRGB codes and linear light (IEC 61966-2-1).

use std::sync::LazyLock;

use glam::Vec3;

static DECODE: LazyLock<[f32; 256]> = LazyLock::new(|| std::array::from_fn(|code| decode(code as f32 / 255.0)));

/// Steps of the table behind [`encode_byte`]; the segment that holds the answer is found by one lookup.
const ENCODE_STEPS: usize = 4096;

/// For each code, the least linear value that rounds to it; `ENCODE_FIRST` says where to start looking.
static ENCODE_THRESHOLDS: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| if code == 0 { 0.0 } else { decode((code as f32 - 0.5) / 255.0) }));

static ENCODE_FIRST: LazyLock<[u8; ENCODE_STEPS + 1]> = LazyLock::new(|| {
    std::array::from_fn(|step| {
        let linear = step as f32 / ENCODE_STEPS as f32;
        (ENCODE_THRESHOLDS.partition_point(|t| *t <= linear) - 1) as u8
    })
});

/// Linear light of an sRGB value in [0, 1].
pub fn decode(srgb: f32) -> f32 {
    if srgb <= 0.04045 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
}

/// sRGB value of linear light in [0, 1].
pub fn encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Linear light of an 8-bit sRGB code, by table.
#[inline]
pub fn decode_byte(code: u8) -> f32 {
    DECODE[code as usize]
}

/// The 8-bit sRGB code nearest to linear light; clamps, and gives 0 for NaN.
///
/// Exact: the code is found by comparing with the thresholds between codes, not by an approximated power.
#[inline]
pub fn encode_byte(linear: f32) -> u8 {
    let clamped = if linear > 0.0 { linear.min(1.0) } else { 0.0 };
    let mut code = ENCODE_FIRST[(clamped * ENCODE_STEPS as f32) as usize];
    while code < 255 && ENCODE_THRESHOLDS[code as usize + 1] <= clamped {
        code += 1;
    }
    code
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
