//! How different two pictures look when one flips between them: FLIP, for pictures of 8-bit sRGB codes.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference Evaluator for Alternating
//! Images" (2020). Two pipelines, and their product:
//!
//! * colour: to opponent colours, blurred as far as an eye at that distance blurs each, to L\*a\*b\* with saturation scaled by
//!   lightness (Hunt), the distance of both, raised to 0.7 and mapped to [0, 1];
//! * features: how much stronger edges and points are in one of the pictures, by Gaussian derivatives.
//!
//! The error of a pixel is colour^(1 − feature): 0 for none, 1 for black against white. Pictures end with their outermost
//! pixels repeated. All in f64. Viewed as is usual for the measure: a screen of 0.7 m and 3840 px seen from 0.7 m.

use rayon::prelude::*;

use crate::image::color::Tables;
use crate::image::{Image, Rgba8};

/// Pixels per degree of sight: distance · (pixels / width of the screen) · π / 180, for the usual view.
pub const PIXELS_PER_DEGREE: f64 = 0.7 * (3840.0 / 0.7) * std::f64::consts::PI / 180.0;

/// Exponent of colour distances.
const COLOR_EXPONENT: f64 = 0.7;

/// Share of the greatest colour distance below which differences get most of the range …
const KNEE: f64 = 0.4;

/// … and how much of the range.
const KNEE_ERROR: f64 = 0.95;

/// Exponent of feature differences.
const FEATURE_EXPONENT: f64 = 0.5;

/// Width of a feature, degrees.
const FEATURE_WIDTH: f64 = 0.082;

/// Gaussians reach to so many standard deviations.
const REACH: f64 = 3.0;

/// Three numbers per pixel.
type Color = [f64; 3];

/// CIE XYZ of sRGB primaries with white at D65, and its inverse.
const XYZ_FROM_RGB: [Color; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// See [`XYZ_FROM_RGB`].
const RGB_FROM_XYZ: [Color; 3] = [
    [3.241_003_275, -1.537_398_934, -0.498_615_861],
    [-0.969_224_334, 1.875_930_071, 0.041_554_224],
    [0.055_639_423, -0.204_011_202, 1.057_148_933],
];

/// The error of every pixel, in [0, 1]; `None` if the sizes differ or there are no pixels. The same both ways round. Alpha
/// does not count.
pub fn map(a: &Image<Rgba8>, b: &Image<Rgba8>) -> Option<Image<f32>> {
    if a.size() != b.size() || a.pixels().is_empty() {
        return None;
    }
    let [a, b] = [a, b].map(opponent);
    let (color, features) = rayon::join(|| color_errors(&a, &b), || feature_errors(&a, &b));
    let pixels = color.pixels().iter().zip(features.pixels()).map(|(c, f)| c.powf(1.0 - f) as f32).collect();
    Some(Image::from_pixels(color.width(), color.height(), pixels))
}

/// The mean of the errors of [`map`], or of those of a part of it.
pub(super) fn mean(errors: &Image<f32>) -> f64 {
    errors.pixels().iter().map(|error| f64::from(*error)).sum::<f64>() / errors.pixels().len() as f64
}

fn transform(matrix: &[Color; 3], color: Color) -> Color {
    matrix.map(|row| row[0] * color[0] + row[1] * color[1] + row[2] * color[2])
}

/// XYZ of white.
fn white() -> Color {
    transform(&XYZ_FROM_RGB, [1.0; 3])
}

/// XYZ relative to white.
fn relative_xyz(rgb: Color) -> Color {
    let (xyz, white) = (transform(&XYZ_FROM_RGB, rgb), white());
    [0, 1, 2].map(|i| xyz[i] / white[i])
}

/// Codes as Y, Cx, Cz: lightness, red against green, blue against yellow, all linear in light.
fn opponent(picture: &Image<Rgba8>) -> Image<Color> {
    let light = &Tables::get().linear_of_code;
    picture.map(|[r, g, b, _]| {
        let [x, y, z] = relative_xyz([r, g, b].map(|code| f64::from(light[code as usize])));
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    })
}

/// Back to linear red, green, blue within [0, 1].
fn rgb_of_opponent([lightness, cx, cz]: Color) -> Color {
    let y = (lightness + 16.0) / 116.0;
    let (xyz, white) = ([cx / 500.0 + y, y, y - cz / 200.0], white());
    transform(&RGB_FROM_XYZ, [0, 1, 2].map(|i| xyz[i] * white[i])).map(|channel| channel.clamp(0.0, 1.0))
}

/// L\*a\*b\* with a\* and b\* scaled by lightness: in the dark colours look less colourful.
fn hunt_lab(rgb: Color) -> Color {
    let delta: f64 = 6.0 / 29.0;
    let [x, y, z] =
        relative_xyz(rgb).map(|t| if t > delta.powi(3) { t.cbrt() } else { t / (3.0 * delta * delta) + 4.0 / 29.0 });
    let lightness = 116.0 * y - 16.0;
    [lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)]
}

/// Distance of two colours: in lightness as on a street grid, in the others straight (HyAB).
fn distance(a: Color, b: Color) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

fn color_errors(a: &Image<Color>, b: &Image<Color>) -> Image<f64> {
    let [a, b] = [a, b].map(|picture| blurred(picture).map(|color| hunt_lab(rgb_of_opponent(color))));
    let greatest = distance(hunt_lab([0.0, 1.0, 0.0]), hunt_lab([0.0, 0.0, 1.0])).powf(COLOR_EXPONENT);
    let knee = KNEE * greatest;
    let error = |(a, b): (&Color, &Color)| {
        let far = distance(*a, *b).powf(COLOR_EXPONENT);
        if far < knee {
            far * KNEE_ERROR / knee
        } else {
            KNEE_ERROR + (far - knee) / (greatest - knee) * (1.0 - KNEE_ERROR)
        }
    };
    let pixels = a.pixels().par_iter().zip(b.pixels()).map(error).collect();
    Image::from_pixels(a.width(), a.height(), pixels)
}

/// A sum of Gaussians that an eye blurs a channel by: heights and squared widths in degrees as the paper has them.
type Sight = [(f64, f64); 2];

/// Of lightness, red against green, and blue against yellow.
const SIGHTS: [Sight; 3] = [[(1.0, 0.0047), (0.0, 1e-5)], [(1.0, 0.0053), (0.0, 1e-5)], [(34.1, 0.04), (13.5, 0.025)]];

/// Opponent colours as an eye at that distance sees them.
fn blurred(picture: &Image<Color>) -> Image<Color> {
    let widest = SIGHTS.as_flattened().iter().map(|(_, b)| *b).fold(0.0, f64::max);
    let sigma = (widest / (2.0 * std::f64::consts::PI.powi(2))).sqrt();
    let reach = (REACH * sigma * PIXELS_PER_DEGREE).ceil() as i32;
    let channels: Vec<Image<f64>> = SIGHTS
        .par_iter()
        .enumerate()
        .map(|(channel, sight)| {
            // Each Gaussian is separable, their sum is not. Weights of both together sum to one.
            let axes = sight.map(|(a, b)| {
                let height = (a * (std::f64::consts::PI / b).sqrt()).sqrt();
                taps(reach, |x| height * (-(std::f64::consts::PI * x / PIXELS_PER_DEGREE).powi(2) / b).exp())
            });
            let total: f64 = axes.iter().map(|axis| axis.iter().sum::<f64>().powi(2)).sum();
            let plane = picture.map(|color| color[channel]);
            let [mut one, other] = axes.map(|axis| convolve(&plane, &axis, &axis));
            for (sum, other) in one.pixels_mut().iter_mut().zip(other.pixels()) {
                *sum = (*sum + other) / total;
            }
            one
        })
        .collect();
    Image::from_fn(picture.width(), picture.height(), |x, y| [0, 1, 2].map(|channel| channels[channel].at(x, y)))
}

/// A function at whole places from −`reach` to `reach`.
fn taps(reach: i32, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    (-reach..=reach).map(|x| weight(f64::from(x))).collect()
}

fn feature_errors(a: &Image<Color>, b: &Image<Color>) -> Image<f64> {
    let sigma = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let reach = (REACH * sigma).ceil() as i32;
    let gaussian = |x: f64| (-x * x / (2.0 * sigma * sigma)).exp();
    let smooth = taps(reach, gaussian);
    let smooth: Vec<f64> = smooth.iter().map(|weight| weight / smooth.iter().sum::<f64>()).collect();
    let slope = balanced(&taps(reach, |x| -x * gaussian(x)));
    let bend = balanced(&taps(reach, |x| (x * x / (sigma * sigma) - 1.0) * gaussian(x)));
    let strengths = |picture: &Image<Color>, filter: &[f64]| {
        let lightness = picture.map(|color| (color[0] + 16.0) / 116.0);
        let (across, down) =
            rayon::join(|| convolve(&lightness, filter, &smooth), || convolve(&lightness, &smooth, filter));
        let pixels = across.pixels().iter().zip(down.pixels()).map(|(x, y)| x.hypot(*y)).collect();
        Image::from_pixels(across.width(), across.height(), pixels)
    };
    let [edges_a, points_a, edges_b, points_b] =
        [(a, &slope), (a, &bend), (b, &slope), (b, &bend)].map(|(picture, filter)| strengths(picture, filter));
    Image::from_fn(a.width(), a.height(), |x, y| {
        let edges = (edges_a.at(x, y) - edges_b.at(x, y)).abs();
        let points = (points_a.at(x, y) - points_b.at(x, y)).abs();
        (edges.max(points) / std::f64::consts::SQRT_2).powf(FEATURE_EXPONENT)
    })
}

/// Weights whose positive ones sum to 1 and whose negative ones sum to −1.
fn balanced(weights: &[f64]) -> Vec<f64> {
    let positive: f64 = weights.iter().filter(|weight| **weight > 0.0).sum();
    let negative: f64 = -weights.iter().filter(|weight| **weight < 0.0).sum::<f64>();
    weights.iter().map(|weight| weight / if *weight > 0.0 { positive } else { negative }).collect()
}

/// Weighted sums along rows, then along columns; the outermost pixels repeat.
fn convolve(plane: &Image<f64>, across: &[f64], down: &[f64]) -> Image<f64> {
    let (width, height) = plane.size();
    let along = |weights: &[f64], value: &dyn Fn(i64) -> f64, at: u32| -> f64 {
        let reach = (weights.len() / 2) as i64;
        weights.iter().zip(i64::from(at) - reach..).map(|(weight, at)| weight * value(at)).sum()
    };
    let rows: Vec<f64> = (0..height)
        .into_par_iter()
        .flat_map_iter(|y| {
            let row = plane.row(y);
            let value = move |at: i64| row[at.clamp(0, i64::from(width) - 1) as usize];
            (0..width).map(move |x| along(across, &value, x))
        })
        .collect();
    let rows = Image::from_pixels(width, height, rows);
    let pixels = (0..height)
        .into_par_iter()
        .flat_map_iter(|y| {
            let mut sums = vec![0.0; width as usize];
            let reach = (down.len() / 2) as i64;
            for (weight, at) in down.iter().zip(i64::from(y) - reach..) {
                let row = rows.row(at.clamp(0, i64::from(height) - 1) as u32);
                for (sum, value) in sums.iter_mut().zip(row) {
                    *sum += weight * value;
                }
            }
            sums
        })
        .collect();
    Image::from_pixels(width, height, pixels)
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

    /// A quarter of the way to grey.
    fn dull(color: [u32; 3]) -> [u32; 3] {
        let grey = color.iter().sum::<u32>() / 3;
        color.map(|code| (3 * code + grey) / 4)
    }

    /// Means and maxima by the authors' own program: the package `flip-evaluator` 1.7 of PyPI, `evaluate(a, b, "LDR",
    /// applyMagma=False)` of PNG files of these pictures, all other settings left as they are.
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
        // Sums of codes, which tell that the pictures are the ones that the figures are of.
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
