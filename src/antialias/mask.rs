//! Convolution masks over a finished picture: blur, sharpen, motion, or any of one's own. Alpha is kept.

use rayon::prelude::*;

use crate::flat2d::convolve::Mask;
use crate::image::color::Tables;
use crate::image::{Image, Rgba8};

/// Applies a mask to every pixel, in codes or in linear light. Sums are rounded half up and clamped once, at the end.
pub fn apply(mask: &Mask, picture: &Image<Rgba8>, linear: bool) -> Image<Rgba8> {
    let (width, height) = picture.size();
    let tables = Tables::get();
    let values = if linear { &tables.linear_of_code } else { &tables.code };
    let mut result = picture.clone();
    result.pixels_mut().par_chunks_mut((width as usize).max(1)).zip(0..height).for_each(|(row, y)| {
        let mut sums = vec![[0.0_f32; 3]; width as usize];
        for ((dx, dy), weight) in mask.weights().filter(|(_, weight)| *weight != 0.0) {
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
        let shown = apply(&Mask::square(&weights).unwrap(), &dot(), false);
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
                assert_eq!(apply(&mask, &plain, linear), plain, "{mask:?}");
            }
        }
    }

    #[test]
    fn half_black_half_white_is_brighter_in_linear_light() {
        let stripes = Image::from_fn(9, 3, |x, _| [if x % 2 == 0 { 0 } else { 255 }; 4]);
        let halves = Mask::square(&[0.0, 0.0, 0.0, 0.25, 0.5, 0.25, 0.0, 0.0, 0.0]).unwrap();
        assert_eq!(apply(&halves, &stripes, false).at(4, 1)[0], 128);
        assert_eq!(apply(&halves, &stripes, true).at(4, 1)[0], 188);
    }

    #[test]
    fn motion_leaves_a_straight_trace() {
        let shown = apply(&Mask::motion(4.0, 0.0), &dot(), false);
        assert_eq!(shown.row(1), [[0, 0, 0, 9]; 7]);
        let codes: Vec<_> = shown.row(2).iter().map(|pixel| pixel[0]).collect();
        // Of four pixels of way half a pixel lies in each of the outer ones.
        assert_eq!(codes, [0, 30, 60, 60, 60, 30, 0]);
    }
}
