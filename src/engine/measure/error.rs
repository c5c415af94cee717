//! Error metrics between two images of the same size.
//!
//! All metrics use 8-bit sRGB-encoded values and ignore alpha. SSIM is the index of Wang, Bovik, Sheikh and Simoncelli
//! (2004) with their constants: Gaussian window of 11 × 11 px with σ = 1.5 px, K₁ = 0.01, K₂ = 0.03, L = 255, on luma.
//! It is averaged over the windows that lie entirely inside the image. Programs with other windows (8 × 8 boxes are
//! common) give other values.

use rayon::prelude::*;
use serde::{Deserialize, Deserializer, Serialize};

use crate::image::{Image, Rgba8};

/// Side of the SSIM window, in pixels.
const WINDOW: usize = 11;

/// Standard deviation of the SSIM window, in pixels.
const SIGMA: f64 = 1.5;

/// (K₁ L)²: keeps the luminance term defined for black regions.
const C1: f64 = (0.01 * 255.0) * (0.01 * 255.0);

/// (K₂ L)²: keeps the structure term defined for flat regions.
const C2: f64 = (0.03 * 255.0) * (0.03 * 255.0);

/// Error metrics between two images. Swapping the images does not change the values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ImageError {
    /// Mean squared error of 8-bit values, over all pixels and the red, green and blue channels.
    pub mse: f64,
    /// Peak signal-to-noise ratio, 10 log₁₀(255² / mse), in dB; infinite for identical images.
    #[serde(deserialize_with = "infinite_if_null")]
    pub psnr_db: f64,
    /// Structural similarity in [−1, 1]; 1 for identical images.
    ///
    /// Along an axis shorter than 11 px, the window shrinks to the largest odd size that fits, and its weights are
    /// renormalised to sum to 1.
    pub ssim: f64,
    /// Largest absolute difference of a channel, in 8-bit steps.
    pub max_abs: u8,
    /// Number of pixels that differ in red, green or blue.
    pub differing_pixels: u64,
}

/// Reads a number that JSON writes as null if it is infinite.
fn infinite_if_null<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::INFINITY))
}

/// Compares two images. Returns `None` if their sizes differ or they have no pixels.
///
/// # Examples
/// ```
/// use rasterscope_engine::image::Image;
/// use rasterscope_engine::measure::error::compare;
///
/// let black = Image::filled(64, 36, [0, 0, 0, 255]);
/// let mut other = black.clone();
/// other.set(3, 1, [0, 30, 0, 255]);
///
/// let error = compare(&black, &other).unwrap();
/// assert_eq!((error.max_abs, error.differing_pixels), (30, 1));
/// assert_eq!(error.mse, 30.0 * 30.0 / (3.0 * 64.0 * 36.0));
/// assert_eq!(compare(&black, &black).unwrap().psnr_db, f64::INFINITY);
/// ```
pub fn compare(a: &Image<Rgba8>, b: &Image<Rgba8>) -> Option<ImageError> {
    if a.size() != b.size() || a.pixels().is_empty() {
        return None;
    }
    let mut sum_of_squares = 0;
    let mut max_abs = 0;
    let mut differing_pixels = 0;
    for ([r0, g0, b0, _], [r1, g1, b1, _]) in a.pixels().iter().zip(b.pixels()) {
        let differences = [r0.abs_diff(*r1), g0.abs_diff(*g1), b0.abs_diff(*b1)];
        sum_of_squares += differences.map(|d| u64::from(d) * u64::from(d)).iter().sum::<u64>();
        let largest = differences[0].max(differences[1]).max(differences[2]);
        max_abs = max_abs.max(largest);
        differing_pixels += u64::from(largest > 0);
    }
    let mse = sum_of_squares as f64 / (3 * a.pixels().len()) as f64;
    let psnr_db = 10.0 * (255.0 * 255.0 / mse).log10();
    Some(ImageError {
        mse,
        psnr_db,
        ssim: ssim(&a.map(luma_of_codes), &b.map(luma_of_codes)),
        max_abs,
        differing_pixels,
    })
}

/// Computes ITU-R BT.601 luma from sRGB-encoded values in [0, 255], as in the SSIM paper.
pub(super) fn luma([red, green, blue]: [f64; 3]) -> f64 {
    0.299 * red + 0.587 * green + 0.114 * blue
}

/// Computes the [`luma`] of 8-bit sRGB codes.
pub(super) fn luma_of_codes([red, green, blue, _]: Rgba8) -> f64 {
    luma([red, green, blue].map(f64::from))
}

/// Computes the mean structural similarity of two greyscale images of equal size, at least 1 × 1 px.
pub(super) fn ssim(a: &Image<f64>, b: &Image<f64>) -> f64 {
    similarity_of(a, b).whole
}

/// Structural similarity with and without its luminance term.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Similarity {
    /// Product of the luminance and structure terms: SSIM.
    pub(super) whole: f64,
    /// Structure term: contrast and correlation.
    pub(super) structure: f64,
}

impl Similarity {
    fn plus(self, other: Self) -> Self {
        Self { whole: self.whole + other.whole, structure: self.structure + other.structure }
    }
}

/// Computes the mean similarity of all windows of two greyscale images of equal size, at least 1 × 1 px.
pub(super) fn similarity_of(a: &Image<f64>, b: &Image<f64>) -> Similarity {
    let across = window(a.width());
    let down = window(a.height());
    let windows_down = a.height() - down.len() as u32 + 1;
    // Row sums are stored and added in order, so the result does not depend on the number of threads.
    let rows: Vec<_> =
        (0..windows_down).into_par_iter().map(|y| similarity_of_row([a, b], y, &across, &down)).collect();
    let windows = f64::from(windows_down) * (a.width() as usize - across.len() + 1) as f64;
    let Similarity { whole, structure } = rows.into_iter().fold(Similarity::default(), Similarity::plus);
    Similarity { whole: whole / windows, structure: structure / windows }
}

/// Returns the Gaussian weights along an axis of `length` px: an odd number of weights that sum to 1.
fn window(length: u32) -> Vec<f64> {
    let length = length as usize;
    let reach = (length.min(WINDOW) - 1) / 2;
    let gaussian = |i: usize| (-(i.abs_diff(reach) as f64 / SIGMA).powi(2) / 2.0).exp();
    let sum: f64 = (0..=2 * reach).map(gaussian).sum();
    (0..=2 * reach).map(|i| gaussian(i) / sum).collect()
}

/// Returns the summed similarity of all windows whose top row is `top`. The window is separable: sums along columns are
/// computed first, then sums along the row.
fn similarity_of_row([a, b]: [&Image<f64>; 2], top: u32, across: &[f64], down: &[f64]) -> Similarity {
    let width = a.width() as usize;
    let mut columns = [const { Vec::new() }; 5];
    columns.iter_mut().for_each(|column| column.resize(width, 0.0));
    let [mean_a, mean_b, square_a, square_b, product] = &mut columns;
    for (y, weight) in (top..).zip(down) {
        for (x, (a, b)) in a.row(y).iter().zip(b.row(y)).enumerate() {
            mean_a[x] += weight * a;
            mean_b[x] += weight * b;
            square_a[x] += weight * (a * a);
            square_b[x] += weight * (b * b);
            product[x] += weight * (a * b);
        }
    }
    let moments = columns.map(|column| blur(&column, across));
    let windows = (0..moments[0].len()).map(|x| similarity(std::array::from_fn(|i| moments[i][x])));
    windows.fold(Similarity::default(), Similarity::plus)
}

/// Returns the weighted sum of `weights.len()` neighbours at each position where all of them exist.
fn blur(values: &[f64], weights: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0; values.len() - weights.len() + 1];
    for (offset, weight) in weights.iter().enumerate() {
        for (sum, value) in sums.iter_mut().zip(&values[offset..]) {
            *sum += weight * value;
        }
    }
    sums
}

/// Computes the similarity of two windows from the weighted means of a, b, a², b² and ab.
fn similarity([mean_a, mean_b, square_a, square_b, product]: [f64; 5]) -> Similarity {
    let (variance_a, variance_b) = (square_a - mean_a * mean_a, square_b - mean_b * mean_b);
    let covariance = product - mean_a * mean_b;
    let luminance = (2.0 * mean_a * mean_b + C1) / (mean_a * mean_a + mean_b * mean_b + C1);
    let structure = (2.0 * covariance + C2) / (variance_a + variance_b + C2);
    Similarity { whole: luminance * structure, structure }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(seed: u64, width: u32, height: u32) -> Image<Rgba8> {
        let mut random = fastrand::Rng::with_seed(seed);
        Image::from_fn(width, height, |_, _| std::array::from_fn(|_| random.u8(..)))
    }

    fn error(a: &Image<Rgba8>, b: &Image<Rgba8>) -> ImageError {
        compare(a, b).expect("same size")
    }

    #[test]
    fn an_image_equals_itself() {
        for (width, height) in [(1, 1), (4, 30), (31, 17)] {
            let image = noise(1, width, height);
            let same = ImageError { mse: 0.0, psnr_db: f64::INFINITY, ssim: 1.0, max_abs: 0, differing_pixels: 0 };
            assert_eq!(error(&image, &image), same, "{width}×{height}");
        }
    }

    #[test]
    fn other_sizes_and_empty_pictures_have_no_error() {
        assert_eq!(compare(&noise(1, 3, 4), &noise(1, 4, 3)), None);
        assert_eq!(compare(&noise(1, 0, 4), &noise(1, 0, 4)), None);
    }

    #[test]
    fn one_wrong_code_by_hand() {
        let black = Image::filled(5, 2, [0, 0, 0, 255]);
        let mut other = black.clone();
        other.set(3, 1, [0, 30, 0, 255]);
        let error = error(&black, &other);
        assert_eq!(error.mse, 900.0 / 30.0);
        assert!((error.psnr_db - 33.359_6).abs() < 1e-4, "10 log(65025 / 30) = {}", error.psnr_db);
        assert_eq!((error.max_abs, error.differing_pixels), (30, 1));
    }

    #[test]
    fn black_against_white_is_as_wrong_as_can_be() {
        let error = error(&Image::filled(20, 20, [0, 0, 0, 255]), &Image::filled(20, 20, [255; 4]));
        assert_eq!((error.mse, error.psnr_db, error.max_abs, error.differing_pixels), (65025.0, 0.0, 255, 400));
        // Both images are flat, so only the luminance term remains: C1 / (255² + C1).
        assert!((error.ssim - 6.5025 / (65025.0 + 6.5025)).abs() < 1e-12, "{}", error.ssim);
    }

    #[test]
    fn alpha_does_not_count() {
        let error = error(&Image::filled(12, 12, [5, 6, 7, 0]), &Image::filled(12, 12, [5, 6, 7, 255]));
        assert_eq!((error.mse, error.ssim, error.differing_pixels), (0.0, 1.0, 0));
    }

    #[test]
    fn the_window_is_the_published_one() {
        let weights = window(100);
        assert_eq!(weights.len(), 11);
        // Centre and end weights: exp(−i²/4.5) divided by the sum of the window, 3.7589748.
        assert!((weights[5] - 0.266_011_7).abs() < 1e-6 && (weights[0] - 0.001_028_4).abs() < 1e-6, "{weights:?}");
        assert_eq!([1, 2, 3, 10, 11].map(|length| window(length).len()), [1, 1, 3, 9, 11]);
    }

    #[test]
    fn similarity_agrees_with_its_definition() {
        for (width, height) in [(1, 1), (2, 3), (11, 11), (10, 12), (4, 25), (23, 19)] {
            let a = noise(7, width, height);
            // Correlated but not equal, so that covariances matter.
            let b = noise(8, width, height);
            let b = Image::from_fn(width, height, |x, y| {
                std::array::from_fn(|c| ((3 * u16::from(a.at(x, y)[c]) + u16::from(b.at(x, y)[c])) / 4) as u8)
            });
            let (fast, direct) = (error(&a, &b).ssim, direct_ssim(&a, &b));
            assert!((fast - direct).abs() < 1e-9, "{width}×{height}: {fast} is not {direct}");
            assert!(width * height < 9 || (0.2..0.99).contains(&direct), "a dull test: {direct}");
        }
    }

    /// Computes SSIM directly, window by window, with a two-dimensional Gaussian and central moments.
    fn direct_ssim(a: &Image<Rgba8>, b: &Image<Rgba8>) -> f64 {
        let odd = |length: u32| (length.min(11) - 1) / 2 * 2 + 1;
        let (width, height) = (odd(a.width()), odd(a.height()));
        let places = || (0..height).flat_map(|j| (0..width).map(move |i| (i, j)));
        let gaussian = |i: u32, j: u32| {
            let (dx, dy) = (f64::from(i) - f64::from(width / 2), f64::from(j) - f64::from(height / 2));
            (-(dx * dx + dy * dy) / (2.0 * 1.5 * 1.5)).exp()
        };
        let total: f64 = places().map(|(i, j)| gaussian(i, j)).sum();
        let mut similarities = Vec::new();
        for (x, y) in (0..=a.height() - height).flat_map(|y| (0..=a.width() - width).map(move |x| (x, y))) {
            let mean = |value: &dyn Fn(u32, u32) -> f64| -> f64 {
                places().map(|(i, j)| gaussian(i, j) / total * value(x + i, y + j)).sum()
            };
            let (mean_a, mean_b) = (mean(&|x, y| luma_of_codes(a.at(x, y))), mean(&|x, y| luma_of_codes(b.at(x, y))));
            let off_a = |x, y| luma_of_codes(a.at(x, y)) - mean_a;
            let off_b = |x, y| luma_of_codes(b.at(x, y)) - mean_b;
            let variance_a = mean(&|x, y| off_a(x, y).powi(2));
            let variance_b = mean(&|x, y| off_b(x, y).powi(2));
            let covariance = mean(&|x, y| off_a(x, y) * off_b(x, y));
            similarities.push(
                (2.0 * mean_a * mean_b + 6.5025) * (2.0 * covariance + 58.5225)
                    / ((mean_a.powi(2) + mean_b.powi(2) + 6.5025) * (variance_a + variance_b + 58.5225)),
            );
        }
        similarities.iter().sum::<f64>() / similarities.len() as f64
    }
}
