//! Comparison of an image with a reference by all error metrics at once, over the whole image or a rectangle.

use serde::{Deserialize, Serialize};

use super::error::{ImageError, compare};
use super::flip;
use super::region::PixelRegion;
use crate::image::{Image, Rgba8};

/// Error of an image against a reference, one value per metric.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorMetrics {
    /// Error metrics on 8-bit sRGB-encoded values.
    #[serde(flatten)]
    pub codes: ImageError,
    /// Mean FLIP error of all pixels, in [0, 1].
    pub flip: f64,
}

/// Reference image with its FLIP preprocessing cached, about 24 bytes per pixel.
#[derive(Clone, Debug)]
pub(crate) struct PreparedReference {
    picture: Image<Rgba8>,
    perceived: flip::Perceived,
}

impl PreparedReference {
    /// Prepares a reference image for comparisons with other images.
    pub(crate) fn new(picture: Image<Rgba8>) -> Self {
        Self { perceived: flip::Perceived::new(&picture), picture }
    }

    /// Compares an image with this reference and also returns the FLIP error of every pixel. Returns `None` if the
    /// sizes differ or there are no pixels.
    pub(crate) fn figures(&self, picture: &Image<Rgba8>) -> Option<(ErrorMetrics, Image<f32>)> {
        let codes = compare(picture, &self.picture)?;
        let map = flip::Perceived::new(picture).difference(&self.perceived)?;
        Some((ErrorMetrics { codes, flip: flip::mean(&map) }, map))
    }
}

/// Compares an image with a reference and also returns the FLIP error of every pixel. Returns `None` if the sizes
/// differ or there are no pixels.
pub fn figures(picture: &Image<Rgba8>, reference: &Image<Rgba8>) -> Option<(ErrorMetrics, Image<f32>)> {
    let codes = compare(picture, reference)?;
    let map = flip::map(picture, reference)?;
    Some((ErrorMetrics { codes, flip: flip::mean(&map) }, map))
}

/// Compares an image with a reference within a rectangle. `flip` holds the FLIP errors of the whole image, because the
/// filters of FLIP also read pixels outside the rectangle. SSIM reads only pixels inside. Returns `None` if the
/// rectangle contains no pixel of the images.
pub fn figures_within(
    region: PixelRegion,
    picture: &Image<Rgba8>,
    reference: &Image<Rgba8>,
    flip: &Image<f32>,
) -> Option<ErrorMetrics> {
    Some(ErrorMetrics { codes: region.compare(picture, reference)?, flip: region.mean(flip)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_around_everything_has_the_figures_of_the_whole() {
        let a = Image::from_fn(24, 16, |x, y| [(x * 9) as u8, (y * 13) as u8, 40, 255]);
        let b = Image::from_fn(24, 16, |x, y| [(x * 9) as u8, (y * 11) as u8, 60, 255]);
        let (whole, map) = figures(&a, &b).unwrap();
        assert!(whole.codes.mse > 0.0 && whole.flip > 0.0);
        let region = PixelRegion { left: 0, top: 0, right: 24, bottom: 16 };
        assert_eq!(figures_within(region, &a, &b, &map), Some(whole));
        assert_eq!(figures_within(PixelRegion { left: 24, right: 30, ..region }, &a, &b, &map), None);
        assert_eq!(figures(&a, &Image::filled(24, 15, [0; 4])), None);
        let standard = PreparedReference::new(b);
        assert_eq!(standard.figures(&a), Some((whole, map)));
        assert_eq!(standard.figures(&Image::filled(24, 15, [0; 4])), None);
    }
}
