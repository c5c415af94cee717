//! Edge-adaptive spatial upsampling.
//!
//! Around an output pixel stand the four nearest samples f, g, j, k and eight more:
//!
//! ```text
//!     b c            1. at each of the four: the slope of luma across and down, and how straight it runs (1 for an
//!   e f g h             even slope, 0 for a ridge), mixed by their nearness to the pixel
//!   i j k l          2. that gives the direction of the edge, and a kernel stretched along it: a polynomial that
//!     n o               resembles Lanczos's, narrower across a clear edge
//!                    3. the weighted mean, kept within the range of f, g, j, k
//! ```
//!
//! The publication writes the weight at a squared distance s from the pixel, measured along the edge and across it and cut
//! off at 1/λ for a lobe λ, as (25/16 (2/5 s − 1)² − 9/16) (λ s − 1)². That is ¼ · (s − 1) (s − 4) (λ s − 1)². With
//! w = 1 − λ s, cut off at 0, it is w² (w² − (2 − 5 λ) w + (1 − λ) (1 − 4 λ)) but for a factor that all weights of a pixel
//! have, and as they are divided by their sum, it is left out. λ s is a quadratic form in x and y.
//!
//! Channels are codes. Slopes belong to samples, so they are found once for each. Alpha is weighed like a colour.
//!
//! Slopes and the kernel are floats. The twelve weights are numbers of sixteen bits, as a register holds twice as many of
//! them: fixed point, each product rounded once ([`times_one`]). Sums of weighed samples are exact again. Rounding moves a colour
//! by a fifth of a code at most where samples are black and white at random, and three tenths are the most that a search for bad
//! cases found; of the codes of photographs one in a thousand is a neighbour of the nearest.
//!
//! This file has the arithmetic of one pixel. [`wide`] has the same for many, from what [`source`] found about samples, with
//! the operations of [`super::words`].

mod source;
mod wide;

use super::words::times_one;
use crate::image::{Image, Rgba8};
use crate::upscale::lattice::{Lattice, Place};

pub(super) use wide::{Scratch, fill};

/// Below this a squared slope has no direction: (1/181)² of the range of codes, less than a code over the width of the
/// kernel.
const LEAST_SLOPE: f32 = 255.0 * 255.0 / 32768.0;

/// What a clear edge takes off the lobe.
const LOBE_OF_EDGE: f32 = 0.25 - 0.04 - 0.5;

/// From here on floats are whole numbers, so that a sum rounds to one, which stands in its last byte.
const WHOLE: f32 = (1 << 23) as f32;

/// Places of the twelve samples relative to f, columns and rows.
const PLACES: [(i32, i32); 12] =
    [(0, -1), (1, -1), (-1, 0), (0, 0), (1, 0), (2, 0), (-1, 1), (0, 1), (1, 1), (2, 1), (0, 2), (1, 2)];

/// The four nearest, as places in [`PLACES`].
const NEAREST: [usize; 4] = [3, 4, 7, 8];

/// The slope at a value between two, and how straight it runs: 1 where both sides share it, 0 at a ridge.
#[inline(always)]
fn slope(before: f32, at: f32, after: f32) -> (f32, f32) {
    let slope = after - before;
    let (one, other) = ((after - at).abs(), (at - before).abs());
    let steepest = if one > other { one } else { other };
    let straight = if steepest > 0.0 { slope.abs() / steepest } else { 0.0 };
    let straight = if straight < 1.0 { straight } else { 1.0 };
    (slope, straight * straight)
}

/// Where the pixel lies between f and its neighbours, in samples.
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

    /// From what is known about the four nearest what it is here.
    fn mix(self, [f, g, j, k]: [f32; 4]) -> f32 {
        let (left, right) = (f * (1.0 - self.y) + j * self.y, g * (1.0 - self.y) + k * self.y);
        left * (1.0 - self.x) + right * self.x
    }
}

/// One while w is found: down to −2, which no sample reaches, it stays within sixteen bits.
const ONE: i16 = 15 << 10;

/// One as w, which is doubled once it is between 0 and 1, and as a factor of it.
const ONE_DOUBLED: f32 = 2.0 * ONE as f32;

/// One as a square of w.
const ONE_SQUARED: f32 = ONE_DOUBLED * ONE_DOUBLED / 32768.0;

/// One as a factor of x², xy or y², which are at most ½. The squared distance of two samples has to stay within sixteen bits
/// as a [`Distances`]: four times [`ONE`] over this is less than one.
const FACTOR: f32 = 61_500.0;

/// The kernel at a pixel, turned along the edge and scaled along both of its axes: floats that are to be rounded.
#[derive(Clone, Copy)]
struct Shape {
    /// Factors of x², xy and y² in the squared distance times the lobe, in 1 / [`FACTOR`].
    xx: f32,
    xy: f32,
    yy: f32,
    /// Factor of w, in 1 / [`ONE_DOUBLED`], and what that is taken off from, in 1 / [`ONE_SQUARED`].
    slope: f32,
    rest: f32,
}

impl Shape {
    /// From the mixed slopes and straightness.
    fn new(across: f32, down: f32, straightness: f32) -> Self {
        let flat = across * across + down * down < LEAST_SLOPE;
        let (across, down) = if flat { (1.0, 0.0) } else { (across, down) };
        let (xx, yy) = (across * across, down * down);
        let (squared, most) = (xx + yy, xx.max(yy));
        // One division for two: by the squared length, and by its greater part.
        let inverse = 1.0 / (squared * most);
        let stretch = ((squared * squared) * inverse).sqrt();
        // The squares of the direction's components, and their product.
        let inverse = most * inverse;
        let (xx, xy, yy) = (xx * inverse, (across * down) * inverse, yy * inverse);
        let half = straightness * 0.5;
        let edge = half * half;
        let (along, across) = ((stretch - 1.0) * edge + 1.0, 1.0 - edge * 0.5);
        let (along, across) = (along * along, across * across);
        // A lobe of ½ is a plain blob; near ¼ the kernel resembles Lanczos with two lobes.
        let lobe = edge * LOBE_OF_EDGE + 0.5;
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

    /// Weights of the twelve samples, but for a factor that all have.
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

/// How far the samples stand from a pixel, for products with the factors of a [`Shape`] that are in 1 / [`ONE`].
#[derive(Clone, Copy)]
struct Distances {
    /// Of four columns and four rows, squared.
    xx: [i16; 4],
    yy: [i16; 4],
    /// Of the twelve samples across times down.
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

/// The share of a weight of one.
fn share(weights: &[i16; 12]) -> f32 {
    1.0 / f32::from(weights.iter().sum::<i16>())
}

/// One channel of a pixel from weights and the twelve samples, within the range of the four nearest.
fn code(weights: &[i16; 12], share: f32, samples: &[u8; 12]) -> u8 {
    let sum: i32 = weights.iter().zip(samples).map(|(weight, sample)| i32::from(*weight) * i32::from(*sample)).sum();
    let [f, g, j, k] = NEAREST.map(|place| samples[place]);
    let (least, greatest) = (f.min(g).min(j.min(k)), f.max(g).max(j.max(k)));
    let value = (sum as f32 * share).max(f32::from(least)).min(f32::from(greatest));
    (value + WHOLE).to_bits() as u8
}

/// Weights at one pixel, by the cell that it lies in, and the share of a weight of one.
fn weights_at(drawn: &Image<Rgba8>, lattice: Lattice, (x, y): (u32, u32)) -> (Place, Place, [i16; 12], f32) {
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
    let shape = Shape::new(spot.mix(across), spot.mix(down), spot.mix(straightness));
    let weights = shape.weights(&Distances::new(spot));
    (column, row, weights, share(&weights))
}

/// One pixel, by the arithmetic that fills the whole picture.
pub(super) fn pixel(drawn: &Image<Rgba8>, lattice: Lattice, at: (u32, u32)) -> Rgba8 {
    let (column, row, weights, share) = weights_at(drawn, lattice, at);
    let samples = PLACES.map(|(x, y)| drawn.at_clamped((column.cell + x).into(), (row.cell + y).into()));
    std::array::from_fn(|channel| code(&weights, share, &samples.map(|sample| sample[channel])))
}

/// The samples of one pixel, each once: row, column and weight.
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
