//! Error metrics within a rectangle of two images.

use serde::{Deserialize, Serialize};

use super::error::{ImageError, compare};
use super::flip;
use crate::image::{Image, Rgba8};

/// Rectangle of pixels in an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PixelRegion {
    /// First column of the rectangle.
    pub left: u32,
    /// First row of the rectangle.
    pub top: u32,
    /// One past the last column of the rectangle.
    pub right: u32,
    /// One past the last row of the rectangle.
    pub bottom: u32,
}

impl PixelRegion {
    /// Returns the part of an image inside the rectangle, or `None` if the image and the rectangle do not overlap.
    pub(crate) fn of<T: Copy>(self, picture: &Image<T>) -> Option<Image<T>> {
        let (right, bottom) = (self.right.min(picture.width()), self.bottom.min(picture.height()));
        if self.left >= right || self.top >= bottom {
            return None;
        }
        Some(Image::from_fn(right - self.left, bottom - self.top, |x, y| picture.at(self.left + x, self.top + y)))
    }

    /// Applies [`compare`] to the parts of two images inside the rectangle. SSIM reads no pixels outside the rectangle.
    pub fn compare(self, a: &Image<Rgba8>, b: &Image<Rgba8>) -> Option<ImageError> {
        if a.size() != b.size() {
            return None;
        }
        compare(&self.of(a)?, &self.of(b)?)
    }

    /// Returns the mean of per-pixel errors, such as those of [`flip::map`], inside the rectangle. FLIP errors also
    /// depend on pixels outside the rectangle.
    pub(crate) fn mean(self, errors: &Image<f32>) -> Option<f64> {
        Some(flip::mean(&self.of(errors)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_pixels_inside_the_rectangle_count() {
        let black = Image::filled(20, 10, [0, 0, 0, 255]);
        let mut other = black.clone();
        other.set(15, 4, [10, 0, 0, 255]);
        let region = PixelRegion { left: 14, top: 4, right: 16, bottom: 99 };
        let error = region.compare(&black, &other).unwrap();
        assert_eq!((error.differing_pixels, error.max_abs, error.mse), (1, 10, 100.0 / (2.0 * 6.0 * 3.0)));
        let beside = PixelRegion { left: 0, right: 15, ..region };
        assert_eq!(beside.compare(&black, &other).unwrap().differing_pixels, 0);
        assert_eq!(PixelRegion { left: 20, right: 30, ..region }.compare(&black, &other), None);
        assert_eq!(region.mean(&Image::from_fn(20, 10, |x, _| x as f32)), Some(14.5));
    }
}
