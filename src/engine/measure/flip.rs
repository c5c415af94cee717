//! FLIP: perceived difference of two 8-bit sRGB-encoded images when a viewer alternates between them.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference Evaluator for Alternating
//! Images" (2020). The metric combines two pipelines:
//!
//! * Colour: opponent colours, blurred by the contrast sensitivity of the eye at the viewing distance, then converted
//!   to L\*a\*b\*. Chroma is scaled by lightness (Hunt effect). The colour distance is raised to the power of 0.7 and
//!   mapped to [0, 1].
//! * Features: the difference in edge and point strength, detected with Gaussian derivatives.
//!
//! The error of a pixel is colour^(1 − feature): 0 for identical pixels, 1 for black against white. Images are extended
//! by repeating their border pixels. Planes are f32, as in the authors' program. The viewing conditions are the usual
//! ones of the metric: a screen 0.7 m and 3840 px wide, seen from a distance of 0.7 m.
//!
//! Most of the work depends on one image only and is cached in [`Perceived`], so a reference is processed only once for
//! any number of comparisons. Filters are separable: a pass along rows, then a pass along columns that also finishes
//! the pixel.

mod color;

mod filters;

use rayon::prelude::*;

use self::color::{LabFromOpponent, Opponents, distance};
use self::filters::{FILTERED, Filters};
use crate::image::{Image, Rgba8};

/// Pixels per degree of visual angle: distance · (pixels / screen width) · π / 180, for the usual viewing conditions.
pub(crate) const PIXELS_PER_DEGREE: f64 = 0.7 * (3840.0 / 0.7) * std::f64::consts::PI / 180.0;

/// Exponent applied to colour distances.
const COLOR_EXPONENT: f32 = 0.7;

/// Knee of the piecewise linear mapping from colour distances, raised to [`COLOR_EXPONENT`], to errors. It is a
/// fraction of the largest such distance. Distances below the knee take up most of the range of errors.
const KNEE: f32 = 0.4;

/// Error at the knee. Distances below the knee are mapped linearly to smaller errors, distances above it to larger
/// ones.
const KNEE_ERROR: f32 = 0.95;

/// Exponent applied to feature differences.
const FEATURE_EXPONENT: f32 = 0.5;

/// Preprocessed image, as perceived at the usual viewing distance.
#[derive(Clone, Debug)]
pub(crate) struct Perceived {
    /// L\*a\*b\* of the blurred image, with a\* and b\* scaled by lightness.
    lab: Image<[f32; 3]>,
    /// Edge and point strength of each pixel.
    features: Image<[f32; 2]>,
}

impl Perceived {
    /// Preprocesses an image: filters it as a viewer perceives it, and detects edges and points. Alpha is ignored.
    pub(crate) fn new(picture: &Image<Rgba8>) -> Self {
        let (width, height) = picture.size();
        let opponents = Opponents::new();
        let filters = Filters::new();
        // The results for an image row are contiguous: one filtered row per filter.
        let row_length = FILTERED * width as usize;
        let mut rows = vec![0.0; row_length * height as usize];
        if !rows.is_empty() {
            rows.par_chunks_mut(row_length).zip(picture.pixels().par_chunks(width as usize)).for_each(
                |(filtered, pixels)| {
                    filters.along_row(&opponents.planes(pixels), filtered);
                },
            );
        }
        let mut lab = Image::filled(width, height, [0.0; 3]);
        let mut features = Image::filled(width, height, [0.0; 2]);
        let finished = lab.pixels_mut().par_chunks_mut((width as usize).max(1));
        finished.zip(features.pixels_mut().par_chunks_mut((width as usize).max(1))).enumerate().for_each(
            |(y, (lab, features))| {
                filters.along_columns(&rows, y, lab, features);
            },
        );
        Self { lab, features }
    }

    /// Returns the FLIP error of every pixel in [0, 1], or `None` if the sizes differ or there are no pixels. Swapping
    /// the two images gives the same result.
    pub(crate) fn difference(&self, other: &Self) -> Option<Image<f32>> {
        if self.lab.size() != other.lab.size() || self.lab.pixels().is_empty() {
            return None;
        }
        let scale = ErrorScale::new();
        let colors = self.lab.pixels().par_iter().zip(other.lab.pixels());
        let features = self.features.pixels().par_iter().zip(other.features.pixels());
        let error = |((a, b), (features_a, features_b)): ((&_, &_), (&[f32; 2], &[f32; 2]))| {
            let far = distance(*a, *b);
            if far == 0.0 {
                return 0.0;
            }
            let [edges, points] = [0, 1].map(|i| (features_a[i] - features_b[i]).abs());
            let feature = (edges.max(points) / std::f32::consts::SQRT_2).powf(FEATURE_EXPONENT);
            scale.error(far).powf(1.0 - feature)
        };
        let pixels = colors.zip(features).map(error).collect();
        Some(Image::from_pixels(self.lab.width(), self.lab.height(), pixels))
    }
}

/// Returns the FLIP error of every pixel in [0, 1], or `None` if the sizes differ or there are no pixels. Swapping the
/// two images gives the same result. Alpha is ignored.
///
/// # Examples
/// ```
/// use rasterscope_engine::image::Image;
/// use rasterscope_engine::measure::flip::map;
///
/// let grey = Image::filled(64, 36, [120, 120, 120, 255]);
/// let mut other = grey.clone();
/// other.set(32, 18, [255, 0, 0, 255]);
///
/// let errors = map(&grey, &other).unwrap();
/// assert!(errors.at(32, 18) > 0.0);
/// assert_eq!(errors.at(0, 0), 0.0, "far from the only pixel that differs");
/// assert_eq!(map(&other, &grey), Some(errors));
/// ```
pub fn map(a: &Image<Rgba8>, b: &Image<Rgba8>) -> Option<Image<f32>> {
    if a.size() != b.size() {
        return None;
    }
    Perceived::new(a).difference(&Perceived::new(b))
}

/// Returns the mean of per-pixel errors: the result of [`map`] for a whole image, or a part of it.
pub(super) fn mean(errors: &Image<f32>) -> f64 {
    errors.pixels().iter().map(|error| f64::from(*error)).sum::<f64>() / errors.pixels().len() as f64
}

/// Mapping from colour distances to errors in [0, 1].
struct ErrorScale {
    /// Largest colour distance, raised to [`COLOR_EXPONENT`].
    greatest: f32,
    knee: f32,
}

impl ErrorScale {
    fn new() -> Self {
        let lab = LabFromOpponent::new();
        let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| lab.lab_of_rgb(rgb));
        let greatest = distance(green, blue).powf(COLOR_EXPONENT);
        Self { greatest, knee: KNEE * greatest }
    }

    fn error(&self, distance: f32) -> f32 {
        let far = distance.powf(COLOR_EXPONENT);
        if far < self.knee {
            far * KNEE_ERROR / self.knee
        } else {
            KNEE_ERROR + (far - self.knee) / (self.greatest - self.knee) * (1.0 - KNEE_ERROR)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (96, 64);

    fn picture(color: impl Fn(u32, u32) -> [u32; 3]) -> Image<Rgba8> {
        Image::from_fn(SIZE.0, SIZE.1, |x, y| {
            let [r, g, b] = color(x, y).map(|code| code as u8);
            [r, g, b, 255]
        })
    }

    fn slopes(x: u32, y: u32) -> [u32; 3] {
        [2 * x + y, 4 * y, 255_u32.wrapping_sub(2 * x)]
    }

    fn squares(x: u32, y: u32) -> [u32; 3] {
        [255 * ((x / 8 + y / 8) % 2); 3]
    }

    fn noise(x: u32, y: u32, seed: u32) -> [u32; 3] {
        [1_u32, 2, 3].map(|channel| {
            let mixed =
                x.wrapping_mul(73_856_093) ^ y.wrapping_mul(19_349_663) ^ channel.wrapping_mul(83_492_791) ^ seed;
            ((mixed ^ (mixed >> 13)).wrapping_mul(1_274_126_177) >> 16) & 255
        })
    }

    fn disc(x: u32, y: u32) -> [u32; 3] {
        if x.abs_diff(40).pow(2) + y.abs_diff(30).pow(2) < 24 * 24 { [230, 60, 30] } else { [20, 40, 90] }
    }

    fn bars(x: u32) -> [u32; 3] {
        [x / 16 % 2, x / 32 % 2, x / 64 % 2].map(|on| 255 * on)
    }

    /// Returns a less saturated colour: 3/4 of `color` plus 1/4 of its grey.
    fn dull(color: [u32; 3]) -> [u32; 3] {
        let grey = color.iter().sum::<u32>() / 3;
        color.map(|code| (3 * code + grey) / 4)
    }

    /// Compares the mean and maximum FLIP errors with those of the authors' implementation: `evaluate(a, b, "LDR",
    /// applyMagma=False)` from the PyPI package `flip-evaluator` 1.7, called on PNG files of the same images, with
    /// default settings otherwise.
    #[test]
    fn errors_are_those_of_the_authors_program() {
        let mixed = |x, y| {
            let (one, other) = (noise(x, y, 0), noise(x, y, 7));
            std::array::from_fn(|channel| (3 * one[channel] + other[channel]) / 4)
        };
        let pairs = [
            ("slopes", picture(slopes), picture(|x, y| slopes(x + 1, y)), 0.054_462, 0.072_186),
            ("squares", picture(squares), picture(|x, y| squares(x + 2, y + 1)), 0.608_863, 0.989_505),
            ("noise", picture(|x, y| noise(x, y, 0)), picture(mixed), 0.231_926, 0.533_043),
            ("disc", picture(disc), picture(|x, y| disc(x / 4 * 4, y / 4 * 4)), 0.091_233, 0.959_630),
            ("bars", picture(|x, _| bars(x)), picture(|x, _| dull(bars(x))), 0.477_385, 0.818_903),
        ];
        // Sums of channel values verify that these are the images the expected figures were computed from.
        let sum = |p: &Image<Rgba8>| p.pixels().iter().flat_map(|p| &p[..3]).map(|code| u32::from(*code)).sum::<u32>();
        let sums = pairs.each_ref().map(|(_, a, b, ..)| (sum(a), sum(b)));
        assert_eq!(
            sums,
            [
                (2_534_400, 2_534_400),
                (2_350_080, 2_350_080),
                (2_368_323, 2_356_431),
                (1_225_730, 1_215_360),
                (1_827_840, 1_820_672)
            ]
        );
        for (name, a, b, expected_mean, expected_max) in pairs {
            let errors = map(&a, &b).unwrap();
            let greatest = f64::from(errors.pixels().iter().copied().fold(0.0, f32::max));
            let mean = mean(&errors);
            assert!((mean - expected_mean).abs() < 1e-4, "{name}: mean {mean}, not {expected_mean}");
            assert!((greatest - expected_max).abs() < 1e-3, "{name}: at most {greatest}, not {expected_max}");
        }
    }

    #[test]
    fn equal_pictures_have_no_error_and_order_does_not_matter() {
        let (a, b) = (picture(disc), picture(|x, y| noise(x, y, 3)));
        assert_eq!(map(&a, &a).map(|errors| mean(&errors)), Some(0.0));
        assert_eq!(map(&a, &b), map(&b, &a));
        assert_eq!(map(&a, &Image::filled(3, 3, [0; 4])), None);
        for size in [(1, 1), (2, 30)] {
            let [black, white] = [[0, 0, 0, 255], [255; 4]].map(|color| Image::filled(size.0, size.1, color));
            let error = mean(&map(&black, &white).unwrap());
            assert!((0.9..=1.0).contains(&error), "{size:?}: {error}");
        }
    }
}
