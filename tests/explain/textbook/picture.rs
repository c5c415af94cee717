//! Finished pictures: 8-bit sRGB, rows from top to bottom.

use std::path::Path;

use image::{ImageResult, RgbImage};

/// Size of a picture in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) width: usize,
    pub(crate) height: usize,
}

/// Finished picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Picture {
    pub(crate) size: Size,
    /// sRGB codes of all pixels, row by row from the top left.
    pub(crate) pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// Returns the number of pixels that differ from `other` by more than `tolerance` codes in any channel.
    ///
    /// # Panics
    ///
    /// Panics if the sizes differ.
    pub(crate) fn differing(&self, other: &Self, tolerance: u8) -> usize {
        assert_eq!(self.size, other.size);
        let differs = |(a, b): &(&[u8; 3], &[u8; 3])| a.iter().zip(*b).any(|(a, &b)| a.abs_diff(b) > tolerance);
        self.pixels.iter().zip(&other.pixels).filter(differs).count()
    }

    /// Writes the picture as a PNG file.
    pub(crate) fn save(&self, path: &Path) -> ImageResult<()> {
        let Size { width, height } = self.size;
        let picture = RgbImage::from_fn(width as u32, height as u32, |x, y| {
            image::Rgb(self.pixels[y as usize * width + x as usize])
        });
        picture.save(path)
    }
}
