//! Convolution of a picture with a mask: blur, sharpen, the trace of a movement, or weights of one's own.
//!
//! A mask is a small odd square of weights around each pixel. Weights need not sum to one: a sum of zero finds edges.
//! Pictures end with their outermost pixels repeated. Here are masks and the plain sum over numbers, whose terms can be
//! read; [`crate::antialias::mask`] applies the same masks to pictures of codes.

use thiserror::Error;

use crate::image::Image;

/// Weights around a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    side: usize,
    weights: Vec<f32>,
    /// Factors of a separable mask: every weight is the product of those of its column and of its row.
    factors: Option<Vec<f32>>,
}

/// How far masks go from their middle at most, px.
pub const MOST_REACH: usize = 15;

/// The longest side of a mask, px.
const MOST_SIDE: usize = 2 * MOST_REACH + 1;

/// Standard deviations from the middle to where a bell is cut off.
pub const BELL_DEVIATIONS: f32 = 3.0;

/// Why weights are no mask.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum MaskError {
    /// There must be a middle.
    #[error("{0} weights are no square of an odd side up to {MOST_SIDE}, such as 9 or 25")]
    Shape(usize),
    /// A weight is no number.
    #[error("weight {0} is not finite")]
    NotFinite(usize),
}

impl Mask {
    /// A square of weights, row by row from the top.
    pub fn square(weights: &[f32]) -> Result<Self, MaskError> {
        let side = weights.len().isqrt();
        if side * side != weights.len() || side.is_multiple_of(2) || side > MOST_SIDE {
            return Err(MaskError::Shape(weights.len()));
        }
        match weights.iter().position(|weight| !weight.is_finite()) {
            Some(index) => Err(MaskError::NotFinite(index)),
            None => Ok(Self { side, weights: weights.to_vec(), factors: None }),
        }
    }

    /// A separable mask from the factors of its rows, which are also those of its columns.
    fn separable(factors: Vec<f32>) -> Self {
        let weights = factors.iter().flat_map(|down| factors.iter().map(move |right| down * right)).collect();
        Self { side: factors.len(), weights, factors: Some(factors) }
    }

    /// The mean of (2 · `reach` + 1)² pixels; `reach` up to [`MOST_REACH`].
    pub fn blur(reach: usize) -> Self {
        let side = 2 * reach.min(MOST_REACH) + 1;
        Self::separable(vec![1.0 / side as f32; side])
    }

    /// The mean of 3 × 3 pixels with the middle counting most: binomial in both directions.
    pub fn binomial() -> Self {
        Self::separable(vec![0.25, 0.5, 0.25])
    }

    /// A bell of standard deviation `sigma` px, cut off at [`BELL_DEVIATIONS`] of them, or at [`MOST_REACH`] px.
    pub fn gaussian(sigma: f32) -> Self {
        let reach = (BELL_DEVIATIONS * sigma).ceil().clamp(1.0, MOST_REACH as f32) as i32;
        let bell = |at: i32| (-((at * at) as f32) / (2.0 * sigma * sigma).max(f32::MIN_POSITIVE)).exp();
        let sum: f32 = (-reach..=reach).map(bell).sum();
        Self::separable((-reach..=reach).map(|at| bell(at) / sum).collect())
    }

    /// The pixel and `amount` times what sets it off from its four neighbours.
    pub fn sharpen(amount: f32) -> Self {
        let beside = -amount / 4.0;
        Self { side: 3, weights: vec![0.0, beside, 0.0, beside, 1.0 + amount, beside, 0.0, beside, 0.0], factors: None }
    }

    /// The mean along a straight way of `length` px through the pixel, up to twice [`MOST_REACH`], `angle` radians from the right towards below: each
    /// pixel counts for as much of the way as lies in it.
    pub fn motion(length: f32, angle: f32) -> Self {
        /// Steps per px of the way.
        const STEPS_PER_PX: f32 = 64.0;
        let length = length.clamp(0.0, 2.0 * MOST_REACH as f32);
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

    /// The sum of all weights: what a plain picture is multiplied by.
    pub fn sum(&self) -> f32 {
        self.weights.iter().sum()
    }

    /// Factors of a separable mask, for columns from the left and for rows from the top: weights are products of two of them.
    pub fn factors(&self) -> Option<&[f32]> {
        self.factors.as_deref()
    }

    /// How many pixels it reads to each side of its middle.
    pub fn reach(&self) -> u32 {
        (self.side / 2) as u32
    }

    /// Its weights, each with the place that it reads: columns to the right and rows below the pixel.
    pub fn weights(&self) -> impl Iterator<Item = ((i64, i64), f32)> {
        let reach = i64::from(self.reach());
        let place = move |index: usize| ((index % self.side) as i64 - reach, (index / self.side) as i64 - reach);
        self.weights.iter().enumerate().map(move |(index, weight)| (place(index), *weight))
    }

    /// What one pixel is the sum of: (weight, value) by rows.
    pub fn terms_at(&self, image: &Image<f64>, (x, y): (u32, u32)) -> impl Iterator<Item = (f64, f64)> {
        let value = move |right, down| image.at_clamped(i64::from(x) + right, i64::from(y) + down);
        self.weights().map(move |((right, down), weight)| (weight.into(), value(right, down)))
    }

    /// Every pixel of a picture of numbers; values may leave the range of those of `image` where weights are negative.
    pub fn apply_to_numbers(&self, image: &Image<f64>) -> Image<f64> {
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
    fn an_impulse_gives_the_mask_turned_over_and_a_plain_picture_stays() {
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
    fn what_is_no_mask_is_refused() {
        assert_eq!(Mask::square(&[1.0; 8]), Err(MaskError::Shape(8)));
        assert_eq!(Mask::square(&[1.0; 16]), Err(MaskError::Shape(16)));
        assert_eq!(Mask::square(&[1.0, f32::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), Err(MaskError::NotFinite(1)));
    }
}
