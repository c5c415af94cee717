//! Weights of the samples around pixels, and of the history pixels around positions.

use super::super::Lattice;
use super::super::lattice::ThreeSamples;
use super::super::planes::{PAD, SampleLanes};
use super::super::quads::{window, with_spare};
use crate::math::lanes::*;

/// Smallest sum of weights that is used: dividing by less would amplify rounding errors.
const LEAST_SUM: f32 = 0.05;

/// Maximum of [`Kernel::new`]'s narrowing; the published limit keeps at least one sample inside the kernel.
const MOST_NARROWING: f32 = 1.99;

/// Samples along one axis that contribute to an output column or row; see [`ThreeSamples`].
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisSamples {
    pub(super) index: [u32; 3],
    /// Index of the middle one in a padded row.
    pub(super) padded: u32,
    /// Squared distance of each sample from the centre of the output pixel, relative to the distance between samples.
    pub(super) distance_squared: [f32; 3],
    /// Whether the middle sample lies inside the output pixel along this axis.
    pub(super) is_inside: bool,
}

/// [`AxisSamples`] of all columns. Those of sixteen can be loaded from every column.
pub(super) struct ColumnLanes {
    padded: Vec<u32>,
    distance_squared: [Vec<f32>; 3],
    /// 1 where the middle sample lies inside the output pixel along this axis, otherwise 0.
    inside: Vec<f32>,
}

impl ColumnLanes {
    pub(super) fn new(columns: &[AxisSamples]) -> Self {
        Self {
            padded: with_spare(columns, |column| column.padded),
            distance_squared: [0, 1, 2].map(|number| with_spare(columns, |column| column.distance_squared[number])),
            inside: with_spare(columns, |column| f32::from(u8::from(column.is_inside))),
        }
    }

    /// Returns the samples nearest to sixteen columns from column `from` on.
    #[inline(always)]
    pub(super) fn samples<S: Simd>(&self, simd: S, from: usize) -> SampleLanes<S> {
        SampleLanes::ascending(simd, window(&self.padded, from))
    }

    /// Returns the squared distances of the sample before the nearest one, of that one, and of the next.
    #[inline(always)]
    pub(super) fn distance_squared<S: Simd>(&self, simd: S, from: usize) -> [f32x16<S>; 3] {
        each!(number in [0, 1, 2] => f32x16::load_array_ref(simd, window(&self.distance_squared[number], from)))
    }

    /// Whether the nearest sample lies inside the output pixel along this axis.
    #[inline(always)]
    pub(super) fn is_inside<S: Simd>(&self, simd: S, from: usize) -> mask32x16<S> {
        f32x16::load_array_ref(simd, window(&self.inside, from)).simd_gt(f32x16::splat(simd, 0.0))
    }
}

impl AxisSamples {
    /// Returns the samples around output column or row `at`, out of `samples` samples of a lattice. They lie at `place`
    /// within their areas.
    pub(super) fn new(lattice: Lattice, place: f64, at: u32, samples: u32) -> Self {
        let ThreeSamples { index, nearest, from_nearest } = lattice.three_around(place, at, samples);
        Self {
            index,
            padded: (nearest + PAD as i64) as u32,
            distance_squared: [-1.0, 0.0, 1.0].map(|number: f32| (number - from_nearest) * (number - from_nearest)),
            is_inside: f64::from(from_nearest.abs()) * lattice.scale.value() <= 0.5,
        }
    }
}

/// Returns the radial Lanczos kernel with two lobes at squared distances, as published: a polynomial that differs from
/// sinc(x) · sinc(x / 2) by at most 0.05. It is zero from distance 2 on.
#[inline(always)]
pub(super) fn lanczos2<S: Simd>(distance_squared: f32x16<S>) -> f32x16<S> {
    let squared = distance_squared.min(4.0);
    let (wave, window) = (squared * 0.4 - 1.0, squared * 0.25 - 1.0);
    (wave * wave * (25.0 / 16.0) - 9.0 / 16.0) * (window * window)
}

/// Returns the weights of four adjacent history pixels for positions at `t` in [0, 1) between the second and the third.
/// They sum to 1.
#[inline(always)]
pub(super) fn history_weights<S: Simd>(t: f32x16<S>) -> [f32x16<S>; 4] {
    let [a, b, c, d] = each!(from in [1.0, 0.0, -1.0, -2.0] => {
        let distance = t + from;
        lanczos2(distance * distance)
    });
    let scale = 1.0 / (a + b + c + d);
    each!(weight in [a, b, c, d] => weight * scale)
}

/// Weights of the 3 × 3 samples around sixteen pixels, row by row.
pub(super) struct Kernel<S: Simd> {
    /// Weights of the present colour, which sum to 1.
    pub(super) lanczos: [[f32x16<S>; 3]; 3],
    /// Sums of the Lanczos weights: the weight of the present colour; 0 if no sample is near enough.
    pub(super) sum: f32x16<S>,
    /// Weights of the mean and the variance, which sum to 1.
    pub(super) window: [[f32x16<S>; 3]; 3],
}

impl<S: Simd> Kernel<S> {
    /// Computes the weights from the squared distances of the samples along the rows and the columns. A narrowing of 1
    /// gives a kernel that spans two samples to each side. Larger ones make it narrower by that factor, up to
    /// [`MOST_NARROWING`].
    #[inline(always)]
    pub(super) fn new(simd: S, across: [f32x16<S>; 3], down: [f32; 3], narrowing: f32x16<S>) -> Self {
        let narrowing = narrowing.min(MOST_NARROWING);
        let factor = narrowing * narrowing;
        let squared = each!(row in [0, 1, 2] => each!(column in [0, 1, 2] => across[column] + down[row]));
        let lanczos = each!(row in [0, 1, 2] => each!(column in [0, 1, 2] => lanczos2(squared[row][column] * factor)));
        let window = each!(row in [0, 1, 2] => each!(column in [0, 1, 2] => {
            let inside = f32x16::splat(simd, 1.0) - (squared[row][column] * (1.0 / 3.0)).min(1.0);
            inside * inside
        }));
        let (sum, window_scale) = (sum_of(&lanczos), 1.0 / sum_of(&window));
        let is_near = sum.simd_ge(f32x16::splat(simd, LEAST_SUM));
        let scale = 1.0 / sum;
        let zero = f32x16::splat(simd, 0.0);
        Self {
            lanczos: each!(row in [0, 1, 2] => each!(column in [0, 1, 2] => {
                let alone = f32x16::splat(simd, if row == 1 && column == 1 { 1.0 } else { 0.0 });
                is_near.select(lanczos[row][column] * scale, alone)
            })),
            sum: is_near.select(sum, zero),
            window: each!(row in [0, 1, 2] => each!(column in [0, 1, 2] => window[row][column] * window_scale)),
        }
    }
}

/// Returns the sum of nine vectors.
#[inline(always)]
fn sum_of<S: Simd>(rows: &[[f32x16<S>; 3]; 3]) -> f32x16<S> {
    let [above, at, below] = each!(row in [0, 1, 2] => rows[row][0] + rows[row][1] + rows[row][2]);
    above + at + below
}
