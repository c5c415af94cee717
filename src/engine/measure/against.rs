//! Comparison of an image with a reference by all error metrics at once, over the whole image or a rectangle.

use serde::{Deserialize, Serialize};

use super::error::{ImageError, compare};
use super::flip;
use super::metric::Metric;
use super::picture_error::error_of_codes;
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
    /// Value of a further metric that was selected for the measurement.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub selected: Option<f64>,
}

impl ErrorMetrics {
    /// Whether a metric is measured without being selected.
    pub fn always_has(metric: Metric) -> bool {
        !matches!(metric, Metric::MsSsim | Metric::Ssimulacra2 | Metric::Jod | Metric::RelativeMse)
    }

    /// Returns the value of a metric; for a further metric that of the selected one, or NaN if none was selected.
    pub fn value(&self, metric: Metric) -> f64 {
        match metric {
            Metric::Psnr => self.codes.psnr_db,
            Metric::Ssim => self.codes.ssim,
            Metric::Flip => self.flip,
            Metric::Mse => self.codes.mse,
            Metric::Max => self.codes.max_abs.into(),
            Metric::Changed => self.codes.differing_pixels as f64,
            Metric::MsSsim | Metric::Ssimulacra2 | Metric::Jod | Metric::RelativeMse => {
                self.selected.unwrap_or(f64::NAN)
            }
        }
    }
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
        Some((ErrorMetrics { codes, flip: flip::mean(&map), selected: None }, map))
    }

    /// Measures a metric of an image against this reference. Returns `None` if it is not defined for images of this size.
    pub(crate) fn measure(&self, picture: &Image<Rgba8>, metric: Metric) -> Option<f64> {
        error_of_codes(metric, picture, &self.picture)
    }
}

/// Compares an image with a reference and also returns the FLIP error of every pixel. Returns `None` if the sizes
/// differ or there are no pixels.
pub fn figures(picture: &Image<Rgba8>, reference: &Image<Rgba8>) -> Option<(ErrorMetrics, Image<f32>)> {
    let codes = compare(picture, reference)?;
    let map = flip::map(picture, reference)?;
    Some((ErrorMetrics { codes, flip: flip::mean(&map), selected: None }, map))
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
    let (codes, flip) = (region.compare(picture, reference)?, region.mean(flip)?);
    Some(ErrorMetrics { codes, flip, selected: None })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::settings::Choice as _;

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
        // Each metric has the value that the comparison of picture files prints.
        for metric in Metric::ALL.iter().copied() {
            let value = standard.measure(&a, metric).unwrap();
            let selected = ErrorMetrics { selected: Some(value), ..whole }.value(metric);
            assert!((selected - value).abs() <= 1e-12 * value.abs(), "{}: {selected} and {value}", metric.id());
        }
    }
}
