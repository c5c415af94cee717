//! Convolution masks over a finished picture: blur, sharpen, motion blur, or a custom mask. Alpha is unchanged.
//!
//! Blur and Gaussian blur are separable: rows are convolved first, then columns. This takes 2 · 31 instead of 31² terms
//! per pixel for the largest mask.

use rayon::prelude::*;

use crate::flat2d::convolve::Mask;
use crate::image::color::Tables;
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;

/// Number of rows per band. Bands are filtered in parallel. Each band also reads rows of the adjacent bands, and
/// converts these rows again.
const BAND_ROWS: u32 = 64;

/// Number of filtered channels: red, green and blue.
const CHANNELS: usize = 3;

/// Convolves a picture with a mask, in linear light if `linear` is `true`, else in sRGB codes. Sums are rounded half up
/// and clamped once, at the end.
pub(crate) fn apply(mask: &Mask, picture: &Image<Rgba8>, linear: bool) -> Image<Rgba8> {
    let width = picture.width();
    let tables = Tables::get();
    let lanes = Lanes::best();
    let mut result = picture.clone();
    let bands = result.pixels_mut().par_chunks_mut((width * BAND_ROWS).max(1) as usize).enumerate();
    bands.for_each_init(FilterBand::default, |band, (index, pixels)| {
        let first = index as u32 * BAND_ROWS;
        let rows = first..first + pixels.len() as u32 / width;
        let values = if linear { &tables.linear_of_code.values } else { &tables.code.values };
        on_lanes!(lanes, _simd => {
            band.read(mask, picture, rows, values);
            if let Some(factors) = mask.factors() {
                band.convolve_rows(factors);
            }
            for (row, pixels) in pixels.chunks_exact_mut(width as usize).enumerate() {
                band.sum(mask, row);
                for (x, pixel) in pixels.iter_mut().enumerate() {
                    for (code, sums) in pixel.iter_mut().zip(&band.sums) {
                        let value = sums[x];
                        *code =
                            if linear { tables.encode(value) } else { (value + 0.5).clamp(0.0, 255.0) as u8 };
                    }
                }
            }
        });
    });
    result
}

/// Buffers for filtering a band of rows: the values of the band and of the margin that the mask reads, and one row of
/// sums.
#[derive(Default)]
struct FilterBand {
    /// Values of each channel, row by row from the top, `stride` values per row.
    planes: [Vec<f32>; CHANNELS],
    stride: usize,
    /// Convolved values of one row, per channel.
    sums: [Vec<f32>; CHANNELS],
}

impl FilterBand {
    /// Fills the planes with the values of `rows` and of a margin around them. Pixels beyond the picture's border
    /// repeat the nearest pixel.
    #[inline(always)]
    fn read(&mut self, mask: &Mask, picture: &Image<Rgba8>, rows: std::ops::Range<u32>, values: &[f32; 256]) {
        let reach = i64::from(mask.reach());
        let width = i64::from(picture.width());
        self.stride = (width + 2 * reach) as usize;
        for plane in &mut self.planes {
            plane.clear();
        }
        for sums in &mut self.sums {
            sums.resize(width as usize, 0.0);
        }
        for y in i64::from(rows.start) - reach..i64::from(rows.end) + reach {
            let row = picture.row(y.clamp(0, i64::from(picture.height()) - 1) as u32);
            for (channel, plane) in self.planes.iter_mut().enumerate() {
                let value = |x: i64| values[row[x.clamp(0, width - 1) as usize][channel] as usize];
                plane.extend((-reach..0).map(value));
                plane.extend(row.iter().map(|pixel| values[pixel[channel] as usize]));
                plane.extend((width..width + reach).map(value));
            }
        }
    }

    /// Convolves every row with the factors of a separable mask, in place.
    #[inline(always)]
    fn convolve_rows(&mut self, factors: &[f32]) {
        let [sums, ..] = &mut self.sums;
        for row in self.planes.iter_mut().flat_map(|plane| plane.chunks_exact_mut(self.stride)) {
            sums.fill(0.0);
            for (right, factor) in factors.iter().enumerate() {
                add(sums, *factor, &row[right..]);
            }
            row[..sums.len()].copy_from_slice(sums);
        }
    }

    /// Computes the convolved values of one row of the band. For a separable mask, only the vertical sum remains,
    /// because [`FilterBand::convolve_rows`] has already computed the horizontal sums.
    #[inline(always)]
    fn sum(&mut self, mask: &Mask, row: usize) {
        let reach = i64::from(mask.reach());
        for (plane, sums) in self.planes.iter().zip(&mut self.sums) {
            sums.fill(0.0);
            let values = |down: usize, right: usize| &plane[(row + down) * self.stride + right..];
            match mask.factors() {
                Some(factors) => {
                    for (down, factor) in factors.iter().enumerate() {
                        add(sums, *factor, values(down, 0));
                    }
                }
                None => {
                    for ((dx, dy), weight) in mask.weights().filter(|(_, weight)| *weight != 0.0) {
                        add(sums, weight, values((dy + reach) as usize, (dx + reach) as usize));
                    }
                }
            }
        }
    }
}

/// Adds `weight` times each value to each sum.
#[inline(always)]
fn add(sums: &mut [f32], weight: f32, values: &[f32]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += weight * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::color::decode_byte;

    fn dot() -> Image<Rgba8> {
        let mut picture = Image::filled(7, 5, [0, 0, 0, 9]);
        picture.set(3, 2, [240, 120, 0, 9]);
        picture
    }

    #[test]
    fn convolving_a_dot_yields_the_mirrored_mask() {
        let weights = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
        let shown = apply(&Mask::square(&weights).unwrap(), &dot(), false);
        for (index, weight) in weights.into_iter().enumerate() {
            let (x, y) = (4 - index as u32 % 3, 3 - index as u32 / 3);
            let exact = |code: f32| (weight * code + 0.5) as u8;
            assert_eq!(shown.at(x, y), [exact(240.0), exact(120.0), 0, 9], "weight {index}");
        }
        assert_eq!(shown.at(1, 2), [0, 0, 0, 9]);
    }

    /// Returns the convolution at one pixel and channel, computed in `f64` as the reference.
    fn exact(mask: &Mask, picture: &Image<Rgba8>, (x, y): (u32, u32), channel: usize, linear: bool) -> f64 {
        let value = |code: u8| f64::from(if linear { decode_byte(code) } else { f32::from(code) });
        let term = |((dx, dy), weight): ((i64, i64), f32)| {
            f64::from(weight) * value(picture.at_clamped(i64::from(x) + dx, i64::from(y) + dy)[channel])
        };
        mask.weights().map(term).sum()
    }

    #[test]
    fn every_pixel_is_the_sum_of_its_terms() {
        let mut random = fastrand::Rng::with_seed(3);
        let masks = [
            Mask::blur(1),
            Mask::blur(15),
            Mask::gaussian(0.4),
            Mask::gaussian(5.0),
            Mask::sharpen(2.0),
            Mask::motion(30.0, 0.7),
        ];
        for (width, height) in [(1, 1), (3, 70), (41, 5), (19, 133)] {
            let picture = Image::from_fn(width, height, |_, _| std::array::from_fn(|_| random.u8(..)));
            for (mask, linear) in masks.iter().flat_map(|mask| [(mask, false), (mask, true)]) {
                let shown = apply(mask, &picture, linear);
                for at in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                    let (own, found) = (picture.at(at.0, at.1), shown.at(at.0, at.1));
                    assert_eq!(found[3], own[3]);
                    for channel in 0..3 {
                        let sum = exact(mask, &picture, at, channel, linear);
                        // The code must lie within the rounding error of the sum.
                        let code = |value: f64| {
                            if linear {
                                Tables::get().encode(value as f32)
                            } else {
                                (value + 0.5).clamp(0.0, 255.0) as u8
                            }
                        };
                        let slack = 1e-5 * if linear { 1.0 } else { 255.0 };
                        let range = code(sum - slack)..=code(sum + slack);
                        assert!(range.contains(&found[channel]), "{width} × {height} at {at:?}: {found:?} for {sum}");
                    }
                }
            }
        }
    }

    #[test]
    fn uniform_pictures_stay_unchanged_up_to_the_border() {
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
        // The trace is four pixels long: it covers three pixels completely, and half of the pixel at each end.
        assert_eq!(codes, [0, 30, 60, 60, 60, 30, 0]);
    }
}
