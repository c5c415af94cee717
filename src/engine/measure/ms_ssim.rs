//! MS-SSIM: structural similarity at five scales.
//!
//! Wang, Simoncelli and Bovik, "Multiscale Structural Similarity for Image Quality Assessment" (2003), with their
//! exponents. Each scale is half as large as the one before, from means of 2 × 2 px; the last row or column of an odd
//! size is repeated. The structure term of each scale is averaged over its windows and raised to the exponent of the
//! scale; at the coarsest scale the luminance term is included. Negative terms count as 0, because powers of them are not
//! real. Window and constants are those of [`super::error`]. The coarsest scale is as large as the window from 176 px
//! on; in smaller pictures its window shrinks.

use super::error::similarity_of;
use crate::image::Image;

/// Exponents of the scales, the finest first.
const EXPONENTS: [f64; 5] = [0.0448, 0.2856, 0.3001, 0.2363, 0.1333];

/// Computes MS-SSIM of two greyscale images of equal size, at least 1 × 1 px, with values in [0, 255]. The result is in
/// [0, 1]; 1 for identical images.
pub(super) fn ms_ssim(a: &Image<f64>, b: &Image<f64>) -> f64 {
    let (mut a, mut b) = (a.clone(), b.clone());
    let mut product = 1.0;
    for (scale, exponent) in EXPONENTS.into_iter().enumerate() {
        let similarity = similarity_of(&a, &b);
        let is_coarsest = scale + 1 == EXPONENTS.len();
        let term = if is_coarsest { similarity.whole } else { similarity.structure };
        product *= term.max(0.0).powf(exponent);
        (a, b) = (halved(&a), halved(&b));
    }
    product
}

/// Returns the image at half the width and height, rounded up.
fn halved(image: &Image<f64>) -> Image<f64> {
    let (width, height) = image.size();
    Image::from_fn(width.div_ceil(2), height.div_ceil(2), |x, y| {
        let (left, top) = (i64::from(2 * x), i64::from(2 * y));
        let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
        corners.iter().map(|(dx, dy)| image.at_clamped(left + dx, top + dy)).sum::<f64>() / 4.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::error::luma_of_codes;
    use crate::measure::test_pictures::{Distortion, original};

    #[test]
    fn values_agree_with_an_independent_program() {
        // SciPy 1.17.1: scipy.signal.convolve2d(…, mode="valid") with the two-dimensional Gaussian window, in float64.
        for (distortion, expected) in [
            (Distortion::Blur, 0.988_248_500_975_267_2),
            (Distortion::Noise, 0.983_789_711_155_178_3),
            (Distortion::Dim, 0.993_924_290_860_995_3),
        ] {
            let [a, b] = [original(), distortion.applied()].map(|picture| picture.map(luma_of_codes));
            let measured = ms_ssim(&a, &b);
            assert!((measured - expected).abs() < 1e-9, "{distortion:?}: {measured} instead of {expected}");
        }
    }

    #[test]
    fn identical_images_of_any_size_have_1() {
        for (width, height) in [(1, 1), (3, 40), (33, 17)] {
            let image = Image::from_fn(width, height, |x, y| f64::from((x * 37 + y * 11) % 256));
            assert_eq!(ms_ssim(&image, &image), 1.0, "{width}×{height}");
        }
    }

    #[test]
    fn an_inverted_image_has_0() {
        let image = Image::from_fn(40, 30, |x, y| if (x / 2 + y / 2) % 2 == 0 { 0.0 } else { 255.0 });
        assert_eq!(ms_ssim(&image, &image.map(|value| 255.0 - value)), 0.0);
    }

    #[test]
    fn odd_sizes_repeat_their_border() {
        let image = Image::from_fn(3, 1, |x, _| f64::from(x * 8));
        assert_eq!(halved(&image).pixels(), [4.0, 16.0]);
    }
}
