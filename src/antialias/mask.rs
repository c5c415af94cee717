//! Convolution masks over a finished picture: blur, sharpen, motion, or any of one's own.
//!
//! A mask is a small odd rectangle of weights around each pixel. Weights need not sum to one: a sum of zero finds edges.
//! Pictures end with their outermost pixels repeated; sums are rounded half up and clamped once, at the end. Alpha is kept.

use rayon::prelude::*;
use thiserror::Error;

use crate::image::color::Tables;
use crate::image::{Image, Rgba8};

/// Weights around a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    width: usize,
    weights: Vec<f32>,
}

/// The longest side of a mask, px.
pub const MOST_SIDE: usize = 31;

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
            None => Ok(Self { width: side, weights: weights.to_vec() }),
        }
    }

    /// The mean of (2 · `reach` + 1)² pixels; `reach` as far as masks go.
    pub fn blur(reach: usize) -> Self {
        let side = (2 * reach + 1).min(MOST_SIDE);
        Self { width: side, weights: vec![1.0 / (side * side) as f32; side * side] }
    }

    /// A bell of standard deviation `sigma` px, cut off at three of them.
    pub fn gaussian(sigma: f32) -> Self {
        let reach = (3.0 * sigma).ceil().clamp(1.0, (MOST_SIDE / 2) as f32) as i32;
        let bell = |at: i32| (-((at * at) as f32) / (2.0 * sigma * sigma).max(f32::MIN_POSITIVE)).exp();
        let places = || (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| (x, y)));
        let sum: f32 = places().map(|(x, y)| bell(x) * bell(y)).sum();
        let weights = places().map(|(x, y)| bell(x) * bell(y) / sum).collect();
        Self { width: (2 * reach + 1) as usize, weights }
    }

    /// The pixel and `amount` times what sets it off from its four neighbours.
    pub fn sharpen(amount: f32) -> Self {
        let beside = -amount / 4.0;
        Self { width: 3, weights: vec![0.0, beside, 0.0, beside, 1.0 + amount, beside, 0.0, beside, 0.0] }
    }

    /// The mean along a straight way of `length` px through the pixel, `angle` radians from the right towards below: each
    /// pixel counts for as much of the way as lies in it.
    pub fn motion(length: f32, angle: f32) -> Self {
        /// Steps per px of the way.
        const STEPS_PER_PX: f32 = 64.0;
        let length = length.clamp(0.0, (MOST_SIDE - 1) as f32);
        let reach = (length / 2.0).ceil().max(1.0) as usize;
        let width = 2 * reach + 1;
        let mut weights = vec![0.0; width * width];
        let steps = (length * STEPS_PER_PX).ceil().max(1.0);
        for step in 0..steps as u32 {
            let along = ((step as f32 + 0.5) / steps - 0.5) * length;
            let [x, y] = [angle.cos(), angle.sin()].map(|axis| (along * axis).round() as i32 + reach as i32);
            weights[y as usize * width + x as usize] += 1.0 / steps;
        }
        Self { width, weights }
    }

    /// The sum of all weights: what a plain picture is multiplied by.
    pub fn sum(&self) -> f32 {
        self.weights.iter().sum()
    }

    /// How many pixels it reads to each side of its middle.
    pub fn reach(&self) -> u32 {
        (self.width / 2) as u32
    }

    /// Applies the mask to every pixel, in codes or in linear light.
    pub fn apply(&self, picture: &Image<Rgba8>, linear: bool) -> Image<Rgba8> {
        let (width, height) = picture.size();
        let tables = Tables::get();
        let values = if linear { &tables.linear_of_code } else { &tables.code };
        let reach = (self.width / 2) as i64;
        let mut result = picture.clone();
        result.pixels_mut().par_chunks_mut((width as usize).max(1)).zip(0..height).for_each(|(row, y)| {
            let mut sums = vec![[0.0_f32; 3]; width as usize];
            for (place, weight) in self.weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
                let (dx, dy) = ((place % self.width) as i64 - reach, (place / self.width) as i64 - reach);
                for (x, sum) in (0..).zip(&mut sums) {
                    let color = picture.at_clamped(x + dx, i64::from(y) + dy);
                    for (sum, code) in sum.iter_mut().zip(color) {
                        *sum += weight * values[code as usize];
                    }
                }
            }
            for (pixel, sum) in row.iter_mut().zip(sums) {
                for (code, value) in pixel.iter_mut().zip(sum) {
                    *code = if linear { tables.encode(value) } else { (value + 0.5).clamp(0.0, 255.0) as u8 };
                }
            }
        });
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot() -> Image<Rgba8> {
        let mut picture = Image::filled(7, 5, [0, 0, 0, 9]);
        picture.set(3, 2, [240, 120, 0, 9]);
        picture
    }

    #[test]
    fn a_dot_shows_the_mask_turned_over() {
        let weights = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
        let shown = Mask::square(&weights).unwrap().apply(&dot(), false);
        for (index, weight) in weights.into_iter().enumerate() {
            let (x, y) = (4 - index as u32 % 3, 3 - index as u32 / 3);
            let exact = |code: f32| (weight * code + 0.5) as u8;
            assert_eq!(shown.at(x, y), [exact(240.0), exact(120.0), 0, 9], "weight {index}");
        }
        assert_eq!(shown.at(1, 2), [0, 0, 0, 9]);
    }

    #[test]
    fn plain_pictures_stay_plain_to_the_border() {
        let masks =
            [Mask::blur(2), Mask::gaussian(1.3), Mask::sharpen(1.5), Mask::motion(9.0, 0.7), Mask::motion(0.0, 2.0)];
        for mask in masks {
            assert!((mask.sum() - 1.0).abs() < 1e-5, "{mask:?}");
            for linear in [false, true] {
                let plain = Image::filled(5, 4, [0, 128, 255, 77]);
                assert_eq!(mask.apply(&plain, linear), plain, "{mask:?}");
            }
        }
    }

    #[test]
    fn half_black_half_white_is_brighter_in_linear_light() {
        let stripes = Image::from_fn(9, 3, |x, _| [if x % 2 == 0 { 0 } else { 255 }; 4]);
        let halves = Mask::square(&[0.0, 0.0, 0.0, 0.25, 0.5, 0.25, 0.0, 0.0, 0.0]).unwrap();
        assert_eq!(halves.apply(&stripes, false).at(4, 1)[0], 128);
        assert_eq!(halves.apply(&stripes, true).at(4, 1)[0], 188);
    }

    #[test]
    fn motion_leaves_a_straight_trace() {
        let shown = Mask::motion(4.0, 0.0).apply(&dot(), false);
        assert_eq!(shown.row(1), [[0, 0, 0, 9]; 7]);
        let codes: Vec<_> = shown.row(2).iter().map(|pixel| pixel[0]).collect();
        // Of four pixels of way half a pixel lies in each of the outer ones.
        assert_eq!(codes, [0, 30, 60, 60, 60, 30, 0]);
    }

    #[test]
    fn what_is_no_mask_is_refused() {
        assert_eq!(Mask::square(&[1.0; 8]), Err(MaskError::Shape(8)));
        assert_eq!(Mask::square(&[1.0; 16]), Err(MaskError::Shape(16)));
        assert_eq!(Mask::square(&[1.0, f32::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), Err(MaskError::NotFinite(1)));
    }
}
