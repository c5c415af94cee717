//! Weights of the 3 × 3 samples around sixteen pixels, and the statistics of their colours.

use super::super::Lattice;
use super::super::lattice::ThreeSamples;
use super::super::planes::PAD;
use crate::math::lanes::*;

/// Exponents of the Gaussian that weights the colours of the box by squared distance, in sample distances: of pixels that
/// do not move, and of fast ones.
const BOX_EXPONENTS: [f64; 2] = [-2.0, -3.0];

/// Smallest sum of weights that is used: dividing by less would amplify rounding errors. It is a fiftieth of the weight
/// of a sample at the centre of the pixel.
const LEAST_SUM: f32 = 0.005;

/// Excess of the present colour over the range of the samples that is not clamped, relative to white.
const OVERSHOOT: f32 = 0.075;

/// Factor of the sum of weights in the weight of the present colour.
const WEIGHT_SCALE: f32 = 1.0 / 3.0;

/// Samples around every output column or row along an axis, padded to a multiple of [`WIDE`] by repeating the last one.
/// The three vectors of each quantity belong to the sample before, nearest to and after the pixel.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    /// Indices of the samples.
    pub(super) index: Vec<[u32; 3]>,
    /// Index of the nearest sample in a padded row.
    pub(super) padded: Vec<u32>,
    /// Squared distances from the centre of the pixel, in sample distances.
    squared: [Vec<f32>; 3],
    /// Weights in the box of colours of a pixel that does not move, and of a fast one.
    boxes: [[Vec<f32>; 3]; 2],
}

/// Distances and weights of three samples along one axis, for sixteen pixels.
#[derive(Clone, Copy)]
pub(super) struct AxisLanes<S: Simd> {
    squared: [f32x16<S>; 3],
    boxes: [[f32x16<S>; 3]; 2],
}

impl Axis {
    /// Returns the samples of an axis of `length` pixels, out of `samples` samples that lie at `place` within their areas.
    pub(super) fn new(lattice: Lattice, place: f64, length: u32, samples: u32) -> Self {
        let padded = length.next_multiple_of(WIDE as u32);
        let all: Vec<ThreeSamples> =
            (0..padded).map(|at| lattice.three_around(place, at.min(length - 1), samples)).collect();
        let of_each = |value: &dyn Fn(f64) -> f32| {
            [-1.0, 0.0, 1.0].map(|number: f64| {
                all.iter().map(|three| value(number - f64::from(three.from_nearest))).collect::<Vec<f32>>()
            })
        };
        let gaussian = |exponent: f64| move |distance: f64| (exponent * distance * distance).exp() as f32;
        Self {
            index: all.iter().map(|three| three.index).collect(),
            padded: all.iter().map(|three| (three.nearest + PAD as i64) as u32).collect(),
            squared: of_each(&|distance| (distance * distance) as f32),
            boxes: BOX_EXPONENTS.map(|exponent| of_each(&gaussian(exponent))),
        }
    }

    /// Loads sixteen adjacent pixels, starting at `first`, which is a multiple of [`WIDE`].
    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S, first: usize) -> AxisLanes<S> {
        let load = |numbers: &Vec<f32>| f32x16::from_slice(simd, &numbers[first..first + WIDE]);
        AxisLanes {
            squared: each!(i in [0, 1, 2] => load(&self.squared[i])),
            boxes: each!(speed in [0, 1] => each!(i in [0, 1, 2] => load(&self.boxes[speed][i]))),
        }
    }

    /// Loads the same pixel into all lanes.
    #[inline(always)]
    pub(super) fn splat<S: Simd>(&self, simd: S, at: usize) -> AxisLanes<S> {
        AxisLanes {
            squared: each!(i in [0, 1, 2] => f32x16::splat(simd, self.squared[i][at])),
            boxes: each!(speed in [0, 1] => each!(i in [0, 1, 2] => f32x16::splat(simd, self.boxes[speed][i][at]))),
        }
    }
}

/// Columns and rows of the samples around sixteen pixels.
pub(super) struct Position<S: Simd> {
    pub(super) columns: AxisLanes<S>,
    pub(super) rows: AxisLanes<S>,
}

/// Shape of the kernel for sixteen pixels.
#[derive(Clone, Copy)]
pub(super) struct Shape<S: Simd> {
    /// Factor of squared distances: the kernel ends where their product is 1.
    pub(super) narrowing: f32x16<S>,
    /// Share of the box weights of fast pixels, in [0, 1].
    pub(super) fast: f32x16<S>,
}

/// Colours of the 3 × 3 samples around sixteen pixels.
pub(super) trait Samples<S: Simd> {
    /// Returns the colours of the samples in a row and a column.
    fn at(&self, row: usize, column: usize) -> [f32x16<S>; 3];

    /// Returns the least and the greatest of the nine colours.
    fn range(&self) -> [[f32x16<S>; 3]; 2];
}

/// Colours around sixteen pixels: their weighted mean, and the box that limits the history.
pub(super) struct Around<S: Simd> {
    /// Colour of this frame alone.
    pub(super) present: [f32x16<S>; 3],
    /// Weight of the present colour.
    pub(super) weight: f32x16<S>,
    pub(super) least: [f32x16<S>; 3],
    pub(super) greatest: [f32x16<S>; 3],
    pub(super) mean: [f32x16<S>; 3],
    pub(super) deviation: [f32x16<S>; 3],
}

impl<S: Simd> Position<S> {
    /// Returns the weight of a sample in the present colour: an approximation of a Lanczos kernel by a polynomial of the
    /// squared distance, (x − 1)³·(x − ¼), where x = 1 at the end of the kernel.
    #[inline(always)]
    pub(super) fn weight(&self, simd: S, shape: Shape<S>, (row, column): (usize, usize)) -> f32x16<S> {
        let squared = self.columns.squared[column] + self.rows.squared[row];
        let end = (squared * shape.narrowing).min(f32x16::splat(simd, 1.0)) - 1.0;
        let end_squared = end * end;
        (end * 0.75 + end_squared) * end_squared
    }

    /// Returns the weight of a sample in the box of colours.
    #[inline(always)]
    fn box_weight(&self, shape: Shape<S>, (row, column): (usize, usize)) -> f32x16<S> {
        let [still, fast] = each!(speed in [0, 1] => self.columns.boxes[speed][column] * self.rows.boxes[speed][row]);
        still + (fast - still) * shape.fast
    }

    /// Computes the mean and the box of the colours of samples. `white` is the luminance of white.
    #[inline(always)]
    pub(super) fn around(&self, simd: S, shape: Shape<S>, white: f32, samples: &impl Samples<S>) -> Around<S> {
        let zero = f32x16::splat(simd, 0.0);
        let (mut colors, mut mean, mut squares) = ([zero; 3], [zero; 3], [zero; 3]);
        let (mut sum, mut box_sum) = (zero, zero);
        for row in 0..3 {
            for column in 0..3 {
                let (weight, box_weight) =
                    (self.weight(simd, shape, (row, column)), self.box_weight(shape, (row, column)));
                sum += weight;
                box_sum += box_weight;
                for (channel, value) in samples.at(row, column).into_iter().enumerate() {
                    let boxed = value * box_weight;
                    colors[channel] += value * weight;
                    mean[channel] += boxed;
                    squares[channel] += boxed * value;
                }
            }
        }
        let [least, greatest] = samples.range();
        let middle = samples.at(1, 1);
        let is_near = sum.simd_ge(LEAST_SUM);
        let one = f32x16::splat(simd, 1.0);
        let (inverse, box_inverse) = (one / is_near.select(sum, one), one / box_sum);
        let present = each!(channel in [0, 1, 2] => {
            let limit = (least[channel] - OVERSHOOT * white, greatest[channel] + OVERSHOOT * white);
            is_near.select((colors[channel] * inverse).max(limit.0).min(limit.1), middle[channel])
        });
        let mean = each!(channel in [0, 1, 2] => mean[channel] * box_inverse);
        let deviation = each!(channel in [0, 1, 2] => {
            (squares[channel] * box_inverse - mean[channel] * mean[channel]).max(zero).sqrt()
        });
        Around { present, weight: is_near.select(sum * WEIGHT_SCALE, zero), least, greatest, mean, deviation }
    }
}

/// Returns whether the sum of the weights of the present colour is used.
pub(super) fn is_near(sum: f32) -> bool {
    sum >= LEAST_SUM
}
