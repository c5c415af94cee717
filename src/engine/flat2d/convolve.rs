//! Convolution of an image with a mask: blur, sharpening, motion blur, or custom weights.
//!
//! A mask is a small square of weights around each pixel, with an odd side length. The weights need not sum to 1;
//! weights that sum to 0 detect edges. Outside the image, the border pixels are repeated. This module defines the
//! masks, and a simple convolution of images of `f64` values that exposes the terms of each sum;
//! [`crate::antialias::mask`] applies the same masks to 8-bit images.

use thiserror::Error;

use crate::image::Image;

/// Convolution mask: a square of weights around a pixel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mask {
    side: usize,
    weights: Vec<f32>,
    /// Factors of a separable mask: each weight is the product of its column's factor and its row's factor.
    factors: Option<Vec<f32>>,
}

/// Maximum number of pixels by which a mask extends to each side of its centre.
pub(crate) const MAX_REACH: usize = 15;

/// Maximum side length of a mask, in pixels.
const MOST_SIDE: usize = 2 * MAX_REACH + 1;

/// Radius at which a Gaussian mask is cut off, in standard deviations.
pub(crate) const GAUSSIAN_CUTOFF: f32 = 3.0;

/// Reason why weights do not form a mask.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub(crate) enum MaskError {
    /// The weights do not form a square whose side length is odd and at most `MOST_SIDE`. Contains the number of
    /// weights.
    #[error("{0} weights are not a square with an odd side up to {MOST_SIDE}, such as 9 or 25")]
    Shape(usize),
    /// The weight with this index is infinite or NaN.
    #[error("weight {0} is not finite")]
    NotFinite(usize),
}

impl Mask {
    /// Creates a mask from a square of weights, row by row from the top.
    pub(crate) fn square(weights: &[f32]) -> Result<Self, MaskError> {
        let side = weights.len().isqrt();
        if side * side != weights.len() || side.is_multiple_of(2) || side > MOST_SIDE {
            return Err(MaskError::Shape(weights.len()));
        }
        match weights.iter().position(|weight| !weight.is_finite()) {
            Some(index) => Err(MaskError::NotFinite(index)),
            None => Ok(Self { side, weights: weights.to_vec(), factors: None }),
        }
    }

    /// Creates a separable mask whose row and column factors are the same.
    fn separable(factors: Vec<f32>) -> Self {
        let weights = factors.iter().flat_map(|down| factors.iter().map(move |right| down * right)).collect();
        Self { side: factors.len(), weights, factors: Some(factors) }
    }

    /// Returns a box blur over (2 · `reach` + 1)² pixels, with `reach` limited to [`MAX_REACH`].
    pub(crate) fn blur(reach: usize) -> Self {
        let side = 2 * reach.min(MAX_REACH) + 1;
        Self::separable(vec![1.0 / side as f32; side])
    }

    /// Returns the 3 × 3 binomial blur, which weights the centre most.
    pub(crate) fn binomial() -> Self {
        Self::separable(vec![0.25, 0.5, 0.25])
    }

    /// Returns a Gaussian blur with a standard deviation of `sigma` px, cut off at [`GAUSSIAN_CUTOFF`] standard
    /// deviations or [`MAX_REACH`] px.
    pub(crate) fn gaussian(sigma: f32) -> Self {
        let reach = (GAUSSIAN_CUTOFF * sigma).ceil().clamp(1.0, MAX_REACH as f32) as i32;
        let bell = |at: i32| (-((at * at) as f32) / (2.0 * sigma * sigma).max(f32::MIN_POSITIVE)).exp();
        let sum: f32 = (-reach..=reach).map(bell).sum();
        Self::separable((-reach..=reach).map(|at| bell(at) / sum).collect())
    }

    /// Returns a sharpening mask, which adds `amount` times the difference between a pixel and the mean of its four
    /// neighbours.
    pub(crate) fn sharpen(amount: f32) -> Self {
        let beside = -amount / 4.0;
        Self { side: 3, weights: vec![0.0, beside, 0.0, beside, 1.0 + amount, beside, 0.0, beside, 0.0], factors: None }
    }

    /// Returns a motion blur along a straight path through the pixel.
    ///
    /// The path is `length` px long, limited to twice [`MAX_REACH`]. `angle` is its direction in radians, measured
    /// clockwise on the screen from the positive x axis. Each pixel is weighted by the length of the path inside it.
    pub(crate) fn motion(length: f32, angle: f32) -> Self {
        /// Number of samples per pixel of path length.
        const STEPS_PER_PX: f32 = 64.0;
        let length = length.clamp(0.0, 2.0 * MAX_REACH as f32);
        let reach = (length / 2.0).ceil().max(1.0) as usize;
        let side = 2 * reach + 1;
        let mut weights = vec![0.0; side * side];
        let steps = (length * STEPS_PER_PX).ceil().max(1.0);
        for step in 0..steps as u32 {
            let along = ((step as f32 + 0.5) / steps - 0.5) * length;
            let [x, y] = [angle.cos(), angle.sin()].map(|axis| (along * axis).round() as i32 + reach as i32);
            weights[y as usize * side + x as usize] += 1.0 / steps;
        }
        Self { side, weights, factors: None }
    }

    /// Returns the sum of all weights, which is the gain for a uniform image.
    #[cfg(test)]
    pub(crate) fn sum(&self) -> f32 {
        self.weights.iter().sum()
    }

    /// Returns the factors of a separable mask, or `None` for other masks. Factor i belongs to both column i from the
    /// left and row i from the top. Each weight is the product of its column's and its row's factor.
    pub(crate) fn factors(&self) -> Option<&[f32]> {
        self.factors.as_deref()
    }

    /// Returns the number of pixels by which the mask extends to each side of its centre.
    pub(crate) fn reach(&self) -> u32 {
        (self.side / 2) as u32
    }

    /// Returns the weights row by row, each with its offset (columns to the right, rows down) from the centre.
    pub(crate) fn weights(&self) -> impl Iterator<Item = ((i64, i64), f32)> {
        let reach = i64::from(self.reach());
        let place = move |index: usize| ((index % self.side) as i64 - reach, (index / self.side) as i64 - reach);
        self.weights.iter().enumerate().map(move |(index, weight)| (place(index), *weight))
    }

    /// Returns the terms of the convolution sum for one pixel, row by row, each as (weight, value).
    pub(crate) fn terms_at(&self, image: &Image<f64>, (x, y): (u32, u32)) -> impl Iterator<Item = (f64, f64)> {
        let value = move |right, down| image.at_clamped(i64::from(x) + right, i64::from(y) + down);
        self.weights().map(move |((right, down), weight)| (weight.into(), value(right, down)))
    }

    /// Convolves an image of `f64` values. Negative weights can produce values outside the range of the input.
    pub(crate) fn apply_to_numbers(&self, image: &Image<f64>) -> Image<f64> {
        Image::from_fn(image.width(), image.height(), |x, y| {
            self.terms_at(image, (x, y)).map(|(weight, value)| weight * value).sum()
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_4;

    use super::*;

    #[test]
    fn an_impulse_gives_the_mirrored_mask_and_a_uniform_image_is_unchanged() {
        let impulse = Image::from_fn(9, 9, |x, y| f64::from(u8::from((x, y) == (4, 4))));
        for mask in [Mask::binomial(), Mask::sharpen(4.0), Mask::motion(3.0, FRAC_PI_4), Mask::gaussian(1.0)] {
            let found = mask.apply_to_numbers(&impulse);
            for ((right, down), weight) in mask.weights() {
                assert_eq!(found.at((4 - right) as u32, (4 - down) as u32), f64::from(weight));
            }
            let plain = mask.apply_to_numbers(&Image::filled(4, 3, 0.5));
            assert!(plain.pixels().iter().all(|value| (value - 0.5).abs() < 1e-6), "weights sum to 1");
        }
    }

    #[test]
    fn the_binomial_mask_is_the_product_of_two_rows_of_pascal() {
        let row = [0.25_f32, 0.5, 0.25];
        for ((right, down), weight) in Mask::binomial().weights() {
            assert_eq!(weight, row[(right + 1) as usize] * row[(down + 1) as usize]);
        }
    }

    #[test]
    fn invalid_masks_are_rejected() {
        assert_eq!(Mask::square(&[1.0; 8]), Err(MaskError::Shape(8)));
        assert_eq!(Mask::square(&[1.0; 16]), Err(MaskError::Shape(16)));
        assert_eq!(Mask::square(&[1.0, f32::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), Err(MaskError::NotFinite(1)));
    }
}
