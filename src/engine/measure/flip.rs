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

use std::array::from_fn;

use rayon::prelude::*;

use crate::image::color::Tables;
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

/// Width of a feature, in degrees of visual angle.
const FEATURE_WIDTH: f64 = 0.082;

/// Truncation radius of the Gaussians, in standard deviations.
const REACH: f64 = 3.0;

/// Three components of a colour, or one row of a colour matrix.
type Color = [f64; 3];

/// Matrix from linear sRGB to CIE XYZ, with white at D65. The inverse is [`RGB_FROM_XYZ`].
const XYZ_FROM_RGB: [Color; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// Inverse of [`XYZ_FROM_RGB`].
const RGB_FROM_XYZ: [Color; 3] = [
    [3.241_003_275, -1.537_398_934, -0.498_615_861],
    [-0.969_224_334, 1.875_930_071, 0.041_554_224],
    [0.055_639_423, -0.204_011_202, 1.057_148_933],
];

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
                filters.along_columns(&rows, (width as usize, height as usize), y, (lab, features));
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

fn transform(matrix: &[Color; 3], color: Color) -> Color {
    matrix.map(|row| row[0] * color[0] + row[1] * color[1] + row[2] * color[2])
}

/// Returns the CIE XYZ of white.
fn white() -> Color {
    transform(&XYZ_FROM_RGB, [1.0; 3])
}

/// Lookup table from 8-bit sRGB-encoded values to opponent colours; the opponent colour of a pixel is the sum of the
/// entries for its three channels.
struct Opponents {
    /// Lightness (Y), red–green (Cx) and blue–yellow (Cz) per channel and 8-bit value, all computed from linear light.
    /// The red entries include the constant term.
    of_code: [[[f32; 3]; 256]; 3],
}

impl Opponents {
    fn new() -> Self {
        let light = &Tables::get().linear_of_code;
        let white = white();
        let of_code = from_fn(|channel| {
            from_fn(|code| {
                let xyz = XYZ_FROM_RGB.map(|row| row[channel] * f64::from(light[code]));
                let [x, y, z] = [0, 1, 2].map(|i| xyz[i] / white[i]);
                let constant = if channel == 0 { 16.0 } else { 0.0 };
                [116.0 * y - constant, 500.0 * (x - y), 200.0 * (y - z)].map(|value| value as f32)
            })
        });
        Self { of_code }
    }

    /// Returns the opponent colours of a row as three planes.
    fn planes(&self, row: &[Rgba8]) -> [Vec<f32>; 3] {
        let [red, green, blue] = &self.of_code;
        let mut planes = [const { Vec::new() }; 3];
        planes.iter_mut().for_each(|plane| plane.reserve(row.len()));
        for [r, g, b, _] in row {
            let parts = [red[*r as usize], green[*g as usize], blue[*b as usize]];
            for (i, plane) in planes.iter_mut().enumerate() {
                plane.push(parts[0][i] + parts[1][i] + parts[2][i]);
            }
        }
        planes
    }
}

/// Conversion from opponent colours to L\*a\*b\*, through linear sRGB clamped to [0, 1]. a\* and b\* are scaled by
/// lightness, because dark colours look less colourful (Hunt effect).
struct LabFromOpponent {
    rgb_from_relative_xyz: [[f32; 3]; 3],
    relative_xyz_from_rgb: [[f32; 3]; 3],
}

impl LabFromOpponent {
    fn new() -> Self {
        let white = white();
        Self {
            rgb_from_relative_xyz: RGB_FROM_XYZ.map(|row| from_fn(|i| (row[i] * white[i]) as f32)),
            relative_xyz_from_rgb: from_fn(|i| XYZ_FROM_RGB[i].map(|value| (value / white[i]) as f32)),
        }
    }

    fn lab_of_opponent(&self, [lightness, cx, cz]: [f32; 3]) -> [f32; 3] {
        let y = (lightness + 16.0) / 116.0;
        let rgb = product(&self.rgb_from_relative_xyz, [cx / 500.0 + y, y, y - cz / 200.0]);
        self.lab_of_rgb(rgb.map(|channel| channel.clamp(0.0, 1.0)))
    }

    fn lab_of_rgb(&self, rgb: [f32; 3]) -> [f32; 3] {
        const DELTA: f32 = 6.0 / 29.0;
        let [x, y, z] = product(&self.relative_xyz_from_rgb, rgb)
            .map(|t| if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 });
        let lightness = 116.0 * y - 16.0;
        [lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)]
    }
}

fn product(matrix: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// Returns the HyAB distance of two L\*a\*b\* colours: absolute difference in lightness plus Euclidean distance in
/// chroma.
fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let (da, db) = (a[1] - b[1], a[2] - b[2]);
    (a[0] - b[0]).abs() + (da * da + db * db).sqrt()
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

/// Sum of Gaussians that blurs a channel: amplitudes and squared widths in degrees, as in the paper. Terms of amplitude
/// 0 are omitted.
type BlurKernel = &'static [(f64, f64)];

/// Blur of the lightness, red–green and blue–yellow channels, in this order.
const BLUR_KERNELS: [BlurKernel; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];

/// Number of planes that the row pass writes. Four are blurred: lightness, red–green, and blue–yellow with each of its
/// two Gaussians. Three are for features: lightness filtered with a Gaussian and with the Gaussian's first and second
/// derivatives.
const FILTERED: usize = 7;

/// Filter weights at integer pixel offsets.
struct Filters {
    /// Blur weights of lightness, red–green and the two Gaussians of blue–yellow; the same along both axes.
    blurs: [Vec<f32>; 4],
    smooth: Vec<f32>,
    slope: Vec<f32>,
    bend: Vec<f32>,
    lab: LabFromOpponent,
}

impl Filters {
    fn new() -> Self {
        let sigma = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
        let reach = (REACH * sigma).ceil() as i32;
        let gaussian = |x: f64| (-x * x / (2.0 * sigma * sigma)).exp();
        let smooth = taps(reach, gaussian);
        let total: f64 = smooth.iter().sum();
        let narrow = |weights: Vec<f64>| weights.into_iter().map(|weight| weight as f32).collect::<Vec<_>>();
        let [lightness, red_green, blue_yellow] = BLUR_KERNELS.map(blur_weights);
        let first = |weights: Vec<Vec<f32>>| weights.into_iter().next().unwrap_or_default();
        let mut blue_yellow = blue_yellow.into_iter();
        let [wide, wider] = from_fn(|_| blue_yellow.next().unwrap_or_default());
        Self {
            blurs: [first(lightness), first(red_green), wide, wider],
            smooth: narrow(smooth.iter().map(|weight| weight / total).collect()),
            slope: narrow(balanced(&taps(reach, |x| -x * gaussian(x)))),
            bend: narrow(balanced(&taps(reach, |x| (x * x / (sigma * sigma) - 1.0) * gaussian(x)))),
            lab: LabFromOpponent::new(),
        }
    }

    /// Filters the opponent colours of a row along the row. `filtered` has room for [`FILTERED`] rows.
    fn along_row(&self, [lightness, cx, cz]: &[Vec<f32>; 3], filtered: &mut [f32]) {
        let relative: Vec<f32> = lightness.iter().map(|value| (value + 16.0) / 116.0).collect();
        let [blur_lightness, blur_cx, blur_cz, blur_cz_again] = &self.blurs;
        let passes = [
            (lightness, blur_lightness),
            (cx, blur_cx),
            (cz, blur_cz),
            (cz, blur_cz_again),
            (&relative, &self.smooth),
            (&relative, &self.slope),
            (&relative, &self.bend),
        ];
        for ((plane, weights), sums) in passes.into_iter().zip(filtered.chunks_mut(lightness.len())) {
            let padded = padded(plane, weights.len() / 2);
            weighted_sums(weights, |tap| &padded[tap..], sums);
        }
    }

    /// Filters row `y` along columns and finishes its pixels. `rows` holds [`FILTERED`] rows for each image row.
    fn along_columns(
        &self,
        rows: &[f32],
        (width, height): (usize, usize),
        y: usize,
        (lab, features): (&mut [[f32; 3]], &mut [[f32; 2]]),
    ) {
        let [smooth_rows, slope_rows, bend_rows] = [4, 5, 6];
        let passes = [
            (0, &self.blurs[0]),
            (1, &self.blurs[1]),
            (2, &self.blurs[2]),
            (3, &self.blurs[3]),
            (slope_rows, &self.smooth),
            (smooth_rows, &self.slope),
            (bend_rows, &self.smooth),
            (smooth_rows, &self.bend),
        ];
        let mut sums = vec![0.0; passes.len() * width];
        for ((filter, weights), sums) in passes.into_iter().zip(sums.chunks_mut(width)) {
            let reach = weights.len() / 2;
            let row = |tap: usize| {
                let at = (y + tap).saturating_sub(reach).min(height - 1);
                &rows[(at * FILTERED + filter) * width..][..width]
            };
            weighted_sums(weights, row, sums);
        }
        let sum = |pass: usize, x: usize| sums[pass * width + x];
        for (x, (lab, features)) in lab.iter_mut().zip(features).enumerate() {
            *lab = self.lab.lab_of_opponent([sum(0, x), sum(1, x), sum(2, x) + sum(3, x)]);
            let length = |x: f32, y: f32| (x * x + y * y).sqrt();
            *features = [length(sum(4, x), sum(5, x)), length(sum(6, x), sum(7, x))];
        }
    }
}

/// Returns the 1D weights of each Gaussian of a kernel. They are scaled such that the weights of all 2D Gaussians of
/// the kernel add up to 1.
fn blur_weights(sight: BlurKernel) -> Vec<Vec<f32>> {
    use std::f64::consts::PI;
    /// Threshold relative to the largest weight; smaller weights vanish in the rounding of an f32 sum.
    const NEGLIGIBLE: f64 = 1e-9;
    let widest = BLUR_KERNELS.iter().copied().flatten().map(|(_, b)| *b).fold(0.0, f64::max);
    let sigma = (widest / (2.0 * PI.powi(2))).sqrt();
    let reach = (REACH * sigma * PIXELS_PER_DEGREE).ceil() as i32;
    let axes = sight.iter().map(|(a, b)| {
        let height = (a * (PI / b).sqrt()).sqrt();
        taps(reach, |x| height * (-(PI * x / PIXELS_PER_DEGREE).powi(2) / b).exp())
    });
    let axes: Vec<_> = axes.collect();
    let total: f64 = axes.iter().map(|axis| axis.iter().sum::<f64>().powi(2)).sum();
    let trimmed = |axis: Vec<f64>| {
        let least = NEGLIGIBLE * axis[axis.len() / 2];
        let weights = axis.into_iter().filter(|weight| *weight >= least);
        weights.map(|weight| (weight / total.sqrt()) as f32).collect()
    };
    axes.into_iter().map(trimmed).collect()
}

/// Samples a function at the integers from −`reach` to `reach`.
fn taps(reach: i32, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    (-reach..=reach).map(|x| weight(f64::from(x))).collect()
}

/// Normalises weights so that the positive ones sum to 1 and the negative ones to −1.
fn balanced(weights: &[f64]) -> Vec<f64> {
    let positive: f64 = weights.iter().filter(|weight| **weight > 0.0).sum();
    let negative: f64 = -weights.iter().filter(|weight| **weight < 0.0).sum::<f64>();
    weights.iter().map(|weight| weight / if *weight > 0.0 { positive } else { negative }).collect()
}

/// Returns a row extended by `reach` copies of its first and last values.
fn padded(row: &[f32], reach: usize) -> Vec<f32> {
    let [first, last] = [row.first(), row.last()].map(|value| value.copied().unwrap_or_default());
    let mut padded = vec![first; reach + row.len()];
    padded[reach..].copy_from_slice(row);
    padded.resize(row.len() + 2 * reach, last);
    padded
}

/// Computes the weighted sum over all taps at each position; `values(tap)` is the row that a tap reads.
fn weighted_sums<'a>(weights: &[f32], values: impl Fn(usize) -> &'a [f32], sums: &mut [f32]) {
    /// Number of sums kept in registers across all taps: avoids a load and a store for each tap.
    const PLACES: usize = 16;
    let in_chunks = sums.len() / PLACES * PLACES;
    let mut chunks = sums.chunks_exact_mut(PLACES);
    for (chunk, sums) in chunks.by_ref().enumerate() {
        let mut together = [0.0_f32; PLACES];
        for (tap, weight) in weights.iter().enumerate() {
            let values = &values(tap)[chunk * PLACES..][..PLACES];
            together.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
        }
        sums.copy_from_slice(&together);
    }
    let rest = chunks.into_remainder();
    rest.fill(0.0);
    for (tap, weight) in weights.iter().enumerate() {
        let values = &values(tap)[in_chunks..][..rest.len()];
        rest.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
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
