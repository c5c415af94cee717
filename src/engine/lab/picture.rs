//! Pictures as input of the lab page on sampling.

use crate::image::color::luma;
use crate::image::{Image, Rgba8};

/// Returns the luma of each pixel in [0, 1], computed on the sRGB-encoded values.
pub(crate) fn brightness(picture: &Image<Rgba8>) -> Image<f64> {
    picture.map(|pixel| f64::from(luma(pixel)) / 255.0)
}

/// Returns a Siemens star, a test pattern for lenses and printers. Its wedges meet at the centre, where they are
/// narrower than a pixel.
pub(crate) fn siemens_star() -> Image<f64> {
    const SIDES: (u32, u32) = (480, 360);
    const WEDGES: f64 = 36.0;
    Image::from_fn(SIDES.0, SIDES.1, |x, y| {
        let [right, down] = [(x, SIDES.0), (y, SIDES.1)].map(|(at, side)| f64::from(at) + 0.5 - f64::from(side) / 2.0);
        let wedge = down.atan2(right) / std::f64::consts::TAU * WEDGES;
        f64::from(u8::from(wedge.rem_euclid(1.0) < 0.5))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_a_star_is_white() {
        let star = siemens_star();
        let mean = star.pixels().iter().sum::<f64>() / star.pixels().len() as f64;
        assert!((mean - 0.5).abs() < 0.01, "{mean}");
    }
}
