//! Filters of FLIP: the blur of a viewer's eye, and the detectors of edges and points.

use std::array::from_fn;

use super::PIXELS_PER_DEGREE;
use super::color::LabFromOpponent;

/// Width of a feature, in degrees of visual angle.
const FEATURE_WIDTH: f64 = 0.082;

/// Truncation radius of the Gaussians, in standard deviations.
const REACH: f64 = 3.0;

/// Sum of Gaussians that blurs a channel: amplitudes and squared widths in degrees, as in the paper. Terms of amplitude
/// 0 are omitted.
type BlurKernel = &'static [(f64, f64)];

/// Blur of the lightness, red–green and blue–yellow channels, in this order.
const BLUR_KERNELS: [BlurKernel; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];

/// Number of planes that the row pass writes. Four are blurred: lightness, red–green, and blue–yellow with each of its
/// two Gaussians. Three are for features: lightness filtered with a Gaussian and with the Gaussian's first and second
/// derivatives.
pub(super) const FILTERED: usize = 7;

/// Filter weights at integer pixel offsets.
pub(super) struct Filters {
    /// Blur weights of lightness, red–green and the two Gaussians of blue–yellow; the same along both axes.
    blurs: [Vec<f32>; 4],
    smooth: Vec<f32>,
    slope: Vec<f32>,
    bend: Vec<f32>,
    lab: LabFromOpponent,
}

impl Filters {
    pub(super) fn new() -> Self {
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
    pub(super) fn along_row(&self, [lightness, cx, cz]: &[Vec<f32>; 3], filtered: &mut [f32]) {
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

    /// Filters row `y` along columns and finishes its pixels, of which there is at least one. `rows` holds [`FILTERED`]
    /// rows for each image row.
    pub(super) fn along_columns(&self, rows: &[f32], y: usize, lab: &mut [[f32; 3]], features: &mut [[f32; 2]]) {
        let width = lab.len();
        let height = rows.len() / (FILTERED * width);
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
