//! Colours between sRGB codes and linear light, and the light of a surface.

use std::array;
use std::sync::LazyLock;

use glam::DVec3;

use super::scene::Light;
use super::{Fault, Faults};

/// Linear light, 0…1, of every sRGB code (IEC 61966-2-1).
static DECODED: LazyLock<[f64; 256]> = LazyLock::new(|| array::from_fn(|code| decode(code as f64 / 255.0)));

/// Returns the linear light, 0…1, of an sRGB value, 0…1.
fn decode(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Returns the sRGB value, 0…1, of linear light, 0…1.
fn encode(light: f64) -> f64 {
    if light <= 0.003_130_8 { light * 12.92 } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

/// Returns the colour in which a renderer computes, 0…1 per channel: linear light unless the faults say otherwise.
pub(crate) fn from_codes(codes: [u8; 3], faults: Faults) -> DVec3 {
    let linear = !faults.has(Fault::LightOnCodes);
    DVec3::from_array(codes.map(|code| if linear { DECODED[usize::from(code)] } else { f64::from(code) / 255.0 }))
}

/// Returns the sRGB codes of a computed colour; values outside 0…1 are clamped.
pub(crate) fn to_codes(color: DVec3, faults: Faults) -> [u8; 3] {
    let raw = faults.has(Fault::LightOnCodes) || faults.has(Fault::NoEncoding);
    let mut codes = color.to_array().map(|channel| {
        let channel = channel.clamp(0.0, 1.0);
        let code = 255.0 * if raw { channel } else { encode(channel) };
        if faults.has(Fault::Truncated) { code as u8 } else { code.round() as u8 }
    });
    if faults.has(Fault::RedBlue) {
        codes.swap(0, 2);
    }
    codes
}

/// Returns the factor, ambient…1, by which light multiplies the colour of a surface with the interpolated `normal`.
pub(crate) fn lambert(light: Light, normal: DVec3, faults: Faults) -> f64 {
    let towards = light.direction.normalize();
    let towards = if faults.has(Fault::LightNegated) { -towards } else { towards };
    let normal = if faults.has(Fault::NormalsNotUnit) { normal } else { normal.normalize_or_zero() };
    light.ambient + (1.0 - light.ambient) * normal.dot(towards).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_codes_survive_decoding_and_encoding() {
        for code in 0..=255 {
            let codes = [code, 255 - code, code / 2];
            assert_eq!(to_codes(from_codes(codes, Faults::default()), Faults::default()), codes);
        }
    }

    #[test]
    fn one_pixel_has_the_light_computed_by_hand() {
        // Cosine 0.6 and ambient 0.2 give 0.2 + 0.8 · 0.6 = 0.68; code 188 is 0.5029 in linear light; the product 0.3420
        // has the code 158.4.
        let light = Light { direction: DVec3::new(0.0, 3.0, 4.0), ambient: 0.2 };
        let color = |faults| from_codes([188; 3], faults) * lambert(light, DVec3::new(0.0, 2.0, 0.0), faults);
        assert_eq!(to_codes(color(Faults::default()), Faults::default()), [158; 3]);
        // Light on codes: 188 · 0.68 = 127.84.
        let codes = Faults::new(&[Fault::LightOnCodes]);
        assert_eq!(to_codes(color(codes), codes), [128; 3]);
        let truncated = Faults::new(&[Fault::LightOnCodes, Fault::Truncated]);
        assert_eq!(to_codes(color(truncated), truncated), [127; 3]);
        // No encoding: 0.3420 · 255 = 87.2.
        assert_eq!(to_codes(color(Faults::default()), Faults::new(&[Fault::NoEncoding])), [87; 3]);
        // Negated light leaves the ambient part, 0.2 · 0.5029 = 0.1006, code 89.3.
        let negated = Faults::new(&[Fault::LightNegated]);
        assert_eq!(to_codes(color(negated), negated), [89; 3]);
    }
}
