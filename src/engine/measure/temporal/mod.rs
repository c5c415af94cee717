//! Error metrics of motion: flicker, ghosting and lag of a sequence against a reference sequence.
//!
//! All metrics read motion fields: for every pixel, the position in the previous frame of the surface that the pixel
//! shows now, in pixels from the top left corner of the picture. The centre of pixel (x, y) is (x + 0.5, y + 0.5). A
//! pixel whose surface the previous frame does not show is NaN. Motion fields belong to the reference, so that they do
//! not depend on the measured method. Each function measures one frame, and each result has a mean over many frames.

pub mod flicker;

pub mod ghosting;

pub mod lag;

use super::error::luma_of_codes;
use crate::image::{Image, Rgba8};

/// Position in the previous frame of every pixel's surface, in pixels; NaN where the previous frame does not show it.
pub type MotionField = Image<[f32; 2]>;

/// Returns the sRGB-coded BT.601 luma of every pixel, in [0, 255].
fn luma_of(picture: &Image<Rgba8>) -> Image<f64> {
    picture.map(luma_of_codes)
}

/// Whether a position lies within the picture. NaN does not.
fn is_inside((width, height): (u32, u32), [x, y]: [f64; 2]) -> bool {
    (0.0..f64::from(width)).contains(&x) && (0.0..f64::from(height)).contains(&y)
}

/// Samples an image bilinearly at a position in pixels, or returns `None` outside the image. Border pixels are repeated.
fn sample(image: &Image<f64>, at: [f64; 2]) -> Option<f64> {
    if !is_inside(image.size(), at) {
        return None;
    }
    let [left, top] = at.map(|at| (at - 0.5).floor());
    let [right_share, bottom_share] = [at[0] - 0.5 - left, at[1] - 0.5 - top];
    let (left, top) = (left as i64, top as i64);
    let row = |y: i64| {
        let [a, b] = [left, left + 1].map(|x| image.at_clamped(x, y));
        a + (b - a) * right_share
    };
    let (upper, lower) = (row(top), row(top + 1));
    Some(upper + (lower - upper) * bottom_share)
}

/// Returns the mean of values that are each the mean of a number of pixels, or `None` without a pixel.
fn mean_by_pixels(values: impl Iterator<Item = (f64, u64)>) -> Option<f64> {
    let (sum, pixels) =
        values.fold((0.0, 0), |(sum, all), (value, pixels)| (sum + value * pixels as f64, all + pixels));
    (pixels > 0).then(|| sum / pixels as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_exact_at_centres_and_linear_between_them() {
        let image = Image::from_fn(3, 2, |x, y| f64::from(x * 10 + y * 100));
        assert_eq!(sample(&image, [1.5, 0.5]), Some(10.0));
        assert_eq!(sample(&image, [2.0, 1.0]), Some(15.0 + 50.0));
        assert_eq!(sample(&image, [0.0, 0.0]), Some(0.0), "the border pixel is repeated");
        assert_eq!(sample(&image, [2.9, 1.9]), Some(120.0));
        for outside in [[3.0, 1.0], [-0.1, 1.0], [1.0, 2.0], [f64::NAN, 1.0]] {
            assert_eq!(sample(&image, outside), None, "{outside:?}");
        }
    }
}
