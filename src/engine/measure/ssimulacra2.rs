//! SSIMULACRA2: structural similarity and edge differences at six scales, weighted by scores of human observers.
//!
//! The metric of Jon Sneyers (Cloudinary, 2023) is defined by its program; the crate `fast-ssim2` has the same scores.
//! 100 is identical; its author calls 90 visually lossless, 70 high quality, 50 medium and 30 low quality. Very different
//! pictures are below 0. Swapping the pictures changes the score: the second one is the original.

use fast_ssim2::{PixelDescriptor, PixelSlice, compute_ssimulacra2};

use crate::image::{Image, Rgba8};

/// Computes the SSIMULACRA2 score of a picture against its original. Alpha is ignored. Returns `None` if the sizes differ,
/// or if the pictures have no pixels or more than 2²⁸.
///
/// # Examples
/// ```
/// use rasterscope_engine::image::Image;
/// use rasterscope_engine::measure::ssimulacra2::score;
///
/// let grey = Image::filled(64, 36, [120, 120, 120, 255]);
/// assert_eq!(score(&grey, &grey), Some(100.0));
/// ```
pub fn score(picture: &Image<Rgba8>, original: &Image<Rgba8>) -> Option<f64> {
    if picture.size() != original.size() {
        return None;
    }
    let (width, height) = picture.size();
    let [picture, original] = [picture, original].map(|image| image.map(|[r, g, b, _]| [r, g, b]));
    let slice = |image| {
        let bytes: &[u8] = Image::<[u8; 3]>::pixels(image).as_flattened();
        PixelSlice::new(bytes, width, height, width as usize * 3, PixelDescriptor::RGB8_SRGB).ok()
    };
    compute_ssimulacra2(&slice(&original)?, &slice(&picture)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Grey picture of 64 × 64 px.
    fn grey(code: impl Fn(u32, u32) -> u32) -> Image<Rgba8> {
        Image::from_fn(64, 64, |x, y| {
            let code = code(x, y) as u8;
            [code, code, code, 255]
        })
    }

    /// Returns the mean of the 8 × 8 px from 4 px before to 3 px after each pixel, rounded down; the border is repeated.
    fn blurred(picture: &Image<Rgba8>) -> Image<Rgba8> {
        let at = |x: u32, y: u32, by: i64| picture.at_clamped(i64::from(x) + by % 8 - 4, i64::from(y) + by / 8 - 4);
        grey(|x, y| (0..64).map(|by| u32::from(at(x, y, by)[0])).sum::<u32>() / 64)
    }

    /// Scores of the C++ program of the metric's author, as the tests of the crate `fast-ssim2` list them.
    #[test]
    fn scores_agree_with_the_program_that_defines_them() {
        let (gradient, edge) = (grey(|x, _| x * 255 / 63), grey(|x, _| if x < 32 { 0 } else { 255 }));
        for (name, picture, original, expected) in [
            ("uniform", grey(|_, _| 128), &gradient, -64.568_721_48),
            ("blurred gradient", blurred(&gradient), &gradient, 94.340_903_15),
            ("blurred edge", blurred(&edge), &edge, 24.273_335_52),
        ] {
            let measured = score(&picture, original).unwrap();
            assert!((measured - expected).abs() < 0.1, "{name}: {measured} instead of {expected}");
        }
    }

    #[test]
    fn identical_pictures_have_100_and_other_sizes_no_score() {
        for (width, height) in [(1, 1), (7, 20), (33, 17)] {
            let picture = Image::from_fn(width, height, |x, y| [(x * 37) as u8, (y * 51) as u8, 90, 255]);
            assert_eq!(score(&picture, &picture), Some(100.0), "{width}×{height}");
            let transparent = picture.map(|[r, g, b, _]| [r, g, b, 0]);
            assert_eq!(score(&transparent, &picture), Some(100.0), "alpha is ignored");
        }
        assert_eq!(score(&grey(|_, _| 0), &Image::filled(3, 3, [0; 4])), None);
        assert_eq!(score(&Image::filled(0, 0, [0; 4]), &Image::filled(0, 0, [0; 4])), None);
    }
}
