//! Weights of the samples around a pixel, and of the history pixels around a position.

use super::super::Lattice;
use super::super::lattice::ThreeSamples;
use crate::math::lanes::*;

/// Smallest sum of weights that is used: dividing by less would amplify rounding errors.
const LEAST_SUM: f32 = 0.05;

/// Maximum of [`Kernel::new`]'s narrowing; the published limit keeps at least one sample inside the kernel.
const MOST_NARROWING: f32 = 1.99;

/// Squared distance of samples that do not exist, at which all weights are zero.
const FAR: f32 = 4.0;

/// Samples along one axis that contribute to an output column or row; see [`ThreeSamples`].
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisSamples {
    pub(super) index: [u32; 3],
    /// Squared distance of each sample from the centre of the output pixel, relative to the distance between samples.
    /// The fourth number is [`FAR`].
    distance_squared: [f32; 4],
    /// Whether the middle sample lies inside the output pixel along this axis.
    pub(super) is_inside: bool,
}

impl AxisSamples {
    /// Returns the samples around output column or row `at`, out of `samples` samples of a lattice. They lie at `place`
    /// within their areas.
    pub(super) fn new(lattice: Lattice, place: f64, at: u32, samples: u32) -> Self {
        let ThreeSamples { index, from_nearest } = lattice.three_around(place, at, samples);
        let [before, own, after] =
            [-1.0, 0.0, 1.0].map(|number: f32| (number - from_nearest) * (number - from_nearest));
        Self {
            index,
            distance_squared: [before, own, after, FAR],
            is_inside: f64::from(from_nearest.abs()) * lattice.scale.value() <= 0.5,
        }
    }
}

/// Returns the radial Lanczos kernel with two lobes at squared distances, as published: a polynomial that differs from
/// sinc(x) · sinc(x / 2) by at most 0.05. It is zero from distance 2 on.
#[inline(always)]
pub(super) fn lanczos2<S: Simd>(simd: S, distance_squared: f32x4<S>) -> f32x4<S> {
    let squared = distance_squared.min(f32x4::splat(simd, FAR));
    let (wave, window) = (squared * 0.4 - 1.0, squared * 0.25 - 1.0);
    (wave * wave * (25.0 / 16.0) - 9.0 / 16.0) * (window * window)
}

/// Returns the weights of four adjacent history pixels for a position at `t` in [0, 1) between the second and the third.
/// They sum to 1.
#[inline(always)]
pub(super) fn history_weights<S: Simd>(simd: S, t: f32) -> [f32; 4] {
    let distance = f32x4::load_array(simd, [-1.0, 0.0, 1.0, 2.0]) - t;
    let weights = lanczos2(simd, distance * distance);
    let [a, b, c, d] = weights.to_array();
    (weights * (1.0 / (a + b + c + d))).to_array()
}

/// Weights of the 3 × 3 samples around a pixel, row by row.
pub(super) struct Kernel {
    /// Weights of the present colour, which sum to 1.
    pub(super) lanczos: [[f32; 3]; 3],
    /// Sum of the Lanczos weights: the weight of the present colour; 0 if no sample is near enough.
    pub(super) sum: f32,
    /// Weights of the mean and the variance, which sum to 1.
    pub(super) window: [[f32; 3]; 3],
}

impl Kernel {
    /// Computes the weights. A narrowing of 1 gives a kernel that spans two samples to each side. Larger ones make it
    /// narrower by that factor, up to [`MOST_NARROWING`].
    #[inline(always)]
    pub(super) fn new<S: Simd>(simd: S, columns: &AxisSamples, rows: &AxisSamples, narrowing: f32) -> Self {
        let narrowing = narrowing.min(MOST_NARROWING);
        let across = f32x4::load_array(simd, columns.distance_squared);
        let [above, own, below, _] = rows.distance_squared;
        let squared = each!(down in [above, own, below] => across + down);
        let lanczos = each!(row in [0, 1, 2] => lanczos2(simd, squared[row] * (narrowing * narrowing)));
        let window = each!(row in [0, 1, 2] => {
            let inside = 1.0 - (squared[row] * (1.0 / 3.0)).min(f32x4::splat(simd, 1.0));
            inside * inside
        });
        let sum = sum_of(lanczos[0] + lanczos[1] + lanczos[2]);
        let window_sum = sum_of(window[0] + window[1] + window[2]);
        let window = each!(row in [0, 1, 2] => first_three(window[row] * (1.0 / window_sum)));
        if sum < LEAST_SUM {
            return Self { lanczos: [[0.0; 3], [0.0, 1.0, 0.0], [0.0; 3]], sum: 0.0, window };
        }
        Self { lanczos: each!(row in [0, 1, 2] => first_three(lanczos[row] * (1.0 / sum))), sum, window }
    }
}

/// Returns the sum of the lanes.
#[inline(always)]
fn sum_of<S: Simd>(lanes: f32x4<S>) -> f32 {
    let [a, b, c, d] = lanes.to_array();
    a + b + c + d
}

/// Returns the first three lanes.
#[inline(always)]
fn first_three<S: Simd>(lanes: f32x4<S>) -> [f32; 3] {
    let [a, b, c, _] = lanes.to_array();
    [a, b, c]
}
