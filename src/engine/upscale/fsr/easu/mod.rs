//! Edge-adaptive spatial upsampling (EASU).
//!
//! An output pixel is surrounded by its four nearest samples f, g, j, k and eight more:
//!
//! ```text
//!     b c            1. At each of f, g, j, k: horizontal and vertical luma slopes, and straightness (1 for an
//!   e f g h             even slope, 0 for a ridge). These are interpolated bilinearly at the pixel.
//!   i j k l          2. They give the edge direction and a kernel stretched along it: a polynomial that
//!     n o               resembles Lanczos and is narrower across a clear edge.
//!                    3. The result is the weighted mean, clamped to the range of f, g, j, k.
//! ```
//!
//! Let s be the squared distance from the pixel, scaled along and across the edge. For a lobe λ, AMD's publication
//! gives the weight as (25/16 (2/5 s − 1)² − 9/16) (λ s − 1)², cut off at s = 1/λ. That equals ¼ · (s − 1) (s − 4)
//! (λ s − 1)². With w = 1 − λ s, clamped to at least 0, it is w² (w² − (2 − 5 λ) w + (1 − λ) (1 − 4 λ)) times a factor
//! common to all weights of a pixel. The factor cancels when the weights are normalised, so it is omitted. λ s is a
//! quadratic form in x and y.
//!
//! Channels are 8-bit sRGB-encoded values. Slopes depend only on the samples, so they are computed once per sample.
//! Alpha is filtered like a colour channel.
//!
//! Slopes and the kernel are floats. The twelve weights are 16-bit fixed point, because a register holds twice as many
//! 16-bit values as floats; each product is rounded once ([`times_one`]). Sums of weighted samples are exact. Rounding
//! changes a channel by at most 0.2 of an 8-bit step for random black and white samples, and by at most 0.3 in a search
//! for bad cases. In photographs, one channel value in a thousand differs by one from correct rounding.
//!
//! This file contains the scalar version for one pixel. [`wide`] is the SIMD version; it reads the per-sample data of
//! [`source`] and uses the operations of [`super::words`].

mod phases;
mod source;
mod wide;

use super::words::times_one;
use crate::image::{Image, Rgba8};
use crate::upscale::lattice::{Lattice, LatticePosition};

pub(super) use phases::phases;
pub(super) use wide::{EasuFrame, EasuScratch};

/// Squared luma slope below which no edge direction is computed. Luma ranges from 0 to 510. The slope itself is 255 /
/// 181: for greys, a difference of 0.7 of an 8-bit step between the two neighbours of a sample.
const MIN_SLOPE: f32 = 255.0 * 255.0 / 32768.0;

/// Difference between the lobe λ at a clear edge and its value of ½ elsewhere.
const EDGE_LOBE: f32 = 0.25 - 0.04 - 0.5;

/// 2²³: adding it to a float rounds the float to an integer, which is then the low byte of the bit pattern.
const WHOLE: f32 = (1 << 23) as f32;

/// Column and row offsets of the twelve samples b to o, relative to f.
const PLACES: [(i32, i32); 12] =
    [(0, -1), (1, -1), (-1, 0), (0, 0), (1, 0), (2, 0), (-1, 1), (0, 1), (1, 1), (2, 1), (0, 2), (1, 2)];

/// Indices of the four nearest samples in [`PLACES`].
const NEAREST: [usize; 4] = [3, 4, 7, 8];

/// Returns the slope between the two neighbours of a value, and its straightness: 1 if the slope is equal on both
/// sides, 0 at a ridge.
#[inline(always)]
fn slope(before: f32, at: f32, after: f32) -> (f32, f32) {
    let slope = after - before;
    let (one, other) = ((after - at).abs(), (at - before).abs());
    let steepest = if one > other { one } else { other };
    let straight = if steepest > 0.0 { slope.abs() / steepest } else { 0.0 };
    let straight = if straight < 1.0 { straight } else { 1.0 };
    (slope, straight * straight)
}

/// Position of an output pixel relative to the sample f, in samples, in [0, 1).
#[derive(Clone, Copy)]
struct Spot {
    x: f32,
    y: f32,
}

impl Spot {
    fn new(lattice: Lattice, x: u32, y: u32) -> Self {
        let [x, y] = [x, y].map(|phase| phase as f32 / lattice.phases() as f32);
        Self { x, y }
    }

    /// Interpolates bilinearly between the values at the four nearest samples.
    fn mix(self, [f, g, j, k]: [f32; 4]) -> f32 {
        let (left, right) = (f * (1.0 - self.y) + j * self.y, g * (1.0 - self.y) + k * self.y);
        left * (1.0 - self.x) + right * self.x
    }
}

/// Number that represents w = 1 in fixed point, before w is clamped. With this scale, 16 bits can represent values down
/// to w = −2, which no sample reaches.
const ONE: i16 = 15 << 10;

/// Number that represents w = 1 in fixed point, after w is clamped to [0, 1] and the number is doubled. The coefficient
/// of w has the same format.
const ONE_DOUBLED: f32 = 2.0 * ONE as f32;

/// Number that represents w² = 1 in fixed point.
const ONE_SQUARED: f32 = ONE_DOUBLED * ONE_DOUBLED / 32768.0;

/// Number that represents 1 in the fixed-point format of the coefficients of x², xy and y², which are at most ½. It is
/// large enough that the squared offsets of samples, which are at most 4, fit in the 16 bits of [`Distances`]: even for
/// the largest one, 4 · [`ONE`] / `FACTOR` is less than 1.
const FACTOR: f32 = 61_500.0;

/// Kernel of an output pixel, oriented along the edge and scaled along both axes. The coefficients are floats that are
/// rounded later.
#[derive(Clone, Copy)]
struct EasuKernel {
    /// Coefficient of x² in λ s. The fields `xy` and `yy` hold the coefficients of xy and y². All are in units of 1 /
    /// [`FACTOR`].
    xx: f32,
    xy: f32,
    yy: f32,
    /// Coefficient 2 − 5 λ, in units of 1 / [`ONE_DOUBLED`]. The field `rest` holds (1 − λ) (1 − 4 λ), in units of 1 /
    /// [`ONE_SQUARED`].
    slope: f32,
    rest: f32,
}

impl EasuKernel {
    /// Computes the kernel from the interpolated slopes and straightness.
    fn new(across: f32, down: f32, straightness: f32) -> Self {
        let flat = across * across + down * down < MIN_SLOPE;
        let (across, down) = if flat { (1.0, 0.0) } else { (across, down) };
        let (xx, yy) = (across * across, down * down);
        let (squared, most) = (xx + yy, xx.max(yy));
        // Both quotients by `squared` and by `most` are derived from this one division.
        let inverse = 1.0 / (squared * most);
        let stretch = ((squared * squared) * inverse).sqrt();
        // Squares and product of the components of the unit direction.
        let inverse = most * inverse;
        let (xx, xy, yy) = (xx * inverse, (across * down) * inverse, yy * inverse);
        let half = straightness * 0.5;
        let edge = half * half;
        let (along, across) = ((stretch - 1.0) * edge + 1.0, 1.0 - edge * 0.5);
        let (along, across) = (along * along, across * across);
        // A lobe of ½ gives a plain blob; near ¼ the kernel resembles Lanczos with two lobes.
        let lobe = edge * EDGE_LOBE + 0.5;
        let factor = lobe * FACTOR;
        let (blob, turned) = (across * factor, (along - across) * factor);
        Self {
            xx: blob + turned * xx,
            xy: (turned + turned) * xy,
            yy: blob + turned * yy,
            slope: 2.0 * ONE_DOUBLED - lobe * (5.0 * ONE_DOUBLED),
            rest: (ONE_SQUARED - lobe * ONE_SQUARED) * (1.0 - lobe * 4.0),
        }
    }

    /// Returns the weights of the twelve samples, up to a common factor.
    fn weights(&self, distances: &Distances) -> [i16; 12] {
        let [xx, xy, yy, slope, rest] =
            [self.xx, self.xy, self.yy, self.slope, self.rest].map(|value| value.round_ties_even() as i16);
        std::array::from_fn(|place| {
            let (column, row) = ((PLACES[place].0 + 1) as usize, (PLACES[place].1 + 1) as usize);
            let w = (ONE - times_one(xx, distances.xx[column])) - times_one(yy, distances.yy[row]);
            let w = (w - times_one(xy, distances.xy[place])).max(0);
            let w = w + w;
            let squared = times_one(w, w);
            times_one(squared, squared + (rest - times_one(w, slope)))
        })
    }
}

/// Offsets of the samples from a pixel, scaled so that products with the coefficients of a [`EasuKernel`] are in units
/// of 1 / [`ONE`].
#[derive(Clone, Copy)]
struct Distances {
    /// Squared horizontal offsets of the four columns; `yy` holds the squared vertical offsets of the four rows.
    xx: [i16; 4],
    yy: [i16; 4],
    /// Horizontal times vertical offset of each of the twelve samples.
    xy: [i16; 12],
}

impl Distances {
    fn new(Spot { x, y }: Spot) -> Self {
        let fixed = |product: f32| (product * (f32::from(ONE) * 32768.0 / FACTOR)).round_ties_even() as i16;
        let squares = |from: f32| [-1.0, 0.0, 1.0, 2.0].map(|at: f32| fixed((at - from) * (at - from)));
        let products = PLACES.map(|(column, row)| fixed((column as f32 - x) * (row as f32 - y)));
        Self { xx: squares(x), yy: squares(y), xy: products }
    }
}

/// Returns the reciprocal of the sum of the weights, which normalises them.
fn share(weights: &[i16; 12]) -> f32 {
    1.0 / f32::from(weights.iter().sum::<i16>())
}

/// Computes one channel of a pixel: the weighted mean of twelve samples, clamped to the range of the four nearest.
fn code(weights: &[i16; 12], share: f32, samples: &[u8; 12]) -> u8 {
    let sum: i32 = weights.iter().zip(samples).map(|(weight, sample)| i32::from(*weight) * i32::from(*sample)).sum();
    let [f, g, j, k] = NEAREST.map(|place| samples[place]);
    let (least, greatest) = (f.min(g).min(j.min(k)), f.max(g).max(j.max(k)));
    let value = (sum as f32 * share).max(f32::from(least)).min(f32::from(greatest));
    (value + WHOLE).to_bits() as u8
}

/// Returns four values for an output pixel: its horizontal and its vertical position between the samples, the weights
/// of the twelve samples, and the factor that normalises these weights.
fn weights_at(
    drawn: &Image<Rgba8>,
    lattice: Lattice,
    (x, y): (u32, u32),
) -> (LatticePosition, LatticePosition, [i16; 12], f32) {
    let (column, row) = (lattice.place(x), lattice.place(y));
    let luma = |x: i32, y: i32| {
        let [r, g, b, _] = drawn.at_clamped(x.into(), y.into()).map(f32::from);
        0.5 * (r + b) + g
    };
    let (mut across, mut down, mut straightness) = ([0.0; 4], [0.0; 4], [0.0; 4]);
    for (index, place) in NEAREST.into_iter().enumerate() {
        let (x, y) = (column.cell + PLACES[place].0, row.cell + PLACES[place].1);
        let (dx, along_x) = slope(luma(x - 1, y), luma(x, y), luma(x + 1, y));
        let (dy, along_y) = slope(luma(x, y - 1), luma(x, y), luma(x, y + 1));
        (across[index], down[index], straightness[index]) = (dx, dy, along_x + along_y);
    }
    let spot = Spot::new(lattice, column.phase, row.phase);
    let shape = EasuKernel::new(spot.mix(across), spot.mix(down), spot.mix(straightness));
    let weights = shape.weights(&Distances::new(spot));
    (column, row, weights, share(&weights))
}

/// Computes one pixel, bit-identical to [`EasuFrame::fill`].
pub(super) fn pixel(drawn: &Image<Rgba8>, lattice: Lattice, at: (u32, u32)) -> Rgba8 {
    let (column, row, weights, share) = weights_at(drawn, lattice, at);
    let samples = PLACES.map(|(x, y)| drawn.at_clamped((column.cell + x).into(), (row.cell + y).into()));
    std::array::from_fn(|channel| code(&weights, share, &samples.map(|sample| sample[channel])))
}

/// Returns the distinct samples that contribute to a pixel: row, column and weight.
pub(super) fn taps(drawn: &Image<Rgba8>, lattice: Lattice, at: (u32, u32)) -> Vec<(u32, u32, f32)> {
    let (column, row, weights, share) = weights_at(drawn, lattice, at);
    let inside = |at: i32, length: u32| at.clamp(0, length as i32 - 1) as u32;
    let mut taps: Vec<(u32, u32, f32)> = Vec::with_capacity(PLACES.len());
    for ((x, y), weight) in PLACES.into_iter().zip(weights) {
        let (x, y) = (inside(column.cell + x, drawn.width()), inside(row.cell + y, drawn.height()));
        match taps.iter_mut().find(|tap| (tap.0, tap.1) == (y, x)) {
            Some(tap) => tap.2 += f32::from(weight) * share,
            None => taps.push((y, x, f32::from(weight) * share)),
        }
    }
    taps
}
