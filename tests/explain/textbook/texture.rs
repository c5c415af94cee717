//! Textures and their filters.

use glam::{DVec2, DVec3};

use super::color::from_codes;
use super::{Fault, Faults, Picture};

/// Returns the index of a texel along an axis of the given length.
fn address(index: f64, length: usize, faults: Faults) -> usize {
    let length = length as f64;
    (if faults.has(Fault::Clamp) { index.clamp(0.0, length - 1.0) } else { index.rem_euclid(length) }) as usize
}

/// Returns the colour of a texture at `uv`, with v upwards, in the colours in which the renderer computes.
pub(crate) fn sample(texture: &Picture, uv: DVec2, faults: Faults) -> DVec3 {
    let size = texture.size;
    let v = if faults.has(Fault::TextureTop) { uv.y } else { 1.0 - uv.y };
    let position = DVec2::new(uv.x, v) * DVec2::new(size.width as f64, size.height as f64);
    let texel = |x: f64, y: f64| {
        let (column, row) = (address(x, size.width, faults), address(y, size.height, faults));
        from_codes(texture.pixels[row * size.width + column], faults)
    };
    if faults.has(Fault::Nearest) {
        return texel(position.x.floor(), position.y.floor());
    }
    let position = if faults.has(Fault::HalfTexel) { position } else { position - 0.5 };
    let low = position.floor();
    let part = position - low;
    let top = texel(low.x, low.y).lerp(texel(low.x + 1.0, low.y), part.x);
    let bottom = texel(low.x, low.y + 1.0).lerp(texel(low.x + 1.0, low.y + 1.0), part.x);
    top.lerp(bottom, part.y)
}

#[cfg(test)]
mod tests {
    use super::super::Size;
    use super::*;

    /// Samples a texture of 2×2 texels: red and green above, black and blue below.
    fn codes(u: f64, v: f64, faults: &[Fault]) -> [f64; 3] {
        let pixels = vec![[255, 0, 0], [0, 255, 0], [0, 0, 0], [0, 0, 255]];
        let texture = Picture { size: Size { width: 2, height: 2 }, pixels };
        sample(&texture, DVec2::new(u, v), Faults::new(faults)).to_array()
    }

    #[test]
    fn texel_centres_give_texels_with_the_origin_at_the_bottom_left() {
        assert_eq!(codes(0.25, 0.75, &[]), [1.0, 0.0, 0.0]);
        assert_eq!(codes(0.75, 0.25, &[]), [0.0, 0.0, 1.0]);
        assert_eq!(codes(0.75, 0.25, &[Fault::TextureTop]), [0.0, 1.0, 0.0]);
        assert_eq!(codes(0.74, 0.26, &[Fault::Nearest]), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn texels_are_blended_in_linear_light() {
        assert_eq!(codes(0.5, 0.75, &[]), [0.5, 0.5, 0.0]);
        assert_eq!(codes(0.5, 0.5, &[]), [0.25; 3]);
        assert_eq!(codes(0.0, 0.5, &[Fault::HalfTexel]), [0.0, 0.0, 0.0]);
    }

    #[test]
    fn coordinates_outside_repeat() {
        assert_eq!(codes(3.25, -1.25, &[]), [1.0, 0.0, 0.0]);
        assert_eq!(codes(3.25, 9.0, &[Fault::Clamp]), [0.0, 1.0, 0.0]);
        assert_eq!(codes(0.0, 0.75, &[]), [0.5, 0.5, 0.0]);
        assert_eq!(codes(0.0, 0.75, &[Fault::Clamp]), [1.0, 0.0, 0.0]);
    }
}
