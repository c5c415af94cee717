//! The cubic through four drawn pixels, along rows and then along columns.
//!
//! The source article fits a cubic through the four samples around the place: the 4-point Lagrange polynomial. At t
//! between samples 0 and 1 the samples −1, 0, 1, 2 weigh
//!
//! ```text
//!   −t(1−t)(2−t)/6    (1+t)(1−t)(2−t)/2    (1+t)t(2−t)/2    −t(1−t)(1+t)/6
//! ```
//!
//! It reproduces cubics, but its slope jumps at the samples. As printed there, the last row of the column pass is read
//! from the row before it (the weights still sum to one, so it shows only as an error on ramps); corrected here.

use super::kernel::{Kernel, SCALES};
use super::{Tap, Upscaler};
use crate::image::{Image, Rgba8};
use crate::pipeline::grid::SampleGrid;

/// 4-point Lagrange cubics between drawn pixels.
pub const BICUBIC: Bicubic = Bicubic;

/// See [`BICUBIC`].
pub struct Bicubic;

/// In 1/128.
const KERNEL: Kernel<4, 7> = Kernel { quarters: [lagrange(0), lagrange(1), lagrange(2), lagrange(3)] };

/// The four Lagrange weights in 1/128, `q` quarters of the way from sample 0 to sample 1. With t = q/4 the fractions
/// above have the denominators 384 and 128, and all of them come out whole.
const fn lagrange(q: i16) -> [i16; 4] {
    [-q * (4 - q) * (8 - q) / 3, (4 + q) * (4 - q) * (8 - q), (4 + q) * q * (8 - q), -q * (4 - q) * (4 + q) / 3]
}

impl Upscaler for Bicubic {
    fn id(&self) -> &'static str {
        "bicubic"
    }

    fn name(&self) -> &'static str {
        "Bicubic"
    }

    fn help(&self) -> &'static str {
        "Draws the top-left pixel of each block and fits a cubic through the four drawn pixels around, along rows and \
         then columns (the source article's 4-point Lagrange cubic, not Catmull-Rom). Good on smooth detail, which \
         stays sharper than bilinear. Overshoots at hard edges by up to 6 % of their height, a dark or bright seam, \
         and keeps the stairs of slanted edges."
    }

    fn scales(&self) -> &'static [u32] {
        SCALES
    }

    fn grid(&self, scale: u32) -> SampleGrid {
        SampleGrid::Block { step: scale }
    }

    fn upscale(&self, drawn: &Image<Rgba8>, scale: u32, width: u32, height: u32) -> Image<Rgba8> {
        KERNEL.upscale(drawn, scale, width, height)
    }

    fn taps(&self, x: u32, y: u32, scale: u32, width: u32, height: u32) -> Vec<Tap> {
        KERNEL.taps(x, y, scale, width, height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_those_of_the_lagrange_cubic() {
        assert_eq!(KERNEL.quarters, [[0, 128, 0, 0], [-7, 105, 35, -5], [-8, 72, 72, -8], [-5, 35, 105, -7]]);
        for (q, weights) in KERNEL.quarters.into_iter().enumerate() {
            let t = q as f64 / 4.0;
            let exact = [
                -t * (1.0 - t) * (2.0 - t) / 6.0,
                (1.0 + t) * (1.0 - t) * (2.0 - t) / 2.0,
                (1.0 + t) * t * (2.0 - t) / 2.0,
                -t * (1.0 - t) * (1.0 + t) / 6.0,
            ];
            for (weight, exact) in weights.into_iter().zip(exact) {
                assert!((f64::from(weight) / 128.0 - exact).abs() < 1e-15, "t = {t}: {weight}/128 is not {exact}");
            }
        }
    }

    #[test]
    fn a_cubic_is_reproduced_where_all_four_taps_lie_inside() {
        let cubic = |t: f64| (t - 1.0) * (t - 3.0) * (t - 4.0) * 4.0 + 120.0;
        let drawn = Image::from_fn(6, 6, |_, y| [cubic(f64::from(y)) as u8; 4]);
        let full = BICUBIC.upscale(&drawn, 4, 24, 24);
        for y in 4..=16 {
            let exact = (cubic(f64::from(y) / 4.0) + 0.5).floor() as u8;
            assert_eq!(full.at(7, y), [exact; 4], "row {y}");
        }
    }

    #[test]
    fn overshoot_is_cut_off_after_both_passes() {
        let column = Image::from_pixels(1, 4, vec![[0; 4], [0; 4], [255; 4], [255; 4]]);
        let full = BICUBIC.upscale(&column, 2, 2, 8);
        assert_eq!(full.at(0, 1), [0; 4], "an undershoot of 16 codes becomes 0");
        assert_eq!(full.at(0, 3), [128; 4], "the middle, 127.5, rounds up");
        assert_eq!(full.at(0, 5), [255; 4], "an overshoot of 16 codes becomes 255");
        let corner = Image::from_fn(4, 4, |x, y| [if x < 2 && y < 2 { 255 } else { 0 }; 4]);
        let full = BICUBIC.upscale(&corner, 2, 8, 8);
        assert_eq!(full.at(1, 3), [135; 4], "half of 255 + 16, not of 255");
    }
}
